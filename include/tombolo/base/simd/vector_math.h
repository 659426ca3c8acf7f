// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>

/** Tells the compiler that exp, log and pow have vector versions in the mathematics library of
 * glibc (accurate to 4 units in the last place), which it otherwise believes only together with
 * -ffast-math: loops over calls of std::exp, std::log and std::pow then vectorize. To be included
 * where such loops are, in source files. */
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
extern "C" __attribute__((simd("notinbranch"))) double exp(double) noexcept;
extern "C" __attribute__((simd("notinbranch"))) double log(double) noexcept;
extern "C" __attribute__((simd("notinbranch"))) double pow(double, double) noexcept;
#endif
