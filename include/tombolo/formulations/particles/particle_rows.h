// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/particles/kernel_configuration.h>
#include <tombolo/formulations/particles/particle_set.h>
#include <tombolo/formulations/particles/patch_test.h>
#include <tombolo/mesh/bodies.h>
#include <tombolo/state/records.h>

#include <deal.II/base/index_set.h>
#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  class ZeroEnergyControl;
  template <int dim>
  class CellDilatation;

  /**
   * The stencils of the particles of one part, in the reference of their kernels: the search of
   * neighbours, their numbers in a partition, when φ and ∇φ are computed. A derived class defines
   * these functions (fill()). After search() the rows have the numbers of the search until
   * set_partition() sets those of a partition.
   */
  template <int dim>
  class ParticleRows
  {
  public:
    virtual ~ParticleRows() = default;
    ParticleRows(const ParticleRows &) = delete;
    ParticleRows &operator=(const ParticleRows &) = delete;

    /** @name The functions of the rows */
    ///@{
    /** Fills value and gradient of @p stencils, the rows of @p found, at @p position with half
     * widths @p support (numbers of the rows, node_stride each); lists rows without a basis. */
    virtual void fill(const Neighbourhoods<dim> &found, const double *position,
                      const double *support, Stencils &stencils) = 0;
    /** The half width of a support over the spacing of particles. */
    virtual double dilation() const = 0;
    /** The entry that sets the reach of supports, for messages. */
    virtual const char *support_entry() const = 0;

    /** Decides the functions of the particles, and removes equal parts from @p setup whose cells do
     * not count for them. Returns whether they are averages over cells. Throws InputError. */
    virtual bool choose_functions(PartSetup<dim> &setup, ParticleSet<dim> & /*particles*/)
    {
      setup.end_at_own_cells();
      return false;
    }
    /** Sets other supports of @p particles, from cells of @p is_taken, than those of their cells.
     * Returns whether it did: then supports do not change as particles deform. Collective. */
    virtual bool choose_supports(const PartSetup<dim> & /*setup*/,
                                 const CellSelection<dim> & /*is_taken*/,
                                 ParticleSet<dim> & /*particles*/)
    {
      return false;
    }
    /** The entry `Kernels across gaps`. */
    bool reaches_other_bodies() const
    {
      return crosses_gaps;
    }
    /** The dilatation that particles have from cells around them; null: they have their own. */
    virtual CellDilatation<dim> *dilatation_of_cells()
    {
      return nullptr;
    }
    /** The control of modes that hardly change the gradients of the particles; null: none. */
    virtual ZeroEnergyControl *zero_energy_control()
    {
      return nullptr;
    }
    /** The functions, for the audit. */
    virtual std::string functions() const
    {
      return {};
    }
    /** Whether F = Σ x_J ⊗ ∇φ_J counts as the identity where rows are new, which saves time. */
    virtual bool are_undeformed_when_new() const
    {
      return false;
    }
    virtual bool depend_on_volumes() const
    {
      return false;
    }
    /** The present volumes of the particles of this rank, before the next rows are computed. */
    virtual void set_present_volumes(const double * /*volumes*/) {}

    /** How far the rows at the start fail the patch test. @p smooths: whether velocities are
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

    /** From the next search on, particles have neighbours of their own body alone, unless the entry
     * `Kernels across gaps` allows others. The image of a body that has no node on the plane is
     * another body. @p mesh_bodies must outlive this. */
    void set_bodies(const Bodies<dim> &mesh_bodies, const PlanesOfBodies &planes,
                    const bool has_planes)
    {
      bodies = (mesh_bodies.n_bodies() > 1 || has_planes) && !crosses_gaps ? &mesh_bodies : nullptr;
      planes_of_bodies = planes;
    }
    /** Removes neighbours of other bodies from @p found, in @p partition. Collective. */
    void separate_bodies(const std::shared_ptr<const NodePartition> &partition,
                         Neighbourhoods<dim> &found, Stencils &stencils) const
    {
      if (bodies == nullptr)
        return;
      const NodalVector body = scalar_field(
          partition, [&](const unsigned int i)
          { return static_cast<double>(bodies->body_of(partition->global_index(i))); });
      const auto n_nodes = static_cast<unsigned int>(found.global_nodes().size());
      const auto body_of = [&](const dealii::types::global_dof_index node) {
        return static_cast<dealii::types::global_dof_index>(
            *body.node(partition->local_index(node)));
      };
      found.remove_neighbours(
          [&](const unsigned int row, const unsigned int neighbour)
          {
            const auto own = body_of(found.global_nodes()[row]);
            if (neighbour < n_nodes)
              return own != body_of(found.global_nodes()[neighbour]);
            const auto &image = found.images()[neighbour - n_nodes];
            return own != body_of(image.source) || !planes_of_bodies.joins(own, image.mirrors);
          },
          stencils);
    }

    /** Resets to particles of these masses, without rows. */
    void reset(const std::vector<double> &masses)
    {
      shape = Stencils();
      shape.mass = masses;
    }

    /** Finds the neighbours of @p particles at @p position with half widths @p support, node_stride
     * each, on all ranks. Values and gradients follow with compute_at_search(). Collective. */
    void search(const ParticleSet<dim> &particles, const std::vector<double> &position,
                const std::vector<double> &support)
    {
      communicator = particles.communicator();
      if (assign_neighbours(particles, position, support))
        return;
      neighbours.search(particles.nodes(), position, support, communicator, searched());
      if (bodies != nullptr)
        separate_bodies(partition(particles), neighbours, searched());
      restrict_neighbours();
    }

    /** φ and ∇φ at the last search. A particle without a basis is refused before finish_start(),
     * and becomes a rank-deficient row later. Collective. */
    void compute_at_search()
    {
      compute(neighbours.position_at_search().data(), neighbours.support_at_search().data());
    }

    /** The same at @p position (current ghosts) with these supports of particles. Collective. */
    void compute_at(const NodalVector &position, const std::vector<double> &support)
    {
      support_of_node.fill(shape.particle_node, [&](const std::size_t i, double *const node_support)
                           { std::copy_n(&support[i * node_stride], node_stride, node_support); });
      compute(position.data(), support_of_node.data());
    }

    /** The same in the reference of @p kernel. @p buffer is a vector of positions with the numbers
     * of the rows, overwritten by those of the reference. Collective. */
    void compute_in_reference(const ParticleSet<dim> &particles,
                              const KernelConfiguration<dim> &kernel, NodalVector &buffer)
    {
      find_reference(particles, kernel, buffer);
      compute_at(buffer, kernel.supports());
    }

    /** Rows are just computed at present positions: F is one if are_undeformed_when_new(). */
    void note_present()
    {
      if (!are_undeformed_when_new())
        return;
      constexpr std::array<double, 3 * node_stride> identity{
          {1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0.}};
      shape.inverse_deformation.resize_fast(identity.size() * shape.n_particles());
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
        std::copy(identity.begin(), identity.end(),
                  &shape.inverse_deformation[i * identity.size()]);
      shape.inverse_deformation_is_current = true;
    }

    /** From now on a particle without a basis is not refused. */
    void finish_start()
    {
      has_started = true;
    }

    /** Ghosts and images that the rows need, as in Formulation. */
    dealii::IndexSet required_nodes(const ParticleSet<dim> &particles) const
    {
      dealii::IndexSet nodes(particles.owned_nodes().size());
      const auto &row_nodes = neighbours.global_nodes();
      nodes.add_indices(row_nodes.begin(), row_nodes.end());
      nodes.compress();
      return nodes;
    }
    const std::vector<ImageNode> &required_image_nodes() const
    {
      return neighbours.images();
    }
    void set_partition(const NodePartition &partition)
    {
      renumber(partition);
      support_of_node.reinit(std::make_shared<const NodePartition>(partition), Quantity::scalars);
    }
    /** Sets positions in the reference of @p kernel for affine smoothing. Collective. */
    void store_reference(const ParticleSet<dim> &particles, const KernelConfiguration<dim> &kernel,
                         const std::shared_ptr<const NodePartition> &partition)
    {
      shape.reference_position.reinit(partition, Quantity::position);
      find_reference(particles, kernel, shape.reference_position);
    }
    /** A partition with what the rows alone need. Collective. */
    std::shared_ptr<const NodePartition> partition(const ParticleSet<dim> &particles) const
    {
      return particles.partition(required_nodes(particles), required_image_nodes());
    }

    /** Lists the start, and which rows lost negative values; complete_reading() removes these. */
    void list(Records &records)
    {
      records.value("has started", has_started);
      records.archived(
          [this](StateArchive &archive)
          {
            // Which rows lose their negative values depends on the masses that there were at that
            // time.
            std::vector<double> flags(shape.mass.size(), 0.);
            for (const unsigned int row : shape.non_negative_rows)
              flags[row] = 1.;
            archive.rows("is kept from extrapolating", 1, flags);
            if (!archive.is_reading())
              return;
            rows_to_change.clear();
            for (unsigned int row = 0; row < flags.size(); ++row)
              if (flags[row] != 0.)
                rows_to_change.push_back(row);
          });
    }
    /** Writes or reads the positions and supports of the last search, as rows of @p archive. On
     * reading they go to @p position and @p support, for a search. */
    void serialize_search(StateArchive &archive, std::vector<double> &position,
                          std::vector<double> &support) const
    {
      const auto n_own = static_cast<std::ptrdiff_t>(shape.mass.size() * node_stride);
      const std::vector<double> &all_positions = neighbours.position_at_search();
      const std::vector<double> &all_supports = neighbours.support_at_search();
      position.assign(all_positions.begin(), all_positions.begin() + n_own);
      support.assign(all_supports.begin(), all_supports.begin() + n_own);
      archive.rows("position at search", node_stride, position);
      archive.rows("support at search", node_stride, support);
    }
    void complete_reading()
    {
      for (const unsigned int row : rows_to_change)
        shape.remove_negative_values(row);
      rows_to_change.clear();
    }

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
    ParticleRows(const Entries &e, const double skin)
        : section(e.section()), neighbours(skin),
          crosses_gaps(e.flag(
              "Kernels across gaps", "false",
              "Whether particles are neighbours of those in another body of the mesh, one that no "
              "common node joins to their own: as if they were glued."))
    {}

    /** The rows that searches fill and that have the indices of Neighbourhoods: the stencils
     * themselves, or more neighbours, among which fill() chooses. */
    virtual Stencils &searched()
    {
      return shape;
    }
    virtual void renumber(const NodePartition &partition)
    {
      neighbours.set_partition(partition, shape);
    }
    /** Adds neighbours that are known without a search to the rows; false: there are none. */
    virtual bool assign_neighbours(const ParticleSet<dim> & /*particles*/,
                                   const std::vector<double> & /*position*/,
                                   const std::vector<double> & /*support*/)
    {
      return false;
    }
    /** Called after each search, for further choices among the neighbours. */
    virtual void restrict_neighbours() {}
    /** The message of a row without a basis in the last fill() of the start; else empty. */
    virtual std::string describe_defects(const double *position, const double *support) const = 0;
    /** "The particle at (1, 2, 3)", for messages. */
    std::string particle_at(const unsigned int row, const double *const position) const
    {
      const double *const x = position + std::size_t(shape.particle_node[row]) * node_stride;
      return "The particle at " + position_text(vector_of<dim>(x));
    }

    Section section;
    Stencils shape;
    Neighbourhoods<dim> neighbours;

  private:
    void compute(const double *position, const double *support)
    {
      fill(neighbours, position, support, shape);
      if (has_started)
        return;
      const std::string message = first_text(communicator, describe_defects(position, support));
      if (!message.empty())
        section.fail(support_entry(), message);
    }
    /** Sets @p reference, with its ghosts, to the positions of @p particles in the reference of @p
     * kernel, with the numbers of the rows. Collective. */
    void find_reference(const ParticleSet<dim> &particles, const KernelConfiguration<dim> &kernel,
                        NodalVector &reference) const
    {
      const bool is_renewed = !kernel.positions().empty();
      reference.fill(shape.particle_node,
                     [&](const std::size_t i, double *const x)
                     {
                       if (is_renewed)
                         std::copy_n(&kernel.positions()[i * node_stride], node_stride, x);
                       else
                         std::copy_n(particles.initial_positions()[i].begin_raw(), dim, x);
                     });
      // Neighbours from other parts, too.
      const std::vector<double> &initial = neighbours.position_at_search();
      for (std::size_t k = 0; !is_renewed && k < neighbours.nodes().size(); ++k)
        std::copy_n(&initial[k * node_stride], dim, reference.node(neighbours.nodes()[k]));
    }

    bool crosses_gaps;
    const Bodies<dim> *bodies = nullptr; // null: there is one
    PlanesOfBodies planes_of_bodies;
    MPI_Comm communicator = MPI_COMM_NULL;
    bool has_started = false;
    NodalVector support_of_node;              // half widths, with those of ghosts [L]
    std::vector<unsigned int> rows_to_change; // between reading and complete_reading()
  };
} // namespace tombolo
