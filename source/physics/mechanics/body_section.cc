// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/body_section.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/name_hints.h>
#include <tombolo/base/throw_on_all_ranks.h>
#include <tombolo/contact/read_vector.h>
#include <tombolo/model/mass_of_part.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The number of the part with this name. Throws InputError. */
    template <int dim>
    std::size_t part_number(const std::string &name, const std::vector<Part<dim>> &parts,
                            const Section &section)
    {
      std::vector<std::string> names;
      for (std::size_t part = 0; part < parts.size(); ++part)
      {
        if (parts[part].name == name)
          return part;
        names.push_back(parts[part].name);
      }
      section.fail("Between parts",
                   "there is no part \"" + name + "\"." + did_you_mean(name, names));
    }

    /** Adds a force at a place relative to @p point. */
    void add_about(const std::array<double, 3> &point, const double *const place,
                   const double *const force, LoadSum &sum)
    {
      const double arm[3] = {place[0] - point[0], place[1] - point[1], place[2] - point[2]};
      sum.add(arm, force);
    }
  } // namespace

  template <int dim>
  BodySection<dim>::BodySection(const Entries &e, const std::vector<Part<dim>> &parts)
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
    const std::vector<std::string> names =
        e.list("Between parts", "",
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
        section.fail("", "a section needs `Normal` and `Point` of a plane, or `Where`, or `Between "
                         "parts`, the names of two parts that share nodes.");
      return;
    }
    for (const char *const other : {"Normal", "Where"})
      if (section.is_set(other))
        section.fail(other, "a section between parts needs no plane and no predicate; remove it, "
                            "or `Between parts`.");
    if (names.size() != 2 || names[0] == names[1])
      section.fail("Between parts", "allowed are the names of two parts, separated by a comma.");
    between.emplace(part_number(names[0], parts, section), part_number(names[1], parts, section));
  }

  template <int dim>
  bool BodySection<dim>::is_interface() const
  {
    return between.has_value();
  }

  template <int dim>
  const std::string &BodySection<dim>::name() const
  {
    return section_name;
  }

  template <int dim>
  const LoadSum &BodySection<dim>::sum() const
  {
    return present;
  }

  template <int dim>
  bool BodySection<dim>::is_beyond(const Point<dim> &initial, const double tolerance) const
  {
    if (!normal)
      return true;
    double distance = 0;
    for (unsigned int d = 0; d < dim; ++d)
      distance += (initial[d] - point[d]) * (*normal)[d];
    return distance >= -tolerance;
  }

  template <int dim>
  void BodySection<dim>::count_cells(const Model<dim> &model, const double tolerance)
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

  template <int dim>
  void BodySection<dim>::find_side(const Section &section, const Model<dim> &model)
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
    // Nodes that a mesh generator has put onto the plane are on it to round-off.
    const double tolerance = 1e-10 * Utilities::MPI::max(extent, model.communicator);
    std::string failure;
    try
    {
      for (unsigned int i = 0; i < n_owned; ++i)
      {
        const Point<dim> place = point_of<dim>(initial.node(i));
        if (is_beyond(place, tolerance) && (!where || (*where)(place)))
          side.push_back(i);
      }
      count_cells(model, tolerance);
    }
    catch (const InputError &error)
    {
      failure = error.what();
    }
    throw_on_all_ranks<InputError>(failure, model.communicator);
    n_side = Utilities::MPI::sum(static_cast<unsigned long>(side.size()), model.communicator);
    n_cut = Utilities::MPI::sum(n_cut, model.communicator);
    n_attached_elsewhere = Utilities::MPI::sum(n_attached_elsewhere, model.communicator);
    if (n_cut == 0)
      section.fail(normal ? "Normal" : "Where",
                   "the section cuts no cell: " +
                       std::string(n_side == 0 ? "no node" : "nothing but whole bodies") +
                       " is on its side.");
  }

  template <int dim>
  void BodySection<dim>::model_changed(const Model<dim> &model)
  {
    if (!is_interface())
      return;
    const NodalVector first = mass_of_part(model, *model.parts[between->first].formulation),
                      second = mass_of_part(model, *model.parts[between->second].formulation);
    side.clear();
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      if (*first.node(i) > 0. && *second.node(i) > 0.)
        side.push_back(i);
    n_shared = Utilities::MPI::sum(static_cast<unsigned long>(side.size()), model.communicator);
    of_first.reinit(model.state.partition());
  }

  template <int dim>
  LoadSum BodySection<dim>::sum_over_side(const NodalVector &force,
                                          const NodalVector &position) const
  {
    LoadSum sum;
    for (const unsigned int node : side)
      add_about(point, position.node(node), force.node(node), sum);
    return sum;
  }

  template <int dim>
  void BodySection<dim>::before_part_force(const std::size_t part, const NodalVector &force)
  {
    if (is_interface() && part == between->first)
      of_first.copy_from(force);
  }

  template <int dim>
  void BodySection<dim>::after_part_force(const std::size_t part, const NodalVector &force,
                                          const NodalVector &position)
  {
    if (!is_interface() || part != between->first)
      return;
    const std::size_t n = std::size_t(force.partition()->n_local()) * node_stride;
    for (std::size_t i = 0; i < n; ++i)
      of_first.data()[i] = force.data()[i] - of_first.data()[i];
    of_first.collect();
    present = sum_over_side(of_first, position);
  }

  template <int dim>
  void BodySection<dim>::take_internal_force(const NodalVector &force, const NodalVector &position)
  {
    if (!is_interface())
      present = sum_over_side(force, position);
  }

  template <int dim>
  std::string BodySection<dim>::description() const
  {
    if (is_interface())
      return std::to_string(n_shared) + " shared nodes";
    return std::to_string(n_cut) + " cells cut, " + std::to_string(n_side) + " nodes on its side";
  }

  template <int dim>
  std::string BodySection<dim>::remark() const
  {
    if (n_attached_elsewhere == 0)
      return "";
    return "The side of section \"" + section_name + "\" is cut free by `Where` in " +
           std::to_string(n_attached_elsewhere) +
           " cells away from the plane too; what passes through these counts as well.";
  }

  template class BodySection<2>;
  template class BodySection<3>;
} // namespace tombolo
