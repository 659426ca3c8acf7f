// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/history.h>

namespace tombolo
{
  /**
   * Where rigid parts are, how they move and what drives them: `rigid_bodies.csv`, with position
   * and velocity of the reference point of each of them, rotation and spin, momentum, angular
   * momentum about the centre of mass, the mean force and the mean moment about the reference point
   * since the row before of what holds and drives the prescribed components, the work of it and of
   * given forces since the start, and kinetic energies. Part of every scene that has rigid parts.
   */
  template <int dim>
  class RigidBodyHistory : public BalanceHistory<dim, RigidBodyBalance>
  {
  public:
    explicit RigidBodyHistory(const Entries &e)
        : BalanceHistory<dim, RigidBodyBalance>(e, "rigid_bodies.csv",
                                                {"works at row", &RigidBodyBalance::work}, {})
    {
      this->records.value("time of row", time_of_row);
    }

  private:
    std::vector<RigidBodyBalance> balances(const OutputView<dim> &view) const override
    {
      return view.rigid_bodies();
    }

    void begin(const OutputView<dim> &view) override
    {
      BalanceHistory<dim, RigidBodyBalance>::begin(view);
      if (!this->table.is_continued())
        time_of_row = view.time;
    }

    void add_balance(const OutputView<dim> &view, std::size_t /*k*/, const RigidBodyBalance &now,
                     const RigidBodyBalance &before) override
    {
      const std::string energy = "M L^2/T^2";
      const double elapsed = view.middle_of_next_step() - time_of_row;
      this->add_vector(now.name + " position", "L", now.position);
      this->add_vector(now.name + " rotation", "1", now.rotation, true);
      this->add_vector(now.name + " velocity", "L/T", now.velocity);
      this->add_vector(now.name + " spin", "1/T", now.spin, true);
      this->add_vector(now.name + " momentum", "M L/T", now.momentum);
      this->add_vector(now.name + " angular momentum", "M L^2/T", now.angular_momentum, true);
      this->add_mean(now.name + " mean force", "M L/T^2", now.impulse, before.impulse, elapsed);
      this->add_mean(now.name + " mean moment", energy, now.angular_impulse, before.angular_impulse,
                     elapsed, true);
      this->table.add(now.name + " work", energy, now.work);
      this->table.add(now.name + " kinetic energy", energy, now.kinetic_energy);
      this->table.add(now.name + " energy of rotation", energy, now.rotation_energy);
    }

    void end_row(const OutputView<dim> &view) override
    {
      BalanceHistory<dim, RigidBodyBalance>::end_row(view);
      time_of_row = view.middle_of_next_step();
    }

    double time_of_row = 0; ///< until which impulses of the last row go
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Output, RigidBodyHistory, "rigid body history",
      "Positions, rotations, momenta, driving forces and works of rigid parts (rigid_bodies.csv); "
      "in every scene that has such.")
} // namespace tombolo
