// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/kernel.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/base/simd/selected_lanes.h>
#include <tombolo/base/simd/unroll.h>

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/numbers.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <vector>

namespace tombolo
{
  /** A kernel of the distance, W(r) = α w(r/(2h)) with the smoothing length h, zero for r >= 2h.
   * The factor α makes its integral over the plane or space one, by a quadrature for any Kernel. */
  template <int dim>
  class RadialKernel
  {
  public:
    RadialKernel(std::shared_ptr<const Kernel> coordinate_kernel, const double smoothing_length)
        : kernel(std::move(coordinate_kernel)), length(smoothing_length),
          scale(1. / (integral_over_ball(*kernel) * std::pow(2. * length, dim)))
    {}

    /** W [1/L^dim] and dW/dr [1/L^(dim+1)] at @p n distances [L]. @p n is a multiple of n_lanes,
     * and no pointer may be the same. At r = 0 the slope is that of r → 0+. */
    void evaluate(const std::size_t n, const double *const distance, double *const value,
                  double *const slope) const
    {
      constexpr std::size_t n_at_once = 512;
      static_assert(n_at_once % n_lanes == 0, "whole Lanes");
      alignas(64) double coordinate[n_at_once];
      const double inverse_support = 1. / support();
      for (std::size_t begin = 0; begin < n; begin += n_at_once)
      {
        const std::size_t count = std::min(n_at_once, n - begin);
        for (std::size_t i = 0; i < count; i += n_lanes)
          store_lanes(load_lanes(distance + begin + i) * inverse_support, coordinate + i);
        kernel->evaluate(count, coordinate, value + begin, slope + begin);
        for (std::size_t i = begin; i < begin + count; i += n_lanes)
        {
          store_lanes(load_lanes(value + i) * scale, value + i);
          store_lanes(load_lanes(slope + i) * (scale * inverse_support), slope + i);
        }
      }
    }

    /** h [L]. */
    double smoothing_length() const
    {
      return length;
    }
    /** 2h [L]. */
    double support() const
    {
      return 2. * length;
    }

  private:
    /** ∫ w(|x|) dx over the unit ball. */
    static double integral_over_ball(const Kernel &kernel)
    {
      // Splines of two and of three intervals are polynomials between these points.
      constexpr unsigned int n_intervals = 6;
      const dealii::QGauss<1> gauss(8);
      const double surface = dim == 2 ? 2. * dealii::numbers::PI : 4. * dealii::numbers::PI;
      double sum = 0;
      for (unsigned int i = 0; i < n_intervals; ++i)
        for (unsigned int q = 0; q < gauss.size(); ++q)
        {
          std::array<double, n_lanes> r = {}, w, dw;
          r[0] = (i + gauss.point(q)[0]) / n_intervals;
          kernel.evaluate(n_lanes, r.data(), w.data(), dw.data());
          sum += gauss.weight(q) / n_intervals * surface * std::pow(r[0], dim - 1) * w[0];
        }
      return sum;
    }

    std::shared_ptr<const Kernel> kernel;
    double length;
    double scale; ///< α
  };

  /**
   * Rows of smoothed particle hydrodynamics: fills value and gradient of Stencils for given
   * neighbours with φ_I = 1, φ_J = 0 and, with d = x_J - x_I, r = |d| and masses over the common
   * initial density as volumes V⁰,
   *
   * @verbatim
   *   ∇φ_J = (m_J/ρ_I) ∇_I W(r) = -(V⁰_J V_I/V⁰_I) W'(r) d/r,     ∇φ_I = -Σ ∇φ_J
   * @endverbatim
   *
   * With V_I = m_I/ρ_I as the volume of a particle, L = Σ v_J ⊗ ∇φ_J is then the velocity gradient
   * of the equation of mass, dρ_I/dt = Σ m_J (v_I - v_J)·∇_IW, and -V_I σ_I ∇φ_J are the forces of
   * dv_I/dt = Σ m_J (σ_I/ρ_I² + σ_J/ρ_J²)·∇_IW: the pair is conjugate in energy, whatever the
   * volumes are. Corrected rows have F⁻¹∇φ_J with the symmetric F = Σ d ⊗ ∇φ_J (Randles and
   * Libersky 1996; Bonet and Lok 1999), so that Σ d ⊗ ∇φ_J = 1: linear fields have their gradients,
   * and angular momentum is conserved. V_I cancels there.
   *
   * F of a row can be nearly singular where a particle has few neighbours. A row is not corrected
   * where det F falls below a limit times (tr F/dim)^dim, which is one where F is isotropic and
   * does not depend on how many neighbours there are, or where it has fewer than dim + 2 of them.
   */
  template <int dim>
  class RadialRows
  {
  public:
    /** What becomes of rows that cannot be corrected. */
    enum class Uncorrected
    {
      raw,  ///< they keep ∇φ_J as it is, and are listed in Stencils::uncorrected_rows
      empty ///< they have no ∇φ, and are listed in Stencils::rank_deficient_rows
    };

    struct Defect
    {
      unsigned int row;          ///< index into Stencils::particle_node
      unsigned int n_neighbours; ///< within the support, without the particle itself
    };

    /** Without @p corrects all rows are raw (Stencils::is_uncorrected). */
    RadialRows(const RadialKernel<dim> &kernel, const bool corrects, const double correction_limit,
               const Uncorrected uncorrected)
        : radial_kernel(kernel), is_corrected(corrects), limit(correction_limit),
          treatment(uncorrected)
    {}

    /** Where component V⁰ of a node is in its support. */
    static constexpr unsigned int volume_slot = node_stride - 1;

    /**
     * Computes the rows of @p shape from @p position and @p support, node_stride doubles per local
     * node, of which only V⁰ in volume_slot counts [L^dim]. The rows of @p candidates have all
     * neighbours that can be within reach(); @p shape receives those that are, in their order, or
     * keeps all where both are the same object. @p nodes lists the local nodes that occur as
     * particle or neighbour. @p volume holds the present V_I of each row, or nothing: V⁰_I. Returns
     * the rows that cannot be corrected, ascending, valid until the next call.
     */
    const std::vector<Defect> &compute(const std::vector<unsigned int> &nodes,
                                       const double *const position, const double *const support,
                                       const std::vector<double> &volume,
                                       const Stencils &candidates, Stencils &shape)
    {
      prepare(nodes, position, support, candidates, shape);
      const unsigned int n_rows = candidates.n_particles();
      for (unsigned int first = 0, last = 0; first < n_rows; first = last)
      {
        block_rows.clear();
        std::size_t n_entries = 0;
        while (last < n_rows && n_entries < block_entries)
        {
          block_rows.push_back(gather(last, n_entries, candidates, shape));
          n_entries += block_rows.back().padded();
          ++last;
        }
        evaluate_kernel(n_entries);
        for (unsigned int row = first; row < last; ++row)
        {
          const Entries &entries = block_rows[row - first];
          write_row(row, entries, find_correction(row, entries, volume, shape), shape);
        }
      }
      shape.gradient[Stencils::n_gradient * shape.row_start[n_rows]] = 0.;
      write_values(shape);
      return defects;
    }

    const RadialKernel<dim> &kernel() const
    {
      return radial_kernel;
    }

    /** By row of the last call, the entry of the particle itself. */
    const std::size_t *own_entries() const
    {
      return own_entry.data();
    }

    /** Neighbours are nearer than this: 2h less a small share of it, since on a lattice particles
     * can be there exactly, and round-off is not to decide whether they are neighbours [L]. */
    double reach() const
    {
      constexpr double at_the_end = 1e-9; // the share of the support where nothing is a neighbour
      return (1. - at_the_end) * radial_kernel.support();
    }

  private:
    /** Entries of one call of the kernel; they stay in the first-level cache. */
    static constexpr std::size_t block_entries = 512;

    /** Of distances: far from subnormal numbers, with which the machine is slow [L^2]. */
    static constexpr double smallest_square = 1e-200;

    /** With the determinant @p det; the library's inverse is a call for each row. */
    static dealii::SymmetricTensor<2, 2> inverse_of(const dealii::SymmetricTensor<2, 2> &matrix,
                                                    const double det)
    {
      dealii::SymmetricTensor<2, 2> result;
      result[0][0] = matrix[1][1] / det;
      result[1][1] = matrix[0][0] / det;
      result[0][1] = -matrix[0][1] / det;
      return result;
    }

    static dealii::SymmetricTensor<2, 3> inverse_of(const dealii::SymmetricTensor<2, 3> &matrix,
                                                    const double det)
    {
      const double xx = matrix[0][0], yy = matrix[1][1], zz = matrix[2][2];
      const double yz = matrix[1][2], zx = matrix[2][0], xy = matrix[0][1];
      const double scale = 1. / det;
      dealii::SymmetricTensor<2, 3> result;
      result[0][0] = scale * (yy * zz - yz * yz);
      result[1][1] = scale * (zz * xx - zx * zx);
      result[2][2] = scale * (xx * yy - xy * xy);
      result[1][2] = scale * (zx * xy - xx * yz);
      result[2][0] = scale * (xy * yz - yy * zx);
      result[0][1] = scale * (yz * zx - zz * xy);
      return result;
    }

    /** The neighbours of some row within the buffers. */
    struct Entries
    {
      std::size_t begin; ///< in the buffers, a multiple of n_lanes
      std::size_t own;   ///< of the particle itself, from the beginning of the row on
      unsigned int size; ///< with the particle itself

      std::size_t padded() const
      {
        return padded_to_lanes(size);
      }
    };

    /** Fills records of the nodes, and sizes what all rows of @p shape need. */
    void prepare(const std::vector<unsigned int> &nodes, const double *const position,
                 const double *const support, const Stencils &candidates, Stencils &shape)
    {
      const unsigned int n_rows = candidates.n_particles();
      const std::size_t n_entries = candidates.row_start[n_rows];
      defects.clear();
      shape.rank_deficient_rows.clear();
      shape.uncorrected_rows.clear();
      shape.non_negative_rows.clear();
      shape.is_uncorrected = !is_corrected;
      shape.inverse_deformation_is_current = false;
      if (&candidates != &shape)
      {
        shape.particle_node.assign(candidates.particle_node.begin(),
                                   candidates.particle_node.end());
        shape.row_start.resize(n_rows + 1);
        shape.row_start[0] = 0;
        // Room for all candidates, and for whole Lanes behind the last of them.
        shape.neighbour.resize(n_entries + n_lanes);
      }
      shape.coefficient_start.resize(n_rows);
      if (shape.value.size() != n_entries)
        last_values = nullptr;
      shape.value.resize_fast(n_entries);
      shape.gradient.resize_fast(n_entries * Stencils::n_gradient + 1);
      own_candidate.resize(n_rows, 0);
      own_entry.resize(n_rows);

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
      std::size_t n_buffered = 0;
      for (unsigned int row = 0; row < n_rows; ++row)
        n_buffered =
            std::max(n_buffered, candidates.row_start[row + 1] - candidates.row_start[row]);
      n_buffered += block_entries + 2 * n_lanes;
      for (auto *const buffer : {&offset[0], &offset[1], &offset[2], &squared, &factor, &distance,
                                 &inverse_distance, &value, &slope})
        if (buffer->size() < n_buffered)
          buffer->resize_fast(n_buffered);
    }
    /** Offsets, their squares and volumes of a row, from entry @p begin on; numbers in @p shape. */
    Entries gather(const unsigned int row, const std::size_t begin, const Stencils &candidates,
                   Stencils &shape)
    {
      const bool is_compact = &candidates != &shape;
      const unsigned int own = candidates.particle_node[row];
      const std::size_t first = candidates.row_start[row], end = candidates.row_start[row + 1];
      std::size_t &own_slot = own_candidate[row];
      if (!(first + own_slot < end && candidates.neighbour[first + own_slot] == own))
        own_slot = static_cast<std::size_t>(
            std::find(candidates.neighbour.begin() + std::ptrdiff_t(first),
                      candidates.neighbour.begin() + std::ptrdiff_t(end), own) -
            candidates.neighbour.begin() - std::ptrdiff_t(first));
      Assert(first + own_slot < end, dealii::ExcInternalError());
      const NodeLanes centre =
          load_node(&records[std::size_t(own) * node_stride]) * node_of(1., 1., 1.);
      const double squared_reach = reach() * reach();
      const std::size_t target = shape.row_start[row];
      Entries entries = {begin, 0, 0};
      // The compiler must assume that what is stored can be any of these addresses.
      const unsigned int *const candidate = candidates.neighbour.data() + first;
      const double *const record = records.data();
      double *const to_offset[3] = {&offset[0][begin], &offset[1][begin], &offset[2][begin]};
      double *const to_squared = &squared[begin], *const to_factor = &factor[begin];
      unsigned int *const to_neighbour = shape.neighbour.data() + target;
      const auto n_candidates = static_cast<unsigned int>(end - first);
      const auto own_number = static_cast<unsigned int>(own_slot);
      unsigned int size = 0, own_index = 0;
      unsigned int last_numbers[n_lanes];
      for (unsigned int k = 0; k < n_candidates; k += n_lanes)
      {
        const unsigned int n = std::min(n_lanes, n_candidates - k);
        const unsigned int *numbers = candidate + k;
        if (n < n_lanes)
        {
          for (unsigned int lane = 0; lane < n_lanes; ++lane)
            last_numbers[lane] = lane < n ? numbers[lane] : own;
          numbers = last_numbers;
        }
        NodeLanes node[n_lanes];
        TOMBOLO_UNROLL
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          node[lane] = load_node(record + std::size_t(numbers[lane]) * node_stride) - centre;
        Lanes d[node_stride];
        nodes_to_lanes(node, d);
        const Lanes square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        const SelectedLanes selected(is_compact ? square < squared_reach : LaneMask(true), n);
        TOMBOLO_UNROLL
        for (unsigned int c = 0; c < dim; ++c)
          selected.store(d[c], to_offset[c] + size);
        selected.store(square, to_squared + size);
        selected.store(d[volume_slot], to_factor + size);
        if (is_compact)
          selected.store(numbers, to_neighbour + size);
        if (own_number - k < n_lanes)
          own_index = size + selected.count_before(own_number - k);
        size += selected.count();
      }
      entries.size = size;
      entries.own = own_index;
      if (is_compact)
        shape.row_start[row + 1] = target + entries.size;
      shape.coefficient_start[row] = target;
      own_entry[row] = target + entries.own;
      // Beyond the row: at a distance, without volume.
      const std::size_t row_end = begin + entries.size;
      for (unsigned int c = 0; c < dim; ++c)
        store_lanes(0., &offset[c][row_end]);
      store_lanes(1., &squared[row_end]);
      store_lanes(0., &factor[row_end]);
      return entries;
    }
    /** Distances of @p n_entries of the buffers, and the slopes of the kernel there. */
    void evaluate_kernel(const std::size_t n_entries)
    {
      for (std::size_t k = 0; k < n_entries; k += n_lanes)
      {
        const Lanes square = load_lanes(&squared[k]);
        // Of the particle itself finite, so that its distance is zero.
        const Lanes inverse = reciprocal_root(max(square, Lanes(smallest_square)));
        store_lanes(inverse, &inverse_distance[k]);
        store_lanes(square * inverse, &distance[k]);
      }
      radial_kernel.evaluate(n_entries, distance.data(), value.data(), slope.data());
    }
    /** The factors c of ∇φ_J = c d. Returns F = Σ c d dᵀ, counts neighbours within the support. */
    dealii::SymmetricTensor<2, dim> find_factors(const Entries &entries, unsigned int &n_neighbours)
    {
      constexpr unsigned int n_sums = dealii::SymmetricTensor<2, dim>::n_independent_components;
      Lanes sum[n_sums];
      TOMBOLO_UNROLL
      for (unsigned int k = 0; k < n_sums; ++k)
        sum[k] = 0.;
      const double end = reach();
      const std::size_t begin = entries.begin, n = entries.padded();
      double *const factor_of = &factor[begin];
      const double *const r_of = &distance[begin], *const slope_of = &slope[begin];
      const double *const inverse_of_r = &inverse_distance[begin];
      const double *const d_of[3] = {&offset[0][begin], &offset[1][begin], &offset[2][begin]};
      unsigned int count = 0;
      for (std::size_t k = 0; k < n; k += n_lanes)
      {
        const Lanes r = load_lanes(r_of + k);
        Lanes c =
            -load_lanes(slope_of + k) * load_lanes(factor_of + k) * load_lanes(inverse_of_r + k);
        where(!(r > 0.) || !(r < end), c) = 0.;
        store_lanes(c, factor_of + k);
        count += static_cast<unsigned int>(popcount(c > 0.));
        Lanes d[dim];
        TOMBOLO_UNROLL
        for (unsigned int a = 0; a < dim; ++a)
          d[a] = load_lanes(d_of[a] + k);
        unsigned int pair = 0;
        TOMBOLO_UNROLL
        for (unsigned int a = 0; a < dim; ++a)
        {
          const Lanes weighted = c * d[a];
          TOMBOLO_UNROLL
          for (unsigned int b = 0; b <= a; ++b)
            sum[pair++] += weighted * d[b];
        }
      }
      n_neighbours = count;
      dealii::SymmetricTensor<2, dim> moment;
      unsigned int pair = 0;
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b <= a; ++b)
          moment[a][b] = reduce(sum[pair++]);
      return moment;
    }
    /** The correction of a row, and its factors; notes rows that are not corrected. */
    dealii::SymmetricTensor<2, dim> find_correction(const unsigned int row, const Entries &entries,
                                                    const std::vector<double> &volume,
                                                    Stencils &shape)
    {
      unsigned int n_neighbours;
      const dealii::SymmetricTensor<2, dim> moment = find_factors(entries, n_neighbours);
      if (is_corrected)
      {
        const double det = determinant(moment);
        if (n_neighbours >= dim + 2 &&
            det > limit * dealii::Utilities::fixed_power<dim>(trace(moment) / dim))
          return inverse_of(moment, det);
        defects.push_back({row, n_neighbours});
        if (treatment == Uncorrected::empty)
        {
          shape.rank_deficient_rows.push_back(row);
          return {};
        }
        shape.uncorrected_rows.push_back(row);
      }
      const double own_volume =
          records[std::size_t(shape.particle_node[row]) * node_stride + volume_slot];
      return (volume.empty() ? 1. : volume[row] / own_volume) *
             dealii::unit_symmetric_tensor<dim>();
    }
    void write_row(const unsigned int row, const Entries &entries,
                   const dealii::SymmetricTensor<2, dim> &correction, Stencils &shape) const
    {
      double *const gradient = shape.gradient.data() + Stencils::n_gradient * shape.row_start[row];
      Lanes matrix[dim][dim], gradient_sum[dim] = {};
      for (unsigned int a = 0; a < dim; ++a)
        for (unsigned int b = 0; b < dim; ++b)
          matrix[a][b] = correction[a][b];
      for (unsigned int k = 0; k < entries.size; k += n_lanes)
      {
        const Lanes c = load_lanes(&factor[entries.begin + k]);
        Lanes d[dim], g[dim];
        for (unsigned int a = 0; a < dim; ++a)
          d[a] = c * load_lanes(&offset[a][entries.begin + k]);
        for (unsigned int a = 0; a < dim; ++a)
        {
          g[a] = matrix[a][0] * d[0];
          for (unsigned int b = 1; b < dim; ++b)
            g[a] += matrix[a][b] * d[b];
          gradient_sum[a] += g[a];
        }
        NodeLanes node[n_lanes];
        lanes_to_nodes(g, node);
        // Four doubles each: the fourth is overwritten by the next entry, and behind the last row
        // there is room for it.
        double *const target = gradient + Stencils::n_gradient * k;
        if (k + n_lanes <= entries.size)
        {
          TOMBOLO_UNROLL
          for (unsigned int lane = 0; lane < n_lanes; ++lane)
            store_node(node[lane], target + Stencils::n_gradient * lane);
        }
        else
          for (unsigned int lane = 0; lane < entries.size - k; ++lane)
            store_node(node[lane], target + Stencils::n_gradient * lane);
      }
      for (unsigned int a = 0; a < dim && entries.size > 0; ++a)
        gradient[Stencils::n_gradient * entries.own + a] = -reduce(gradient_sum[a]);
    }
    void write_values(Stencils &shape)
    {
      if (last_values == shape.value.data())
        for (const std::size_t entry : last_own_entry)
          shape.value[entry] = 0.;
      else
        std::fill(shape.value.begin(), shape.value.end(), 0.);
      for (const std::size_t entry : own_entry)
        shape.value[entry] = 1.;
      last_values = shape.value.data();
      last_own_entry = own_entry;
    }

    RadialKernel<dim> radial_kernel;
    bool is_corrected;
    double limit;
    Uncorrected treatment;
    std::vector<Defect> defects;
    dealii::AlignedVector<double> records; // of each node: position and V⁰
    dealii::AlignedVector<double> offset[3], squared, factor, distance, inverse_distance, value,
        slope;
    std::vector<Entries> block_rows;
    std::vector<std::size_t> own_candidate; // by row, where it was last
    std::vector<std::size_t> own_entry;     // by row of shape
    /** Of the last call: the entries with φ = 1, and the values. */
    std::vector<std::size_t> last_own_entry;
    const double *last_values = nullptr;
  };
} // namespace tombolo
