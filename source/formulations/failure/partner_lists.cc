// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/failure/partner_lists.h>

#include <tombolo/formulations/elements/split_number.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <map>

namespace tombolo
{
  template <int dim>
  void NeighbourPartners<dim>::find(const std::shared_ptr<const NodePartition> &partition,
                                    const Neighbourhoods<dim> &neighbourhoods,
                                    const std::vector<std::uint64_t> &ids,
                                    const PartnerLists &broken,
                                    const std::vector<ParticleGrowth> &growth)
  {
    const auto &nodes = neighbourhoods.global_nodes();
    std::vector<unsigned int> own;
    for (std::size_t i = 0; i < ids.size(); ++i)
      own.push_back(partition->local_index(nodes[i]));
    const NodalVector tags = nodal_field(partition, Quantity::scalars, own,
                                         [&](const std::size_t i, double *const tag)
                                         {
                                           tag[0] = upper_half(ids[i]);
                                           tag[1] = lower_half(ids[i]);
                                           tag[2] = broken[i].empty() ? 0. : 1.;
                                           tag[3] =
                                               growth.empty() ? 0. : static_cast<double>(growth[i]);
                                         });
    neighbours.clear();
    const auto add = [&](const types::global_dof_index node, const unsigned int mirrors)
    {
      const double *const tag = tags.node(partition->local_index(node));
      neighbours.push_back(
          {{joined(tag[0], tag[1]), mirrors}, tag[2] > 0., static_cast<ParticleGrowth>(tag[3])});
    };
    for (const types::global_dof_index node : nodes)
      add(node, 0);
    for (const ImageNode &image : neighbourhoods.images())
      add(image.source, image.mirrors);
    is_found = true;
  }

  template class NeighbourPartners<2>;
  template class NeighbourPartners<3>;

  bool PartnerLists::has(const std::size_t i, const BondPartner &partner) const
  {
    return !lists[i].empty() && std::binary_search(lists[i].begin(), lists[i].end(), partner);
  }

  bool PartnerLists::add(const std::size_t i, const BondPartner &partner)
  {
    List &list = lists[i];
    const auto position = std::lower_bound(list.begin(), list.end(), partner);
    if (position != list.end() && *position == partner)
      return false;
    list.insert(position, partner);
    return true;
  }

  void PartnerLists::add_at_owners(const NodePartition &partition,
                                   const std::vector<types::global_dof_index> &particles,
                                   const std::vector<PartnerMessage> &messages)
  {
    const auto take = [&](const types::global_dof_index end, const BondPartner &other)
    {
      const auto found = std::lower_bound(particles.begin(), particles.end(), end);
      AssertThrow(found != particles.end() && *found == end, ExcInternalError());
      add(static_cast<std::size_t>(found - particles.begin()), other);
    };
    std::vector<unsigned int> rank_of_ghost;
    for (const auto &[rank, n] : partition.scalars()->ghost_targets())
      rank_of_ghost.insert(rank_of_ghost.end(), n, rank);
    std::map<unsigned int, std::vector<std::array<std::uint64_t, 3>>> to_ranks;
    for (const PartnerMessage &message : messages)
      if (partition.owned().is_element(message.end))
        take(message.end, message.other);
      else
        to_ranks[rank_of_ghost[partition.local_index(message.end) - partition.n_owned()]].push_back(
            {{message.end, message.other.id, message.other.planes}});
    for (const auto &[rank, received] :
         Utilities::MPI::some_to_some(partition.communicator(), to_ranks))
      for (const auto &[end, id, planes] : received)
        take(static_cast<types::global_dof_index>(end), {id, planes});
  }

  void PartnerLists::serialize(StateArchive &archive, const std::string &name)
  {
    // Rows of the file are of one length, that of the longest list.
    unsigned int longest = 0;
    for (const List &list : lists)
      longest = std::max(longest, static_cast<unsigned int>(list.size()));
    longest = Utilities::MPI::max(longest, archive.communicator());
    archive("most " + name, longest);
    if (archive.is_reading())
      lists.assign(lists.size(), {});
    if (longest == 0)
      return;
    constexpr unsigned int n_numbers = 3;
    constexpr double none = -1.;
    std::vector<double> values;
    for (const List &list : lists)
    {
      for (const BondPartner &partner : list)
        values.insert(values.end(), {upper_half(partner.id), lower_half(partner.id),
                                     static_cast<double>(partner.planes)});
      values.resize(values.size() + std::size_t(n_numbers) * (longest - list.size()), none);
    }
    archive.rows(name, n_numbers * longest, values);
    if (!archive.is_reading())
      return;
    std::size_t next = 0;
    for (List &list : lists)
      for (unsigned int k = 0; k < longest; ++k, next += n_numbers)
        if (values[next] != none)
          list.push_back({joined(values[next], values[next + 1]),
                          static_cast<std::uint64_t>(values[next + 2])});
  }
} // namespace tombolo
