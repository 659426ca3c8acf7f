// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/heat_conductor.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  HeatConductor::HeatConductor(const Entries &e)
      : initial_density(e.number("Density", mandatory, positive(), "M/L^3",
                                 "Density in the initial configuration."))
  {}

  double HeatConductor::density() const
  {
    return initial_density;
  }

  bool HeatConductor::has_mechanics() const
  {
    return false;
  }

  double HeatConductor::bulk_modulus() const
  {
    return 0.;
  }

  double HeatConductor::shear_modulus() const
  {
    return 0.;
  }

  void HeatConductor::update_stress(MaterialBatch & /*batch*/) const {}

  void HeatConductor::elastic_energy_density(const unsigned int n,
                                             const double *const /*stress*/[6],
                                             const double * /*temperature*/,
                                             double *energy_density) const
  {
    std::fill(energy_density, energy_density + n, 0.);
  }

  TOMBOLO_REGISTER(Material, HeatConductor, "heat conductor",
                   "no stress, for scenes of heat alone and rigid parts")
} // namespace tombolo
