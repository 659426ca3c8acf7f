// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/mortar_contact.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/contact/surface_contact.h>

#include <cmath>

namespace tombolo
{
  MortarSettings::MortarSettings(const Entries &e, const bool is_tied, const bool has_heat)
      : FrictionSettings(has_heat)
  {
    resolves_overlap = e.choice("Initial overlap", "refuse", "refuse|resolve",
                                "What happens where bodies overlap at the start: `refuse` ends "
                                "with the depth and the place, `resolve` takes the overlap as it "
                                "is for no overlap, until the bodies separate.") == "resolve";
    stiffness = e.number("Stiffness", "1", positive_up_to(100.), "",
                         "The penalty stiffness of both sides as a fraction of their mass over the "
                         "square of the stable time step, above 0 and up to 100. The step becomes "
                         "smaller by 1/sqrt(1 + a/4) at least.");
    law = bond = ContactLaw(stiffness, 0.);
    if (e.when(!is_tied))
    {
      law = ContactLaw(stiffness, e.number("Damping", "0.2", from_to(0., 1.), "",
                                           "Fraction of critical damping while bodies approach, "
                                           "from 0 to 1. Tied bodies have none."));
      read_friction(
          e,
          "Coulomb's coefficient of friction, from 0 to 10; 0 is frictionless contact. In scenes "
          "with heat also pairs `temperature: value` separated by commas, over the mean "
          "temperature of both sides.");
      if (!e.text("Shear limit", "", "M/(L T^2)",
                  "The largest traction along the surface, which friction does not exceed however "
                  "large the pressure. Empty: there is no limit. Only with `Friction`.")
               .empty())
      {
        e.refuse(!(friction.largest() > 0.), "Shear limit",
                 "there is no friction; allowed is nothing, or a `Friction` above 0.");
        shear_limit = e.section().get_positive("Shear limit");
      }
    }
    if (e.when(!is_tied && has_heat))
      read_heat_fraction(
          e, "Share of the heat of friction that enters the slave, from 0 to 1; the rest "
             "enters the master. `by effusivity`: e_s/(e_s + e_m) with the √(k ρ c) of slave "
             "and master at the present temperatures. Only in scenes with heat.");

    if (e.when(has_heat))
    {
      conductance = e.object<TemperatureTable>(
          "Conductance", "0", "M/(T^3 temperature)",
          "h of the heat h (temperature of the master - temperature of the slave) that enters the "
          "slave per area in contact and time, and leaves the master: one number, or pairs "
          "`pressure: value` separated by commas, joined by straight lines. 0: nothing is "
          "conducted. Only in scenes with heat.",
          "pressure");
      e.refuse(conductance.smallest() < 0., "Conductance", "allowed are numbers from zero on.");
    }
    if (!e.when(!is_tied))
      return;
    bonding_temperature =
        e.optional_number("Bonding temperature", any_number(), "temperature",
                          "Where the mean temperature of both sides reaches it while they press, "
                          "they are tied from then on. Empty: never. Only in scenes with heat.");
    e.refuse(
        bonding_temperature && !has_heat, "Bonding temperature",
        "the scene has no temperature; allowed is nothing, or materials with a section \"Heat\".");
  }

  namespace
  {
    /** Negative only where bonded surfaces are apart. */
    template <int dim>
    double pressed_depth(const MortarHistory<dim> &history)
    {
      const double depth = -history.gap - history.offset;
      return history.is_bonded ? depth : std::max(0., depth);
    }

    /** Throws the InputError that tied bodies are apart, and how far. Collective. */
    template <int dim>
    [[noreturn]] void refuse_distance(const Section &section, const NodalState &state,
                                      const std::vector<unsigned int> &slave_nodes,
                                      const std::vector<unsigned int> &master_nodes,
                                      const MPI_Comm communicator)
    {
      std::vector<Tensor<1, dim>> master_points;
      for (const unsigned int node : master_nodes)
        master_points.push_back(vector_of<dim>(state.initial_position.node(node)));
      double least = std::numeric_limits<double>::max();
      std::string where;
      for (const Tensor<1, dim> &master_point : from_all_ranks(master_points, communicator))
        for (const unsigned int node : slave_nodes)
        {
          const auto x = vector_of<dim>(state.initial_position.node(node));
          if (const double distance = (x - master_point).norm(); distance < least)
          {
            least = distance;
            where = position_text(x);
          }
        }
      const double least_of_all = Utilities::MPI::min(least, communicator);
      std::ostringstream message;
      message << section.describe("Type") << ": the tied bodies are apart: the nearest nodes, at "
              << where << ", are " << least
              << " from each other, or their faces do not face each other; allowed is 10 % of the "
                 "thickness of the thinner cells.";
      throw_on_all_ranks<InputError>(least > least_of_all ? "" : message.str(), communicator);
      section.fail("Type", "the tied bodies are apart.");
    }
  } // namespace

  template <int dim>
  MortarContact<dim>::MortarContact(const Section &section,
                                    std::unique_ptr<const Pairing<dim>> face_pairing,
                                    const bool has_heat, const Nodes<dim> &nodes,
                                    const NodalState &state, const Selector &is_slave,
                                    const Selector &is_master)
      : communicator(nodes.communicator()), pairing(std::move(face_pairing)),
        settings(section, pairing->is_tied(), has_heat), contact_name(section.name()),
        slaves(nodes, is_slave), masters(nodes, is_master),
        segments(slaves, masters, *pairing, settings.splits_by_effusivity, communicator)
  {
    const auto n_slaves = Utilities::MPI::sum(slaves.faces().size(), communicator);
    const auto n_masters = Utilities::MPI::sum(masters.faces().size(), communicator);
    for (const auto &[n_faces, side] :
         {std::make_pair(n_slaves, "slave"), std::make_pair(n_masters, "master")})
      if (n_faces == 0)
        section.fail("", std::string("the ") + side +
                             " has no faces on the boundary of the mesh; the contact would do "
                             "nothing.");
    std::size_t n_different = slaves.faces().size() != masters.faces().size() ? 1 : 0;
    for (std::size_t f = 0; f < std::min(slaves.faces().size(), masters.faces().size()); ++f)
      n_different += slaves.faces()[f].global_nodes != masters.faces()[f].global_nodes ? 1 : 0;
    is_one_surface = n_slaves == n_masters && Utilities::MPI::sum(n_different, communicator) == 0;
    if (is_one_surface && pairing->is_tied())
      section.fail("Type", "slave and master are the same faces; a surface cannot be tied to "
                           "itself.");
    set_partition(state.partition());
    histories.resize(slaves.owned_nodes().size());
    start(section, nodes, state);
    stiffness.list(records, slaves, masters, !pairing->is_tied());
    records.sums("heat, work and impulse", totals.friction, totals.damping, totals.conducted,
                 interleaved(totals.impulse, totals.force, dim));
    NodeHistory::list(records, slaves.owned_nodes(), histories, !pairing->is_tied());
  }

  template <int dim>
  void MortarContact<dim>::set_partition(const std::shared_ptr<const NodePartition> &partition)
  {
    slaves.set_partition(partition);
    masters.set_partition(partition);
    segments.set_partition(partition);
    traction.reinit(partition);
    if (!settings.has_heat)
      return;
    heat_flow.reinit(partition, Quantity::scalars);
    thermal.reinit(partition, Quantity::scalars);
  }

  template <int dim>
  void MortarContact<dim>::start(const Section &section, const Nodes<dim> &nodes,
                                 const NodalState &state)
  {
    const NodalVector &position = state.initial_position;
    segments.gather(position, position, nullptr);
    unsigned int n_near = 0;
    for (std::size_t k = 0; k < histories.size(); ++k)
    {
      const unsigned int node = slaves.owned_nodes()[k];
      NodeHistory &history = histories[k];
      if (!segments.find_normal(node, history.normal))
        continue;
      ++n_near;
      history.area = segments.area_of(node);
      history.gap =
          -(vector_of<dim>(segments.sums().gap.node(node)) * history.normal) / history.area;
      history.offset = pairing->is_tied() ? history.gap : std::max(0., -history.gap);
    }
    if (pairing->is_tied() && Utilities::MPI::sum(n_near, communicator) == 0)
      refuse_distance<dim>(section, state, slaves.owned_nodes(), masters.owned_nodes(),
                           communicator);
    if (pairing->is_tied() || settings.resolves_overlap)
      return;
    std::vector<double> depths;
    for (const NodeHistory &history : histories)
      depths.push_back(history.offset);
    ContactScene<dim>::refuse_depth(nodes, state, slaves.owned_nodes(), depths,
                                    [&](const std::string &depth, const std::string &node)
                                    {
                                      return section.describe("") +
                                             ": the bodies overlap at the start: the slave is " +
                                             depth + " deep in the master around " + node +
                                             ". Move a body, or set `Initial overlap = resolve`.";
                                    });
  }

  template <int dim>
  const NodalVector *MortarContact<dim>::find_thermal(const NodalHeat &nodal_heat)
  {
    if (!settings.needs_temperature())
      return nullptr;
    using Segments = MortarSegments<dim>;
    const auto fill = [&](const unsigned int node, const unsigned int slot, const double area)
    {
      const double theta = nodal_heat.present_temperature(node);
      const double capacity = nodal_heat.enthalpy->capacity(node, theta);
      thermal.node(node)[Segments::temperature] = theta;
      thermal.node(node)[slot] = capacity > 0. ? area / capacity : 0.;
      if (settings.splits_by_effusivity)
        thermal.node(node)[Segments::effusivity] = nodal_heat.enthalpy->effusivity(node, theta);
    };
    for (std::size_t k = 0; k < stiffness.slave_areas.size(); ++k)
      fill(slaves.owned_nodes()[k], Segments::slave_inverse_capacity, stiffness.slave_areas[k]);
    for (std::size_t k = 0; k < stiffness.master_areas.size(); ++k)
      fill(masters.owned_nodes()[k], Segments::master_inverse_capacity, stiffness.master_areas[k]);
    thermal.update_ghosts();
    return &thermal;
  }

  template <int dim>
  void MortarContact<dim>::add_forces(const NodalState &state, const NodalVector &last_position,
                                      const Clock &clock, const NodalHeat &nodal_heat,
                                      NodalVector &loads, NodalVector *const heat)
  {
    totals.force = 0.;
    if (!(clock.stable_step > 0.)) // the very start, where nothing has moved yet
      return;
    if (touch_distance == 0.)
      find_stiffness(state, clock);
    segments.gather(state.position, last_position, find_thermal(nodal_heat));
    const Step step{clock.previous_step, clock.stable_step,
                    stiffness.value * clock.stable_step * clock.stable_step / settings.stiffness};
    for (std::size_t k = 0; k < histories.size(); ++k)
    {
      const unsigned int node = slaves.owned_nodes()[k];
      if (settings.has_heat)
        std::fill_n(heat_flow.node(node), node_stride, 0.);
      advance_node(k, step, heat);
      for (unsigned int d = 0; d < dim; ++d)
        traction.node(node)[d] = histories[k].traction[d];
      totals.force += histories[k].area * histories[k].traction;
    }
    traction.update_ghosts();
    if (settings.has_heat)
      heat_flow.update_ghosts();
    segments.scatter(traction, settings.has_heat ? &heat_flow : nullptr, loads, heat);
  }

  template <int dim>
  void MortarContact<dim>::advance_node(const std::size_t k, const Step &step,
                                        NodalVector *const heat)
  {
    const unsigned int node = slaves.owned_nodes()[k];
    NodeHistory &history = histories[k];
    const auto &sums = segments.sums();
    history.traction = 0.;
    Tensor<1, dim> normal;
    if (!segments.find_normal(node, normal))
    {
      if (history.spring.is_closed())
        release(history, node, Tensor<1, dim>(), heat);
      history.area = history.offset = 0.;
      return;
    }
    const double area = segments.area_of(node);
    const Tensor<1, dim> gap = vector_of<dim>(sums.gap.node(node)) / area;
    if (pairing->is_tied())
    {
      history.normal = normal;
      history.area = area;
      hold(history, gap, step);
      conduct(history, node, step.time_step);
      return;
    }
    const double distance = -(gap * normal);
    Tensor<1, dim> motion = vector_of<dim>(sums.motion.node(node)) / area;
    if (history.area > 0.)
      motion -= 0.5 * (history.gap + distance) * (normal - history.normal);
    ContactSpring<dim> &spring = history.spring;
    if (spring.is_closed())
      spring.elastic_slip = rotated_tangent(spring.elastic_slip, history.normal, normal);
    history.offset = std::min(history.offset, std::max(0., -distance));
    history.normal = normal;
    history.gap = distance;
    if (!(-distance - history.offset > -touch_distance) && !history.is_bonded)
    {
      if (spring.is_closed())
        release(history, node, motion, heat);
      history.area = area;
      return;
    }
    // Area that comes into contact, or leaves it, at the depth of the rest.
    if (spring.is_closed())
      totals.damping -= (area - history.area) * spring.elastic_energy();
    history.area = area;
    press(history, node, motion, step);
    conduct(history, node, step.time_step);
  }

  template <int dim>
  void MortarContact<dim>::press(NodeHistory &history, const unsigned int node,
                                 const Tensor<1, dim> &motion, const Step &step)
  {
    ContactSpring<dim> &spring = history.spring;
    const ContactMotion<dim> move(pressed_depth(history), motion, history.normal);
    double dissipated = 0, friction = 0;
    (history.is_bonded ? settings.bond : settings.law)
        .press(move, step.mass, step.stable_step, step.time_step, spring, dissipated);
    totals.damping += history.area * dissipated;
    const double temperature =
        settings.needs_temperature() ? mean(node, MortarSegments<dim>::mean_temperature) : 0.;
    if (history.is_bonded)
      spring.elastic_slip += move.along;
    else if (settings.friction.largest() > 0.)
    {
      const double limit = settings.largest_traction(spring.normal_force(), temperature);
      spring.limit_follows_pressure = limit < settings.shear_limit;
      friction = ContactLaw::slide(move, limit, spring);
    }
    if (settings.bonding_temperature && temperature >= *settings.bonding_temperature)
      history.is_bonded = true;
    totals.friction += history.area * friction;
    if (settings.has_heat)
    {
      heat_flow.node(node)[1] = friction;
      heat_flow.node(node)[2] = heat_fraction(node);
    }
    history.traction = spring.force(history.normal);
  }

  template <int dim>
  void MortarContact<dim>::hold(NodeHistory &history, const Tensor<1, dim> &gap, const Step &step)
  {
    ContactSpring<dim> &spring = history.spring;
    const ContactSpring<dim> before = spring;
    const double allowed = settings.law.stiffness(step.mass, step.stable_step);
    spring.stiffness = before.is_closed() ? std::min(before.stiffness, allowed) : allowed;
    history.gap = -(gap * history.normal);
    spring.depth = history.offset - history.gap;
    spring.elastic_slip = -gap - history.gap * history.normal;
    if (before.is_closed())
      totals.damping += 0.5 * history.area * (before.stiffness - spring.stiffness) *
                        (before.depth * spring.depth + before.elastic_slip * spring.elastic_slip);
    history.traction = spring.stiffness * (spring.depth * history.normal - spring.elastic_slip);
  }

  template <int dim>
  void MortarContact<dim>::conduct(const NodeHistory &history, const unsigned int node,
                                   const double time_step)
  {
    if (!settings.has_heat || !settings.conducts())
      return;
    const double h = settings.conductance.value(std::max(0., history.spring.normal_force()));
    const double inverse_capacity = mean(node, MortarSegments<dim>::inverse_capacity);
    if (!(h > 0. && inverse_capacity > 0.))
      return;
    const double received = -std::expm1(-h * time_step * inverse_capacity) / inverse_capacity *
                            mean(node, MortarSegments<dim>::temperature_difference);
    heat_flow.node(node)[0] = received;
    totals.conducted += history.area * received;
  }

  template <int dim>
  ContactBalance MortarContact<dim>::balance() const
  {
    ContactBalance result;
    result.name = name();
    for (const NodeHistory &history : histories)
    {
      result.elastic += history.area * history.spring.elastic_energy();
      result.n_nodes += history.spring.is_closed() ? 1. : 0.;
      result.area += history.spring.is_closed() ? history.area : 0.;
      result.penetration = std::max(result.penetration, history.spring.depth);
    }
    totals.add_to(result);
    result.sum_over_ranks(communicator);
    return result;
  }

  template class FaceExchange<2>;
  template class FaceExchange<3>;
  template class MortarContact<2>;
  template class MortarContact<3>;
} // namespace tombolo
