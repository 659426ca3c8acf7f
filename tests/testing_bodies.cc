// SPDX-License-Identifier: LGPL-2.1-or-later
#include "frozen_body.h"
#include "mesh_testing.h"

namespace tombolo
{
  namespace testing
  {
    template class FrozenBody<2>;
    template class FrozenBody<3>;
    template class MeshScene<2>;
    template class MeshScene<3>;
  } // namespace testing
} // namespace tombolo
