// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/statics/equations_of_sources.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    const NodePartition::Reflected *image(const NodePartition &partition, const unsigned int node)
    {
      const unsigned int n_nodes = partition.n_owned() + partition.n_ghosts();
      return node < n_nodes ? nullptr : &partition.images()[node - n_nodes];
    }
  } // namespace

  EquationsOfSources::EquationsOfSources(const NodePartition &partition,
                                         const std::vector<unsigned int> &nodes_and_images,
                                         const std::vector<double> &of_all,
                                         const unsigned int n_components)
  {
    const std::vector<unsigned int> sources = sources_of(partition, nodes_and_images);
    nodes = sources;
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    // Of each row: that of its source, and the sign of the reflection.
    std::vector<std::size_t> place;
    std::vector<double> sign;
    for (std::size_t k = 0; k < sources.size(); ++k)
    {
      const NodePartition::Reflected *const of = image(partition, nodes_and_images[k]);
      const auto first = static_cast<std::size_t>(
          std::lower_bound(nodes.begin(), nodes.end(), sources[k]) - nodes.begin());
      for (unsigned int d = 0; d < n_components; ++d)
      {
        place.push_back(first * n_components + d);
        sign.push_back(of == nullptr ? 1. : of->reflection.sign[d]);
      }
    }
    const std::size_t n_rows = nodes.size() * n_components;
    matrix.assign(n_rows * n_rows, 0.);
    for (std::size_t a = 0; a < place.size(); ++a)
      for (std::size_t b = 0; b < place.size(); ++b)
        matrix[place[a] * n_rows + place[b]] += sign[a] * sign[b] * of_all[a * place.size() + b];
  }

  bool have_images(const NodePartition &partition, const std::vector<unsigned int> &nodes)
  {
    const unsigned int n_nodes = partition.n_owned() + partition.n_ghosts();
    return std::any_of(nodes.begin(), nodes.end(),
                       [&](const unsigned int node) { return node >= n_nodes; });
  }

  std::vector<unsigned int> sources_of(const NodePartition &partition,
                                       const std::vector<unsigned int> &nodes)
  {
    std::vector<unsigned int> result = nodes;
    for (unsigned int &node : result)
      if (const NodePartition::Reflected *const of = image(partition, node))
        node = of->source;
    return result;
  }
} // namespace tombolo
