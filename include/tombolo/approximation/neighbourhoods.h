// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/neighbour_search.h>
#include <tombolo/approximation/particle_ghosts.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/state/node_partition.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/point.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * Which particles of one part are neighbours of which: the rows of Stencils, across ranks.
   *
   * search() finds those of the particles of this rank at their present positions, before any
   * partition of nodes with the right ghosts exists. It numbers the nodes of the rows by indices:
   * own particles in their order, then those particles of other ranks that are neighbours;
   * global_nodes() are what a partition has to contain. set_partition() turns indices into local
   * numbers, and may be called again for every new partition. Behind the indices of nodes are those
   * of images(): images of particles of this rank and of others that are neighbours. Candidates are
   * found with a skin, so that they can be kept while candidates_hold().
   */
  template <int dim>
  class Neighbourhoods
  {
  public:
    /** Neighbours are candidates up to (1 + skin) times the support. */
    explicit Neighbourhoods(const double skin = 0.) : skin(skin) {}

    /** From the next search on, neighbours are in the order of their offsets from the particle. */
    void order_by_offset()
    {
      is_ordered_by_offset = true;
    }

    /** Particles have these images of others as neighbours, from the next search on. */
    void set_images(const std::shared_ptr<const Images> &images)
    {
      images_of_body = images;
    }

    /**
     * Finds the candidates of all particles of this rank, with global numbers @p particles
     * (ascending), positions and half widths with node_stride doubles for each. Particles and
     * neighbours in the rows of @p shape are indices. Collective.
     */
    void search(const std::vector<dealii::types::global_dof_index> &particles,
                const std::vector<double> &position, const std::vector<double> &support,
                MPI_Comm communicator, Stencils &shape)
    {
      Assert(std::is_sorted(particles.begin(), particles.end()), dealii::ExcInternalError());
      Assert(position.size() == particles.size() * node_stride, dealii::ExcInternalError());
      Assert(support.size() == particles.size() * node_stride, dealii::ExcInternalError());
      const RemoteParticles remote =
          ghost_finder.exchange(particles, position.data(), support.data(), skin, communicator);
      n_own = static_cast<unsigned int>(particles.size());
      all_positions = position;
      all_supports = support;
      all_positions.insert(all_positions.end(), remote.position.begin(), remote.position.end());
      all_supports.insert(all_supports.end(), remote.support.begin(), remote.support.end());
      count_up(rows, n_own);
      all_images.clear();
      image_source.clear();
      if (!images_of_body->empty())
        add_images(remote);
      const auto n_candidates = static_cast<unsigned int>(all_positions.size() / node_stride);
      const unsigned int n_received = n_own + static_cast<unsigned int>(remote.node.size());
      count_up(columns, n_candidates);
      finder.find(rows, columns, all_positions.data(), all_supports.data(), skin, shape.row_start,
                  neighbour_index);
      if (skin == 0.) // the next search is not near
        finder = NeighbourSearch<dim>();

      // Of the particles received and of images only those that are neighbours keep an index, and
      // the sources of these images. They stay ascending by global number, and so do the rows.
      constexpr unsigned int unused = std::numeric_limits<unsigned int>::max();
      std::vector<unsigned int> new_index(n_candidates - n_own, unused);
      for (const unsigned int j : neighbour_index)
        if (j >= n_own)
        {
          new_index[j - n_own] = 0;
          if (j >= n_received && image_source[j - n_received] >= n_own)
            new_index[image_source[j - n_received] - n_own] = 0;
        }
      all_nodes = particles;
      for (std::size_t k = 0; k < remote.node.size(); ++k)
        if (new_index[k] != unused)
        {
          new_index[k] = static_cast<unsigned int>(all_nodes.size());
          all_nodes.push_back(remote.node[k]);
          std::copy_n(&remote.position[k * node_stride], node_stride,
                      &all_positions[new_index[k] * node_stride]);
          std::copy_n(&remote.support[k * node_stride], node_stride,
                      &all_supports[new_index[k] * node_stride]);
        }
      // Images keep their order; what is in their way was moved before.
      unsigned int n_images = 0;
      for (std::size_t k = 0; k < all_images.size(); ++k)
        if (new_index[n_received - n_own + k] != unused)
        {
          const unsigned int source =
              image_source[k] < n_own ? image_source[k] : new_index[image_source[k] - n_own];
          const auto image_index = static_cast<unsigned int>(all_nodes.size()) + n_images;
          new_index[n_received - n_own + k] = image_index;
          all_images[n_images++] = {all_nodes[source], all_images[k].mirrors};
          std::copy_n(&all_positions[(n_received + k) * node_stride], node_stride,
                      &all_positions[std::size_t(image_index) * node_stride]);
          std::copy_n(&all_supports[(n_received + k) * node_stride], node_stride,
                      &all_supports[std::size_t(image_index) * node_stride]);
        }
      all_images.resize(n_images);
      all_positions.resize((all_nodes.size() + n_images) * node_stride);
      all_supports.resize((all_nodes.size() + n_images) * node_stride);
      if (!new_index.empty())
        for (unsigned int &j : neighbour_index)
          if (j >= n_own)
            j = new_index[j - n_own];
      finish(shape);
    }

    /**
     * Sets neighbours that are known, instead of a search: those of each particle are the
     * members `node` (ImageNode) of a list of @p neighbour_lists, sources of images among them.
     * Those that are no particles of this rank are at @p source_positions, may belong to other
     * parts, and have no supports.
     */
    template <typename Entry>
    void
    assign(const std::vector<dealii::types::global_dof_index> &particles,
           const std::vector<double> &position, const std::vector<double> &support,
           const std::vector<std::vector<Entry>> &neighbour_lists,
           const std::map<dealii::types::global_dof_index, dealii::Point<dim>> &source_positions,
           Stencils &shape)
    {
      n_own = static_cast<unsigned int>(particles.size());
      std::map<ImageNode, unsigned int> others, images; // and their indices
      std::vector<unsigned int> own;                    // indices, from the first particle on
      constexpr unsigned int none = std::numeric_limits<unsigned int>::max();
      if (n_own > 0)
        own.resize(particles.back() - particles.front() + 1, none);
      for (unsigned int i = 0; i < n_own; ++i)
        own[particles[i] - particles.front()] = i;
      const auto own_index = [&](const ImageNode &node)
      {
        return node.mirrors == 0 && node.source >= particles.front() &&
                       node.source <= particles.back()
                   ? own[node.source - particles.front()]
                   : none;
      };
      std::size_t n_entries = 0;
      for (const std::vector<Entry> &row : neighbour_lists)
      {
        n_entries += row.size();
        for (const Entry &entry : row)
          if (own_index(entry.node) == none)
            (entry.node.mirrors == 0 ? others : images).emplace(entry.node, 0);
      }

      all_nodes = particles;
      all_positions = position;
      all_images.clear();
      for (auto *const list : {&others, &images})
        for (auto &[node, index] : *list)
        {
          index = static_cast<unsigned int>(all_positions.size() / node_stride);
          const unsigned int source = own_index({node.source, 0});
          const double *const x = source != none ? &position[std::size_t(source) * node_stride]
                                                 : source_positions.at(node.source).begin_raw();
          const Images::Map map = images_of_body->map(node.mirrors);
          for (unsigned int d = 0; d < node_stride; ++d)
            all_positions.push_back(d < dim ? map.sign[d] * x[d] + map.offset[d] : 0.);
          if (node.mirrors == 0)
            all_nodes.push_back(node.source);
          else
            all_images.push_back(node);
        }
      all_supports = support;
      all_supports.resize(all_positions.size(), 0.);

      shape.row_start.assign(1, 0);
      neighbour_index.clear();
      neighbour_index.reserve(n_entries);
      for (const std::vector<Entry> &row : neighbour_lists)
      {
        for (const Entry &entry : row)
        {
          const unsigned int index = own_index(entry.node);
          neighbour_index.push_back(
              index != none ? index : (entry.node.mirrors == 0 ? others : images).at(entry.node));
        }
        shape.row_start.push_back(neighbour_index.size());
      }
      finish(shape);
    }

    /** Global numbers of the nodes of the rows, by index; sources of images are among them. */
    const std::vector<dealii::types::global_dof_index> &global_nodes() const
    {
      return all_nodes;
    }

    /** Images that are neighbours. Their indices follow those of global_nodes(). */
    const std::vector<ImageNode> &images() const
    {
      return all_images;
    }

    /** Positions and half widths by index, as they were at the search; node_stride doubles each. */
    const std::vector<double> &position_at_search() const
    {
      return all_positions;
    }

    const std::vector<double> &support_at_search() const
    {
      return all_supports;
    }

    /** Particles and neighbours of @p shape become local numbers of @p partition, which has all. */
    void set_partition(const NodePartition &partition, Stencils &shape)
    {
      for (std::size_t index = 0; index < all_nodes.size(); ++index)
        numbers_in_use[index] = partition.local_index(all_nodes[index]);
      for (std::size_t k = 0; k < all_images.size(); ++k)
        numbers_in_use[all_nodes.size() + k] = partition.local_index(all_images[k]);
      std::copy_n(numbers_in_use.begin(), n_own, shape.particle_node.begin());
      for (std::size_t entry = 0; entry < neighbour_index.size(); ++entry)
        shape.neighbour[entry] = numbers_in_use[neighbour_index[entry]];
    }

    /** Removes the neighbours for which @p is_removed(row, index) holds from the rows, which stay
     * in their order; the indices of nodes remain. They come back with the next search. */
    void remove_neighbours(const std::function<bool(unsigned int, unsigned int)> &is_removed,
                           Stencils &shape)
    {
      std::size_t kept = 0;
      for (unsigned int row = 0; row < n_own; ++row)
      {
        const std::size_t begin = shape.row_start[row], end = shape.row_start[row + 1];
        shape.row_start[row] = kept;
        for (std::size_t entry = begin; entry < end; ++entry)
        {
          if (is_removed(row, neighbour_index[entry]))
            continue;
          neighbour_index[kept] = neighbour_index[entry];
          shape.neighbour[kept] = shape.neighbour[entry];
          ++kept;
        }
      }
      shape.row_start[n_own] = kept;
      neighbour_index.resize(kept);
      shape.neighbour.resize(kept);
    }

    /** The index of each neighbour of the rows; particles of this rank have that of their row. */
    const std::vector<unsigned int> &neighbour_indices() const
    {
      return neighbour_index;
    }

    /** By index: the numbers that the rows use at present, indices or local numbers. */
    const std::vector<unsigned int> &nodes() const
    {
      return numbers_in_use;
    }

    /**
     * Whether every pair within a support is still among the candidates, for the particles of this
     * rank at other positions and with other half widths, node_stride doubles each in the order of
     * the search. A pair that was none was apart by a_J (1 + skin) on some axis, and still is by
     * a_J (1 + skin) - R, with the range R of all displacements since the search on that axis. So
     * candidates hold while R <= a_J (1 + skin) - a'_J for all J with new half widths a'. Rigid
     * translation costs nothing (except where images move the other way); bodies that come together
     * are found. Collective, the same answer on all ranks.
     */
    bool candidates_hold(const std::vector<double> &position, const std::vector<double> &support,
                         MPI_Comm communicator) const
    {
      // Largest displacement either way, largest growth beyond the skin, by axis.
      constexpr double lowest = std::numeric_limits<double>::lowest();
      std::array<double, 3 * dim> local;
      local.fill(lowest);
      for (unsigned int i = 0; i < n_own; ++i)
        for (unsigned int d = 0; d < dim; ++d)
        {
          const std::size_t slot = std::size_t(i) * node_stride + d;
          const double displacement = position[slot] - all_positions[slot];
          local[d] = std::max(local[d], displacement);
          local[dim + d] = std::max(local[dim + d], -displacement);
          local[2 * dim + d] =
              std::max(local[2 * dim + d], support[slot] - all_supports[slot] * (1. + skin));
        }
      for (unsigned int d = 0; d < dim; ++d)
        if (images_of_body->are_opposite_along(d))
          local[d] = local[dim + d] = std::max(local[d], local[dim + d]);
      std::array<double, 3 * dim> global;
      dealii::Utilities::MPI::max(dealii::ArrayView<const double>(local.data(), local.size()),
                                  communicator,
                                  dealii::ArrayView<double>(global.data(), global.size()));
      for (unsigned int d = 0; d < dim; ++d)
        if (global[d] > lowest && !(global[d] + global[dim + d] + global[2 * dim + d] <= 0.))
          return false;
      return true;
    }

  private:
    /** Writes what was found to @p shape, which has the starts of rows. */
    void finish(Stencils &shape)
    {
      if (is_ordered_by_offset)
        sort_by_offset(shape.row_start);
      count_up(numbers_in_use, all_nodes.size() + all_images.size());
      count_up(shape.particle_node, n_own);
      shape.neighbour = neighbour_index;
    }
    static void count_up(std::vector<unsigned int> &list, const std::size_t n)
    {
      list.resize(n);
      std::iota(list.begin(), list.end(), 0u);
    }

    /** Appends the images of particles that can reach a particle of this rank. */
    void add_images(const RemoteParticles &remote)
    {
      // Closer than this share of its support a particle is on a mirror, and its own image.
      constexpr double on_mirror = 1e-6;
      const unsigned int n_sources = n_own + static_cast<unsigned int>(remote.node.size());
      std::vector<unsigned int> is_near(n_sources, 0), is_on(n_sources, 0);
      for (unsigned int j = 0; j < n_sources; ++j)
      {
        const double *const x = &all_positions[std::size_t(j) * node_stride];
        const double *const reach = &all_supports[std::size_t(j) * node_stride];
        // An image is farther from all particles than from the mirror.
        is_near[j] = images_of_body->near(x, reach, 1. + skin);
        is_on[j] = images_of_body->near(x, reach, on_mirror);
      }
      for (const unsigned int through : images_of_body->combinations())
      {
        const Images::Map map = images_of_body->map(through);
        for (unsigned int j = 0; j < n_sources; ++j)
        {
          if ((is_near[j] & through) != through || (is_on[j] & through) != 0)
            continue;
          image_source.push_back(j);
          all_images.push_back({0, through});
          for (unsigned int d = 0; d < node_stride; ++d)
          {
            const std::size_t slot = std::size_t(j) * node_stride + d;
            all_positions.push_back(map.sign[d] * all_positions[slot] + map.offset[d]);
            all_supports.push_back(all_supports[slot]);
          }
        }
      }
    }

    void sort_by_offset(const std::vector<std::size_t> &row_start)
    {
      // Offsets in a millionth of the particle's reach, of which the sign fits into 21 bits.
      constexpr double resolution = 5e5;
      constexpr unsigned int n_bits = 21;
      std::vector<std::pair<std::uint64_t, unsigned int>> keys;
      for (unsigned int row = 0; row < n_own; ++row)
      {
        const double *const own = &all_positions[std::size_t(row) * node_stride];
        const double *const reach = &all_supports[std::size_t(row) * node_stride];
        double largest[dim];
        std::copy_n(reach, dim, largest);
        for (std::size_t entry = row_start[row]; entry < row_start[row + 1]; ++entry)
        {
          const double *const other =
              &all_positions[std::size_t(neighbour_index[entry]) * node_stride];
          for (unsigned int d = 0; d < dim; ++d)
            largest[d] = std::max(largest[d], std::abs(other[d] - own[d]));
        }
        keys.clear();
        for (std::size_t entry = row_start[row]; entry < row_start[row + 1]; ++entry)
        {
          const unsigned int other_index = neighbour_index[entry];
          const double *const other = &all_positions[std::size_t(other_index) * node_stride];
          std::uint64_t key = 0;
          for (unsigned int d = dim; d-- > 0;)
            key = (key << n_bits) | static_cast<std::uint64_t>(std::llrint(
                                        (1. + (other[d] - own[d]) / largest[d]) * resolution));
          keys.emplace_back(key, other_index);
        }
        std::sort(keys.begin(), keys.end());
        for (std::size_t k = 0; k < keys.size(); ++k)
          neighbour_index[row_start[row] + k] = keys[k].second;
      }
    }

    double skin;
    bool is_ordered_by_offset = false;
    std::shared_ptr<const Images> images_of_body = Images::none();
    std::vector<ImageNode> all_images;
    std::vector<unsigned int> image_source; // indices
    NeighbourSearch<dim> finder;
    ParticleGhosts<dim> ghost_finder;
    unsigned int n_own = 0;
    std::vector<double> all_positions;
    std::vector<double> all_supports;
    std::vector<dealii::types::global_dof_index> all_nodes;
    std::vector<unsigned int> numbers_in_use;
    std::vector<unsigned int> rows, columns;
    std::vector<unsigned int> neighbour_index;
  };

  extern template class Neighbourhoods<2>;
  extern template class Neighbourhoods<3>;
} // namespace tombolo
