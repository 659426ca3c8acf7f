// SPDX-License-Identifier: LGPL-2.1-or-later
#include <stdexcept>

namespace
{
  int refuse()
  {
    throw std::runtime_error("no licence");
  }

  const int started = refuse();
} // namespace
