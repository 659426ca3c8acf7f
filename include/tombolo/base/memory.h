// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

namespace tombolo
{
  /** The memory [bytes] that this process can still take: the least of what the machine has free,
   * what the limit of a container leaves and what that of the process leaves (`ulimit -v`). */
  double free_memory();
} // namespace tombolo
