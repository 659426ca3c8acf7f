// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/contact/contact_faces.h>
#include <tombolo/contact/contact_law.h>
#include <tombolo/state/nodal_state.h>

#include <vector>

namespace tombolo
{
  class Records;

  /**
   * The stiffness per area κ = α / Δt² / (1/μ_s + 1/μ_m) of the springs between two surfaces, with
   * μ = min m_k / A_k over the nodes of a side. It becomes softer where Δt or the masses per area
   * demand it, and stiffer only while nothing touches. Masses per area are found every 16 steps.
   */
  template <int dim>
  class MortarStiffness
  {
  public:
    /** The present κ, of springs of @p law, for this @p share of the masses. Collective in every
     * 16th step. */
    void find(const NodalState &state, const Clock &clock, const ContactLaw &law, double share,
              bool touches, ContactFaces<dim> &slaves, ContactFaces<dim> &masters);

    double value() const ///< κ [M/(L^(dim-1) T^2)]; zero without contact
    {
      return stiffness;
    }

    /** Areas of owned nodes of each side. */
    const std::vector<double> &of_slaves() const
    {
      return slave_areas;
    }
    const std::vector<double> &of_masters() const
    {
      return master_areas;
    }

    /** Lists what is kept from step to step, of nodes of these faces, which are referred to; @p
     * continues: a run that starts from the end of another takes the stiffness from there. */
    void list(Records &records, const ContactFaces<dim> &slaves, const ContactFaces<dim> &masters,
              bool continues);

    /** Lets the next find() take the masses anew. */
    void forget_masses()
    {
      mass_per_area = 0.;
    }

  private:
    std::vector<double> slave_areas, master_areas; ///< of owned nodes, for masses per area
    double mass_per_area = 0;                      ///< 1/(1/μ_s + 1/μ_m); zero before it is known
    double stiffness = 0;
  };
} // namespace tombolo
