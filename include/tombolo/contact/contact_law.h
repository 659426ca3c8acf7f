// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tombolo
{
  /** The state of one contact: a spring along the normal and one along the surface. */
  template <int dim>
  struct ContactSpring
  {
    double stiffness = 0;                ///< k; zero without contact [M/T^2]
    double depth = 0;                    ///< δ [L]
    double damping_force = 0;            ///< c δ̇ >= -k δ [M L/T^2]
    dealii::Tensor<1, dim> elastic_slip; ///< displacement along the surface before slip [L]
    /** Its length before Coulomb's limit, in this step; negative without friction [L]. */
    double trial_slip = -1;
    /** Whether that limit is Coulomb's, not the limit of shear. */
    bool limit_follows_pressure = true;

    bool is_closed() const
    {
      return stiffness > 0.;
    }

    /** ⟨k δ + c δ̇⟩ [M L/T^2]. */
    double normal_force() const
    {
      return stiffness * depth + damping_force;
    }

    /** ⟨k δ + c δ̇⟩ n - k s [M L/T^2]. */
    dealii::Tensor<1, dim> force(const dealii::Tensor<1, dim> &normal) const
    {
      return normal_force() * normal - stiffness * elastic_slip;
    }

    /** Stored in both springs [M L^2/T^2]. */
    double elastic_energy() const
    {
      return 0.5 * stiffness * (depth * depth + elastic_slip.norm_square());
    }
  };

  /** How a contact has moved over a step, relative to what it touches. */
  template <int dim>
  struct ContactMotion
  {
    ContactMotion(const double depth, const dealii::Tensor<1, dim> &motion,
                  const dealii::Tensor<1, dim> &normal)
        : depth(depth), motion(motion), normal(normal), approach(-(motion * normal)),
          past_approach(approach), along(motion + approach * normal)
    {}

    double depth;                          ///< δ at the end [L]
    dealii::Tensor<1, dim> motion, normal; ///< [L], out of what is touched [1]
    double approach;                       ///< of the points that are in contact at the end [L]
    double past_approach;                  ///< of those in contact at the start [L]
    dealii::Tensor<1, dim> along;          ///< along the surface [L]
  };

  /**
   * The penalty law of contact with friction (doc/method.md, section 11; after Fraser et al.,
   * Hybrid thermo-mechanical contact algorithm for 3D SPH-FEM multi-physics simulations, eqs 7-13):
   * a mass m with the penetration δ along the unit normal n has the force
   *
   *   f = ⟨k δ + c δ̇⟩ n - k s,  k = α m/Δt²,  c = 2 ζ √(k m),  |k s| <= μ ⟨k δ + c δ̇⟩,
   *
   * where ⟨⟩ is the positive part, so that there is no adhesion, and s the elastic slip, which
   * Coulomb's limit reduces. Δt is a stable time step, or another time that is short against the
   * motion. k is chosen at the first touch and is never increased afterwards. The damper acts on
   * approach, and where it damps the return also while the mass leaves, so that springs do not
   * throw back what has arrived.
   *
   * Dissipated energies are computed from the motion over a step with the mean of the forces at
   * both of its ends, so that stored and dissipated energies sum to the work of the forces. Without
   * dampers the work of the normal force is zero on average: a contact that begins within a step
   * dissipates, and one that ends returns energy.
   */
  class ContactLaw
  {
  public:
    ContactLaw() = default;

    /** @p stiffness is α, @p damping ζ, also while the mass leaves where @p damps_return. */
    ContactLaw(const double stiffness, const double damping, const bool damps_return = false)
        : stiffness_factor(stiffness), damping_ratio(damping), damps_return(damps_return)
    {}

    /** The same springs without dampers, for static steps: these have no rates, and what the normal
     * force dissipates in them is the error of their integration, not counted. */
    ContactLaw without_rates() const
    {
      ContactLaw law(stiffness_factor, 0.);
      law.has_rates = false;
      return law;
    }

    /** k of @p mass at the time step @p time_step. */
    double stiffness(const double mass, const double time_step) const
    {
      return stiffness_factor * mass / (time_step * time_step);
    }

    /** c δ̇, at least -k δ or without damping of the return 0, where @p spring has come by
     * @p approach over @p time_step to where it is. */
    template <int dim>
    double damping_force(const ContactSpring<dim> &spring, const double mass, const double approach,
                         const double time_step) const
    {
      const double viscosity = 2. * damping_ratio * std::sqrt(spring.stiffness * mass);
      return std::max(viscosity * approach / time_step,
                      damps_return ? std::min(0., -spring.stiffness * spring.depth) : 0.);
    }

    /** Moves @p spring after the motion @p move over @p time_step, which is zero at the start of a
     * run. Adds to @p dissipated what the normal force and a decrease of the stiffness dissipate.
     * Leaves the elastic slip to slide(). */
    template <int dim>
    void press(const ContactMotion<dim> &move, const double mass, const double stable_step,
               const double time_step, ContactSpring<dim> &spring, double &dissipated) const
    {
      const ContactSpring<dim> before = spring;
      const double allowed = stiffness(mass, stable_step);
      spring.stiffness = before.is_closed() ? std::min(before.stiffness, allowed) : allowed;
      spring.depth = move.depth;
      spring.damping_force =
          time_step > 0. ? damping_force(spring, mass, move.approach, time_step) : 0.;
      if (time_step > 0. && has_rates)
        dissipated += lost_by_normal_force(before, spring, move) +
                      0.5 * (before.stiffness - spring.stiffness) * before.elastic_slip *
                          (before.elastic_slip + move.along);
    }

    /** After press(): the elastic slip, whose force is at most @p limit, which by Coulomb's law is
     * the coefficient times the normal force. Returns the heat of friction. */
    template <int dim>
    static double slide(const ContactMotion<dim> &move, const double limit,
                        ContactSpring<dim> &spring)
    {
      const dealii::Tensor<1, dim> before = spring.elastic_slip;
      const double stiffness = spring.stiffness;
      spring.elastic_slip = before + move.motion;
      spring.elastic_slip -= (spring.elastic_slip * move.normal) * move.normal;
      spring.trial_slip = spring.elastic_slip.norm();
      const double trial_tangential_force = stiffness * spring.trial_slip;
      if (trial_tangential_force > limit)
        spring.elastic_slip *= limit / trial_tangential_force;
      return 0.5 * stiffness *
             ((before + spring.elastic_slip) * move.along -
              (spring.elastic_slip.norm_square() - before.norm_square()));
    }

    /** Ends a contact after the motion @p move. Adds to @p dissipated what the normal force has
     * dissipated. Returns the heat of friction: what the spring along the surface stored, less what
     * it returned on the way. */
    template <int dim>
    double release(const ContactMotion<dim> &move, ContactSpring<dim> &spring,
                   double &dissipated) const
    {
      const ContactSpring<dim> before = std::exchange(spring, ContactSpring<dim>());
      dissipated += has_rates ? lost_by_normal_force(before, spring, move) : 0.;
      return 0.5 * before.stiffness * before.elastic_slip * (before.elastic_slip + move.along);
    }

    /** The fraction x of a stable step Δt of the bodies at which the fastest mode of a node is
     * stable with one spring of stiffness(m, Δt) and its damper. Its 4/Δt² and α/Δt² add up, and
     * the force of the damper is that of the velocity half a step before: (4 + α) x² + 4 ζ √α x =
     * 4, with half of the second term where it acts in the half period of approach alone. */
    double stable_fraction() const
    {
      return stable_fraction(4. + stiffness_factor, (damps_return ? 2. : 1.) * damping_ratio *
                                                        std::sqrt(stiffness_factor));
    }

    /** The positive root of springs x² + 2 dampers x = 4. */
    static double stable_fraction(const double springs, const double dampers)
    {
      return (std::sqrt(dampers * dampers + 4. * springs) - dampers) / springs;
    }

  private:
    /** The work of the normal force less what its spring stores thereby: that of the damper, of a
     * decrease of the stiffness, and of a contact that began or ended within the step. */
    template <int dim>
    static double lost_by_normal_force(const ContactSpring<dim> &before,
                                       const ContactSpring<dim> &after,
                                       const ContactMotion<dim> &move)
    {
      const auto stored = [](const ContactSpring<dim> &spring)
      { return 0.5 * spring.stiffness * spring.depth * spring.depth; };
      return 0.5 * (before.normal_force() * move.past_approach +
                    after.normal_force() * move.approach) -
             (stored(after) - stored(before));
    }

    double stiffness_factor = 1.; ///< α
    double damping_ratio = 0.;    ///< ζ
    bool damps_return = false, has_rates = true;
  };
} // namespace tombolo
