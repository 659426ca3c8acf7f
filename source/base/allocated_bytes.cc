// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/allocated_bytes.h>

#ifdef __GLIBC__
#  include <malloc.h>
#else
#  include <deal.II/base/utilities.h>
#endif

namespace tombolo
{
  std::size_t allocated_bytes()
  {
#ifdef __GLIBC__
    const auto allocated = mallinfo2();
    return allocated.uordblks + allocated.hblkhd;
#else
    dealii::Utilities::System::MemoryStats memory;
    dealii::Utilities::System::get_memory_stats(memory);
    return memory.VmRSS * 1024;
#endif
  }
} // namespace tombolo
