// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/particles/particle_method.h>

namespace tombolo
{
  /**
   * The particle method of Pan et al. 2019 (doc/method.md, sections 2 and 6): moving least squares
   * shape functions on cuboidal supports, direct nodal integration with one point at every node,
   * momentum-consistent smoothing (done by the bridge).
   */
  template <int dim>
  class MomentumConsistentParticle : public ParticleMethod<dim>
  {
  public:
    explicit MomentumConsistentParticle(const Section &section);
    static void declare_parameters(const Entries &e);

    double cost_per_cell(const Material &material, double box_ratio) const override;
  };
} // namespace tombolo
