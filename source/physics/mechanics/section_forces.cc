// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/read_vector.h>
#include <tombolo/base/moment.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/impulse_account.h>
#include <tombolo/model/model.h>
#include <tombolo/model/model_input.h>
#include <tombolo/model/process.h>
#include <tombolo/output/history.h>
#include <tombolo/physics/mechanics/named_parts.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/tensor.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <memory>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * A section that forces pass through, of one of two kinds.
   *
   * A cut divides the nodes by their initial positions: its side are those on the plane or beyond
   * it along the normal, and among them those where the predicate holds. Its force is that of the
   * material on the nodes of the side, F = Σ_side f_int. Material between nodes of the
   * side adds nothing, since its forces are in balance, so that F is the force of the material
   * across the cut. By Σ m a = F + the forces from outside on the side, F is exactly the force of
   * the rest of the bodies on it, for all elements and particles.
   *
   * An interface lies between two parts. Its force is that of the material of the first part on the
   * nodes of the second, less that of the second on the other nodes of the first: the force of the
   * first on the second, since the forces within the second are in balance. Only particles act
   * beyond shared nodes. Forces on dependent nodes act on those on which they depend.
   */
  template <int dim>
  class BodySection
  {
  public:
    /** Of a section "Section: NAME". */
    BodySection(const Entries &e, const std::vector<Part<dim>> &parts)
        : section_name(e.section().name())
    {
      if (e.when(e.is_set("Normal")))
        normal = e.read(
            "Normal", "", "",
            "The direction of the normal of the plane that cuts the bodies as they are initially. "
            "The force is that on the nodes which the normal points to and on those on the plane.",
            &read_direction<dim>);
      const std::vector<double> given =
          e.numbers("Point", dim == 2 ? "0, 0" : "0, 0, 0", dim, "L",
                    "A point of the plane, which does not move; moments are about it.");
      std::copy(given.begin(), given.end(), point.begin());
      where = e.if_set<Predicate<dim>>(
          "Where", "",
          "A predicate of the initial position, for example `y < 2`: the force is on those nodes "
          "alone where it holds. Together with a plane it selects one of several members that the "
          "plane cuts; without one it cuts free what it selects.");
      const std::vector<std::string> names = e.list(
          "Between parts", "",
          "Two parts that share nodes, `NAME, OTHER`, in place of a plane or a predicate: the "
          "force is that of the first on the second.");
      if (e.declares())
        return;
      const Section &section = e.section();
      if (normal && !section.is_set("Point"))
        section.fail("Normal", "a plane needs `Point` too, a point in it.");
      if (names.empty())
      {
        if (!normal && !where)
          section.fail("",
                       "a section needs `Normal` and `Point` of a plane, or `Where`, or `Between "
                       "parts`, the names of two parts that share nodes.");
        return;
      }
      for (const char *const other : {"Normal", "Where"})
        if (section.is_set(other))
          section.fail(other, "a section between parts needs no plane and no predicate; remove it, "
                              "or `Between parts`.");
      if (names.size() != 2 || names[0] == names[1])
        section.fail("Between parts", "allowed are the names of two parts, separated by a comma.");
      between.emplace(part_of_entry(section, "Between parts", names[0], parts),
                      part_of_entry(section, "Between parts", names[1], parts));
    }

    /** Finds the side of a cut, and refuses one that divides nothing. Throws InputError.
     * Collective. */
    void find_side(const Section &section, const Model<dim> &model)
    {
      if (is_interface())
      {
        model_changed(model);
        if (n_shared == 0)
          section.fail("Between parts", "the two parts share no node: no force passes through "
                                        "shared nodes.");
        return;
      }
      const NodalVector &initial = model.state.initial_position;
      const unsigned int n_owned = initial.partition()->n_owned();
      double extent = 0;
      for (unsigned int i = 0; i < n_owned; ++i)
        for (unsigned int d = 0; d < dim; ++d)
          extent = std::max(extent, std::abs(initial.node(i)[d] - point[d]));
      // Nodes that a mesh generator has placed on the plane are on it to round-off.
      const double tolerance = 1e-10 * Utilities::MPI::max(extent, model.communicator);
      attempt_on_all_ranks<InputError>(
          model.communicator,
          [&]
          {
            for (unsigned int i = 0; i < n_owned; ++i)
            {
              const Point<dim> position = point_of<dim>(initial.node(i));
              if (is_beyond(position, tolerance) && (!where || (*where)(position)))
                side.push_back(i);
            }
            count_cells(model, tolerance);
          });
      n_side = Utilities::MPI::sum(static_cast<unsigned long>(side.size()), model.communicator);
      n_cut = Utilities::MPI::sum(n_cut, model.communicator);
      n_attached_elsewhere = Utilities::MPI::sum(n_attached_elsewhere, model.communicator);
      if (n_cut == 0)
        section.fail(normal ? "Normal" : "Where",
                     "the section cuts no cell: " +
                         std::string(n_side == 0 ? "no node" : "nothing but whole bodies") +
                         " is on its side.");
    }

    /** For other ghosts, images or cells. Throws nothing. Collective. */
    void model_changed(const Model<dim> &model)
    {
      if (!is_interface())
        return;
      const NodalVector first = mass_of_part(model, *model.parts[between->first].formulation),
                        second = mass_of_part(model, *model.parts[between->second].formulation);
      side.clear();
      only_of_first.clear();
      n_shared = 0;
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      {
        n_shared += *first.node(i) > 0. && *second.node(i) > 0. ? 1 : 0;
        if (*second.node(i) > 0.)
          side.push_back(i);
        else if (*first.node(i) > 0.)
          only_of_first.push_back(i);
      }
      n_shared = Utilities::MPI::sum(n_shared, model.communicator);
      part_force.reinit(model.state.partition());
    }

    /** Of an interface: the contribution of any part is the force where it @p is_added less that
     * before. Collective. */
    void add_part_force(const std::size_t part, const NodalVector &force, const bool is_added,
                        const NodalVector &position)
    {
      if (!is_interface() || (part != between->first && part != between->second))
        return;
      if (!is_added)
      {
        part_force.copy_from(force);
        return;
      }
      const std::size_t n = std::size_t(force.partition()->n_local()) * node_stride;
      for (std::size_t i = 0; i < n; ++i)
        part_force.data()[i] = force.data()[i] - part_force.data()[i];
      part_force.collect();
      const bool is_first = part == between->first;
      const LoadSum added = sum_over(is_first ? side : only_of_first, part_force, position);
      if (is_complete)
        present = LoadSum();
      is_complete = false;
      for (unsigned int c = 0; c < 3; ++c)
      {
        present.force[c] += is_first ? added.force[c] : -added.force[c];
        present.moment[c] += is_first ? added.moment[c] : -added.moment[c];
      }
    }

    /** Of a cut: the sum over the internal forces of all parts, at owned nodes. */
    void set_internal_force(const NodalVector &force, const NodalVector &position)
    {
      is_complete = true;
      if (!is_interface())
        present = sum_over(side, force, position);
    }

    /** The force at t_n and its moment about the point, of this rank. */
    const LoadSum &sum() const
    {
      return present;
    }

    const std::string &name() const
    {
      return section_name;
    }

    /** A sentence for the audit. */
    std::string description() const
    {
      if (is_interface())
        return std::to_string(n_shared) + " shared nodes";
      return std::to_string(n_cut) + " cells cut, " + std::to_string(n_side) + " nodes on its side";
    }

    /** A warning; empty for none. */
    std::string remark() const
    {
      if (n_attached_elsewhere == 0)
        return "";
      return "The side of section \"" + section_name + "\" is cut free by `Where` in " +
             std::to_string(n_attached_elsewhere) +
             " cells away from the plane too; what passes through these counts as well.";
    }

  private:
    bool is_interface() const
    {
      return between.has_value();
    }

    bool is_beyond(const Point<dim> &initial, const double tolerance) const
    {
      if (!normal)
        return true;
      double distance = 0;
      for (unsigned int d = 0; d < dim; ++d)
        distance += (initial[d] - point[d]) * (*normal)[d];
      return distance >= -tolerance;
    }

    /** Sets n_cut and n_attached_elsewhere for this rank's cells. */
    void count_cells(const Model<dim> &model, const double tolerance)
    {
      std::vector<Point<dim>> points;
      for (const auto &cell : model.nodes->dof_handler().active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        model.nodes->cell_points(cell, points);
        std::size_t n_beyond = 0, n_of_side = 0;
        for (const Point<dim> &node : points)
          if (is_beyond(node, tolerance))
          {
            ++n_beyond;
            n_of_side += !where || (*where)(node) ? 1 : 0;
          }
        if (n_of_side == 0 || n_of_side == points.size())
          continue;
        ++n_cut;
        n_attached_elsewhere += normal && n_beyond == points.size() ? 1 : 0;
      }
    }

    LoadSum sum_over(const std::vector<unsigned int> &nodes, const NodalVector &force,
                     const NodalVector &position) const
    {
      LoadSum sum;
      for (const unsigned int node : nodes)
      {
        const double *const x = position.node(node);
        const double arm[3] = {x[0] - point[0], x[1] - point[1], x[2] - point[2]};
        sum.add(arm, force.node(node));
      }
      return sum;
    }

    std::string section_name;
    std::array<double, 3> point{}; ///< of moments and of the plane
    std::optional<dealii::Tensor<1, dim>> normal;
    std::optional<Predicate<dim>> where;
    std::optional<std::pair<std::size_t, std::size_t>> between; ///< parts of an interface
    std::vector<unsigned int> side; ///< owned nodes of a cut, or of an interface's second part
    std::vector<unsigned int> only_of_first; ///< of the parts of an interface
    NodalVector part_force;                  ///< the force of a part of an interface
    LoadSum present;
    bool is_complete = true;  ///< all parts have added to it
    unsigned long n_side = 0; ///< over all ranks, as those below
    unsigned long n_cut = 0, n_attached_elsewhere = 0, n_shared = 0;
  };

  namespace
  {
    constexpr const char *sections_list = "Sections", *section_history = "section history";
  } // namespace

  /** Observes the forces through the sections of the scene (BodySection); it changes nothing. It
   * acts after the viscosity of surfaces and before all external forces, so that the nodal forces
   * are those of the material alone. */
  template <int dim>
  class SectionForces : public Process<dim>
  {
  public:
    SectionForces(std::vector<BodySection<dim>> sections, const Model<dim> &model)
        : model(model), members(std::move(sections)), impulses(members.size())
    {
      Records &all = this->records.group("sections");
      for (std::size_t k = 0; k < members.size(); ++k)
        impulses[k].list(all.group(std::to_string(k)));
      all.value("time of impulse", time_of_impulse);
      model.signals.part_force.connect(
          [this](const std::size_t part, const NodalVector &force, const bool is_added)
          {
            for (BodySection<dim> &member : members)
              member.add_part_force(part, force, is_added, this->model.state.position);
          });
      this->observed.audit.connect(
          [this](std::ostream &text)
          {
            for (const BodySection<dim> &member : members)
              text << "  section \"" << member.name() << "\": " << member.description() << "\n";
          });
      this->observed.warnings.connect(
          [this](auto &, const auto occasion, auto &warnings)
          {
            for (const BodySection<dim> &member : members)
              if (occasion == Process<dim>::Occasion::audit && !member.remark().empty())
                warnings.push_back(member.remark());
          });
      this->observed.history(section_history, [this](BalanceHistory<dim> &row) { fill_row(row); });
    }

    void model_changed(const Model<dim> &changed) override
    {
      for (BodySection<dim> &member : members)
        member.model_changed(changed);
    }

    void add_forces(const Model<dim> &, const Clock &, const NodalVector &force) override
    {
      for (BodySection<dim> &member : members)
        member.set_internal_force(force, model.state.position);
    }

    void after_acceleration(const Model<dim> &, const Clock &clock) override
    {
      time_of_impulse = clock.velocity_time();
      for (std::size_t k = 0; k < members.size(); ++k)
      {
        impulses[k].begin_step();
        impulses[k].add(members[k].sum().force, members[k].sum().moment, clock.velocity_step());
      }
    }

    static void declare_parameters(Parameters &parameters)
    {
      parameters.handler().declare_entry(
          sections_list, "", Patterns::Anything(),
          "Names of sections of the bodies, each with a section `Section: NAME`: forces and "
          "moments through them are in sections.csv.");
      for (const std::string &name : section_names(parameters, sections_list))
        declare_section<BodySection<dim>>(parameters, "Section: " + name, std::vector<Part<dim>>());
    }

    static void validate(const Parameters &parameters, const std::vector<Part<dim>> &parts)
    {
      if (parts.empty()) // nothing can be checked
        return;
      for (const Section &section : named_sections(parameters, sections_list, "Section"))
      {
        BodySection<dim>(section, parts);
        if (std::none_of(parts.begin(), parts.end(),
                         [](const Part<dim> &part) { return part.material->has_mechanics(); }))
          section.fail("", "the scene has no mechanics, since its materials have no stresses; "
                           "no force passes through a section.");
      }
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &parameters, Model<dim> &model)
    {
      std::vector<BodySection<dim>> sections;
      for (const Section &section : named_sections(parameters, sections_list, "Section"))
      {
        sections.emplace_back(section, model.parts);
        sections.back().find_side(section, model);
      }
      if (sections.empty())
        return nullptr;
      return std::make_unique<SectionForces>(std::move(sections), model);
    }

  private:
    /** Sections in their order. Collective. */
    void fill_row(BalanceHistory<dim> &row) const
    {
      std::vector<double> sums;
      for (const ImpulseAccount &account : impulses)
        account.append(sums);
      sums = ordered_sum(sums, model.communicator);
      for (std::size_t k = 0; k < members.size(); ++k)
      {
        ImpulseBalance now;
        now.name = members[k].name();
        now.time_of_impulse = time_of_impulse;
        std::copy_n(sums.data() + 6 * k, 3, now.impulse.begin());
        std::copy_n(sums.data() + 6 * k + 3, 3, now.angular_impulse.begin());
        row.begin_item(now);
        row.add_impulses();
      }
    }

    const Model<dim> &model;
    std::vector<BodySection<dim>> members; // in the order of `Sections`
    std::vector<ImpulseAccount> impulses;  ///< of each, with moments about its point
    double time_of_impulse = 0;
  };

  TOMBOLO_REGISTER_PROCESS(SectionForces, process_order::sections)

  /** `sections.csv` (doc/conditions.md). */
  const HistoryRegistration section_registration(
      {section_history, "sections.csv",
       "Forces, moments and impulses through sections and interfaces of parts (sections.csv); in "
       "every scene that has `Sections`.",
       false, false, "sections"},
      4, "the entry Sections",
      [](const Section &output) { return !output.all().raw_list(sections_list).empty(); });
} // namespace tombolo
