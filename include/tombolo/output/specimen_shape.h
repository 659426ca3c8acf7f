// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/mesh/boundary_names.h>
#include <tombolo/output/history.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The dimensions of a specimen that stands with its foot on a plane, as in an impact test
   * (Pan et al. 2019, Sec. 4.1.3): `specimen.csv`, `results` of the summary, and the screen.
   *
   * Surfaces are chosen once, in the initial mesh, and followed by the current positions of the
   * corners of their faces, which are nodes of elements or particles. Means over the circumference
   * are integrals over the angle about the axis, so that a half or a quarter between symmetry
   * planes has those of the whole. A row of specimen.csv comes every so many steps and at each
   * output; averages over time are those of the rows.
   */
  class SpecimenShape : public History<3>
  {
  public:
    /** What is measured at one time. NaN where there is nothing to measure. */
    struct Dimensions
    {
      double length = 0;                ///< extent of foot, side and rear along the axis
      double foot_diameter = 0;         ///< mean over the edge between foot and side
      double largest_foot_diameter = 0; ///< twice the largest radius on that edge
      double largest_diameter = 0;      ///< twice the largest radius of foot, side and rear
      double bulge_diameter = 0;        ///< mean where side and plane at the bulge height meet
    };

    explicit SpecimenShape(const Entries &e)
        : History<3>(e, "specimen.csv", {"Steps", "20", "Interval"})
    {
      axis = static_cast<unsigned int>(
          e.choice("Axis", "z", "x|y|z", "The direction of the axis of the specimen.")[0] - 'x');
      const std::vector<double> point =
          e.numbers("Point on axis", "0, 0, 0", 3, "L", "A point that the axis passes through.");
      std::copy(point.begin(), point.end(), point_on_axis.begin());
      for (unsigned int i = 0; i < 3; ++i)
      {
        const std::string name = surface_entries[i];
        const std::string boundary = default_boundaries[i];
        const std::string where = name + " where";
        const bool is_changed = e.text(name, boundary, "",
                                       "The boundaries that make up the " + boundary +
                                           " of the specimen, separated by commas.") != boundary;
        if (e.text(name + " where", "", "",
                   "Instead of `" + name +
                       "`, a predicate: all faces of the surface of the mesh whose corners fulfil "
                       "it, for example \"z < 1e-9\".")
                .empty())
          continue;
        e.refuse(is_changed, where, "only one of `" + name + "` and `" + where + "` can be set");
        Predicate<3>(section, where);
      }
      bulge_height = e.number("Bulge height", "0", at_least(0.), "L",
                              "The height above the lowest place of the foot at which the diameter "
                              "of the bulge is taken. 0: a fifth of the initial length.");
      for (unsigned int i = 0; i < 3; ++i)
      {
        const std::string entry = test_entries[i];
        test_dimensions[i] = e.number(
            entry, "0", at_least(0.), "L",
            "The dimension of the specimen after the test, for the mean error: |computed - test| / "
            "test, averaged over length, foot diameter and bulge diameter. 0: no test.");
        has_test = has_test || test_dimensions[i] > 0;
      }
      for (unsigned int i = 0; i < 3; ++i)
        e.refuse(has_test && test_dimensions[i] == 0, test_entries[i],
                 "the mean error is that of three dimensions: give this one, too, or none of them");
      average_from = e.number(
          "Average from", "-1", any_number(), "T",
          "From this time to the end the dimensions are averaged over time, by the rows of "
          "specimen.csv, of which each output has one besides. Negative: no averages.");
      const auto all_of = [](Dimensions &dimensions)
      {
        std::vector<double *> result;
        for (const Measure &measure : measures)
          result.push_back(&(dimensions.*measure.value));
        return result;
      };
      records.value("bulge height", bulge_height);
      records.numbers("present", all_of(present));
      records.numbers("time integral", all_of(time_integral));
      records.value("time of present", time_of_present);
      records.value("step of present", step_of_present);
      records.value("has present", has_present);
      records.value("averaged time", averaged_time);
      records.value("is averaging", is_averaging);
    }

    /** Throws InputError where a surface has no face or foot and side have no edge in common. */
    void check(const OutputView<3> &view) override
    {
      select_surfaces(view);
      find_local_nodes(view);
      const Dimensions initial = measure(view);
      if (!(initial.length > 0 && initial.foot_diameter > 0))
        section.fail("Axis", "the specimen has the length " + format_number(initial.length) +
                                 " and the foot diameter " + format_number(initial.foot_diameter) +
                                 " about this axis");
      if (bulge_height == 0)
        bulge_height = 0.2 * initial.length;
      if (bulge_height >= initial.length)
        section.fail("Bulge height", "the specimen is not so high: its initial length is " +
                                         format_number(initial.length));
      History<3>::check(view);
    }

    void write(const OutputView<3> &view, TimeTable &statistics) override
    {
      if (!is_sampled(view))
        write_row(view);
      for (const Measure &measure : measures)
        statistics.add(std::string("specimen ") + measure.heading, "L", present.*measure.value);
      if (has_test)
        statistics.add("specimen mean error", "1", mean_error(present));
      History<3>::write(view, statistics);
    }

    void finish(Json &results) override
    {
      is_finished = true;
      if (!has_present)
        return;
      const auto write = [&](const Dimensions &dimensions, const std::string &prefix)
      {
        for (const Measure &measure : measures)
          results[prefix + measure.key] = dimensions.*measure.value;
        if (has_test)
          results[prefix + "mean_error"] = mean_error(dimensions);
      };
      write(present, "");
      results["bulge_height"] = bulge_height;
      if (is_averaging)
      {
        // A window with one sample has its values for averages.
        for (const Measure &measure : measures)
          time_integral.*measure.value = averaged_time > 0
                                             ? time_integral.*measure.value / averaged_time
                                             : present.*measure.value;
        averaged_time = 1;
        write(time_integral, "average_");
      }
      History<3>::finish(results);
    }

    std::string report() const override
    {
      if (!has_present)
        return "";
      if (!is_finished)
        return "  specimen: " + text_of(present);
      return is_averaging ? "  specimen, averaged from t = " + format_number(average_from) + ": " +
                                text_of(time_integral)
                          : "";
    }

    /** Measures the present positions. Collective; the same on all ranks. */
    Dimensions measure(const OutputView<3> &view) const
    {
      const NodalVector &position = view.state->position;
      const unsigned int across[] = {(axis + 1) % 3, (axis + 2) % 3};
      const auto polar = [&](const unsigned int node)
      {
        const double *const x_node = position.node(node);
        PolarPosition result;
        const double x = x_node[across[0]] - point_on_axis[across[0]];
        const double y = x_node[across[1]] - point_on_axis[across[1]];
        result.radius = std::hypot(x, y);
        if (result.radius > 0)
        {
          result.x = x / result.radius;
          result.y = y / result.radius;
        }
        return result;
      };
      const MPI_Comm communicator = view.nodes->communicator();

      // The negative of the smallest height and the largest, the largest radius of all and of the
      // foot's edge.
      constexpr double nothing = std::numeric_limits<double>::lowest();
      std::vector<double> largest = {nothing, nothing, nothing, nothing};
      for (const unsigned int node : local_surface)
      {
        const double height = position.node(node)[axis];
        largest[0] = std::max(largest[0], -height);
        largest[1] = std::max(largest[1], height);
        largest[2] = std::max(largest[2], polar(node).radius);
      }
      for (const unsigned int node : local_edges)
        largest[3] = std::max(largest[3], polar(node).radius);
      Utilities::MPI::max(std::vector<double>(largest), communicator, largest);
      const double bottom = -largest[0];

      // Integrals over the angle of the radius and of one: the foot's edge, then the bulge.
      std::vector<double> integrals(4, 0.);
      const auto add = [&](const PolarPosition &a, const PolarPosition &b, const unsigned int first)
      {
        const double angle = std::abs(std::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y));
        integrals[first] += 0.5 * (a.radius + b.radius) * angle;
        integrals[first + 1] += angle;
      };
      for (std::size_t i = 0; i < local_edges.size(); i += 2)
        add(polar(local_edges[i]), polar(local_edges[i + 1]), 0);
      const double level = bottom + bulge_height;
      for (std::size_t i = 0; i < local_sides.size(); i += 4)
      {
        std::array<PolarPosition, 4> crossings;
        unsigned int n_crossings = 0;
        for (unsigned int v = 0; v < 4; ++v)
        {
          const unsigned int a = local_sides[i + v], b = local_sides[i + (v + 1) % 4];
          const double height_a = position.node(a)[axis], height_b = position.node(b)[axis];
          if ((height_a < level) != (height_b < level))
            crossings[n_crossings++] =
                between(polar(a), polar(b), (level - height_a) / (height_b - height_a));
        }
        for (unsigned int c = 0; c + 1 < n_crossings; c += 2)
          add(crossings[c], crossings[c + 1], 2);
      }
      Utilities::MPI::sum(std::vector<double>(integrals), communicator, integrals);

      Dimensions result;
      result.length = largest[1] - bottom;
      result.largest_diameter = 2 * largest[2];
      result.largest_foot_diameter = 2 * largest[3];
      result.foot_diameter = integrals[1] > 0 ? 2 * integrals[0] / integrals[1]
                                              : std::numeric_limits<double>::quiet_NaN();
      result.bulge_diameter = integrals[3] > 0 ? 2 * integrals[2] / integrals[3]
                                               : std::numeric_limits<double>::quiet_NaN();
      return result;
    }

    /** The mean of |computed - test| / test over length, foot and bulge diameter, Eq. (42). */
    double mean_error(const Dimensions &dimensions) const
    {
      double sum = 0;
      for (unsigned int i = 0; i < 3; ++i)
        sum += std::abs(dimensions.*tested[i] - test_dimensions[i]) / test_dimensions[i];
      return sum / 3;
    }

  private:
    static constexpr const char *surface_entries[] = {"Foot", "Side", "Rear"};
    static constexpr const char *default_boundaries[] = {"foot", "side", "rear"};

    struct Measure
    {
      double Dimensions::*value;
      const char *heading;
      const char *key; ///< in the summary
    };

    static constexpr Measure measures[] = {
        {&Dimensions::length, "length", "length"},
        {&Dimensions::foot_diameter, "foot diameter", "foot_diameter"},
        {&Dimensions::largest_foot_diameter, "largest foot diameter", "largest_foot_diameter"},
        {&Dimensions::largest_diameter, "largest diameter", "largest_diameter"},
        {&Dimensions::bulge_diameter, "bulge diameter", "bulge_diameter"}};

    // Dimensions of a test.
    static constexpr const char *test_entries[] = {"Test length", "Test foot diameter",
                                                   "Test bulge diameter"};
    static constexpr double Dimensions::*tested[] = {
        &Dimensions::length, &Dimensions::foot_diameter, &Dimensions::bulge_diameter};

    /** A surface of the specimen: boundaries of the mesh, or a predicate instead. */
    struct Surface
    {
      Surface(const Section &section, const std::string &name, const Mesh<3> &mesh) : name(name)
      {
        if (section.get(name + " where").empty())
          boundaries = boundary_ids(mesh, section, name);
        else
          where.emplace(section, name + " where");
      }

      template <typename Face>
      bool has(const Face &face) const
      {
        if (!where)
          return boundaries.count(face->boundary_id()) > 0;
        for (const unsigned int v : face->vertex_indices())
          if (!(*where)(face->vertex(v)))
            return false;
        return true;
      }

      std::string entry() const
      {
        return where ? name + " where" : name;
      }

      std::string name;
      std::set<types::boundary_id> boundaries;
      std::optional<Predicate<3>> where;
    };

    /** A position in a plane normal to the axis: radius and direction. */
    struct PolarPosition
    {
      double radius = 0, x = 1, y = 0;
    };

    /** The position at the fraction @p s of an edge. Interpolates the radius, so that an edge along
     * or around a round body stays on its surface. */
    static PolarPosition between(const PolarPosition &a, const PolarPosition &b, const double s)
    {
      return {(1 - s) * a.radius + s * b.radius, (1 - s) * a.x + s * b.x, (1 - s) * a.y + s * b.y};
    }

    using GlobalNode = dealii::types::global_dof_index;

    void select_surfaces(const OutputView<3> &view)
    {
      const Nodes<3> &nodes = *view.nodes;
      const Surface foot(section, "Foot", *view.mesh);
      const Surface side(section, "Side", *view.mesh);
      const Surface rear(section, "Rear", *view.mesh);
      const Surface *const surfaces[] = {&foot, &side, &rear};
      std::array<unsigned int, 3> n_faces = {};
      std::set<GlobalNode> on_surface;
      edge_nodes.clear(); // those of another mesh
      side_nodes.clear();

      const MPI_Comm communicator = nodes.communicator();
      attempt_on_all_ranks<InputError>(
          communicator,
          [&]
          {
            // A foot face of an owned cell may have its edge in common with a side face of a ghost.
            std::set<unsigned int> lines_of_side;
            for (const auto &cell : nodes.dof_handler().active_cell_iterators())
              for (const unsigned int f : cell->face_indices())
                if (!cell->is_artificial() && cell->face(f)->at_boundary() &&
                    side.has(cell->face(f)))
                  for (unsigned int l = 0; l < 4; ++l)
                    lines_of_side.insert(cell->face(f)->line_index(l));

            for (const auto &cell : nodes.dof_handler().active_cell_iterators())
              if (cell->is_locally_owned())
                for (const unsigned int f : cell->face_indices())
                {
                  const auto face = cell->face(f);
                  if (!face->at_boundary())
                    continue;
                  for (unsigned int s = 0; s < 3; ++s)
                    if (surfaces[s]->has(face))
                    {
                      ++n_faces[s];
                      for (const unsigned int v : face->vertex_indices())
                        on_surface.insert(face->vertex_dof_index(v, 0));
                    }
                  if (side.has(face))
                    for (const unsigned int v : {0u, 1u, 3u, 2u})
                      side_nodes.push_back(face->vertex_dof_index(v, 0));
                  if (foot.has(face))
                    for (unsigned int l = 0; l < 4; ++l)
                      if (lines_of_side.count(face->line_index(l)) > 0)
                        for (unsigned int v = 0; v < 2; ++v)
                          edge_nodes.push_back(face->line(l)->vertex_dof_index(v, 0));
                }
          });
      surface_nodes.assign(on_surface.begin(), on_surface.end());

      for (unsigned int s = 0; s < 3; ++s)
        if (Utilities::MPI::sum(n_faces[s], communicator) == 0)
          section.fail(surfaces[s]->entry(), "there is no such face of the surface of the mesh");
      if (Utilities::MPI::sum(static_cast<unsigned int>(edge_nodes.size()), communicator) == 0)
        section.fail(foot.entry(), "foot and side have no edge in common, and so the foot has no "
                                   "circumference");
    }

    void find_local_nodes(const OutputView<3> &view)
    {
      partition = view.state->position.partition();
      const auto find = [&](const std::vector<GlobalNode> &global, std::vector<unsigned int> &local)
      {
        local.clear();
        for (const GlobalNode node : global)
          local.push_back(partition->local_index(node));
      };
      find(surface_nodes, local_surface);
      find(edge_nodes, local_edges);
      find(side_nodes, local_sides);
    }

    bool is_sampled(const OutputView<3> &view) const
    {
      return has_present && step_of_present == view.step;
    }

    bool has_row(const OutputView<3> &view) const override
    {
      return History<3>::has_row(view) && !is_sampled(view);
    }

    void add_columns(const OutputView<3> &view) override
    {
      if (view.state->position.partition() != partition)
        find_local_nodes(view);
      measured = measure(view);
      for (const Measure &measure : measures)
        table.add(measure.heading, "L", measured.*measure.value);
      if (has_test)
        table.add("mean error", "1", mean_error(measured));
    }

    void end_row(const OutputView<3> &view) override
    {
      if (average_from >= 0 && view.time >= average_from)
      {
        const double interval = view.time - time_of_present;
        for (const Measure &measure : measures)
          if (is_averaging)
            time_integral.*measure.value +=
                0.5 * interval * (present.*measure.value + measured.*measure.value);
        averaged_time += is_averaging ? interval : 0.;
        is_averaging = true;
      }
      present = measured;
      time_of_present = view.time;
      step_of_present = view.step;
      has_present = true;
    }

    std::string text_of(const Dimensions &dimensions) const
    {
      std::ostringstream text;
      text.precision(5);
      text << "length " << dimensions.length << ", foot diameter " << dimensions.foot_diameter
           << ", diameter at the height " << bulge_height << " " << dimensions.bulge_diameter;
      if (has_test)
        text << ", mean error " << mean_error(dimensions);
      return text.str();
    }

    unsigned int axis;
    std::array<double, 3> point_on_axis;
    double average_from; ///< negative: no averages
    double bulge_height; ///< above the lowest point of the foot [L]
    std::array<double, 3> test_dimensions;
    bool has_test = false;

    // Of owned cells, global and, for one partition at a time, local: nodes of foot, side and rear;
    // pairs of nodes for the edges between foot and side; four for each face of the side, around.
    std::vector<GlobalNode> surface_nodes, edge_nodes, side_nodes;
    std::vector<unsigned int> local_surface, local_edges, local_sides;
    std::shared_ptr<const NodePartition> partition;

    Dimensions measured; ///< of the row that is being written
    Dimensions present;
    double time_of_present = 0;
    std::uint64_t step_of_present = 0;
    bool has_present = false;
    Dimensions time_integral; ///< of the samples since `average_from`, by the trapezoidal rule
    double averaged_time = 0;
    bool is_averaging = false;
    bool is_finished = false;
  };
} // namespace tombolo
