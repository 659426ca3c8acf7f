// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/simplex_overlaps.h>

#include <cstring>
#include <numeric>

namespace tombolo
{
  namespace
  {
    /** The entries of @p a and @p b with these numbers; those of @p b are counted on from eight. */
    template <int... numbers>
    TOMBOLO_ALWAYS_INLINE EightDoubles choose_eight(const EightDoubles &a, const EightDoubles &b)
    {
      static_assert(sizeof...(numbers) == 8, "There are eight of them.");
#if defined(__AVX512F__)
      using Register = double __attribute__((vector_size(64)));
      Register a_register, b_register;
      std::memcpy(&a_register, static_cast<const void *>(&a), sizeof a_register);
      std::memcpy(&b_register, static_cast<const void *>(&b), sizeof b_register);
      const Register chosen = __builtin_shufflevector(a_register, b_register, numbers...);
      EightDoubles result;
      std::memcpy(static_cast<void *>(&result), &chosen, sizeof result);
      return result;
#else
      double entries[16];
      store_eight(a, entries);
      store_eight(b, entries + 8);
      const double chosen[8] = {entries[numbers]...};
      return load_eight(chosen);
#endif
    }

    /** Those of @p n doubles, 8 or 16, at @p data that have these eight @p numbers. */
    template <unsigned int n>
    TOMBOLO_ALWAYS_INLINE EightDoubles pick_eight_of(const double *data,
                                                     const std::uint8_t *numbers)
    {
      static_assert(n == 8 || n == 16, "There are one or two sets of eight.");
#if defined(__AVX512F__)
      if constexpr (n == 8)
      {
        const __m512i indices = _mm512_maskz_cvtepu8_epi64(
            0xFF, _mm_loadl_epi64(reinterpret_cast<const __m128i *>(numbers)));
        const __m512d picked = _mm512_maskz_permutexvar_pd(0xFF, indices, _mm512_loadu_pd(data));
        EightDoubles result;
        std::memcpy(static_cast<void *>(&result), &picked, sizeof result);
        return result;
      }
#endif
      return pick_eight(data, numbers);
    }

    /** 1/x but for round-off, of numbers that are not denormal. */
    TOMBOLO_ALWAYS_INLINE EightDoubles inverse_of(const EightDoubles &value)
    {
#if defined(__AVX512F__)
      __m512d value_register;
      std::memcpy(&value_register, static_cast<const void *>(&value), sizeof value_register);
      const __m512d estimate = _mm512_maskz_rcp14_pd(0xFF, value_register);
      EightDoubles result;
      std::memcpy(static_cast<void *>(&result), &estimate, sizeof result);
      // Newton's method doubles the number of digits.
      for (unsigned int step = 0; step < 2; ++step)
        result += result * (1. - value * result);
      return result;
#else
      return 1. / value;
#endif
    }

    /** The sums of all entries of @p a and of @p b, four times. */
    TOMBOLO_ALWAYS_INLINE EightDoubles sums_of_two(const EightDoubles &a, const EightDoubles &b)
    {
      EightDoubles sum = choose_eight<0, 8, 2, 10, 4, 12, 6, 14>(a, b) +
                         choose_eight<1, 9, 3, 11, 5, 13, 7, 15>(a, b);
      sum += choose_eight<2, 3, 0, 1, 6, 7, 4, 5>(sum, sum);
      return sum + choose_eight<4, 5, 6, 7, 0, 1, 2, 3>(sum, sum);
    }

    /** The vertices of a polyhedron that a plane can find: so many faces it has by then. */
    constexpr unsigned int most_vertices_at(const unsigned int plane)
    {
      return 4 + 2 * plane;
    }

    /** What the plane leaves between eight pairs of the vertices that it finds, by coordinate but
     * the first. */
    template <unsigned int plane>
    TOMBOLO_ALWAYS_INLINE void cut_eight(const double (&in_new)[4][16], const std::uint8_t *inside,
                                         const std::uint8_t *outside, EightDoubles (&result)[4])
    {
      constexpr bool are_eight = most_vertices_at(plane) <= 8;
      EightDoubles from[4], to[4];
      TOMBOLO_UNROLL
      for (unsigned int j = plane == 0 ? 0 : 1; j < 4; ++j)
      {
        from[j] = pick_eight_of < are_eight ? 8 : 16 > (in_new[j], inside);
        to[j] = pick_eight_of < are_eight ? 8 : 16 > (in_new[j], outside);
      }
      const EightDoubles here = from[plane];
      EightDoubles length = here - to[plane];
      std::experimental::where(length == 0., length) = 1.; // where a vertex stays
      const EightDoubles share = here * inverse_of(length);
      TOMBOLO_UNROLL
      for (unsigned int j = 1; j < 4; ++j)
        result[j] = from[j] + share * (to[j] - from[j]);
    }

    /** Of eight tetrahedra of a fan from the @p first one on: the edges from the apex, by edge and
     * coordinate but the first. Returns their volumes over that of the new tetrahedron. */
    TOMBOLO_ALWAYS_INLINE EightDoubles edges_of_eight(const double (&in_new)[4][16],
                                                      const ClippedTetrahedra::Fan &fan,
                                                      const unsigned int first,
                                                      const EightDoubles (&apex)[3],
                                                      EightDoubles (&edges)[3][3])
    {
      TOMBOLO_UNROLL
      for (unsigned int j = 0; j < 3; ++j)
        TOMBOLO_UNROLL
      for (unsigned int k = 0; k < 3; ++k)
        edges[k][j] = pick_eight(in_new[j + 1], fan.triangles[k].data() + first) - apex[j];
      return edges[0][0] * (edges[1][1] * edges[2][2] - edges[1][2] * edges[2][1]) -
             edges[0][1] * (edges[1][0] * edges[2][2] - edges[1][2] * edges[2][0]) +
             edges[0][2] * (edges[1][0] * edges[2][1] - edges[1][1] * edges[2][0]);
    }

    /** The moments with all coordinates but the first, from integrals over a polyhedron of
     * products of r = b - b(apex) and of r: ∫ rr_11, 12, 13, 22, 23, 33, r_1 and r_2, of ∫ r_3, and
     * of the volume. */
    TOMBOLO_ALWAYS_INLINE void shift_from_apex(const EightDoubles (&apex)[3],
                                               const EightDoubles &integrals,
                                               const EightDoubles &last_and_volume,
                                               OverlapMoments<3> &moments)
    {
      constexpr double first_row[8] = {0., 0., 0., 0., 1., 1., 1., 1.},
                       second_row[8] = {1., 1., 1., 1., 0., 0., 0., 0.},
                       first_columns[8] = {0., 1., 0., 0., 0., 1., 0., 0.},
                       second_columns[8] = {0., 0., 1., 0., 0., 0., 1., 0.},
                       third_columns[8] = {0., 0., 0., 1., 0., 0., 0., 1.};
      // Two rows each, with r; then with b instead of the rows, and of the columns.
      EightDoubles low = choose_eight<9, 6, 7, 8, 6, 0, 1, 2>(integrals, last_and_volume);
      EightDoubles high = choose_eight<7, 1, 3, 4, 8, 2, 4, 5>(integrals, last_and_volume);
      const EightDoubles top = choose_eight<0, 1, 2, 3, 0, 1, 2, 3>(low, low);
      low += apex[0] * load_eight(first_row) * top;
      high += (apex[1] * load_eight(second_row) + apex[2] * load_eight(first_row)) * top;
      const EightDoubles across = apex[0] * load_eight(first_columns) +
                                  apex[1] * load_eight(second_columns) +
                                  apex[2] * load_eight(third_columns);
      low += across * choose_eight<0, 0, 0, 0, 4, 4, 4, 4>(low, low);
      high += across * choose_eight<0, 0, 0, 0, 4, 4, 4, 4>(high, high);
      store_eight(low, moments.products[0]);
      store_eight(high, moments.products[2]);
    }
  } // namespace

  template <int dim>
  void SimplexOverlaps<dim>::clip()
  {
    kept.resize(n_polyhedra);
    std::iota(kept.begin(), kept.end(), 0u);
    if constexpr (dim == 3)
    {
      cut_ones.resize(n_polyhedra);
      clip_by<0>();
      clip_by<1>();
      clip_by<2>();
      clip_by<3>();
    }
  }

  template <int dim>
  template <unsigned int plane>
  void SimplexOverlaps<dim>::clip_by()
  {
    const ClippedTetrahedra &shapes = ClippedTetrahedra::instance();
    std::size_t n_kept = 0, n_cut = 0;
    for (const unsigned int number : kept)
    {
      Polyhedron &polyhedron = polyhedra[number];
      const double *const here = polyhedron.in_new[plane];
      const unsigned int all = (1u << polyhedron.n_vertices) - 1;
      unsigned int inside = bits_of(load_eight(here) >= 0.);
      if (most_vertices_at(plane) > 8)
        inside |= bits_of(load_eight(here + 8) >= 0.) << 8;
      inside &= all;
      // Sums instead of branches, which would follow no pattern.
      const unsigned int is_done = polyhedron.next_plane != none ? 1 : 0;
      const unsigned int is_whole = is_done | (inside == all ? 1 : 0);
      const unsigned int is_left = is_whole | (inside != 0 ? 1 : 0);
      polyhedron.inside = inside;
      kept[n_kept] = cut_ones[n_cut] = number;
      n_kept += is_left;
      n_cut += is_left & ~is_whole;
    }
    kept.resize(n_kept);
    for (std::size_t k = 0; k < n_cut; ++k)
    {
      Polyhedron &polyhedron = polyhedra[cut_ones[k]];
      const auto &rest = shapes.rest(polyhedron.shape, polyhedron.inside);
      if (rest.is_possible)
        cut<plane>(polyhedron, rest);
      else
        polyhedron.next_plane = plane;
    }
  }

  template <int dim>
  template <unsigned int plane>
  TOMBOLO_ALWAYS_INLINE void SimplexOverlaps<dim>::cut(Polyhedron &polyhedron,
                                                       const ClippedTetrahedra::Rest &rest)
  {
    EightDoubles low[4], high[4];
    cut_eight<plane>(polyhedron.in_new, rest.inside.data(), rest.outside.data(), low);
    if (most_vertices_at(plane + 1) > 8 && rest.n_vertices > 8)
    {
      cut_eight<plane>(polyhedron.in_new, rest.inside.data() + 8, rest.outside.data() + 8, high);
      TOMBOLO_UNROLL
      for (unsigned int j = 1; j < 4; ++j)
        store_eight(high[j], polyhedron.in_new[j] + 8);
    }
    TOMBOLO_UNROLL
    for (unsigned int j = 1; j < 4; ++j)
      store_eight(low[j], polyhedron.in_new[j]);
    polyhedron.shape = rest.shape;
    polyhedron.n_vertices = rest.n_vertices;
  }

  template <int dim>
  template <typename Use>
  void SimplexOverlaps<dim>::for_pieces(const Polyhedron &polyhedron, const Use &use) const
  {
    SimplexOverlap::Piece<dim> piece;
    const auto set_vertex = [&](const unsigned int k, const unsigned int vertex)
    {
      piece[k].in_new[0] = 1.;
      for (unsigned int j = 1; j <= dim; ++j)
      {
        piece[k].in_new[j] = polyhedron.in_new[j][vertex];
        piece[k].in_new[0] -= piece[k].in_new[j];
      }
    };
    if constexpr (dim == 3)
    {
      const ClippedTetrahedra::Fan &fan = ClippedTetrahedra::instance().fan(polyhedron.shape);
      set_vertex(0, fan.apex);
      for (unsigned int triangle = 0; triangle < fan.n_triangles; ++triangle)
      {
        for (unsigned int k = 0; k < 3; ++k)
          set_vertex(k + 1, fan.triangles[k][triangle]);
        SimplexOverlap::clip<dim>(piece, polyhedron.next_plane, use);
      }
    }
    else
    {
      for (unsigned int k = 0; k <= dim; ++k)
        set_vertex(k, k);
      SimplexOverlap::clip<dim>(piece, polyhedron.next_plane, use);
    }
  }

  template <int dim>
  void SimplexOverlaps<dim>::find_moments(const unsigned int number,
                                          OverlapMoments<dim> &moments) const
  {
    const Polyhedron &polyhedron = polyhedra[number];
    if constexpr (dim == 3)
      if (polyhedron.next_plane == none)
      {
        const ClippedTetrahedra::Fan &fan = ClippedTetrahedra::instance().fan(polyhedron.shape);
        EightDoubles apex[3];
        TOMBOLO_UNROLL
        for (unsigned int j = 0; j < 3; ++j)
          apex[j] = polyhedron.in_new[j + 1][fan.apex];
        // As shift_from_apex() needs them, but for factors.
        EightDoubles integrals[8] = {0., 0., 0., 0., 0., 0., 0., 0.}, last_integral = 0.,
                     volume = 0.;
        for (unsigned int first = 0; first < fan.n_triangles; first += 8)
        {
          EightDoubles edges[3][3], sum[3];
          const EightDoubles share = edges_of_eight(polyhedron.in_new, fan, first, apex, edges);
          unsigned int number_of_product = 0;
          TOMBOLO_UNROLL
          for (unsigned int j = 0; j < 3; ++j)
            sum[j] = edges[0][j] + edges[1][j] + edges[2][j];
          TOMBOLO_UNROLL
          for (unsigned int j = 0; j < 3; ++j)
            TOMBOLO_UNROLL
          for (unsigned int k = j; k < 3; ++k)
            integrals[number_of_product++] +=
                share * (sum[j] * sum[k] + edges[0][j] * edges[0][k] + edges[1][j] * edges[1][k] +
                         edges[2][j] * edges[2][k]);
          integrals[6] += share * sum[0];
          integrals[7] += share * sum[1];
          last_integral += share * sum[2];
          volume += share;
        }
        constexpr double factors[8] = {1. / 20., 1. / 20., 1. / 20., 1. / 20.,
                                       1. / 20., 1. / 20., 1. / 4.,  1. / 4.};
        constexpr double factors_of_others[8] = {1. / 4., 1., 1. / 4., 1.,
                                                 1. / 4., 1., 1. / 4., 1.};
        shift_from_apex(apex, load_eight(factors) * sums_of(integrals),
                        load_eight(factors_of_others) * sums_of_two(last_integral, volume),
                        moments);
        return;
      }
    moments = {};
    for_pieces(polyhedron, [&](const SimplexOverlap::Piece<dim> &piece) { moments.add(piece); });
  }

  template class SimplexOverlaps<2>;
  template class SimplexOverlaps<3>;
} // namespace tombolo
