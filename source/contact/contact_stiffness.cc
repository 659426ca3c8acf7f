// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_stiffness.h>

#include <deal.II/base/mpi.h>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void ContactRows<dim>::add(const types::global_dof_index place,
                             const types::global_dof_index node, const Tensor<1, dim> &normal,
                             const double weight, const Tensor<1, dim> &shift)
  {
    Entry &entry = rows[place].try_emplace(node, Entry{node, {}, 0., {}}).first->second;
    entry.normal += normal;
    entry.weight += weight;
    entry.shift += shift;
  }

  template <int dim>
  void ContactRows<dim>::collect(const NodePartition &partition)
  {
    // Numbers of nodes are exact as doubles up to 2^53. Pieces that others own are few: those of
    // nodes at the border of two ranks.
    std::vector<double> pieces;
    for (auto row = rows.begin(); row != rows.end();)
    {
      if (partition.owned().is_element(row->first))
      {
        ++row;
        continue;
      }
      for (const auto &[node, entry] : row->second)
      {
        pieces.insert(pieces.end(), {static_cast<double>(row->first), static_cast<double>(node)});
        for (unsigned int d = 0; d < dim; ++d)
          pieces.push_back(entry.normal[d]);
        pieces.push_back(entry.weight);
        for (unsigned int d = 0; d < dim; ++d)
          pieces.push_back(entry.shift[d]);
      }
      row = rows.erase(row);
    }
    for (const std::vector<double> &of_rank :
         Utilities::MPI::all_gather(partition.communicator(), pieces))
      for (std::size_t i = 0; i < of_rank.size(); i += 2 * dim + 3)
      {
        const auto place = static_cast<types::global_dof_index>(of_rank[i]);
        if (!partition.owned().is_element(place))
          continue;
        Tensor<1, dim> normal, shift;
        for (unsigned int d = 0; d < dim; ++d)
        {
          normal[d] = of_rank[i + 2 + d];
          shift[d] = of_rank[i + 3 + dim + d];
        }
        add(place, static_cast<types::global_dof_index>(of_rank[i + 1]), normal,
            of_rank[i + 2 + dim], shift);
      }
  }

  template <int dim>
  typename ContactRows<dim>::Entries
  ContactRows<dim>::row(const types::global_dof_index place) const
  {
    Entries result;
    const auto found = rows.find(place);
    if (found != rows.end())
      for (const auto &[node, entry] : found->second)
        result.push_back(entry);
    return result;
  }

  template class ContactRows<2>;
  template class ContactRows<3>;
} // namespace tombolo
