// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/processor.h>

#include <tombolo/version.h>

namespace tombolo
{
  std::string advice_on_processor()
  {
#if defined(__x86_64__) && defined(__OPTIMIZE__)
    const std::string architecture = TOMBOLO_ARCHITECTURE;
    std::string wider;
#  ifndef __AVX2__
    if (__builtin_cpu_supports("avx2"))
      wider = "AVX2";
#  endif
#  ifndef __AVX512F__
    if (__builtin_cpu_supports("avx512f"))
      wider = "AVX-512";
#  endif
    if (!wider.empty())
      return "This program is built for " +
             (architecture.empty() ? std::string("every processor of its kind") : architecture) +
             ", and this processor has " + wider +
             ": built from its sources on this machine, it can be faster.";
#endif
    return "";
  }
} // namespace tombolo
