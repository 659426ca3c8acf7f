// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/moment.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/tensor.h>

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

namespace tombolo
{
  /** Mean and largest of @p values of all ranks; zeros without any. Collective. */
  inline std::array<double, 2> mean_and_largest(const std::vector<double> &values,
                                                const MPI_Comm communicator)
  {
    std::array<double, 2> sums{};
    double largest = std::numeric_limits<double>::lowest();
    for (const double value : values)
    {
      sums[0] += value;
      sums[1] += 1.;
      largest = std::max(largest, value);
    }
    sums = ordered_sum(sums, communicator);
    largest = dealii::Utilities::MPI::max(largest, communicator);
    if (sums[1] == 0.)
      return {};
    return {{sums[0] / sums[1], largest}};
  }

  /** The same of slot 0 of @p values at these owned nodes. Collective. */
  inline std::array<double, 2> mean_and_largest(const NodalVector &values,
                                                const std::vector<unsigned int> &nodes)
  {
    std::vector<double> node_values;
    for (const unsigned int node : nodes)
      node_values.push_back(*values.node(node));
    return mean_and_largest(node_values, values.partition()->communicator());
  }

  /** Forces, impulses and energies of a contact at one time. Impulses are those of its force, and
   * of its torque about the surface's reference point, wherever that was; the work is that of the
   * motion of the surface on the bodies. */
  struct ContactBalance : ImpulseBalance
  {
    std::array<double, 3> force{}; ///< of the surface on the bodies, at t_n [M L/T^2]
    double elastic = 0;            ///< stored in the penalty springs [M L^2/T^2]
    double friction = 0;           ///< turned into heat by sliding
    double damping = 0;            ///< dissipated by damping and by changes of the stiffness
    /** From outside: `work` of a surface that moves by functions of time; that of the given force
     * and of the turning of one that has a mass. */
    double external_work = 0;
    double conducted = 0;          ///< heat received by the bodies by conduction
    double friction_of_bodies = 0; ///< their share of `friction`; zero without heat
    double heat_of_bodies = 0;     ///< that, and their share of `friction`; zero without heat
    double heat_of_tool = 0; ///< heat received by the tool, or its content where it has a capacity
    double tool_temperature = 0;
    std::array<double, 3> position{};      ///< of the surface's reference point, at t_n [L]
    std::array<double, 3> velocity{};      ///< of a surface with a mass, at t_{n-1/2} [L/T]
    std::array<double, 3> tool_momentum{}; ///< likewise [M L/T]
    double tool_kinetic = 0;               ///< ½ m v_{n-1/2} · v_{n+1/2}
    double n_nodes = 0;                    ///< in contact
    double area = 0;                       ///< likewise, where areas are known [L^(dim-1)]
    double penetration = 0;                ///< the largest [L]

    /** Adds those of another contact, but for position and temperature, which are of one alone. */
    void add(const ContactBalance &other)
    {
      ContactBalance other_shares = other;
      const std::vector<double *> values = sums(), added = other_shares.sums();
      for (std::size_t k = 0; k < values.size(); ++k)
        *values[k] += *added[k];
      penetration = std::max(penetration, other.penetration);
    }

    /** From shares of ranks to the sums over them, and the largest penetration. Collective. */
    void sum_over_ranks(const MPI_Comm communicator)
    {
      const std::vector<double *> values = sums();
      std::vector<double> numbers;
      for (const double *const value : values)
        numbers.push_back(*value);
      numbers = ordered_sum(numbers, communicator);
      for (std::size_t k = 0; k < values.size(); ++k)
        *values[k] = numbers[k];
      penetration = dealii::Utilities::MPI::max(penetration, communicator);
    }

  private:
    std::vector<double *> sums()
    {
      std::vector<double *> result{&elastic,
                                   &friction,
                                   &damping,
                                   &work,
                                   &n_nodes,
                                   &external_work,
                                   &conducted,
                                   &area,
                                   &tool_kinetic,
                                   &heat_of_bodies,
                                   &friction_of_bodies,
                                   &heat_of_tool};
      for (auto *const vector : {&force, &impulse, &angular_impulse, &tool_momentum})
        for (double &component : *vector)
          result.push_back(&component);
      return result;
    }
  };

  /** Sums of one rank over the forces of a contact, on the slave where it is one of two bodies:
   * those at t_n, and impulses, heat and works since the start. */
  template <int dim>
  struct ContactSums
  {
    dealii::Tensor<1, dim> position;       ///< of the surface's reference point, at t_n [L]
    dealii::Tensor<1, dim> force;          ///< at t_n [M L/T^2]
    dealii::Tensor<1, 3> torque_of_force;  ///< about position, likewise
    double area = 0;                       ///< in contact, likewise, where areas are known
    dealii::Tensor<1, dim> impulse;        ///< since the start [M L/T]
    dealii::Tensor<1, 3> angular_impulse;  ///< likewise
    double friction = 0;                   ///< heat of friction, likewise [M L^2/T^2]
    double damping = 0;                    ///< dissipated by damping, likewise
    double conducted = 0;                  ///< heat into the slave, likewise
    double work = 0, translation_work = 0; ///< of the surface; of its translation

    /** Clears the forces of the step before. */
    void begin_forces(const dealii::Tensor<1, dim> &reference_point)
    {
      position = reference_point;
      force = 0.;
      torque_of_force = 0.;
      area = 0.;
    }

    void add_force(const dealii::Tensor<1, dim> &node_force, const dealii::Tensor<1, dim> &x)
    {
      force += node_force;
      torque_of_force += torque<dim>(x - position, node_force);
    }

    /** Adds the work of the motion of the surface over the last step, @p surface_motion at a node
     * and @p translation of the surface as a whole, with the mean of the forces before and now. */
    void add_work(const dealii::Tensor<1, dim> &sum_of_forces,
                  const dealii::Tensor<1, dim> &surface_motion,
                  const dealii::Tensor<1, dim> &translation)
    {
      work += 0.5 * sum_of_forces * surface_motion;
      translation_work += 0.5 * sum_of_forces * translation;
    }

    /** Adds the impulse of the forces at t_n over Δt_n. */
    void add_impulse(const double velocity_step)
    {
      impulse += velocity_step * force;
      angular_impulse += velocity_step * torque_of_force;
    }

    /** Copies them to the @p shares of this rank; translation_work is the external work. */
    void add_to(ContactBalance &shares) const
    {
      shares.friction = friction;
      shares.damping = damping;
      shares.conducted = conducted;
      shares.work = work;
      shares.external_work = translation_work;
      shares.area += area;
      std::copy_n(force.begin_raw(), dim, shares.force.begin());
      std::copy_n(impulse.begin_raw(), dim, shares.impulse.begin());
      std::copy_n(angular_impulse.begin_raw(), 3, shares.angular_impulse.begin());
    }
  };
} // namespace tombolo
