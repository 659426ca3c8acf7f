// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_stiffness.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void ContactRows<dim>::add(const types::global_dof_index place,
                             const types::global_dof_index node, const Tensor<1, dim> &normal,
                             const double weight, const Tensor<1, dim> &shift,
                             const Tensor<2, dim> &shares)
  {
    Entry &entry = rows[place].try_emplace(node, Entry{node, {}, 0.}).first->second;
    entry.normal += normal;
    entry.weight += weight;
    entry.shift += shift;
    entry.shares += shares;
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
        pieces.insert(pieces.end(), entry.normal.begin_raw(), entry.normal.end_raw());
        pieces.push_back(entry.weight);
        pieces.insert(pieces.end(), entry.shift.begin_raw(), entry.shift.end_raw());
        pieces.insert(pieces.end(), entry.shares.begin_raw(), entry.shares.end_raw());
      }
      row = rows.erase(row);
    }
    for (const std::vector<double> &of_rank :
         Utilities::MPI::all_gather(partition.communicator(), pieces))
      for (auto piece = of_rank.begin(); piece != of_rank.end();)
      {
        const auto place = static_cast<types::global_dof_index>(*piece++);
        Entry entry{static_cast<types::global_dof_index>(*piece++), {}, 0.};
        const auto next = [&](auto &tensor)
        {
          const auto begin = piece;
          piece += tensor.n_independent_components;
          std::copy(begin, piece, tensor.begin_raw());
        };
        next(entry.normal);
        entry.weight = *piece++;
        next(entry.shift);
        next(entry.shares);
        if (partition.owned().is_element(place))
          add(place, entry.node, entry.normal, entry.weight, entry.shift, entry.shares);
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
