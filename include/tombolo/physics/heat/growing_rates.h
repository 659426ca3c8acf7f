// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/records.h>

namespace tombolo
{
  /**
   * Notices forward Euler steps that are too long by what they do. A step amplifies modes with an
   * eigenvalue λ of C⁻¹A above 2/Δt, and then the rates of temperature d = C⁻¹ dH/dt are made of
   * such modes sooner or later. The largest rate is followed. Whenever it is twice the usual one, A
   * is applied to the rates once, for the quotient (y · C⁻¹ y)/(d · y) with y = A d: a lower bound
   * of the largest eigenvalue, since A is symmetric. Sources and what is prescribed make rates
   * grow, too, but are not in A: no step that is stable exceeds 2/λ.
   */
  template <int dim>
  class GrowingRates
  {
  public:
    /** λ [1/T] from @p rate, dH/dt of owned nodes at @p time; the areas of surfaces are those of
     * the present. Zero where the largest rate is not twice the usual one, which is that at the
     * last λ and follows smaller ones by 3 % a step, and where a step of @p time_step changes
     * temperatures by round-off only. Collective. */
    double find_eigenvalue(const Model<dim> &model, double time, const NodalVector &rate,
                           double time_step);

    /** Lists what is kept between steps. */
    void list(Records &records)
    {
      records.value("usual rate", usual);
    }

  private:
    /** Whether the largest rate is that of a uniform temperature. Collective. */
    bool changes_are_round_off(const ThermalModel<dim> &heat, double time_step) const;
    /** The quotient for the rates. Collective. */
    double quotient_of_rates(const Model<dim> &model, double time, const NodalVector &rate,
                             double time_step);

    double largest = 0;           ///< of the last rates, of all ranks [temperature/T]
    double usual = 0;             ///< largest rate that was no growth; zero at the start
    NodalVector direction, image; ///< d/largest and y, where a quotient was needed
  };
} // namespace tombolo
