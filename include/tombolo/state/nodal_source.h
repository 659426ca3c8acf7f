// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/tensor.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /** Forces or heat at local nodes: at owned ones, ghosts and images in planes of
   * symmetry. */
  class NodalSource
  {
  public:
    explicit NodalSource(const Quantity quantity) : quantity(quantity) {}

    /** It is added at owned nodes only, so that ranks have nothing to exchange. */
    void stays_on_rank()
    {
      is_on_rank = true;
    }

    /** Adds a value of scalars at a local node. */
    void add(const unsigned int node, const double value)
    {
      double &sum = *values.node(node);
      if (sum == 0.)
        touched.push_back(node);
      sum += value;
    }

    /** Adds a value of vectors. */
    template <int dim>
    void add(const unsigned int node, const dealii::Tensor<1, dim> &value)
    {
      double *const sum = values.node(node);
      if (sum[0] == 0. && sum[1] == 0. && sum[2] == 0.)
        touched.push_back(node);
      for (unsigned int d = 0; d < dim; ++d)
        sum[d] += value[d];
    }

    /** The values at local nodes for loops, zero at first: to be given at any of them, or only at
     * those that the loop adds to touched_nodes(), in any order. */
    NodalVector &at_all_nodes()
    {
      is_anywhere = true;
      return values;
    }

    NodalVector &at_touched_nodes()
    {
      return values;
    }

    std::vector<unsigned int> &touched_nodes()
    {
      return touched;
    }

    /** The values as they were given, at owned nodes, until those of the next step. */
    const NodalVector &given() const
    {
      return values;
    }

    /** Has values for this partition. Collective. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition);

  protected:
    void clear();

    /** Moves what ghosts, images and hanging nodes have to the nodes that move. Collective. */
    void gather();

    /** After gather(), calls @p use for owned nodes that can have values, ascending. */
    template <typename Use>
    void for_given(const Use &use) const
    {
      if (is_anywhere)
        for (unsigned int node = 0; node < values.partition()->n_owned(); ++node)
          use(node);
      else
        for (const unsigned int node : touched)
          use(node);
    }

    Quantity quantity;
    bool is_on_rank = false;
    NodalVector values;
    std::vector<unsigned int> touched; ///< local nodes that have values
    bool is_anywhere = false;          ///< any node can have
  };
} // namespace tombolo
