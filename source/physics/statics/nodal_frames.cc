// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/statics/nodal_frames.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <utility>

namespace tombolo
{
  template <int dim>
  NodalFrames<dim>::NodalFrames(const Model<dim> &model)
  {
    using Frame = std::pair<types::global_dof_index, std::array<double, dim * dim>>;
    std::vector<Frame> of_rank;
    for (const ObliqueNode &oblique : model.conditions->oblique_nodes().all())
    {
      Frame &frame = of_rank.emplace_back();
      frame.first = model.state.partition()->global_index(oblique.node);
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int d = 0; d < dim; ++d)
          frame.second[k * dim + d] = oblique.axes[k][d];
    }
    for (const std::vector<Frame> &all : Utilities::MPI::all_gather(model.communicator, of_rank))
      for (const auto &[node, axes] : all)
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int d = 0; d < dim; ++d)
            frames[node][k][d] = axes[k * dim + d];
  }

  template <int dim>
  void NodalFrames<dim>::turn(const std::vector<types::global_dof_index> &nodes,
                              std::vector<double> &entries) const
  {
    if (std::none_of(nodes.begin(), nodes.end(),
                     [this](const types::global_dof_index node) { return find(node) != nullptr; }))
      return;
    const std::size_t n_rows = nodes.size() * dim;
    for (std::size_t a = 0; a < nodes.size(); ++a)
      for (std::size_t b = 0; b < nodes.size(); ++b)
      {
        if (find(nodes[a]) == nullptr && find(nodes[b]) == nullptr)
          continue;
        const auto entry = [&](const unsigned int k, const unsigned int l) -> double &
        { return entries[(a * dim + k) * n_rows + b * dim + l]; };
        Tensor<2, dim> block;
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int l = 0; l < dim; ++l)
            block[k][l] = entry(k, l);
        turn(nodes[a], nodes[b], block);
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int l = 0; l < dim; ++l)
            entry(k, l) = block[k][l];
      }
  }

  template <int dim>
  Tensor<2, dim> NodalFrames<dim>::block(const ContactStiffness<dim> &spring,
                                         const typename ContactStiffness<dim>::Entry &row,
                                         const typename ContactStiffness<dim>::Entry &column) const
  {
    Tensor<2, dim> result;
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b < dim; ++b)
        result[a][b] = (spring.normal * row.normal[a] + row.weight * spring.slip[a]) *
                           (column.normal[b] + column.shift[b]) +
                       row.weight * (column.weight * spring.along[a][b] + column.shares[a][b]);
    turn(row.node, column.node, result);
    return result;
  }

  template <int dim>
  void NodalFrames<dim>::turn(const NodalVector &nodes,
                              LinearAlgebra::distributed::Vector<double> &rows) const
  {
    for (unsigned int i = 0; i < nodes.partition()->n_owned(); ++i)
    {
      std::array<double, dim> of_node;
      std::copy_n(nodes.node(i), dim, of_node.begin());
      turn(nodes.partition()->global_index(i), of_node.data());
      for (unsigned int d = 0; d < dim; ++d)
        rows.local_element(i * dim + d) = of_node[d];
    }
  }

  template class NodalFrames<2>;
  template class NodalFrames<3>;
} // namespace tombolo
