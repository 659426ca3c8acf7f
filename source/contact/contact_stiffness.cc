// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_stiffness.h>

#include <tombolo/base/on_ranks.h>

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
    // Pieces that others own are few: those of nodes at the border of two ranks.
    struct Piece
    {
      types::global_dof_index place;
      Entry entry;
    };
    std::vector<Piece> pieces;
    for (auto row = rows.begin(); row != rows.end();)
    {
      if (partition.owned().is_element(row->first))
      {
        ++row;
        continue;
      }
      for (const auto &[node, entry] : row->second)
        pieces.push_back({row->first, entry});
      row = rows.erase(row);
    }
    for (const auto &[place, entry] : of_all_ranks(pieces, partition.communicator()))
      if (partition.owned().is_element(place))
        add(place, entry.node, entry.normal, entry.weight, entry.shift, entry.shares);
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
