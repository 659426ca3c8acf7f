#pragma once

#include <cstring>

namespace tombolo
{
  namespace internal
  {
    /** Eight doubles as the compiler's own vector, for what Lanes cannot do: fixed permutations. */
    typedef double Vector8 __attribute__((vector_size(64)));
    typedef double Vector4 __attribute__((vector_size(32)));

    inline void load(Vector8 &vector, const double *data)
    {
      std::memcpy(&vector, data, sizeof(vector));
    }

    inline void store(const Vector8 &vector, double *data)
    {
      std::memcpy(data, &vector, sizeof(vector));
    }

    /** Of the records of eight doubles at @p record[0 ... 7], component 0 ... dim-1 goes to lanes
     * first[0 ... dim-1], component 4 ... 4+dim-1 to second[0 ... dim-1]. */
    template <int dim>
    inline void transpose_records(const double *const record[8], Vector8 *const first,
                                  Vector8 *const second)
    {
      Vector8 r[8];
      for (unsigned int lane = 0; lane < 8; ++lane)
        load(r[lane], record[lane]);
      Vector8 even[4], odd[4]; // components 0 2 4 6 and 1 3 5 7 of two records, interleaved
      for (unsigned int pair = 0; pair < 4; ++pair)
      {
        even[pair] =
            __builtin_shufflevector(r[2 * pair], r[2 * pair + 1], 0, 8, 2, 10, 4, 12, 6, 14);
        odd[pair] =
            __builtin_shufflevector(r[2 * pair], r[2 * pair + 1], 1, 9, 3, 11, 5, 13, 7, 15);
      }
      // Components 0 and 4 of four records, then of eight.
      const Vector8 a = __builtin_shufflevector(even[0], even[1], 0, 1, 8, 9, 4, 5, 12, 13);
      const Vector8 b = __builtin_shufflevector(even[2], even[3], 0, 1, 8, 9, 4, 5, 12, 13);
      first[0] = __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11);
      second[0] = __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
      const Vector8 c = __builtin_shufflevector(odd[0], odd[1], 0, 1, 8, 9, 4, 5, 12, 13);
      const Vector8 d = __builtin_shufflevector(odd[2], odd[3], 0, 1, 8, 9, 4, 5, 12, 13);
      first[1] = __builtin_shufflevector(c, d, 0, 1, 2, 3, 8, 9, 10, 11);
      second[1] = __builtin_shufflevector(c, d, 4, 5, 6, 7, 12, 13, 14, 15);
      if (dim == 3)
      {
        const Vector8 e = __builtin_shufflevector(even[0], even[1], 2, 3, 10, 11, 6, 7, 14, 15);
        const Vector8 f = __builtin_shufflevector(even[2], even[3], 2, 3, 10, 11, 6, 7, 14, 15);
        first[dim - 1] = __builtin_shufflevector(e, f, 0, 1, 2, 3, 8, 9, 10, 11);
        second[dim - 1] = __builtin_shufflevector(e, f, 4, 5, 6, 7, 12, 13, 14, 15);
      }
    }

    /** Lane l of x, y, z and a zero goes to the four doubles at @p node[l]. */
    inline void transpose_to_nodes(const Vector8 &x, const Vector8 &y, const Vector8 &z,
                                   double *const node[8])
    {
      const Vector8 zero = {};
      const Vector8 xy_even = __builtin_shufflevector(x, y, 0, 8, 2, 10, 4, 12, 6, 14);
      const Vector8 xy_odd = __builtin_shufflevector(x, y, 1, 9, 3, 11, 5, 13, 7, 15);
      const Vector8 z_even = __builtin_shufflevector(z, zero, 0, 8, 2, 10, 4, 12, 6, 14);
      const Vector8 z_odd = __builtin_shufflevector(z, zero, 1, 9, 3, 11, 5, 13, 7, 15);
      Vector8 n[4]; // nodes 0 2, 4 6, 1 3, 5 7
      n[0] = __builtin_shufflevector(xy_even, z_even, 0, 1, 8, 9, 2, 3, 10, 11);
      n[1] = __builtin_shufflevector(xy_even, z_even, 4, 5, 12, 13, 6, 7, 14, 15);
      n[2] = __builtin_shufflevector(xy_odd, z_odd, 0, 1, 8, 9, 2, 3, 10, 11);
      n[3] = __builtin_shufflevector(xy_odd, z_odd, 4, 5, 12, 13, 6, 7, 14, 15);
      static constexpr unsigned int lanes_of[4] = {0, 4, 1, 5};
      for (unsigned int i = 0; i < 4; ++i)
      {
        const Vector4 low = __builtin_shufflevector(n[i], n[i], 0, 1, 2, 3);
        const Vector4 high = __builtin_shufflevector(n[i], n[i], 4, 5, 6, 7);
        std::memcpy(node[lanes_of[i]], &low, sizeof(low));
        std::memcpy(node[lanes_of[i] + 2], &high, sizeof(high));
      }
    }
  } // namespace internal
} // namespace tombolo
