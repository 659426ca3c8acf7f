// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/on_ranks.h>
#include <tombolo/contact/contact_stiffness.h>
#include <tombolo/model/model.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/node_partition.h>

#include <deal.II/base/mpi.h>

#include <array>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /** The global numbers of the nodes that contacts couple, which may be those of any rank. */
  template <int dim>
  std::vector<dealii::types::global_dof_index>
  nodes_of_contacts(const std::vector<ContactStiffness<dim>> &contacts)
  {
    std::vector<dealii::types::global_dof_index> result;
    for (const ContactStiffness<dim> &contact : contacts)
      for (const auto &entry : contact.entries)
        result.push_back(entry.node);
    return result;
  }

  /** @p owned_value of the nodes in @p wanted that this rank neither owns nor has as ghosts, by
   * global number, from their owners. For few nodes, since all ranks get all of them.
   * Collective. */
  template <typename Value, typename Function>
  std::map<dealii::types::global_dof_index, Value>
  values_of_far_nodes(const std::vector<dealii::types::global_dof_index> &wanted,
                      const NodePartition &partition, const Function &owned_value)
  {
    using Node = dealii::types::global_dof_index;
    std::map<Node, Value> result;
    for (const Node node : wanted)
      if (!partition.has(node))
        result.try_emplace(node);
    std::vector<Node> far;
    for (const auto &item : result)
      far.push_back(item.first);
    struct Answer
    {
      Node node;
      Value value;
    };
    std::vector<Answer> answers;
    for (const Node node : from_all_ranks(far, partition.communicator()))
      if (partition.owned().is_element(node))
        answers.push_back({node, owned_value(partition.local_index(node))});
    for (const auto &[node, value] : from_all_ranks(answers, partition.communicator()))
      if (const auto found = result.find(node); found != result.end())
        found->second = value;
    return result;
  }

  template <int dim>
  constexpr unsigned int n_rigid_modes = dim == 2 ? 3 : 6;

  /** By rigid mode, translations first: its component @p d at @p arm from the centre. */
  template <int dim>
  std::array<double, 6> rigid_motion_along(const unsigned int d, const std::array<double, 3> &arm)
  {
    std::array<double, 6> result{};
    result[d] = 1.;
    for (unsigned int mode = dim; mode < n_rigid_modes<dim>; ++mode)
    {
      const unsigned int c = dim == 2 ? 2 : mode - dim;
      const unsigned int a = (c + 1) % 3, b = (c + 2) % 3;
      result[mode] = d == a ? -arm[b] : d == b ? arm[a] : 0.;
    }
    return result;
  }

  /**
   * The rigid motions of the bodies of a mesh that nothing holds, in words: "the body around
   * (0, 0, 0), which can move along x, turn about z". Empty where all are held. @p constrained is
   * one at components that are held, of owned nodes; @p contacts hold along their normal where they
   * touch. Each body is checked with its partners at rest, then all that touch as one body.
   * Collective.
   */
  template <int dim>
  std::string free_rigid_modes(const Model<dim> &model, const NodalVector &constrained,
                               const std::vector<ContactStiffness<dim>> &contacts);
} // namespace tombolo
