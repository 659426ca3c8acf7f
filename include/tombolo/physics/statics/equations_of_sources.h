// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/node_partition.h>

#include <vector>

namespace tombolo
{
  /**
   * The nodes of an equation, and a matrix of it, by nodes that move: the motion of an image in
   * planes of symmetry is the reflected motion of its source, u_I' = R u_I, and a force on it is
   * one on its source. So with the rows R of all nodes the matrix is Pᵀ K P.
   */
  struct EquationsOfSources
  {
    /** @p n_components rows and columns of @p matrix for each of the local @p nodes. */
    EquationsOfSources(const NodePartition &partition, const std::vector<unsigned int> &nodes,
                       const std::vector<double> &matrix, unsigned int n_components);

    std::vector<unsigned int> nodes; ///< local numbers, without images, each once
    std::vector<double> matrix;      ///< by rows
  };

  /** Whether there are images among local @p nodes. */
  bool have_images(const NodePartition &partition, const std::vector<unsigned int> &nodes);

  /** The nodes whose motion local @p nodes have: images are replaced by their sources. */
  std::vector<unsigned int> sources_of(const NodePartition &partition,
                                       const std::vector<unsigned int> &nodes);
} // namespace tombolo
