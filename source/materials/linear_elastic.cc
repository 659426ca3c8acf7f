#include <tombolo/materials/linear_elastic.h>

namespace tombolo
{
  using namespace dealii;

  void LinearElastic::declare_parameters(ParameterHandler &handler)
  {
    Parameters::declare_mandatory(handler, "Density", Patterns::Double(),
                                  "Density in the initial configuration. Units: M/L^3.");
    Parameters::declare_mandatory(handler, "Young's modulus", Patterns::Double(),
                                  "Young's modulus $E$. Units: M/(L T^2).");
    Parameters::declare_mandatory(handler, "Poisson's ratio", Patterns::Double(),
                                  "Poisson's ratio $\\nu$, between -1 and 0.5, both excluded.");
  }

  LinearElastic::LinearElastic(const Section &section)
      : initial_density(section.get_positive("Density"))
  {
    const double young = section.get_positive("Young's modulus");
    const double poisson = section.get_double("Poisson's ratio");
    if (!(poisson > -1. && poisson < 0.5))
      section.fail("Poisson's ratio", "allowed is a number between -1 and 0.5, both excluded; for "
                                      "nearly incompressible material take for example 0.4999");
    bulk = young / (3. * (1. - 2. * poisson));
    shear = young / (2. * (1. + poisson));
  }

  double LinearElastic::density() const
  {
    return initial_density;
  }

  double LinearElastic::bulk_modulus() const
  {
    return bulk;
  }

  double LinearElastic::shear_modulus() const
  {
    return shear;
  }

  void LinearElastic::update_stress(MaterialBatch &batch) const
  {
    const double lambda = bulk - 2. / 3. * shear;
    const double twice_shear = 2. * shear;
    const double *const xx = batch.strain_increment[0];
    const double *const yy = batch.strain_increment[1];
    const double *const zz = batch.strain_increment[2];
    for (unsigned int c = 0; c < 6; ++c)
    {
      const double *const strain = batch.strain_increment[c];
      double *const stress = batch.stress[c];
      if (c < 3)
      {
#pragma GCC ivdep
        for (unsigned int i = 0; i < batch.n; ++i)
          stress[i] += lambda * (xx[i] + yy[i] + zz[i]) + twice_shear * strain[i];
      }
      else
      {
#pragma GCC ivdep
        for (unsigned int i = 0; i < batch.n; ++i)
          stress[i] += twice_shear * strain[i];
      }
    }
  }

  TOMBOLO_REGISTER(Material, LinearElastic, "elastic",
                   "isotropic elasticity in rate form with an objective stress rate")
} // namespace tombolo
