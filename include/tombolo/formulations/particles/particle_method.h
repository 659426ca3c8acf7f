// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/failure/bonds.h>
#include <tombolo/formulations/particles/nodal_particles.h>
#include <tombolo/formulations/particles/particle_rows.h>
#include <tombolo/formulations/particles/self_contact.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * Particles of one part on any rows (ParticleRows): what particle methods share, however φ and ∇φ
   * come about. Stress, strain and force are those of eqs (13), (5), (16) of Pan et al. 2019, with
   * gradients carried from the reference of the kernel to the present by the deformation since
   * then, F_I = Σ_J x_J ⊗ ∇φ_J. A derived class makes the rows and chooses the smoothing, or none.
   */
  template <int dim>
  class ParticleMethod : public NodalParticles<dim>
  {
  public:
    StepCost step_cost(const Material &material, double box_ratio) const override;
    void initialize(const PartSetup<dim> &setup) override;
    dealii::IndexSet required_nodes() const override;
    std::vector<ImageNode> required_image_nodes() const override
    {
      return rows->required_image_nodes();
    }
    void set_partition(const NodePartition &partition) override;
    EnergyAccounts energies() const override;
    NeighbourhoodChange update_neighbourhoods(const NodalVector &position) override;
    void list(Records &records) override;
    void complete_reading(NodalVector &buffer) override;

    const Stencils &stencils() const override
    {
      return rows->stencils();
    }
    Stencils &stencils() override
    {
      return rows->stencils();
    }
    SmoothingSettings smoothing() const override
    {
      return smoothing_settings;
    }
    PatchTest patch_test(const NodalVector &position) const override
    {
      return rows->patch_test(setup, set, kernel, smoothing_settings.is_active, position);
    }
    std::string shape_functions() const override
    {
      return rows->functions();
    }
    const std::vector<SurfaceFibre> &surface_fibres() const override
    {
      return fibres;
    }
    Bonds<dim> *breaking_bonds() override
    {
      return bonds.is_on() ? &bonds : nullptr;
    }

    SelfContact<dim> *fragment_contact() override
    {
      return self_contact.get();
    }

    void add_particles(const CellSelection<dim> &is_taken, const NodalVector &position,
                       const StateTransfer *state, const NodalVector *volumes) override;
    bool can_add_particles() const override
    {
      return true;
    }
    bool sees_other_bodies() const override
    {
      return rows->sees_other_bodies();
    }
    void set_before_change(const std::function<void()> &before_change) override
    {
      bonds.set_before_change(before_change);
    }

  protected:
    /** The entries of what is shared. */
    static void declare_shared_parameters(const Entries &e,
                                          const std::string &default_configuration);

    /** Takes @p rows, which have no particles yet. Throws InputError. */
    ParticleMethod(const Section &section, std::unique_ptr<ParticleRows<dim>> rows,
                   StrainMeasure measure);

    using NodalParticles<dim>::set;
    using NodalParticles<dim>::kernel;
    using NodalParticles<dim>::part_points;

    Section section;
    SmoothingSettings smoothing_settings;
    std::unique_ptr<ParticleRows<dim>> rows;

  private:
    /** Begins with the particles of these cells, without rows. */
    void collect(const CellSelection<dim> &is_taken, const NodalVector *volumes = nullptr);
    void create_points();
    /** Throws the InputError of what the part must not have. Collective. */
    void check_setup() const;
    /** Makes @p position the reference of more particles: new ones get their deformation from rows
     * in the initial configuration. Collective. */
    void renew_reference(const NodalVector &position, const std::vector<unsigned int> &old_index);
    /** Tells self-contact, where there is some, what particles there are. Returns the number of
     * fragments that it has. Collective. */
    unsigned long tell_self_contact();
    /** Finds neighbours anew, here and on other ranks, at these positions (node_stride a particle)
     * and the supports of the reference, and computes the rows. Collective. */
    void find_neighbours(const std::vector<double> &positions);
    /** update_neighbourhoods() of the rows alone. Collective. */
    NeighbourhoodChange update_rows(const NodalVector &position);
    /** Gives rows that depend on them the present volumes. */
    void tell_volumes();

    PartSetup<dim> setup;
    Bonds<dim> bonds;
    std::vector<SurfaceFibre> fibres;
    std::unique_ptr<SelfContact<dim>> self_contact; // null: fragments do not feel each other
    double smallest_spacing_at_start = 0;           // of all that can be particles of the part [L]
  };
} // namespace tombolo
