// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cmath>

/** Declares the vector versions of exp, log and pow in the mathematics library of glibc (accurate
 * to 4 units in the last place), so that loops over calls of std::exp, std::log and std::pow
 * vectorize without -ffast-math. To be included in source files with such loops. */
#if defined(__x86_64__) && defined(__GLIBC__) && defined(__GNUC__) && !defined(__clang__)
extern "C" __attribute__((simd("notinbranch"))) double exp(double) noexcept;
extern "C" __attribute__((simd("notinbranch"))) double log(double) noexcept;
extern "C" __attribute__((simd("notinbranch"))) double pow(double, double) noexcept;
#endif
