// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <cstddef>
#include <string>

namespace tombolo
{
  /** What this process has allocated and not released [bytes]; its resident memory where the system
   * does not count allocations. */
  std::size_t allocated_bytes();

  /** The memory [bytes] that this process can still allocate: the least of what the machine has
   * free, what the limit of a container leaves and what that of the process leaves (`ulimit -v`).
   * @p container is the directory of the control group (version 2). */
  double free_memory(const std::string &container = "/sys/fs/cgroup");
} // namespace tombolo
