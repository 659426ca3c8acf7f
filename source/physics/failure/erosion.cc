// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/failure/erosion.h>

namespace tombolo
{
  TOMBOLO_REGISTER_PROCESS(Erosion, process_order::erosion)
} // namespace tombolo
