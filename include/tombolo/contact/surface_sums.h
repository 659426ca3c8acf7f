// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/contact_balance.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/contact/surfaces/rigid_translation.h>

#include <deal.II/base/tensor.h>

#include <vector>

namespace tombolo
{
  /** Sums of one rank over the forces of a rigid surface: those at t_n, and impulses and works
   * since the start. */
  template <int dim>
  struct SurfaceSums
  {
    dealii::Tensor<1, dim> position;       ///< of the surface's reference point, at t_n [L]
    dealii::Tensor<1, dim> force;          ///< at t_n [M L/T^2]
    dealii::Tensor<1, 3> torque_of_force;  ///< about position, likewise
    double area = 0;                       ///< in contact, likewise, where areas are known
    dealii::Tensor<1, dim> impulse;        ///< since the start [M L/T]
    dealii::Tensor<1, 3> angular_impulse;  ///< likewise
    double work = 0, translation_work = 0; ///< the latter is what a mass loses of it [M L^2/T^2]

    /** Forgets the forces of the step before. */
    void begin_forces(const dealii::Tensor<1, dim> &reference_point)
    {
      position = reference_point;
      force = 0.;
      torque_of_force = 0.;
      area = 0.;
    }

    /** Adds the force on a node at @p x. */
    void add_force(const dealii::Tensor<1, dim> &of_node, const dealii::Tensor<1, dim> &x)
    {
      force += of_node;
      torque_of_force += torque<dim>(x - position, of_node);
    }

    /** Adds the work of the motion of the surface over the last step, @p of_surface at a node and
     * @p translation of the surface as a whole, with the mean of the forces before and now. */
    void add_work(const dealii::Tensor<1, dim> &sum_of_forces,
                  const dealii::Tensor<1, dim> &of_surface,
                  const dealii::Tensor<1, dim> &translation)
    {
      work += 0.5 * sum_of_forces * of_surface;
      translation_work += 0.5 * sum_of_forces * translation;
    }

    /** Adds the impulse of the forces at t_n over Δt_n. */
    void add_impulse(const double velocity_step)
    {
      impulse += velocity_step * force;
      angular_impulse += velocity_step * torque_of_force;
    }

    /** The sums over ranks of this and of @p shares of single ranks: elastic, friction, damping,
     * n_nodes, conducted and friction_of_bodies; the largest of their penetration; and what follows
     * from the @p translation of the surface. Collective. */
    ContactBalance balance(const ContactBalance &shares, const RigidTranslation<dim> &translation,
                           MPI_Comm communicator) const;

    /** What is kept from step to step, for Records::sums(). */
    std::vector<double *> shares()
    {
      std::vector<double *> result{&work, &translation_work};
      for (unsigned int d = 0; d < dim; ++d)
        result.insert(result.end(), {&impulse[d], &force[d]});
      for (unsigned int c = 0; c < 3; ++c)
        result.insert(result.end(), {&angular_impulse[c], &torque_of_force[c]});
      return result;
    }
  };
} // namespace tombolo
