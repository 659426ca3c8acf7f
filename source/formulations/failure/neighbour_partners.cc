// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/failure/neighbour_partners.h>

#include <tombolo/formulations/elements/split_number.h>
#include <tombolo/state/nodal_vector.h>

namespace tombolo
{
  using namespace dealii;

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
    partners.clear();
    damaged.clear();
    growths.clear();
    const auto add = [&](const types::global_dof_index node, const unsigned int mirrors)
    {
      const double *const tag = tags.node(partition->local_index(node));
      partners.push_back({joined(tag[0], tag[1]), mirrors});
      damaged.push_back(tag[2] > 0.);
      growths.push_back(static_cast<ParticleGrowth>(tag[3]));
    };
    for (const types::global_dof_index node : nodes)
      add(node, 0);
    for (const ImageNode &image : neighbourhoods.images())
      add(image.source, image.mirrors);
    is_found = true;
  }

  template <int dim>
  bool NeighbourPartners<dim>::are_current() const
  {
    return is_found;
  }

  template <int dim>
  void NeighbourPartners<dim>::forget()
  {
    is_found = false;
  }

  template <int dim>
  const BondPartner &NeighbourPartners<dim>::partner(const unsigned int place) const
  {
    return partners[place];
  }

  template <int dim>
  bool NeighbourPartners<dim>::is_damaged(const unsigned int place) const
  {
    return damaged[place];
  }

  template <int dim>
  ParticleGrowth NeighbourPartners<dim>::growth(const unsigned int place) const
  {
    return growths[place];
  }

  template class NeighbourPartners<2>;
  template class NeighbourPartners<3>;
} // namespace tombolo
