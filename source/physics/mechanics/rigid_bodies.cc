// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/rigid_bodies.h>

#include <tombolo/base/input/section_names.h>
#include <tombolo/base/moment.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/model/initial_condition.h>
#include <tombolo/model/model.h>
#include <tombolo/model/model_input.h>
#include <tombolo/model/moving_parts.h>
#include <tombolo/output/output.h>
#include <tombolo/physics/remeshing/model_content.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ostream>
#include <sstream>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The step that the user gives; zero where none. As text, since who makes a model alone does
     * not declare it. */
    double fixed_step(const Parameters &parameters)
    {
      return std::strtod(parameters.raw("Time step/Fixed", "0").c_str(), nullptr);
    }

    std::string text_of(const Tensor<1, 3> &vector, const unsigned int dim)
    {
      std::ostringstream text;
      text.precision(6);
      for (unsigned int d = 0; d < dim; ++d)
        text << (d == 0 ? "(" : ", ") << vector[d];
      return text.str() + ")";
    }
  } // namespace

  template <int dim>
  RigidBodies<dim>::RigidBodies(const Parameters &parameters, Model<dim> &model)
      : impulses(model.impulses),
        is_first_rank(Utilities::MPI::this_mpi_process(model.communicator) == 0)
  {
    this->roles.rest = ProcessRole::is_refused;
    this->roles.divided_cells = ProcessRole::is_refused;
    const std::vector<Section> sections = named_sections(parameters, "Parts", "Part");
    const bool all_are_rigid =
        std::all_of(model.parts.begin(), model.parts.end(),
                    [](const Part<dim> &part) { return rigid_cells(part) != nullptr; });
    if (all_are_rigid && !(fixed_step(parameters) > 0.))
      parameters.fail("Time step/Fixed", "all parts of the scene are rigid and limit no step; give "
                                         "the step here.");
    start_interval = all_are_rigid ? 1e-3 * fixed_step(parameters) : short_interval(model);
    joined = find_rigid_bodies(sections, model);
    for (JoinedParts &body : joined)
    {
      const unsigned int leader = body.parts.front();
      RigidBodySettings<dim> motion(sections[leader].subsection("rigid"));
      check_rigid_body(sections[leader], motion, model, body);
      bodies.emplace_back(model.parts[leader].name, std::move(motion), inertia_of(body, model));
      start(sections[leader].subsection("rigid"), bodies.size() - 1, model);
    }
    masses_have_changed(model);
    model.state.unsmoothed_velocity.distribute();
    list(model);
    observe();
  }

  template <int dim>
  void RigidBodies<dim>::observe()
  {
    this->observed.energies.connect(
        [this](EnergyAccounts &accounts)
        {
          double kinetic = 0, work = 0;
          for (const RigidBody<dim> &body : bodies)
          {
            kinetic += body.kinetic_energy_beyond_nodes();
            work += body.external_work();
          }
          accounts.add_replicated("kinetic energy", EnergyKind::stored, kinetic);
          accounts.add_replicated("external work", EnergyKind::external, work);
          if (lost != 0.) // beside that of the process which has moved mass
            accounts.add_replicated("remap loss", EnergyKind::dissipated, lost);
          accounts.add_removed_momentum(lost_momentum, lost_angular_momentum);
        });
    this->observed.results.connect([this](const TimeTable &, Json &summary)
                                   { summarize(summary); });
    this->observed.audit.connect([this](std::ostream &text) { describe(text); });
    this->observed.views.connect(
        [this](OutputView<dim> &view)
        {
          view.rigid_bodies = [this]
          {
            std::vector<RigidBodyBalance> result;
            for (const RigidBody<dim> &body : bodies)
              result.push_back(body.balance());
            return result;
          };
        });
  }

  template <int dim>
  void RigidBodies<dim>::list(Model<dim> &model)
  {
    const auto renew = [this, &model]
    {
      if (masses_have_changed(model))
        renew_inertia(model);
    };
    this->records.on_reading(renew);
    this->records.on_continuation(renew);
    for (RigidBody<dim> &body : bodies)
      body.list(this->records.group("rigid part " + body.name()));
    this->records.on_continuation(
        [this, &model]
        {
          for (std::size_t b = 0; b < bodies.size(); ++b)
          {
            bodies[b].continue_motion(start_interval);
            set_velocity(b, model.state);
          }
          model.state.unsmoothed_velocity.distribute();
        });
    Records &of_all = this->records.group("rigid parts");
    of_all.value("lost energy", lost);
    of_all.sums("lost momentum", interleaved(lost_momentum, lost_angular_momentum));
  }

  template <int dim>
  Wrench RigidBodies<dim>::momentum_of_nodes(const std::size_t index, const Model<dim> &model) const
  {
    std::array<double, 3> moment{};
    std::array<double, 6> sums{};
    for (const unsigned int node : joined[index].nodes)
    {
      const Tensor<1, 3> momentum = *model.bridge->mass().node(node) *
                                    vector_of<3>(model.state.unsmoothed_velocity.node(node));
      const Tensor<1, 3> r = vector_of<3>(model.state.position.node(node)) - bodies[index].centre();
      add_moment(&r[0], &momentum[0], moment);
      for (unsigned int d = 0; d < 3; ++d)
        sums[d] += momentum[d];
    }
    std::copy(moment.begin(), moment.end(), sums.begin() + 3);
    sums = ordered_sum(sums, model.communicator);
    return {vector_of<3>(sums.data()), vector_of<3>(sums.data() + 3)};
  }

  template <int dim>
  ModelChange RigidBodies<dim>::change_model(Model<dim> &model, const Clock &clock)
  {
    if (!std::exchange(masses_can_be_old, false) || !masses_have_changed(model))
      return {};
    NodalVector &v_hat = model.state.unsmoothed_velocity;
    const ModelContent before = ModelContent::of(model);
    double rotation_before = 0, rotation_after = 0;
    for (const RigidBody<dim> &body : bodies)
      rotation_before += body.energy_beyond_nodes_before(clock.previous_step);
    renew_inertia(model);
    for (std::size_t b = 0; b < bodies.size(); ++b)
    {
      const Wrench momentum = momentum_of_nodes(b, model);
      const auto way_back = bodies[b].take_momentum(clock, momentum.force, momentum.moment);
      for (const unsigned int node : joined[b].nodes)
      {
        const Tensor<1, 3> way = way_back.of(vector_of<3>(model.state.initial_position.node(node)));
        for (unsigned int d = 0; d < dim; ++d)
          v_hat.node(node)[d] = -way[d] / clock.previous_step;
      }
      rotation_after += bodies[b].energy_beyond_nodes_before(clock.previous_step);
    }
    v_hat.distribute();
    const ModelContent after = ModelContent::of(model);
    lost += before.energy + rotation_before - after.energy - rotation_after;
    for (unsigned int d = 0; is_first_rank && d < 3; ++d)
    {
      lost_momentum[d] += before.momentum[d] - after.momentum[d];
      lost_angular_momentum[d] += before.angular_momentum[d] - after.angular_momentum[d];
    }
    return {};
  }

  template <int dim>
  void RigidBodies<dim>::start(const Section &section, const std::size_t index, Model<dim> &model)
  {
    RigidBody<dim> &body = bodies[index];
    const RigidBodySettings<dim> &motion = body.motion();
    const Wrench of_nodes = momentum_of_nodes(index, model);
    const Tensor<1, 3> &momentum = of_nodes.force, &angular_momentum = of_nodes.moment;
    const bool is_given = momentum.norm() > 0. || angular_momentum.norm() > 0.;
    if (is_given && (motion.initial_velocity || motion.initial_spin))
      section.fail(motion.initial_velocity ? "Initial velocity" : "Initial spin",
                   "the motion at the start is given twice: an initial condition gives velocities "
                   "to nodes of the part too. Remove one of them.");
    const Tensor<2, 3> inertia = inertia_of(body.inertia().nodal_second);
    Tensor<1, 3> spin = invert(inertia) * angular_momentum;
    if (motion.rotation == RigidRotation::about_axis)
      spin =
          (motion.axis * angular_momentum) / (motion.axis * (inertia * motion.axis)) * motion.axis;
    body.start(momentum / body.inertia().mass, spin, start_interval);
    set_velocity(index, model.state);
  }

  template <int dim>
  void RigidBodies<dim>::constrain_acceleration(const Model<dim> &model, const Clock &clock,
                                                NodalState &state)
  {
    std::vector<double> sums;
    for (std::size_t b = 0; b < bodies.size(); ++b)
    {
      Tensor<1, 3> force;
      std::array<double, 3> moment{};
      for (const unsigned int node : joined[b].nodes)
      {
        const Tensor<1, 3> of_node = vector_of<3>(state.force.node(node));
        const Tensor<1, 3> r = vector_of<3>(state.position.node(node)) - bodies[b].centre();
        force += of_node;
        add_moment(&r[0], &of_node[0], moment);
      }
      sums.insert(sums.end(), &force[0], &force[0] + 3);
      sums.insert(sums.end(), moment.begin(), moment.end());
    }
    sums = ordered_sum(sums, model.communicator);
    for (std::size_t b = 0; b < bodies.size(); ++b)
    {
      bodies[b].find_motion(clock, vector_of<3>(&sums[6 * b]), vector_of<3>(&sums[6 * b + 3]));
      move_nodes(b, clock, state);
    }
  }

  template <int dim>
  void RigidBodies<dim>::move_nodes(const std::size_t index, const Clock &clock,
                                    NodalState &state) const
  {
    // The round-off of positions is taken back slowly: at once, it would be a noise of velocities.
    constexpr double share_of_correction = 1e-3;
    const auto from_start = bodies[index].placement();
    const auto of_step = bodies[index].motion_of_step(clock);
    for (const unsigned int node : joined[index].nodes)
    {
      const Tensor<1, 3> initial = vector_of<3>(state.initial_position.node(node));
      const Tensor<1, 3> place = initial + from_start.of(initial), motion = of_step.of(initial);
      for (unsigned int d = 0; d < dim; ++d)
      {
        const double correction = share_of_correction * (place[d] - state.position.node(node)[d]);
        state.acceleration.node(node)[d] =
            ((motion[d] + correction) / clock.next_step - state.unsmoothed_velocity.node(node)[d]) /
            clock.velocity_step();
      }
    }
  }

  template <int dim>
  void RigidBodies<dim>::summarize(Json &summary) const
  {
    for (const RigidBody<dim> &body : bodies)
    {
      const RigidInertia &inertia = body.inertia();
      const Tensor<2, 3> tensor = inertia_of(inertia.second);
      Json entry = Json::object();
      entry["mass"] = inertia.mass;
      entry["centre"] = Json::array();
      for (unsigned int d = 0; d < dim; ++d)
        entry["centre"].push_back(inertia.centre[d]);
      entry["inertia"] = Json::array();
      if (dim == 2)
        entry["inertia"].push_back(tensor[2][2]);
      else
        for (const auto &component :
             {std::make_pair(0, 0), std::make_pair(1, 1), std::make_pair(2, 2),
              std::make_pair(1, 2), std::make_pair(0, 2), std::make_pair(0, 1)})
          entry["inertia"].push_back(tensor[component.first][component.second]);
      summary["rigid_parts"][body.name()] = entry;
    }
  }

  template <int dim>
  void RigidBodies<dim>::describe(std::ostream &text) const
  {
    for (const RigidBody<dim> &body : bodies)
    {
      const RigidBodySettings<dim> &motion = body.motion();
      std::string free;
      for (unsigned int d = 0; d < dim; ++d)
        if (motion.is_free(d))
          free += std::string(free.empty() ? "" : ", ") + "xyz"[d];
      const Tensor<2, 3> tensor = inertia_of(body.inertia().second);
      text << "  rigid part \"" << body.name() << "\": mass " << body.inertia().mass << ", centre "
           << text_of(body.inertia().centre, dim) << ", moments of inertia ";
      if (dim == 2)
        text << tensor[2][2];
      else
        text << text_of(Tensor<1, 3>({tensor[0][0], tensor[1][1], tensor[2][2]}), 3);
      text << (free.empty() ? ", moves as prescribed" : ", forces move it along " + free)
           << (motion.rotation == RigidRotation::by_angle ? ""
               : motion.rotation == RigidRotation::free   ? ", moments turn it"
                                                          : ", moments turn it about its axis")
           << "\n";
    }
  }

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

  template class RigidBodies<2>;
  template class RigidBodies<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(RigidBodiesKind, after_all_forces)
} // namespace tombolo
