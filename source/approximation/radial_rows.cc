// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/radial_rows.h>

#include <tombolo/base/simd/node_lanes.h>

#include <deal.II/base/utilities.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** Entries that are treated together: one virtual call of the kernel serves them, and they stay
     * in the first-level cache. */
    constexpr std::size_t block_entries = 512;

    /** The share of the support at its end where nothing is a neighbour. */
    constexpr double at_the_end = 1e-9;

    std::size_t whole_lanes(const std::size_t n)
    {
      return (n + n_lanes - 1) / n_lanes * n_lanes;
    }
  } // namespace

  template <int dim>
  RadialRows<dim>::RadialRows(const RadialKernel<dim> &kernel, const bool corrects,
                              const double correction_limit, const Uncorrected uncorrected)
      : radial_kernel(kernel), is_corrected(corrects), limit(correction_limit),
        treatment(uncorrected)
  {}

  template <int dim>
  std::size_t RadialRows<dim>::gather(const unsigned int first, const unsigned int last,
                                      const Stencils &shape)
  {
    std::size_t n_entries = 0;
    for (unsigned int row = first; row < last; ++row)
      n_entries += whole_lanes(shape.row_start[row + 1] - shape.row_start[row]);
    for (auto *const buffer :
         {&offset[0], &offset[1], &offset[2], &distance, &factor, &value, &slope})
      if (buffer->size() < n_entries)
        buffer->resize_fast(n_entries);
    std::size_t entry = 0;
    for (unsigned int row = first; row < last; ++row)
    {
      const unsigned int own = shape.particle_node[row];
      const NodeLanes centre = load_node(&records[std::size_t(own) * node_stride]);
      const std::size_t begin = shape.row_start[row], end = shape.row_start[row + 1];
      for (std::size_t k = begin; k < end; k += n_lanes, entry += n_lanes)
      {
        NodeLanes node[n_lanes];
        alignas(64) double volume[n_lanes];
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
        {
          // Beyond the row the particle itself, which gets no ∇φ.
          const unsigned int neighbour = k + lane < end ? shape.neighbour[k + lane] : own;
          const double *const record = &records[std::size_t(neighbour) * node_stride];
          node[lane] = load_node(record) - centre;
          volume[lane] = record[volume_slot];
        }
        Lanes d[3];
        nodes_to_lanes(node, d);
        for (unsigned int c = 0; c < 3; ++c)
          store_lanes(d[c], &offset[c][entry]);
        store_lanes(square_root(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]), &distance[entry]);
        store_lanes(load_lanes(volume), &factor[entry]);
      }
    }
    return n_entries;
  }

  template <int dim>
  SymmetricTensor<2, dim> RadialRows<dim>::find_factors(const std::size_t begin,
                                                        const std::size_t n_padded,
                                                        unsigned int &n_neighbours)
  {
    Lanes sum[dim][dim] = {};
    const double end = reach();
    n_neighbours = 0;
    for (std::size_t k = begin; k < begin + n_padded; k += n_lanes)
    {
      const Lanes r = load_lanes(&distance[k]);
      Lanes c = -load_lanes(&slope[k]) * load_lanes(&factor[k]) / r;
      where(!(r > 0.) || !(r < end), c) = 0.;
      store_lanes(c, &factor[k]);
      n_neighbours += static_cast<unsigned int>(popcount(c > 0.));
      Lanes d[dim];
      for (unsigned int a = 0; a < dim; ++a)
        d[a] = load_lanes(&offset[a][k]);
      for (unsigned int a = 0; a < dim; ++a)
      {
        const Lanes weighted = c * d[a];
        for (unsigned int b = 0; b <= a; ++b)
          sum[a][b] += weighted * d[b];
      }
    }
    SymmetricTensor<2, dim> deformation;
    for (unsigned int a = 0; a < dim; ++a)
      for (unsigned int b = 0; b <= a; ++b)
        deformation[a][b] = reduce(sum[a][b]);
    return deformation;
  }

  template <int dim>
  void RadialRows<dim>::write_row(const unsigned int row, const std::size_t begin,
                                  const SymmetricTensor<2, dim> &correction, Stencils &shape) const
  {
    const std::size_t first = shape.row_start[row], end = shape.row_start[row + 1];
    const unsigned int own = shape.particle_node[row];
    double *const gradient = shape.gradient.data();
    Lanes of_others[dim] = {};
    std::size_t own_entry = end;
    for (std::size_t k = first, entry = begin; k < end; k += n_lanes, entry += n_lanes)
    {
      const Lanes c = load_lanes(&factor[entry]);
      Lanes d[dim], g[dim];
      for (unsigned int a = 0; a < dim; ++a)
        d[a] = c * load_lanes(&offset[a][entry]);
      for (unsigned int a = 0; a < dim; ++a)
      {
        g[a] = correction[a][0] * d[0];
        for (unsigned int b = 1; b < dim; ++b)
          g[a] += correction[a][b] * d[b];
        of_others[a] += g[a];
      }
      NodeLanes node[n_lanes];
      lanes_to_nodes(g, node);
      // Four doubles each: the fourth is overwritten by the next entry, and behind the last row
      // there is room for it.
      const auto n = static_cast<unsigned int>(std::min<std::size_t>(n_lanes, end - k));
      for (unsigned int lane = 0; lane < n; ++lane)
      {
        store_node(node[lane], gradient + Stencils::n_gradient * (k + lane));
        own_entry = shape.neighbour[k + lane] == own ? k + lane : own_entry;
      }
    }
    std::fill(shape.value.begin() + std::ptrdiff_t(first),
              shape.value.begin() + std::ptrdiff_t(end), 0.);
    if (own_entry == end)
      return;
    shape.value[own_entry] = 1.;
    for (unsigned int a = 0; a < dim; ++a)
      gradient[Stencils::n_gradient * own_entry + a] = -reduce(of_others[a]);
  }

  template <int dim>
  const std::vector<typename RadialRows<dim>::Defect> &
  RadialRows<dim>::compute(const std::vector<unsigned int> &nodes, const double *const position,
                           const double *const support, const std::vector<double> &volume,
                           Stencils &shape)
  {
    defects.clear();
    shape.rank_deficient_rows.clear();
    shape.uncorrected_rows.clear();
    shape.non_negative_rows.clear();
    shape.is_uncorrected = !is_corrected;
    shape.inverse_deformation_is_current = false;
    const unsigned int n_rows = shape.n_particles();
    shape.coefficient_start.assign(shape.row_start.begin(), shape.row_start.end() - 1);
    shape.value.resize_fast(shape.neighbour.size());
    shape.gradient.resize_fast(shape.neighbour.size() * Stencils::n_gradient + 1);
    shape.gradient.back() = 0.;
    const std::size_t n_records =
        nodes.empty() ? 0 : *std::max_element(nodes.begin(), nodes.end()) + std::size_t(1);
    if (records.size() < n_records * node_stride)
      records.resize_fast(n_records * node_stride);
    for (const unsigned int node : nodes)
    {
      const std::size_t slot = std::size_t(node) * node_stride;
      for (unsigned int d = 0; d < volume_slot; ++d)
        records[slot + d] = d < dim ? position[slot + d] : 0.;
      records[slot + volume_slot] = support[slot + volume_slot];
    }

    for (unsigned int first = 0, last = 0; first < n_rows; first = last)
    {
      for (std::size_t n = 0; last < n_rows && (last == first || n < block_entries); ++last)
        n += shape.row_start[last + 1] - shape.row_start[last];
      const std::size_t n_entries = gather(first, last, shape);
      radial_kernel.evaluate(n_entries, distance.data(), value.data(), slope.data());
      std::size_t begin = 0;
      for (unsigned int row = first; row < last; ++row)
      {
        const std::size_t n_padded = whole_lanes(shape.row_start[row + 1] - shape.row_start[row]);
        unsigned int n_neighbours;
        const SymmetricTensor<2, dim> deformation = find_factors(begin, n_padded, n_neighbours);
        const double own_volume =
            records[std::size_t(shape.particle_node[row]) * node_stride + volume_slot];
        SymmetricTensor<2, dim> correction =
            (volume.empty() ? 1. : volume[row] / own_volume) * unit_symmetric_tensor<dim>();
        if (is_corrected)
        {
          const bool is_regular = n_neighbours >= dim + 2 &&
                                  determinant(deformation) >
                                      limit * Utilities::fixed_power<dim>(trace(deformation) / dim);
          if (is_regular)
            correction = invert(deformation);
          else
          {
            defects.push_back({row, n_neighbours});
            if (treatment == Uncorrected::empty)
              correction = 0.;
            (treatment == Uncorrected::empty ? shape.rank_deficient_rows : shape.uncorrected_rows)
                .push_back(row);
          }
        }
        write_row(row, begin, correction, shape);
        begin += n_padded;
      }
    }
    return defects;
  }

  template <int dim>
  const RadialKernel<dim> &RadialRows<dim>::kernel() const
  {
    return radial_kernel;
  }

  template <int dim>
  double RadialRows<dim>::reach() const
  {
    return (1. - at_the_end) * radial_kernel.support();
  }

  template <int dim>
  std::size_t RadialRows<dim>::memory_consumption() const
  {
    std::size_t bytes = records.memory_consumption() + defects.capacity() * sizeof(Defect);
    for (const auto *buffer :
         {&offset[0], &offset[1], &offset[2], &distance, &factor, &value, &slope})
      bytes += buffer->memory_consumption();
    return bytes;
  }

  template class RadialRows<2>;
  template class RadialRows<3>;
} // namespace tombolo
