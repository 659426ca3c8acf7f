// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/loads.h>

#include <tombolo/model/plain_kind.h>

namespace tombolo
{
  TOMBOLO_REGISTER_PROCESS(Loads, process_order::loads)
} // namespace tombolo
