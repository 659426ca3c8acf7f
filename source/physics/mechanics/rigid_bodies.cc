// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/rigid_bodies.h>

#include <tombolo/contact/surface_contact.h>
#include <tombolo/model/process.h>
#include <tombolo/output/history.h>

namespace tombolo
{
  namespace
  {
    bool share_a_node(const std::vector<unsigned int> &one, const std::vector<unsigned int> &other,
                      const MPI_Comm communicator)
    {
      std::vector<unsigned int> common;
      std::set_intersection(one.begin(), one.end(), other.begin(), other.end(),
                            std::back_inserter(common));
      return Utilities::MPI::max(common.empty() ? 0 : 1, communicator) == 1;
    }

    bool sets_motion(const Section &section)
    {
      const Section motion = section.subsection("rigid");
      const auto entries = {"Origin", "Displacement", "Rotation",         "Angle",
                            "Force",  "Moment",       "Initial velocity", "Initial spin"};
      return std::any_of(entries.begin(), entries.end(),
                         [&](const char *const entry) { return motion.is_set(entry); });
    }

    /** Moves the part that prescribes the motion to the front. */
    void put_leader_first(const std::vector<Section> &sections, std::vector<unsigned int> &parts)
    {
      std::sort(parts.begin(), parts.end());
      std::stable_partition(parts.begin(), parts.end(),
                            [&](const unsigned int part) { return sets_motion(sections[part]); });
      if (parts.size() > 1 && sets_motion(sections[parts[1]]))
        sections[parts[1]].fail(
            "Cells", "common nodes join the part to the rigid part \"" + sections[parts[0]].name() +
                         "\", so that both move as one body, and both give its motion; "
                         "allowed are entries in one of their sections `rigid`.");
    }

    template <int dim>
    void refuse_shared_nodes(const Section &section, const Model<dim> &model,
                             const JoinedParts &body)
    {
      for (unsigned int p = 0; p < model.parts.size(); ++p)
      {
        const Part<dim> &other = model.parts[p];
        const bool becomes_particles =
            std::any_of(model.parts.begin(), model.parts.end(),
                        [&](const Part<dim> &particles) { return particles.source == p; });
        if ((other.particles != nullptr || becomes_particles) &&
            share_a_node(body.nodes, owned_nodes_of_part(model, p), model.communicator))
          section.fail(
              "Cells",
              "the part shares nodes with part \"" + other.name + "\", whose " +
                  (becomes_particles ? "cells become particles, which are" : "particles are") +
                  " smoothed with their neighbours; allowed are shared nodes with "
                  "elements that stay elements.");
      }
    }

    /** Leaves out the nodes that depend on others, which must be of the part as well: then they
     * move with it, and their masses are at these. */
    template <int dim>
    void leave_out_dependent_nodes(const Section &section, const Model<dim> &model,
                                   std::vector<unsigned int> &nodes)
    {
      const NodalVector is_rigid =
          marked_nodes(model.state.partition(),
                       [&](const auto &mark) { std::for_each(nodes.begin(), nodes.end(), mark); });
      const NodePartition::DependentNodes &dependent = model.state.partition()->dependent_nodes();
      bool follows_others = false;
      for (std::size_t row = 0; row < dependent.node.size(); ++row)
        if (const auto found = std::lower_bound(nodes.begin(), nodes.end(), dependent.node[row]);
            found != nodes.end() && *found == dependent.node[row])
        {
          nodes.erase(found);
          for (std::size_t k = dependent.start[row]; k < dependent.start[row + 1]; ++k)
            follows_others = follows_others || *is_rigid.node(dependent.weights[k].first) == 0.;
        }
      if (Utilities::MPI::max(follows_others ? 1 : 0, model.communicator) == 1)
        section.fail("Cells", "a node of the part lies in the middle of an edge of large elements, "
                              "whose ends it would follow, and which are not all of the part; let "
                              "elements change their size elsewhere (`Refine where` in section "
                              "Mesh).");
    }

    template <int dim>
    void refuse_conditions(const Section &section, const Model<dim> &model,
                           const std::vector<unsigned int> &nodes)
    {
      MechanicalConditions<dim> &conditions = *model.conditions;
      const std::vector<unsigned int> &constrained = conditions.constrained_nodes();
      const int none = static_cast<int>(conditions.all().size());
      int first = none;
      std::vector<double> times{0.};
      for (const MechanicalCondition<dim> &condition : conditions.all())
        if (condition.start > 0.)
          times.push_back(condition.start);
      for (auto time = times.rbegin(); time != times.rend(); ++time)
      {
        conditions.act_at(*time);
        for (std::size_t k = 0; k < constrained.size(); ++k)
          if (std::binary_search(nodes.begin(), nodes.end(), constrained[k]))
            for (unsigned int d = 0; d < dim; ++d)
              if (const int c = conditions.prescribing_condition(k, d); c >= 0)
                first = std::min(first, c);
      }
      first = Utilities::MPI::min(first, model.communicator);
      if (first == none)
        return;
      const std::string &name = conditions.all()[static_cast<unsigned int>(first)].name;
      section.all()
          .section("Condition: " + name)
          .fail("Type", "it prescribes the motion of nodes of the rigid part \"" + section.name() +
                            "\", which move as one body. Instead use `Displacement` and `Angle` of "
                            "its section " +
                            in_quotes(section.path() + "/rigid") +
                            ", and leave its nodes out here.");
    }

    template <int dim>
    void refuse_contacts(const Section &section, const Model<dim> &model,
                         const std::vector<unsigned int> &nodes)
    {
      for (const auto *const contact : shown_by_processes<SurfaceContact<dim>>(model))
        if (contact->contact_settings().is_kinematic &&
            share_a_node(nodes, contact->candidate_nodes(), model.communicator))
          section.all()
              .section("Contact: " + contact->name())
              .fail("Method", "it would put nodes of the rigid part \"" + section.name() +
                                  "\" onto the surface one by one; allowed is penalty, or "
                                  "`Boundary` or `Where` without these nodes.");
    }

    /** A half of a body that is its own image can move along the mirror and turn about its normal.
     */
    template <int dim>
    void refuse_motion_out_of_mirrors(const Section &section, const RigidBodySettings<dim> &motion,
                                      const Model<dim> &model,
                                      const std::vector<unsigned int> &nodes)
    {
      std::array<int, dim> is_crossed{};
      for (const NodePartition::Reflected &on_mirror : model.state.partition()->nodes_on_planes())
        for (unsigned int d = 0; d < dim; ++d)
          if (on_mirror.reflection.sign[d] < 0. &&
              std::binary_search(nodes.begin(), nodes.end(), on_mirror.source))
            is_crossed[d] = 1;
      for (unsigned int axis = 0; axis < dim; ++axis)
      {
        if (Utilities::MPI::max(is_crossed[axis], model.communicator) == 0)
          continue;
        const std::string begin = "the part lies on a " + Images::words(true) + " normal to " +
                                  "xyz"[axis] + "; allowed is ";
        if (motion.is_free(axis))
          section.subsection("rigid").fail("Displacement", begin + "0 in this component.");
        if (motion.rotation == RigidRotation::free ||
            (motion.rotation == RigidRotation::about_axis &&
             std::abs(std::abs(motion.axis[axis]) - 1.) > 1e-12))
          section.subsection("rigid").fail("Rotation", begin + "a rotation about this axis.");
      }
    }
  } // namespace

  template <int dim>
  std::vector<unsigned int> owned_nodes_of_part(const Model<dim> &model, const unsigned int part)
  {
    std::vector<unsigned int> result;
    std::vector<types::global_dof_index> cell_nodes;
    for (const auto &cell : model.nodes->dof_handler().active_cell_iterators())
    {
      if (cell->is_artificial() || model.part_cells->part_of(cell) != part)
        continue;
      model.nodes->cell_nodes(cell, cell_nodes);
      for (const types::global_dof_index node : cell_nodes)
        if (model.nodes->owned().is_element(node))
          result.push_back(model.state.partition()->local_index(node));
    }
    std::sort(result.begin(), result.end());
    result.erase(std::unique(result.begin(), result.end()), result.end());
    return result;
  }

  template <int dim>
  std::vector<JoinedParts> find_rigid_bodies(const std::vector<Section> &sections,
                                             const Model<dim> &model)
  {
    std::vector<JoinedParts> bodies;
    for (unsigned int p = 0; p < model.parts.size(); ++p)
    {
      if (rigid_cells(model.parts[p]) == nullptr)
        continue;
      JoinedParts joined{{p}, owned_nodes_of_part(model, p)};
      const auto is_joined = [&](const JoinedParts &other)
      { return share_a_node(joined.nodes, other.nodes, model.communicator); };
      const auto end = std::stable_partition(bodies.begin(), bodies.end(), std::not_fn(is_joined));
      for (auto other = end; other != bodies.end(); ++other)
      {
        joined.parts.insert(joined.parts.end(), other->parts.begin(), other->parts.end());
        std::vector<unsigned int> nodes;
        std::set_union(joined.nodes.begin(), joined.nodes.end(), other->nodes.begin(),
                       other->nodes.end(), std::back_inserter(nodes));
        joined.nodes = std::move(nodes);
      }
      bodies.erase(end, bodies.end());
      bodies.push_back(std::move(joined));
    }
    for (JoinedParts &body : bodies)
      put_leader_first(sections, body.parts);
    return bodies;
  }

  template <int dim>
  RigidInertia inertia_of(const JoinedParts &body, const Model<dim> &model)
  {
    const std::vector<unsigned int> &nodes = body.nodes;
    const NodalVector &mass = model.bridge->mass();
    RigidInertia result;
    std::array<double, 4> first{};
    for (const unsigned int node : nodes)
    {
      const double *const x = model.state.initial_position.node(node);
      for (unsigned int d = 0; d < 3; ++d)
        first[d] += *mass.node(node) * x[d];
      first[3] += *mass.node(node);
    }
    first = ordered_sum(first, model.communicator);
    result.mass = first[3];
    for (unsigned int d = 0; d < 3; ++d)
      result.centre[d] = first[d] / first[3];

    NodalVector own_mass(model.state.partition(), Quantity::scalar);
    for (const unsigned int part : body.parts)
    {
      const NodalVector part_mass = mass_of_part(model, *model.parts[part].formulation);
      for (const unsigned int node : nodes)
        *own_mass.node(node) +=
            model.parts[part].material->relative_inertia() * *part_mass.node(node);
    }
    std::array<double, 18> second{}; // of all masses of nodes, of those of other parts
    for (const unsigned int node : nodes)
    {
      const Tensor<1, 3> r = vector_of<3>(model.state.initial_position.node(node)) - result.centre;
      // Round-off adds no mass to nodes that are not shared.
      const double other_mass = *mass.node(node) - *own_mass.node(node);
      const bool is_shared = other_mass > 1e-12 * *mass.node(node);
      for (unsigned int a = 0; a < 3; ++a)
        for (unsigned int b = 0; b < 3; ++b)
        {
          second[3 * a + b] += *mass.node(node) * r[a] * r[b];
          second[9 + 3 * a + b] += is_shared ? other_mass * r[a] * r[b] : 0.;
        }
    }
    second = ordered_sum(second, model.communicator);
    result.nodal_second = Tensor<2, 3>(ArrayView<const double>(second.data(), 9));
    for (const unsigned int part : body.parts)
    {
      const MassMoments &cells = rigid_cells(model.parts[part])->mass_moments();
      const Tensor<1, 3> offset = cells.centre - result.centre;
      result.second += model.parts[part].material->relative_inertia() *
                       (cells.second + outer_product(cells.mass * offset, offset));
    }
    result.second += Tensor<2, 3>(ArrayView<const double>(second.data() + 9, 9));
    return result;
  }

  template <int dim>
  void check_rigid_body(const Section &section, const RigidBodySettings<dim> &motion,
                        const Model<dim> &model, JoinedParts &body)
  {
    refuse_shared_nodes(section, model, body);
    refuse_conditions(section, model, body.nodes);
    refuse_contacts(section, model, body.nodes);
    refuse_motion_out_of_mirrors(section, motion, model, body.nodes);
    leave_out_dependent_nodes(section, model, body.nodes);
  }

  template std::vector<unsigned int> owned_nodes_of_part(const Model<2> &, unsigned int);
  template std::vector<unsigned int> owned_nodes_of_part(const Model<3> &, unsigned int);
  template std::vector<JoinedParts> find_rigid_bodies(const std::vector<Section> &,
                                                      const Model<2> &);
  template RigidInertia inertia_of(const JoinedParts &, const Model<2> &);
  template void check_rigid_body(const Section &, const RigidBodySettings<2> &, const Model<2> &,
                                 JoinedParts &);
  template std::vector<JoinedParts> find_rigid_bodies(const std::vector<Section> &,
                                                      const Model<3> &);
  template RigidInertia inertia_of(const JoinedParts &, const Model<3> &);
  template void check_rigid_body(const Section &, const RigidBodySettings<3> &, const Model<3> &,
                                 JoinedParts &);

  namespace
  {
    /** After all others, since all their forces move the bodies. */
    constexpr int after_all_forces = process_order::named + 100;
  } // namespace

  TOMBOLO_REGISTER_PROCESS(RigidBodies, after_all_forces)

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
    /** `rigid_bodies.csv` (doc/rigid_bodies.md). */
    const HistoryRegistration rigid_body_registration(
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
