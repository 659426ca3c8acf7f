#pragma once

#include <tombolo/base/parameters.h>
#include <tombolo/formulations/particle_formulation.h>
#include <tombolo/particles/neighbourhoods.h>

#include <deal.II/base/aligned_vector.h>

#include <memory>

namespace tombolo
{
  /**
   * The particle method of the paper: moving least squares shape functions on cuboidal supports,
   * direct nodal integration with one point at every node, momentum-consistent smoothing (done by the
   * bridge). Stress, strain and force are those of eqs (13), (5), (16), with gradients carried from the
   * kernel's reference to the present by F_I = Σ_J x_J ⊗ ∇φ_J.
   */
  template <int dim>
  class MomentumConsistentParticle : public ParticleFormulation<dim>
  {
  public:
    explicit MomentumConsistentParticle(const Section &section);
    static void declare_parameters(dealii::ParameterHandler &handler);

    unsigned int degree() const override;
    void initialize(const PartSetup<dim> &setup) override;
    dealii::IndexSet required_nodes() const override;
    void set_partition(const NodePartition &partition) override;
    void add_mass(NodalVector &mass) const override;
    void add_internal_force(const MechanicalInput &input, NodalVector &force) override;
    void add_stiffness_action(const NodalVector &position, const NodalVector &velocity,
                              double time_step, NodalVector &force) const override;
    StepLimit courant_limit(const NodalVector &position) const override;
    PartEnergies energies() const override;
    NeighbourhoodChange update_neighbourhoods(const NodalVector &position) override;
    void point_positions(const NodalVector &position,
                         std::vector<dealii::Point<dim>> &points) const override;
    const std::vector<dealii::Point<dim>> &initial_point_positions() const override;
    const MaterialPoints &points() const override;
    MaterialPoints &points() override;
    const Material &material() const override;
    unsigned int n_cells() const override;
    unsigned int n_points_per_cell() const override;
    std::size_t memory_consumption() const override;

    ShapeFunctions &shape_functions() override;
    SmoothingSettings smoothing() const override;
    double smallest_spacing() const override;
    NeighbourCounts neighbour_counts() const override;
    dealii::Point<dim> support(unsigned int i) const override;

  private:
    Section section;
    std::string kernel_name;
    double dilation;
    SmoothingSettings smoothing_settings;
    enum class Configuration
    {
      total_lagrangian,
      updated_lagrangian,
      current
    } configuration;
    unsigned int rebuild_interval;
    double rebuild_deformation;
    unsigned int steps_since_rebuild = 0;

    std::shared_ptr<const Material> part_material;
    Neighbourhoods<dim> neighbourhoods;
    MaterialPoints material_points;
    std::vector<dealii::Point<dim>> initial_positions;
    std::vector<double> initial_volume; // m̂ / ρ₀
    double spacing = 0;
  };
} // namespace tombolo
