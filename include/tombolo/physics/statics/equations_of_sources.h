// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/state/node_partition.h>

#include <algorithm>
#include <utility>
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
    /** The local @p nodes with images replaced by their sources. */
    static std::vector<unsigned int> sources_of(const NodePartition &partition,
                                                const std::vector<unsigned int> &nodes)
    {
      std::vector<unsigned int> result = nodes;
      for (unsigned int &node : result)
        if (const NodePartition::Reflected *const of = image(partition, node))
          node = of->source;
      return result;
    }

    /** The source of an image; null for other nodes. */
    static const NodePartition::Reflected *image(const NodePartition &partition,
                                                 const unsigned int node)
    {
      const unsigned int n_nodes = partition.n_owned() + partition.n_ghosts();
      return node < n_nodes ? nullptr : &partition.images()[node - n_nodes];
    }

    /** @p n_components rows and columns of @p all_entries for each of the local nodes. */
    EquationsOfSources(const NodePartition &partition,
                       const std::vector<unsigned int> &nodes_and_images,
                       const std::vector<double> &all_entries, const unsigned int n_components)
    {
      const std::vector<unsigned int> sources = sources_of(partition, nodes_and_images);
      nodes = sources;
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
      // For each row: the row of its source, and the sign of the reflection.
      std::vector<std::pair<std::size_t, double>> rows;
      for (std::size_t k = 0; k < sources.size(); ++k)
      {
        const NodePartition::Reflected *const of = image(partition, nodes_and_images[k]);
        const auto first = static_cast<std::size_t>(
            std::lower_bound(nodes.begin(), nodes.end(), sources[k]) - nodes.begin());
        for (unsigned int d = 0; d < n_components; ++d)
          rows.emplace_back(first * n_components + d, of == nullptr ? 1. : of->reflection.sign[d]);
      }
      const std::size_t n_rows = nodes.size() * n_components;
      matrix.assign(n_rows * n_rows, 0.);
      for (std::size_t a = 0; a < rows.size(); ++a)
        for (std::size_t b = 0; b < rows.size(); ++b)
          matrix[rows[a].first * n_rows + rows[b].first] +=
              rows[a].second * rows[b].second * all_entries[a * rows.size() + b];
    }

    std::vector<unsigned int> nodes; ///< local numbers, without images, each once
    std::vector<double> matrix;      ///< by rows
  };
} // namespace tombolo
