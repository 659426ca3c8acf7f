// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/rigid_bodies.h>

#include <tombolo/base/input/parameters.h>
#include <tombolo/output/history.h>

namespace tombolo
{
  namespace
  {
    /** After all others, since what they add to the forces moves the bodies. */
    constexpr int after_all_forces = process_order::named + 100;

    template <int dim>
    class RigidBodiesKind : public ProcessKind<dim>
    {
    public:
      void declare_parameters(Parameters &parameters) const override
      {
        for (const std::string &name : section_names(parameters, "Parts"))
          declare<RigidBodySettings<dim>>(
              Entries(parameters.handler()).subsection("Part: " + name).subsection("rigid"));
      }

      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        const std::vector<Section> sections = named_sections(parameters, "Parts", "Part");
        for (std::size_t p = 0; p < parts.size(); ++p)
          if (rigid_cells(parts[p]) != nullptr)
            RigidBodySettings<dim>(sections[p].subsection("rigid"));
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        if (std::none_of(model.parts.begin(), model.parts.end(),
                         [](const Part<dim> &part) { return rigid_cells(part) != nullptr; }))
          return nullptr;
        return std::make_unique<RigidBodies<dim>>(parameters, model);
      }
    };
  } // namespace

  TOMBOLO_REGISTER_PROCESS_KIND(RigidBodiesKind, after_all_forces)

  template <int dim>
  void add_rigid_body_columns(const RigidBodyBalance &now, BalanceHistory<dim> &row)
  {
    const std::string energy = "M L^2/T^2";
    row.begin_item(now);
    row.add("position", "L", now.position);
    row.add("rotation", "1", now.rotation, true);
    row.add("velocity", "L/T", now.velocity);
    row.add("spin", "1/T", now.spin, true);
    row.add("momentum", "M L/T", now.momentum);
    row.add("angular momentum", "M L^2/T", now.angular_momentum, true);
    row.add_mean("mean force", "M L/T^2", &RigidBodyBalance::impulse);
    row.add_mean("mean moment", energy, &RigidBodyBalance::angular_impulse, true);
    row.add("work", energy, now.work);
    row.add("kinetic energy", energy, now.kinetic_energy);
    row.add("energy of rotation", energy, now.rotation_energy);
  }

  template void add_rigid_body_columns(const RigidBodyBalance &, BalanceHistory<2> &);
  template void add_rigid_body_columns(const RigidBodyBalance &, BalanceHistory<3> &);

  namespace
  {
    /**
     * Where rigid parts are, how they move and what drives them: `rigid_bodies.csv`, with position
     * and velocity of the reference point of each of them, rotation and spin, momentum, angular
     * momentum about the centre of mass, the mean force and the mean moment about the reference
     * point since the row before of what holds and drives the prescribed components, the work of it
     * and of given forces since the start, and kinetic energies.
     */
    const HistoryRegistration of_rigid_bodies(
        {"rigid body history", "rigid_bodies.csv",
         "Positions, rotations, momenta, driving forces and works of rigid parts "
         "(rigid_bodies.csv); in every scene that has such.",
         true},
        5, "the formulation rigid of a part",
        [](const Section &output)
        {
          const Parameters &parameters = output.all();
          const std::vector<std::string> parts = parameters.raw_list("Parts");
          return std::any_of(parts.begin(), parts.end(),
                             [&](const std::string &name) {
                               return parameters.raw("Part: " + name + "/Formulation") == "rigid";
                             });
        });
  } // namespace
} // namespace tombolo
