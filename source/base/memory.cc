// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/memory.h>

#include <sys/resource.h>

#include <algorithm>
#include <fstream>
#include <limits>
#include <string>
#include <unistd.h>

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

  namespace
  {
    constexpr double unlimited = std::numeric_limits<double>::max();

    double free_memory_of_machine()
    {
      std::ifstream in("/proc/meminfo");
      std::string name;
      double kilobytes = 0;
      std::string unit;
      while (in >> name >> kilobytes && std::getline(in, unit))
        if (name == "MemAvailable:")
          return 1024. * kilobytes;
      return unlimited;
    }

    double free_memory_of_container(const std::string &directory)
    {
      double limit = 0, used = 0, bytes = 0;
      if (!(std::ifstream(directory + "/memory.max") >> limit) ||
          !(std::ifstream(directory + "/memory.current") >> used))
        return unlimited;
      // Files that were read or written stay in memory as long as nobody needs it.
      std::ifstream statistics(directory + "/memory.stat");
      for (std::string name; statistics >> name >> bytes;)
        if (name == "inactive_file")
          used -= bytes;
      return std::max(0., limit - used);
    }

    double free_memory_of_process()
    {
      rlimit limit{};
      double pages = 0;
      if (getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY ||
          !(std::ifstream("/proc/self/statm") >> pages))
        return unlimited;
      return std::max(0., static_cast<double>(limit.rlim_cur) -
                              pages * static_cast<double>(sysconf(_SC_PAGESIZE)));
    }
  } // namespace

  double free_memory(const std::string &container)
  {
    return std::min(
        {free_memory_of_machine(), free_memory_of_container(container), free_memory_of_process()});
  }
} // namespace tombolo
