// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/rigid_body_history.h>

#include <tombolo/base/input/declarations.h>
#include <tombolo/output/balance_rows.h>

#include <string>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void RigidBodyHistory<dim>::declare_parameters(ParameterHandler &handler)
  {
    Declarations(handler).whole_number("Steps between rows", 10, 1,
                                       "rigid_bodies.csv has a row every so many steps.");
  }

  template <int dim>
  RigidBodyHistory<dim>::RigidBodyHistory(const Section &section)
      : steps_between(section.get_unsigned("Steps between rows"))
  {}

  template <int dim>
  void RigidBodyHistory<dim>::start(const OutputView<dim> &view, const OutputDirectory &directory,
                                    const UnitLabels &unit_labels)
  {
    const std::vector<RigidBodyBalance> now = view.rigid_bodies();
    if (!table.is_continued())
    {
      last = now;
      time_of_row = view.time;
    }
    add_row(view, now);
    table.open(directory, unit_labels);
  }

  template <int dim>
  void RigidBodyHistory<dim>::serialize(StateArchive &archive)
  {
    table.serialize(archive);
    archive("time of row", time_of_row);
    serialize_last_row(archive, "works at row", &RigidBodyBalance::work, "rigid parts", last);
  }

  template <int dim>
  void RigidBodyHistory<dim>::after_step(const OutputView<dim> &view)
  {
    if (!view.has_row(steps_between))
      return;
    const std::vector<RigidBodyBalance> now = view.rigid_bodies();
    add_row(view, now);
    table.write_row();
    time_of_row = view.time + 0.5 * view.time_step; // the middle of the coming step
    last = now;
  }

  template <int dim>
  void RigidBodyHistory<dim>::add_row(const OutputView<dim> &view,
                                      const std::vector<RigidBodyBalance> &now)
  {
    const std::string energy = "M L^2/T^2";
    const double elapsed = view.time + 0.5 * view.time_step - time_of_row;
    table.begin_row(view.time, view.step);
    for (std::size_t k = 0; k < now.size(); ++k)
    {
      using Vector = RigidBodyBalance::Vector;
      const auto add = [&](const std::string &what, const std::string &unit, const Vector &value,
                           const bool is_of_rotation)
      {
        for (unsigned int c = is_of_rotation && dim == 2 ? 2 : 0; c < (is_of_rotation ? 3 : dim);
             ++c)
          table.add(now[k].name + " " + what + " " + "xyz"[c], unit, value[c]);
      };
      const auto mean = [&](const Vector &impulse, const Vector &before)
      {
        Vector result{};
        for (unsigned int c = 0; c < 3 && elapsed > 0.; ++c)
          result[c] = (impulse[c] - before[c]) / elapsed;
        return result;
      };
      add("position", "L", now[k].position, false);
      add("rotation", "1", now[k].rotation, true);
      add("velocity", "L/T", now[k].velocity, false);
      add("spin", "1/T", now[k].spin, true);
      add("momentum", "M L/T", now[k].momentum, false);
      add("angular momentum", "M L^2/T", now[k].angular_momentum, true);
      add("mean force", "M L/T^2", mean(now[k].impulse, last[k].impulse), false);
      add("mean moment", energy, mean(now[k].angular_impulse, last[k].angular_impulse), true);
      table.add(now[k].name + " work", energy, now[k].work);
      table.add(now[k].name + " kinetic energy", energy, now[k].kinetic_energy);
      table.add(now[k].name + " energy of rotation", energy, now[k].rotation_energy);
    }
  }

  template <int dim>
  void RigidBodyHistory<dim>::write(const OutputView<dim> & /*view*/, TimeTable & /*statistics*/)
  {
    table.flush();
  }

  template <int dim>
  void RigidBodyHistory<dim>::finish(Json & /*results*/)
  {
    table.flush();
  }

  template class RigidBodyHistory<2>;
  template class RigidBodyHistory<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Output, RigidBodyHistory, "rigid body history",
      "Positions, rotations, momenta, driving forces and works of rigid parts (rigid_bodies.csv); "
      "in every scene that has such.")
} // namespace tombolo
