// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/particles/kernel_configuration.h>
#include <tombolo/formulations/particles/particle_set.h>
#include <tombolo/formulations/particles/patch_test.h>
#include <tombolo/mesh/bodies.h>

#include <deal.II/base/index_set.h>

#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  class Records;
  class StateArchive;
  class ZeroEnergyControl;
  template <int dim>
  class CellDilatation;

  /**
   * The stencils of the particles of one part, in the reference of their kernels: the search of
   * neighbours, their numbers in a partition, when φ and ∇φ are computed. What these are, a derived
   * class says (fill()). After search() the rows have the numbers of the search until
   * set_partition() gives them those of a partition.
   */
  template <int dim>
  class ParticleRows
  {
  public:
    /** `Kernels across gaps`. */
    static void declare_parameters(const Entries &e);

    virtual ~ParticleRows() = default;
    ParticleRows(const ParticleRows &) = delete;
    ParticleRows &operator=(const ParticleRows &) = delete;

    /** @name What rows are filled with */
    ///@{
    /** Fills value and gradient of @p stencils, the rows of @p found, for nodes at @p position with
     * half widths @p support (both with the numbers of the rows, node_stride a node), and lists
     * rows that have no basis. */
    virtual void fill(const Neighbourhoods<dim> &found, const double *position,
                      const double *support, Stencils &stencils) = 0;
    /** The half width of a support over the spacing of particles. */
    virtual double dilation() const = 0;
    /** The entry that says how far supports reach, for messages. */
    virtual const char *support_entry() const = 0;

    /** Decides which functions the particles of the part have, from now on. Returns whether they
     * are averages over cells. Throws InputError. */
    virtual bool choose_functions(const PartSetup<dim> & /*setup*/,
                                  ParticleSet<dim> & /*particles*/)
    {
      return false;
    }
    /** Gives @p particles, which come from the cells of @p is_taken, other supports than those of
     * their cells. Returns whether it did; then supports do not change as particles deform.
     * Collective. */
    virtual bool choose_supports(const PartSetup<dim> & /*setup*/,
                                 const CellSelection<dim> & /*is_taken*/,
                                 ParticleSet<dim> & /*particles*/)
    {
      return false;
    }
    /** Whether particles are neighbours of those of other bodies: the entry `Kernels across gaps`.
     */
    bool sees_other_bodies() const
    {
      return crosses_gaps;
    }
    /** The dilatation that particles have from cells around them; null: they have their own. */
    virtual CellDilatation<dim> *dilatation_of_cells()
    {
      return nullptr;
    }
    /** What holds modes that the gradients of the particles hardly see; null: nothing. */
    virtual ZeroEnergyControl *zero_energy_control()
    {
      return nullptr;
    }
    /** What the functions are, for the audit. */
    virtual std::string functions() const
    {
      return {};
    }
    /** Whether F = Σ x_J ⊗ ∇φ_J counts as the identity where rows have just been computed, which
     * saves finding it. */
    virtual bool are_undeformed_when_new() const
    {
      return false;
    }
    /** Whether rows change with the volumes of set_present_volumes(). */
    virtual bool depend_on_volumes() const
    {
      return false;
    }
    /** The present volumes of the particles of this rank, before the next rows are computed. */
    virtual void set_present_volumes(const double * /*volumes*/) {}

    /** How far the rows at the start fail the patch test. @p smooths tells whether velocities are
     * smoothed by them, @p position are initial ones with current ghosts. Collective. */
    virtual PatchTest patch_test(const PartSetup<dim> & /*setup*/,
                                 const ParticleSet<dim> & /*particles*/,
                                 const KernelConfiguration<dim> & /*kernel*/, bool /*smooths*/,
                                 const NodalVector & /*position*/) const
    {
      return {};
    }
    ///@}

    void set_images(const std::shared_ptr<const Images> &images)
    {
      neighbours.set_images(images);
    }

    /** From the next search on, particles have neighbours of their own body alone, unless the
     * entry `Kernels across gaps` asks for others. The image of a body that has no node on the
     * plane is another body. @p of_mesh must outlive this. */
    void set_bodies(const Bodies<dim> &of_mesh, const PlanesOfBodies &planes, const bool has_planes)
    {
      bodies = (of_mesh.n_bodies() > 1 || has_planes) && !crosses_gaps ? &of_mesh : nullptr;
      planes_of_bodies = planes;
    }
    /** Takes neighbours of other bodies out of the rows of @p found, whose nodes @p partition has.
     * Collective. */
    void separate_bodies(const std::shared_ptr<const NodePartition> &partition,
                         Neighbourhoods<dim> &found, Stencils &stencils) const;

    /** Begins with particles of these masses, which have no rows yet. */
    void reset(const std::vector<double> &masses)
    {
      shape = Stencils();
      shape.mass = masses;
    }

    /** Finds the neighbours of @p particles at @p position with half widths @p support, node_stride
     * each, here and on other ranks. Values and gradients follow with compute_at_search().
     * Collective. */
    void search(const ParticleSet<dim> &particles, const std::vector<double> &position,
                const std::vector<double> &support);

    /** φ and ∇φ at the positions and with the supports of the last search. A particle without a
     * basis is refused before finish_start(), and becomes a rank-deficient row later.
     * Collective. */
    void compute_at_search()
    {
      compute(neighbours.position_at_search().data(), neighbours.support_at_search().data());
    }

    /** The same at @p position (current ghosts, the numbers of the rows), with these supports of
     * the particles, node_stride each. Collective. */
    void compute_at(const NodalVector &position, const std::vector<double> &support);

    /** The same in the reference of @p kernel. @p buffer is a vector of positions with the numbers
     * of the rows, overwritten by those of the reference. Collective. */
    void compute_in_reference(const ParticleSet<dim> &particles,
                              const KernelConfiguration<dim> &kernel, NodalVector &buffer);

    /** Tells that rows have just been computed at the present positions: then F is the identity
     * where are_undeformed_when_new() says so. */
    void note_present();

    /** From now on a particle without a basis is not refused. */
    void finish_start()
    {
      has_started = true;
    }

    /** Ghosts and images that the rows need, as in Formulation. */
    dealii::IndexSet required_nodes(const ParticleSet<dim> &particles) const;
    const std::vector<ImageNode> &required_image_nodes() const
    {
      return neighbours.images();
    }
    void set_partition(const NodePartition &partition);
    /** Tells affine smoothing where @p particles are in the reference of @p kernel. Collective. */
    void store_reference(const ParticleSet<dim> &particles, const KernelConfiguration<dim> &kernel,
                         const std::shared_ptr<const NodePartition> &partition);
    /** A partition with what the rows alone need. Collective. */
    std::shared_ptr<const NodePartition> partition(const ParticleSet<dim> &particles) const
    {
      return particles.partition(required_nodes(particles), required_image_nodes());
    }

    /** Lists whether finish_start() was called, and which rows lost their negative values; after
     * complete_reading() they have lost them. */
    void list(Records &records);
    /** Writes or reads the positions and supports of the last search, as rows of @p archive. On
     * reading they go to @p position and @p support, for a search. */
    void serialize_search(StateArchive &archive, std::vector<double> &position,
                          std::vector<double> &support) const;
    void complete_reading();

    const Stencils &stencils() const
    {
      return shape;
    }
    Stencils &stencils()
    {
      return shape;
    }
    const Neighbourhoods<dim> &neighbourhoods() const
    {
      return neighbours;
    }
    Neighbourhoods<dim> &neighbourhoods()
    {
      return neighbours;
    }

  protected:
    /** Candidates are found with @p skin, as in Neighbourhoods. */
    ParticleRows(const Section &section, double skin);

    /** The rows that searches fill and that have the places of Neighbourhoods: the stencils
     * themselves, or more neighbours, among which fill() chooses. */
    virtual Stencils &searched()
    {
      return shape;
    }
    /** Gives the rows the numbers of nodes in @p partition. */
    virtual void renumber(const NodePartition &partition)
    {
      neighbours.set_partition(partition, shape);
    }
    /** Called after each search, for further choices among the neighbours. */
    virtual void restrict_neighbours() {}
    /** The message of a row of the last fill() of the start that has no basis; empty without one.
     */
    virtual std::string describe_defects(const double *position, const double *support) const = 0;

    Section section;
    Stencils shape;
    Neighbourhoods<dim> neighbours;

  private:
    void compute(const double *position, const double *support);
    /** Where @p particles are in the reference of @p kernel, with the numbers of the rows, into @p
     * reference, and its ghosts. Collective. */
    void find_reference(const ParticleSet<dim> &particles, const KernelConfiguration<dim> &kernel,
                        NodalVector &reference) const;

    bool crosses_gaps;
    const Bodies<dim> *bodies = nullptr; // null: there is one
    PlanesOfBodies planes_of_bodies;
    MPI_Comm communicator = MPI_COMM_NULL;
    bool has_started = false;
    NodalVector support_of_node;              // half widths, with those of ghosts [L]
    std::vector<unsigned int> rows_to_change; // between reading and complete_reading()
  };
} // namespace tombolo
