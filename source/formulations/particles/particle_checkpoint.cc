// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/momentum_consistent_particle.h>

#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <map>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void MomentumConsistentParticle<dim>::serialize(StateArchive &archive)
  {
    archive("steps since rebuild", steps_since_rebuild);
    archive("has started", has_started);
    if (bonds)
      bonds->serialize(archive);
    if (self_contact)
      self_contact->serialize(archive);
    serialize_extrapolation(archive);
    // Positions of a rebuild are remembered from the first one on; a rank can be without particles.
    bool is_rebuilt = Utilities::MPI::max(present_position.empty() ? 0 : 1, communicator) == 1;
    archive("is rebuilt", is_rebuilt);
    if (!is_rebuilt)
    {
      serialize_pairs(archive);
      return;
    }

    // Rows and shape functions are not stored: the same search and the same rebuild at the same
    // places give them bit by bit, in the same order.
    const auto n_own = static_cast<std::ptrdiff_t>(particle_global.size() * node_stride);
    const std::vector<double> &all_positions = neighbourhoods.position_at_search();
    const std::vector<double> &all_supports = neighbourhoods.support_at_search();
    std::vector<double> search_position(all_positions.begin(), all_positions.begin() + n_own);
    std::vector<double> search_support(all_supports.begin(), all_supports.begin() + n_own);
    std::vector<double> deformation;
    for (const Tensor<2, dim> &of_particle : reference_deformation)
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          deformation.push_back(of_particle[a][b]);
    archive.rows("position at search", node_stride, search_position);
    archive.rows("support at search", node_stride, search_support);
    archive.rows("position at rebuild", node_stride, present_position);
    archive.rows("support at rebuild", node_stride, present_support);
    archive.rows("deformation at rebuild", dim * dim, deformation);
    if (!archive.is_reading())
    {
      serialize_pairs(archive);
      return;
    }
    for (std::size_t i = 0; i < reference_deformation.size(); ++i)
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          reference_deformation[i][a][b] = deformation[i * dim * dim + a * dim + b];
    neighbourhoods.search(particle_global, search_position, search_support, communicator, shape);
    serialize_pairs(archive);
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::serialize_pairs(StateArchive &archive)
  {
    if (!zero_energy_stabilization.is_on())
      return;
    const std::vector<unsigned int> &nodes = neighbourhoods.nodes();
    std::map<unsigned int, unsigned int> place_of_node;
    for (unsigned int place = 0; place < nodes.size(); ++place)
      place_of_node[nodes[place]] = place;
    std::vector<unsigned int> places;
    for (const unsigned int node : shape.neighbour)
      places.push_back(place_of_node.at(node));
    zero_energy_stabilization.serialize(shape, neighbourhoods.position_at_search(), places,
                                        archive);
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::complete_reading(NodalVector &position)
  {
    // Whoever looked at the model since it was built may have left one of its initial positions.
    shape.inverse_deformation_is_current = false;
    const bool is_rebuilt =
        Utilities::MPI::max(present_position.empty() ? 0 : 1, communicator) == 1;
    const bool has_broken = bonds && bonds->any();
    if (has_broken)
      bonds->remove_broken(position.partition(), neighbourhoods, shape);
    if (is_rebuilt || has_broken)
      compute_in_reference(position);
    for (const unsigned int row : rows_to_change)
      shape.remove_negative_values(row);
    rows_to_change.clear();
    zero_energy_stabilization.complete_reading();
  }

  template <int dim>
  void MomentumConsistentParticle<dim>::serialize_extrapolation(StateArchive &archive)
  {
    // Which rows lose their negative values depends on the masses that there were at that time.
    std::vector<double> flags(particle_global.size(), 0.);
    for (const unsigned int row : shape.non_negative_rows)
      flags[row] = 1.;
    archive.rows("is kept from extrapolating", 1, flags);
    if (!archive.is_reading())
      return;
    rows_to_change.clear();
    for (unsigned int row = 0; row < flags.size(); ++row)
      if (flags[row] != 0.)
        rows_to_change.push_back(row);
  }

  template void MomentumConsistentParticle<2>::serialize_pairs(StateArchive &);
  template void MomentumConsistentParticle<3>::serialize_pairs(StateArchive &);
  template void MomentumConsistentParticle<2>::serialize_extrapolation(StateArchive &);
  template void MomentumConsistentParticle<3>::serialize_extrapolation(StateArchive &);
  template void MomentumConsistentParticle<2>::serialize(StateArchive &);
  template void MomentumConsistentParticle<3>::serialize(StateArchive &);
  template void MomentumConsistentParticle<2>::complete_reading(NodalVector &);
  template void MomentumConsistentParticle<3>::complete_reading(NodalVector &);
} // namespace tombolo
