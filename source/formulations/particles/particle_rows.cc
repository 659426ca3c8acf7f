// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/particle_rows.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/state/records.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>

namespace tombolo
{
  template <int dim>
  void ParticleRows<dim>::declare_parameters(const Entries &e)
  {
    e.flag("Kernels across gaps", "false",
           "Whether particles are neighbours of those in another body of the mesh, one that no "
           "common node joins to their own: as if they were glued.");
  }

  template <int dim>
  ParticleRows<dim>::ParticleRows(const Section &section, const double skin)
      : section(section), neighbours(skin), crosses_gaps(section.get_bool("Kernels across gaps"))
  {}

  template <int dim>
  void ParticleRows<dim>::search(const ParticleSet<dim> &particles,
                                 const std::vector<double> &position,
                                 const std::vector<double> &support)
  {
    communicator = particles.communicator();
    neighbours.search(particles.nodes(), position, support, communicator, searched());
    if (bodies != nullptr)
      separate_bodies(partition(particles), neighbours, searched());
    restrict_neighbours();
  }

  template <int dim>
  void ParticleRows<dim>::separate_bodies(const std::shared_ptr<const NodePartition> &partition,
                                          Neighbourhoods<dim> &found, Stencils &stencils) const
  {
    if (bodies == nullptr)
      return;
    const NodalVector body =
        scalar_field(partition, [&](const unsigned int i)
                     { return static_cast<double>(bodies->body_of(partition->global_index(i))); });
    const auto n_nodes = static_cast<unsigned int>(found.global_nodes().size());
    const auto body_of = [&](const types::global_dof_index node)
    { return static_cast<types::global_dof_index>(*body.node(partition->local_index(node))); };
    found.remove_neighbours(
        [&](const unsigned int row, const unsigned int place)
        {
          const auto own = body_of(found.global_nodes()[row]);
          if (place < n_nodes)
            return own != body_of(found.global_nodes()[place]);
          const auto &image = found.images()[place - n_nodes];
          return own != body_of(image.source) || !planes_of_bodies.joins(own, image.mirrors);
        },
        stencils);
  }

  template <int dim>
  void ParticleRows<dim>::compute_at(const NodalVector &position,
                                     const std::vector<double> &support)
  {
    support_of_node.fill(shape.particle_node, [&](const std::size_t i, double *const of_node)
                         { std::copy_n(&support[i * node_stride], node_stride, of_node); });
    compute(position.data(), support_of_node.data());
  }

  template <int dim>
  void ParticleRows<dim>::compute_in_reference(const ParticleSet<dim> &particles,
                                               const KernelConfiguration<dim> &kernel,
                                               NodalVector &buffer)
  {
    find_reference(particles, kernel, buffer);
    compute_at(buffer, kernel.supports());
  }

  template <int dim>
  void ParticleRows<dim>::find_reference(const ParticleSet<dim> &particles,
                                         const KernelConfiguration<dim> &kernel,
                                         NodalVector &reference) const
  {
    const bool is_renewed = !kernel.positions().empty();
    reference.fill(shape.particle_node,
                   [&](const std::size_t i, double *const place)
                   {
                     if (is_renewed)
                       std::copy_n(&kernel.positions()[i * node_stride], node_stride, place);
                     else
                       std::copy_n(particles.initial_positions()[i].begin_raw(), dim, place);
                   });
  }

  template <int dim>
  void ParticleRows<dim>::compute(const double *position, const double *support)
  {
    fill(neighbours, position, support, shape);
    if (has_started)
      return;
    const std::string message = describe_defects(position, support);
    for (const std::string &of_rank : texts_of_ranks(communicator, message))
      if (!of_rank.empty())
        section.fail(support_entry(), of_rank);
  }

  template <int dim>
  void ParticleRows<dim>::note_present()
  {
    if (!are_undeformed_when_new())
      return;
    constexpr std::array<double, 3 * node_stride> identity{
        {1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0.}};
    shape.inverse_deformation.resize_fast(identity.size() * shape.n_particles());
    for (unsigned int i = 0; i < shape.n_particles(); ++i)
      std::copy(identity.begin(), identity.end(), &shape.inverse_deformation[i * identity.size()]);
    shape.inverse_deformation_is_current = true;
  }

  template <int dim>
  IndexSet ParticleRows<dim>::required_nodes(const ParticleSet<dim> &particles) const
  {
    IndexSet nodes(particles.owned_nodes().size());
    const auto &of_rows = neighbours.global_nodes();
    nodes.add_indices(of_rows.begin(), of_rows.end());
    nodes.compress();
    return nodes;
  }

  template <int dim>
  void ParticleRows<dim>::store_reference(const ParticleSet<dim> &particles,
                                          const KernelConfiguration<dim> &kernel,
                                          const std::shared_ptr<const NodePartition> &partition)
  {
    shape.reference_position.reinit(partition, Quantity::position);
    find_reference(particles, kernel, shape.reference_position);
  }

  template <int dim>
  void ParticleRows<dim>::set_partition(const NodePartition &partition)
  {
    renumber(partition);
    support_of_node.reinit(std::make_shared<const NodePartition>(partition), Quantity::scalars);
  }

  template <int dim>
  void ParticleRows<dim>::list(Records &records)
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

  template <int dim>
  void ParticleRows<dim>::serialize_search(StateArchive &archive, std::vector<double> &position,
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

  template <int dim>
  void ParticleRows<dim>::complete_reading()
  {
    for (const unsigned int row : rows_to_change)
      shape.remove_negative_values(row);
    rows_to_change.clear();
  }

  template class ParticleRows<2>;
  template class ParticleRows<3>;
} // namespace tombolo
