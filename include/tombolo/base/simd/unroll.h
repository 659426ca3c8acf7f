// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

/** For small functions of Lanes. Their arguments stay in registers only where the functions are
 * inlined, which the compiler decides by their size alone. The second is for lambdas, after their
 * parameters. */
#if defined(__GNUC__)
#  define TOMBOLO_ALWAYS_INLINE [[gnu::always_inline]] inline
#  define TOMBOLO_INLINE_LAMBDA __attribute__((always_inline))
#else
#  define TOMBOLO_ALWAYS_INLINE inline
#  define TOMBOLO_INLINE_LAMBDA
#endif

/** Before a loop with a small constant number of passes over Lanes: unrolls it. Otherwise the
 * compiler keeps the loop, and with it the arrays of Lanes in memory instead of registers. */
#if defined(__clang__)
#  define TOMBOLO_UNROLL _Pragma("clang loop unroll(full)")
#elif defined(__GNUC__)
#  define TOMBOLO_UNROLL _Pragma("GCC unroll 64")
#else
#  define TOMBOLO_UNROLL
#endif
