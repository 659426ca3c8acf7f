// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/materials/equation_of_state.h>

#include <algorithm>

namespace tombolo
{
  namespace
  {
    const char *const equation_entry = "Equation of state";

    enum PressureField : unsigned int
    {
      pressure_work,
      viscous_work,
      bulk_modulus_field
    };
  } // namespace

  std::unique_ptr<const EquationOfState> EquationOfState::create(const Entries &e)
  {
    auto equation = e.plugin<EquationOfState>(
        equation_entry, "none",
        "For strong shocks: the pressure follows from the density and the internal energy. With "
        "`none` it follows from the bulk modulus.",
        "none");
    e.plugins<EquationOfState>();
    if (equation == nullptr)
      return nullptr;
    for (const char *const entry : {"Specific heat capacity", "Conductivity"})
      e.refuse(
          e.section().parent().subsection("Heat").is_set(entry), equation_entry,
          "the material has a section \"Heat\", but with an equation of state the heat of a point "
          "is in its internal energy and stays there; allowed is `none`, or no section \"Heat\".");
    return equation;
  }

  std::vector<FieldDescription> EquationOfState::fields() const
  {
    return {energy_field("pressure work"),
            energy_field("viscous work"),
            {"bulk modulus", "M/(L T^2)", FieldLocation::material_point, 1, true, bulk_modulus(),
             true}};
  }

  void EquationOfState::advance(const MaterialBatch &batch, const unsigned int begin,
                                const unsigned int n, const unsigned int first_field,
                                const double *const plastic_work, const double elastic_bulk) const
  {
    AssertThrow(batch.relative_volume != nullptr,
                ExcMessage("An equation of state needs the volumes of the points."));
    constexpr unsigned int chunk_size = 64;
    alignas(64) double a[chunk_size], a_modulus[chunk_size], b[chunk_size], b_change[chunk_size];
    for (unsigned int first = begin; first < begin + n; first += chunk_size)
    {
      const unsigned int size = std::min(chunk_size, begin + n - first);
      EquationOfStateBatch state{size, batch.relative_volume + first, a, a_modulus, b, b_change};
      evaluate(state);

      double *stress[3];
      const double *strain[3];
      for (unsigned int c = 0; c < 3; ++c)
      {
        stress[c] = batch.stress[c] + first;
        strain[c] = batch.strain_increment[c] + first;
      }
      double *const work = batch.internal_variables[first_field + pressure_work] + first;
      const double *const viscous = batch.internal_variables[first_field + viscous_work] + first;
      double *const bulk = batch.internal_variables[first_field + bulk_modulus_field] + first;
      const double *const plastic = plastic_work + (first - begin);
#pragma GCC ivdep
      for (unsigned int i = 0; i < size; ++i)
      {
        const double now = state.relative_volume[i];
        const double volumetric = strain[0][i] + strain[1][i] + strain[2][i];
        const double before = now * (1. - 0.5 * volumetric) / (1. + 0.5 * volumetric);
        const double mean = (stress[0][i] + stress[1][i] + stress[2][i]) * (1. / 3.);
        const double old_mean = mean - elastic_bulk * volumetric;
        const double old_pressure = -old_mean / before;
        const double half_change = 0.5 * (now - before);
        const double known = work[i] - half_change * old_pressure;
        const double pressure =
            (a[i] + b[i] * (known + plastic[i] + viscous[i])) / (1. + b[i] * half_change);
        work[i] = known - half_change * pressure;
        const double energy = work[i] + plastic[i] + viscous[i];
        // -J dp/dJ with dE = -p dJ.
        const double isentropic = a_modulus[i] + b_change[i] * energy + b[i] * pressure * now;
        bulk[i] = isentropic > 0. ? isentropic : 0.;
        const double change = -pressure * now - mean;
        for (unsigned int c = 0; c < 3; ++c)
          stress[c][i] += change;
      }
    }
  }

  void EquationOfState::deviatoric_energy_density(const unsigned int n,
                                                  const double *const stress[6],
                                                  const double shear_modulus,
                                                  double *const energy_density)
  {
    const double factor = 1. / (4. * shear_modulus);
    for (unsigned int i = 0; i < n; ++i)
    {
      const double mean = (stress[0][i] + stress[1][i] + stress[2][i]) * (1. / 3.);
      double squared = 0.;
      for (unsigned int c = 0; c < 3; ++c)
        squared += (stress[c][i] - mean) * (stress[c][i] - mean) +
                   2. * stress[3 + c][i] * stress[3 + c][i];
      energy_density[i] = factor * squared;
    }
  }
} // namespace tombolo
