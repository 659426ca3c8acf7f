// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/contact_stiffness.h>
#include <tombolo/model/model.h>

#include <deal.II/base/tensor.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <unordered_map>
#include <vector>

namespace tombolo
{
  /**
   * The orthonormal frames of nodes of which directions are prescribed that are no axes of the
   * coordinates (ObliqueNodes). Equations of such nodes are along their frames: vectors A u and
   * matrices A K Aᵀ, where A has the axes as rows. All ranks know all of them.
   */
  template <int dim>
  class NodalFrames
  {
  public:
    NodalFrames() = default;

    /** Those of the conditions as they act now. Collective. */
    explicit NodalFrames(const Model<dim> &model);

    bool is_empty() const
    {
      return frames.empty();
    }

    /** The axes of a node with a global number, by rows; null where they are those of the
     * coordinates. */
    const dealii::Tensor<2, dim> *find(const dealii::types::global_dof_index node) const
    {
      const auto found = frames.find(node);
      return found == frames.end() ? nullptr : &found->second;
    }

    /** Components along the frame from those along the axes of the coordinates. */
    void turn(const dealii::types::global_dof_index node, double *const vector) const
    {
      if (const dealii::Tensor<2, dim> *const axes = find(node))
        apply(*axes, vector);
    }

    /** The way back. */
    void turn_back(const dealii::types::global_dof_index node, double *const vector) const
    {
      if (const dealii::Tensor<2, dim> *const axes = find(node))
        apply(dealii::transpose(*axes), vector);
    }

    /** A matrix with dim rows and columns for each of the @p nodes, by rows. */
    void turn(const std::vector<dealii::types::global_dof_index> &nodes,
              std::vector<double> &entries) const;

    /** A block of rows of one node and columns of another. */
    void turn(const dealii::types::global_dof_index row,
              const dealii::types::global_dof_index column, dealii::Tensor<2, dim> &block) const
    {
      if (const dealii::Tensor<2, dim> *const axes = find(row))
        block = *axes * block;
      if (const dealii::Tensor<2, dim> *const axes = find(column))
        block = block * dealii::transpose(*axes);
    }

    /** The rows and columns of two nodes of a spring. */
    dealii::Tensor<2, dim> block(const ContactStiffness<dim> &spring,
                                 const typename ContactStiffness<dim>::Entry &row,
                                 const typename ContactStiffness<dim>::Entry &column) const;

    /** A vector of nodes to one of rows, dim for each owned node. */
    void turn(const NodalVector &nodes,
              dealii::LinearAlgebra::distributed::Vector<double> &rows) const;

  private:
    static void apply(const dealii::Tensor<2, dim> &matrix, double *const vector)
    {
      dealii::Tensor<1, dim> values;
      for (unsigned int d = 0; d < dim; ++d)
        values[d] = vector[d];
      values = matrix * values;
      for (unsigned int d = 0; d < dim; ++d)
        vector[d] = values[d];
    }

    std::unordered_map<dealii::types::global_dof_index, dealii::Tensor<2, dim>> frames;
  };
} // namespace tombolo
