// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

/** For small functions of Lanes: their arguments stay in registers only where they are inlined, and
 * the compiler thinks of their size, not of that. */
#if defined(__GNUC__)
#  define TOMBOLO_ALWAYS_INLINE [[gnu::always_inline]] inline
#else
#  define TOMBOLO_ALWAYS_INLINE inline
#endif

/** Before a loop of a small constant number of passes over Lanes: to be written out. Left to itself
 * the compiler keeps such loops, and with them the arrays of Lanes in memory instead of registers.
 */
#if defined(__clang__)
#  define TOMBOLO_UNROLL _Pragma("clang loop unroll(full)")
#elif defined(__GNUC__)
#  define TOMBOLO_UNROLL _Pragma("GCC unroll 64")
#else
#  define TOMBOLO_UNROLL
#endif
