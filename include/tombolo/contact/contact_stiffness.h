// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/on_ranks.h>
#include <tombolo/state/node_partition.h>

#include <deal.II/base/tensor.h>
#include <deal.II/base/types.h>

#include <map>
#include <vector>

namespace tombolo
{
  /**
   * How the forces f of a contact change with positions x, at one contact point: the sum over pairs
   * of nodes J, K of
   *
   * @verbatim
   *   -∂f_J/∂x_K = k c_J ⊗ (c_K + s_K) + w_J T (w_K + D_K) + w_J q ⊗ (c_K + s_K)
   * @endverbatim
   *
   * with the derivative -(c_K + s_K) of the depth, of which -s_K comes from the change of weights,
   * the weights w_K of the motion along the surface, whose mean over points has other shares of
   * these where depths change (D_K), and k, T, q by area where c, s, w and D are integrals over it.
   * The second term is that of sticking, the third that of slip, whose force follows the normal
   * force.
   */
  template <int dim>
  struct ContactStiffness
  {
    struct Entry
    {
      dealii::types::global_dof_index node; ///< of any rank
      dealii::Tensor<1, dim> normal;        ///< c
      double weight;                        ///< w
      dealii::Tensor<1, dim> shift{};       ///< s
      dealii::Tensor<2, dim> shares{};      ///< D
    };
    using Entries = std::vector<Entry>;

    unsigned int node; ///< local number of the node of the contact point
    Entries entries;
    dealii::Tensor<1, dim> direction; ///< the unit normal there; zero where nothing is pressed
    double normal = 0;                ///< k
    dealii::Tensor<2, dim> along;     ///< T
    dealii::Tensor<1, dim> slip;      ///< q
    bool is_tied = false;             ///< whether it holds in all directions, also in tension

    /** Removes from T and q the components that @p kept, one or zero each, does not keep: across
     * planes of symmetry, where motions and forces of both halves add up to zero. The normal lies
     * in the planes. */
    void keep(const double *const kept)
    {
      for (unsigned int d = 0; d < dim; ++d)
      {
        slip[d] *= kept[d];
        for (unsigned int e = 0; e < dim; ++e)
          along[d][e] *= kept[d] * kept[e];
      }
    }
  };

  /** Adds k, T and q of the spring of a contact that touches along @p direction, whose stiffness is
   * @p share of @p spring: sticking, or sliding with the direction of the slip fixed, the secant
   * stiffness across it and Coulomb's force that follows the pressure. */
  template <int dim, typename Spring>
  void add_spring(const Spring &spring, const double share, ContactStiffness<dim> &stiffness)
  {
    const double k = share * spring.stiffness;
    stiffness.normal += k;
    if (spring.trial_slip < 0. || !(spring.depth > 0.))
      return;
    const double slip = spring.elastic_slip.norm();
    dealii::Tensor<2, dim> across;
    for (unsigned int d = 0; d < dim; ++d)
      across[d][d] = 1.;
    across -= outer_product(stiffness.direction, stiffness.direction);
    if (!(slip < spring.trial_slip))
    {
      stiffness.along += k * across;
      return;
    }
    if (!(slip > 0.))
      return;
    const dealii::Tensor<1, dim> along = spring.elastic_slip / slip;
    across -= outer_product(along, along);
    stiffness.along += k * slip / spring.trial_slip * across;
    if (spring.limit_follows_pressure)
      stiffness.slip -= k * slip / spring.depth * along;
  }

  /** Rows of entries by the node of the contact point, of which ranks have pieces. */
  template <int dim>
  class ContactRows
  {
  public:
    using Entry = typename ContactStiffness<dim>::Entry;
    using Entries = typename ContactStiffness<dim>::Entries;

    /** Adds to the entry of @p node in the row of @p row_node, both by global numbers. */
    void add(const dealii::types::global_dof_index row_node,
             const dealii::types::global_dof_index node, const dealii::Tensor<1, dim> &normal,
             const double weight, const dealii::Tensor<1, dim> &shift = {},
             const dealii::Tensor<2, dim> &shares = {})
    {
      Entry &entry = rows[row_node].try_emplace(node, Entry{node, {}, 0.}).first->second;
      entry.normal += normal;
      entry.weight += weight;
      entry.shift += shift;
      entry.shares += shares;
    }

    /** Sends the pieces to the owners of the rows. Collective. */
    void collect(const NodePartition &partition)
    {
      // Pieces that others own are few: those of nodes at the border of two ranks.
      struct Piece
      {
        dealii::types::global_dof_index row_node;
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
      for (const auto &[row_node, entry] : from_all_ranks(pieces, partition.communicator()))
        if (partition.owned().is_element(row_node))
          add(row_node, entry.node, entry.normal, entry.weight, entry.shift, entry.shares);
    }

    /** Of an owned node, after collect(), ascending. */
    Entries row(const dealii::types::global_dof_index row_node) const
    {
      Entries result;
      const auto found = rows.find(row_node);
      if (found != rows.end())
        for (const auto &[node, entry] : found->second)
          result.push_back(entry);
      return result;
    }

  private:
    using Row = std::map<dealii::types::global_dof_index, Entry>;
    std::map<dealii::types::global_dof_index, Row> rows;
  };
} // namespace tombolo
