// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

/** F(BIT, NAME) for each extension of x86-64 that compilers use on their own: its bit in
 * tombolo_compiled_features and its name in __builtin_cpu_supports(). */
#define TOMBOLO_PROCESSOR_FEATURES(F)                                                              \
  F(0, "sse4.2")                                                                                   \
  F(1, "popcnt")                                                                                   \
  F(2, "avx")                                                                                      \
  F(3, "avx2")                                                                                     \
  F(4, "fma")                                                                                      \
  F(5, "bmi")                                                                                      \
  F(6, "bmi2")                                                                                     \
  F(7, "avx512f")                                                                                  \
  F(8, "avx512cd")                                                                                 \
  F(9, "avx512dq")                                                                                 \
  F(10, "avx512bw")                                                                                \
  F(11, "avx512vl")                                                                                \
  F(12, "avx512er")

/** Bits of the extensions that the programs need; a constant, not code. */
extern "C" const unsigned int tombolo_compiled_features;

/** What the programs were built for, as in "x86-64-v3". */
extern "C" const char *const tombolo_architecture;
