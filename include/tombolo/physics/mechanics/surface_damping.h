// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/process.h>

#include <array>
#include <cstddef>
#include <vector>

namespace tombolo
{
  /**
   * Viscosity at the surface of particles whose shape functions are cell averages. Their outermost
   * layer has a mode of its own: it is half as heavy as the others and as stiff, so that it
   * oscillates faster than any wave of the layers inside, which can therefore not take the energy
   * away that a sudden load gives it. A fibre from a node I on the surface through the next nodes A
   * and B inside, with the rate
   *
   * @verbatim
   *   r = e_IA · (v_I - v_A) / l_IA - e_AB · (v_A - v_B) / l_AB
   * @endverbatim
   *
   * of the difference of its two stretches, dissipates η V r² with η = b ρ h min(c_P, 2 c_S): the
   * mode is gone after some ten spacings of way, while waves lose to it with the fourth power of
   * their number only. Forces are along the edges: linear and angular momentum are those without
   * it, and a rigid motion makes none. Materials that flow plastically have none of it: their flow
   * takes the mode, and a viscosity of elastic impedance would hold them by stresses like their
   * yield stress. b is the entry `Coefficient` of the section `Surface damping`.
   */
  template <int dim>
  class SurfaceDamping : public Process<dim>
  {
  public:
    SurfaceDamping(double coefficient, const Model<dim> &model);

    /** Whether this rank has some. */
    bool has_fibres() const
    {
      return !fibres.empty();
    }

    void model_changed(const Model<dim> &model) override;

    void add_forces(const Model<dim> &model, const Clock &, const NodalVector &) override
    {
      damping.touched_nodes() = touched;
      add_to(model.state.position, model.state.velocity, damping.at_touched_nodes());
    }

    void linearize(const Model<dim> &model, const Clock &clock, Tangent<dim> &tangent) override;

  private:
    struct Fibre
    {
      std::array<dealii::types::global_dof_index, 3> node;
      double viscosity; ///< η V [M L^2/T]
    };

    /** Adds -C @p velocity at @p position to local nodes. */
    void add_to(const NodalVector &position, const NodalVector &velocity,
                NodalVector &result) const;

    std::vector<Fibre> fibres;
    std::vector<std::array<unsigned int, 3>> local; ///< nodes of each fibre
    std::vector<unsigned int> touched; ///< owned nodes of fibres of any rank, ascending
    NodalVector viscous_force;         ///< buffer of linearize()
    Action &damping;
  };
} // namespace tombolo
