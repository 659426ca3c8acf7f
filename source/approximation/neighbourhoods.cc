// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/neighbourhoods.h>

namespace tombolo
{
  template class NeighbourSearch<2>;
  template class NeighbourSearch<3>;
  template class ParticleGhosts<2>;
  template class ParticleGhosts<3>;
  template class Neighbourhoods<2>;
  template class Neighbourhoods<3>;
} // namespace tombolo
