// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/on_ranks.h>
#include <tombolo/mesh/image_conditions.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/mesh/extent.h>
#include <tombolo/mesh/region.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <map>
#include <set>
#include <sstream>

namespace tombolo
{
  namespace
  {
    /** Of the extent of the body: nodes that differ by less are on one plane. */
    constexpr double coordinate_tolerance = 1e-9;

    constexpr char axis_name[] = {'x', 'y', 'z'};

    template <int dim>
    using NodePoints = std::map<types::global_dof_index, Point<dim>>;

    /** Owned nodes that a condition selects. */
    template <int dim>
    std::set<types::global_dof_index> selected_nodes(const Section &section, const Mesh<dim> &mesh,
                                                     const Nodes<dim> &nodes,
                                                     const NodePoints<dim> &all_nodes)
    {
      const Region<dim> where(section, false);
      std::set<types::global_dof_index> candidates;
      if (section.get("Boundary").empty())
        for (const auto &node : all_nodes)
          candidates.insert(node.first);
      else
      {
        const std::set<types::boundary_id> boundaries = boundary_ids(mesh, section, "Boundary");
        nodes.for_each_boundary_node([&](const auto &cell, const unsigned int f)
                                     { return boundaries.count(cell->face(f)->boundary_id()) > 0; },
                                     [&](const types::global_dof_index node)
                                     { candidates.insert(node); });
      }
      std::set<types::global_dof_index> selected;
      attempt_on_all_ranks<InputError>(nodes.communicator(),
                                       [&]
                                       {
                                         for (const types::global_dof_index node : candidates)
                                         {
                                           const auto point = all_nodes.find(node);
                                           if (point != all_nodes.end() &&
                                               where.contains(point->second))
                                             selected.insert(node);
                                         }
                                       });
      return selected;
    }

    /** Owned nodes with their points, and the extent of the body over all ranks. Collective. */
    template <int dim>
    std::pair<NodePoints<dim>, Extent<dim>> owned_nodes(const Nodes<dim> &nodes)
    {
      NodePoints<dim> all_nodes;
      Extent<dim> body;
      std::vector<types::global_dof_index> cell_nodes;
      std::vector<Point<dim>> cell_points;
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      {
        if (cell->is_artificial())
          continue;
        nodes.cell_nodes(cell, cell_nodes);
        nodes.cell_points(cell, cell_points);
        for (unsigned int k = 0; k < cell_nodes.size(); ++k)
          if (nodes.owned().is_element(cell_nodes[k]))
          {
            all_nodes.emplace(cell_nodes[k], cell_points[k]);
            body.add(cell_points[k]);
          }
      }
      body.merge_ranks(nodes.communicator());
      return {all_nodes, body};
    }

    /** What a condition refers to in messages. */
    std::string entry_of(const Section &section)
    {
      return section.get("Boundary").empty() ? "Where" : "Boundary";
    }

    std::string plane_text(const unsigned int axis, const double coordinate)
    {
      return as_text(axis_name[axis], " = ", coordinate);
    }

    /** The one axis that the plane of the nodes is normal to. Throws InputError. */
    template <int dim>
    unsigned int axis_of(const Section &section, const Extent<dim> &plane_extent,
                         const double tolerance)
    {
      std::vector<unsigned int> flat_axes;
      for (unsigned int d = 0; d < dim; ++d)
        if (plane_extent.length(d) <= tolerance)
          flat_axes.push_back(d);
      if (flat_axes.size() == 1)
        return flat_axes.front();
      std::ostringstream text;
      text << "a plane of symmetry is normal to a coordinate axis, but the nodes selected have ";
      for (unsigned int d = 0; d < dim; ++d)
        text << (d > 0 ? ", " : "") << axis_name[d] << " in [" << plane_extent.lowest[d] << ", "
             << plane_extent.highest[d] << "]";
      text << (flat_axes.empty() ? ". A tilted plane is not possible; turn the mesh."
                                 : ": too few to say which plane is meant.");
      section.fail(entry_of(section), text.str());
    }

    template <int dim>
    void refuse_body_on_both_sides(const Section &section, const Extent<dim> &body,
                                   const Images::Mirror &plane, const double tolerance)
    {
      const double below = plane.coordinate - body.lowest[plane.axis];
      const double above = body.highest[plane.axis] - plane.coordinate;
      if (!(below > tolerance && above > tolerance))
        return;
      section.fail(entry_of(section),
                   as_text("the body reaches beyond the plane ",
                           plane_text(plane.axis, plane.coordinate), " on both sides, by ", below,
                           " and ", above, "; model one side of a plane of symmetry only."));
    }

    /** Owned nodes on a plane, all of which must be @p selected. Throws InputError. Collective. */
    template <int dim>
    std::vector<types::global_dof_index>
    nodes_on_plane(const Section &section, const Images::Mirror &plane,
                   const std::set<types::global_dof_index> &selected,
                   const NodePoints<dim> &all_nodes, const double tolerance,
                   const MPI_Comm communicator)
    {
      std::vector<types::global_dof_index> result;
      unsigned long n_missed = 0;
      for (const auto &[node, point] : all_nodes)
        if (std::abs(point[plane.axis] - plane.coordinate) <= tolerance)
        {
          result.push_back(node);
          n_missed += selected.count(node) == 0 ? 1 : 0;
        }
      n_missed = Utilities::MPI::sum(n_missed, communicator);
      if (n_missed > 0)
        section.fail(entry_of(section), "the condition leaves out " + std::to_string(n_missed) +
                                            " nodes on the plane " +
                                            plane_text(plane.axis, plane.coordinate) +
                                            "; a plane of symmetry holds for all nodes on it.");
      return result;
    }
  } // namespace

  bool makes_images(const Section &condition)
  {
    return condition.get("Type") == "symmetry";
  }

  template <int dim>
  void validate_images(const Section &condition)
  {
    Region<dim>(condition, false);
    if (condition.is_set("Function"))
      condition.fail("Function", "a plane of symmetry needs no function.");
  }

  template <int dim>
  std::shared_ptr<const Images> find_images(const Parameters &scene, const Mesh<dim> &mesh,
                                            const Nodes<dim> &nodes)
  {
    std::vector<Section> conditions;
    for (const std::string &name : section_names(scene, "Conditions"))
      if (const Section condition = scene.section("Condition: " + name); makes_images(condition))
        conditions.push_back(condition);
    if (conditions.empty())
      return Images::none();
    const MPI_Comm communicator = nodes.communicator();
    const auto [all_nodes, body] = owned_nodes(nodes);
    const double tolerance = coordinate_tolerance * body.longest();

    auto images = std::make_shared<Images>();
    for (unsigned int p = 0; p < conditions.size(); ++p)
    {
      const Section &section = conditions[p];
      validate_images<dim>(section);
      const auto selected = selected_nodes(section, mesh, nodes, all_nodes);
      if (Utilities::MPI::sum(static_cast<unsigned long>(selected.size()), communicator) == 0)
        section.fail(entry_of(section), "the condition selects no node; it would do nothing.");
      Extent<dim> plane_extent;
      for (const types::global_dof_index node : selected)
        plane_extent.add(all_nodes.at(node));
      plane_extent.merge_ranks(communicator);

      Images::Mirror plane;
      plane.axis = axis_of(section, plane_extent, tolerance);
      plane.coordinate = 0.5 * (plane_extent.lowest[plane.axis] + plane_extent.highest[plane.axis]);
      refuse_body_on_both_sides(section, body, plane, tolerance);
      for (unsigned int q = 0; q < p; ++q)
        if (images->all[q].axis == plane.axis &&
            std::abs(images->all[q].coordinate - plane.coordinate) <= tolerance)
          section.fail(entry_of(section), "condition \"" + conditions[q].name() +
                                              "\" is the same plane of symmetry, " +
                                              plane_text(plane.axis, plane.coordinate) + ".");
      plane.own_images =
          nodes_on_plane(section, plane, selected, all_nodes, tolerance, communicator);
      images->all.push_back(plane);
    }
    return images;
  }

  template <int dim>
  void refuse_images_of_images(const Section &section, const char *const entry,
                               const Images &images, const std::vector<Point<dim>> &points,
                               const std::vector<double> &half_widths, const MPI_Comm communicator)
  {
    // The nearest image of an image is as far as the planes are apart, and the distance of its
    // source to one of them, from others.
    const std::size_t stride = points.empty() ? 0 : half_widths.size() / points.size();
    for (const Images::Mirror &lower : images.all)
      for (const Images::Mirror &upper : images.all)
      {
        if (lower.axis != upper.axis || !(lower.coordinate < upper.coordinate))
          continue;
        const double thickness = upper.coordinate - lower.coordinate;
        double excess = 0;
        for (std::size_t i = 0; i < points.size(); ++i)
        {
          const double reach = half_widths[i * stride + lower.axis];
          for (const double plane : {lower.coordinate, upper.coordinate})
          {
            const double distance = std::abs(points[i][lower.axis] - plane);
            if (distance > 1e-6 * reach)
              excess = std::max(excess, reach - thickness - distance);
          }
        }
        if (Utilities::MPI::max(excess, communicator) > 1e-9 * thickness)
          section.fail(entry,
                       "supports reach across the whole slab between two planes of symmetry; make "
                       "it thicker, or model it with one plane.");
      }
  }

  std::string name_of_cut(const char axis)
  {
    return std::string("symmetry ") + axis;
  }

  std::string Images::words(const bool is_one)
  {
    return is_one ? "plane of symmetry" : "planes of symmetry";
  }

  void Images::describe(std::ostream &text) const
  {
    text << words(false);
    for (const Mirror &mirror : all)
      text << " " << axis_name[mirror.axis] << " = " << mirror.coordinate;
  }

  template void validate_images<2>(const Section &);
  template void validate_images<3>(const Section &);
  template std::shared_ptr<const Images> find_images<2>(const Parameters &, const Mesh<2> &,
                                                        const Nodes<2> &);
  template std::shared_ptr<const Images> find_images<3>(const Parameters &, const Mesh<3> &,
                                                        const Nodes<3> &);
  template void refuse_images_of_images<2>(const Section &, const char *, const Images &,
                                           const std::vector<Point<2>> &,
                                           const std::vector<double> &, MPI_Comm);
  template void refuse_images_of_images<3>(const Section &, const char *, const Images &,
                                           const std::vector<Point<3>> &,
                                           const std::vector<double> &, MPI_Comm);
} // namespace tombolo
