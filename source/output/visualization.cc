// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/visualization.h>

#include <tombolo/contact/contact_surface.h>
#include <tombolo/mesh/extent.h>

#include <array>
#include <utility>

namespace tombolo
{
  template <int dim>
  VtuPiece make_tool_piece(const OutputView<dim> &view, const bool double_precision,
                           const bool with_facets)
  {
    VtuPiece piece(dim == 2 ? 3 : 5, dim, double_precision);
    const Extent<dim> box = extent_of<dim>(view.state->position);
    const auto low = vector_of<dim>(box.lowest.data()), high = vector_of<dim>(box.highest.data());
    std::vector<std::string> names;
    std::vector<std::int64_t> numbers;
    std::vector<double> forces, penetrations;
    for (const OutputSurface<dim> &surface : view.surfaces)
    {
      const auto number = static_cast<std::int64_t>(names.size());
      names.push_back(surface.name);
      const auto [force, penetration] = surface.force_and_penetration();
      const FacetList<dim> facets =
          with_facets ? surface.surface->picture(view.time, low, high) : FacetList<dim>();
      const auto first = static_cast<std::int64_t>(piece.n_points());
      for (const Tensor<1, dim> &vertex : facets.vertices)
        for (unsigned int d = 0; d < 3; ++d)
          piece.points.push_back(d < dim ? vertex[d] : 0.);
      for (const auto &facet : facets.facets)
      {
        for (const unsigned int vertex : facet.vertex)
          piece.connectivity.push_back(first + vertex);
        numbers.push_back(number);
        forces.insert(forces.end(), force.begin(), force.end());
        penetrations.push_back(penetration);
      }
    }
    piece.cell_data.add("contact", std::move(numbers));
    piece.cell_data.add("force on the bodies", "M L/T^2", 3, std::move(forces));
    piece.cell_data.add("penetration", "L", 1, std::move(penetrations));
    piece.names.emplace_back("contact names", names);
    return piece;
  }

  template VtuPiece make_tool_piece(const OutputView<2> &, bool, bool);
  template VtuPiece make_tool_piece(const OutputView<3> &, bool, bool);

  namespace
  {
    /** Adds the names of all parts, since `part` is an index among all. */
    template <int dim>
    void add_part_names(const OutputView<dim> &view, VtuPiece &piece)
    {
      std::vector<std::string> names;
      for (const OutputPart<dim> &part : view.parts)
        names.push_back(part.name);
      piece.names.emplace_back("part names", names);
    }

    /** Positions, motion, temperatures and forces of nodes. */
    template <int dim>
    class NodeData
    {
    public:
      /** Collective. */
      explicit NodeData(const OutputView<dim> &view) : view(view)
      {
        for (const auto &[name, terms] : view.nodal_forces)
        {
          forces.push_back({name, NodalVector(view.state->partition()), {}});
          for (const auto &add_to : terms)
            add_to(forces.back().nodal_values);
          forces.back().nodal_values.update_ghosts();
        }
        const auto set_reaction = [&](const unsigned int node, double *const values)
        {
          const std::array<double, 3> force = view.reaction(node);
          std::copy(force.begin(), force.end(), values);
        };
        if (view.reaction)
          forces.push_back({"reaction",
                            nodal_field(view.state->partition(), Quantity::vector, set_reaction),
                            {}});
      }

      void add(const unsigned int node, std::vector<double> &points)
      {
        const NodalState &state = *view.state;
        const double *const initial = state.initial_position.node(node);
        const double *const position = state.position.node(node);
        for (unsigned int d = 0; d < 3; ++d)
        {
          points.push_back(position[d]);
          if (!view.has_mechanics)
            continue;
          initial_positions.push_back(initial[d]);
          displacements.push_back(position[d] - initial[d]);
          velocities.push_back(state.velocity.node(node)[d]);
          for (Force &force : forces)
            force.point_values.push_back(force.nodal_values.node(node)[d]);
        }
        if (view.heat != nullptr)
          temperatures.push_back(*view.heat->present_temperature.node(node));
        if (view.exact_temperature)
          exact_temperatures.push_back(view.exact_temperature(point_of<dim>(initial), view.time));
      }

      void write_to(VtuPiece &piece)
      {
        if (view.has_mechanics)
        {
          piece.point_data.add("initial position", "L", 3, std::move(initial_positions));
          piece.point_data.add("displacement", "L", 3, std::move(displacements));
          piece.point_data.add("velocity", "L/T", 3, std::move(velocities));
          for (Force &force : forces)
            piece.point_data.add(force.name, "M L/T^2", 3, std::move(force.point_values));
        }
        // With mechanics, material points have a "temperature" of their own.
        const std::string name = view.has_mechanics ? "nodal temperature" : "temperature";
        if (view.heat != nullptr)
          piece.point_data.add(name, "temperature", 1, std::move(temperatures));
        if (view.exact_temperature)
          piece.point_data.add("exact " + name, "temperature", 1, std::move(exact_temperatures));
      }

    private:
      struct Force
      {
        std::string name;
        NodalVector nodal_values; ///< with ghosts
        std::vector<double> point_values;
      };

      const OutputView<dim> &view;
      std::vector<Force> forces; ///< the reaction is the last
      std::vector<double> initial_positions, displacements, velocities, temperatures,
          exact_temperatures;
    };

    /** Owned cells of each part of elements, in the order of active cells. */
    template <int dim>
    std::vector<std::vector<typename Nodes<dim>::Cell>> cells_of_parts(const OutputView<dim> &view)
    {
      std::vector<std::vector<typename Nodes<dim>::Cell>> result(view.parts.size());
      for (const auto &cell : view.nodes->dof_handler().active_cell_iterators())
        if (cell->is_locally_owned())
        {
          const unsigned int part = view.part_cells->part_of(cell);
          if (view.parts[part].particles == nullptr)
            result[part].push_back(cell);
        }
      for (std::size_t part = 0; part < view.parts.size(); ++part)
        AssertThrow(view.parts[part].particles != nullptr ||
                        result[part].size() == view.parts[part].formulation->n_cells(),
                    ExcInternalError());
      return result;
    }

    /** The corners of linear cells in a lattice of (degree+1)^dim points in lexicographic order;
     * the corners in the order of VTK: round each face. */
    template <int dim>
    std::vector<std::array<unsigned int, 1u << dim>> linear_cells(const unsigned int degree)
    {
      std::vector<std::array<unsigned int, 1u << dim>> result;
      const unsigned int row = degree + 1, layer = row * row;
      for (unsigned int k = 0; k < (dim == 3 ? degree : 1); ++k)
        for (unsigned int j = 0; j < degree; ++j)
          for (unsigned int i = 0; i < degree; ++i)
          {
            std::array<unsigned int, 1u << dim> corners{};
            for (unsigned int z = 0; z < dim - 1; ++z)
            {
              const unsigned int first = (k + z) * layer + j * row + i;
              corners[4 * z] = first;
              corners[4 * z + 1] = first + 1;
              corners[4 * z + 2] = first + row + 1;
              corners[4 * z + 3] = first + row;
            }
            result.push_back(corners);
          }
      return result;
    }

    /** The material point at each node of a cell; empty unless every node has one. */
    template <int dim>
    std::vector<unsigned int> points_at_nodes(const Formulation<dim> &formulation,
                                              const unsigned int cell,
                                              const std::vector<Point<dim>> &node_positions)
    {
      const unsigned int n_points = formulation.n_points_per_cell();
      if (n_points != node_positions.size())
        return {};
      const double tolerance = 1e-8 * node_positions.front().distance(node_positions.back());
      std::vector<unsigned int> result;
      for (const Point<dim> &position : node_positions)
        for (unsigned int q = 0; q < n_points; ++q)
        {
          const unsigned int point = formulation.point_of_cell(cell, q);
          if (formulation.initial_point_positions()[point].distance(position) < tolerance)
          {
            result.push_back(point);
            break;
          }
        }
      return result.size() == n_points ? result : std::vector<unsigned int>();
    }

    /** Material points with weights. */
    struct WeightedPoints
    {
      std::vector<unsigned int> indices;
      std::vector<double> weights;
    };

    /** The points whose mean a linear cell with these @p corners of a cell shows: those at its
     * corners, where there are @p points_of_nodes, otherwise all of the cell by volume. */
    template <int dim>
    WeightedPoints points_of_subcell(const Formulation<dim> &formulation, const unsigned int cell,
                                     const std::array<unsigned int, 1u << dim> &corners,
                                     const std::vector<unsigned int> &points_of_nodes)
    {
      WeightedPoints result;
      if (formulation.n_points_per_cell() == 0)
        return result;
      if (!points_of_nodes.empty())
      {
        for (const unsigned int corner : corners)
          result.indices.push_back(points_of_nodes[corner]);
        result.weights.assign(corners.size(), 1.);
        return result;
      }
      const double *const volumes = formulation.points().component(MaterialPoints::volume, 0);
      for (unsigned int q = 0; q < formulation.n_points_per_cell(); ++q)
      {
        result.indices.push_back(formulation.point_of_cell(cell, q));
        result.weights.push_back(volumes[result.indices.back()]);
      }
      return result;
    }

    /** F in the middle of a linear cell with these local nodes, in the order of VTK. */
    template <int dim>
    Tensor<2, dim> deformation_gradient(const OutputView<dim> &view,
                                        const std::array<unsigned int, 1u << dim> &nodes)
    {
      Tensor<2, dim> initial, present; // by local coordinates
      for (unsigned int corner = 0; corner < nodes.size(); ++corner)
      {
        const bool is_high[3] = {corner % 4 == 1 || corner % 4 == 2, corner % 4 >= 2, corner >= 4};
        for (unsigned int a = 0; a < dim; ++a)
          for (unsigned int b = 0; b < dim; ++b)
          {
            const double sign = is_high[b] ? 1. : -1.;
            initial[a][b] += sign * view.state->initial_position.node(nodes[corner])[a];
            present[a][b] += sign * view.state->position.node(nodes[corner])[a];
          }
      }
      return present * invert(initial);
    }

    /** Positive at owned nodes of elements that are not removed. Collective. */
    template <int dim>
    NodalVector nodes_of_elements(const OutputView<dim> &view)
    {
      const auto cells = cells_of_parts(view);
      std::vector<types::global_dof_index> cell_nodes;
      return marked_nodes(view.state->partition(),
                          [&](const auto &mark)
                          {
                            for (unsigned int part = 0; part < view.parts.size(); ++part)
                              for (unsigned int cell = 0; cell < cells[part].size(); ++cell)
                              {
                                if (view.parts[part].formulation->is_removed(cell))
                                  continue;
                                view.nodes->cell_nodes(cells[part][cell], cell_nodes);
                                for (const auto node : cell_nodes)
                                  mark(view.state->partition()->local_index(node));
                              }
                          });
    }
  } // namespace

  template <int dim>
  VtuPiece make_cell_piece(const OutputView<dim> &view, const PictureFields &requested)
  {
    VtuPiece piece(dim == 2 ? 9 : 12, 1u << dim, requested.double_precision);
    const NodePartition &partition = *view.state->partition();
    const unsigned int degree = view.nodes->degree();
    const auto subcells = linear_cells<dim>(degree);
    const auto cells = cells_of_parts(view);

    NodeData<dim> node_data(view);
    PointData<dim> point_data(view, requested, false);
    std::vector<std::int64_t> point_of_node(partition.n_local(), -1);
    std::vector<types::global_dof_index> cell_nodes;
    std::vector<Point<dim>> node_positions;

    for (unsigned int part = 0; part < view.parts.size(); ++part)
    {
      if (view.parts[part].particles != nullptr)
        continue;
      const Formulation<dim> &formulation = *view.parts[part].formulation;
      point_data.set_part(part);
      for (unsigned int cell = 0; cell < cells[part].size(); ++cell)
      {
        if (formulation.is_removed(cell))
          continue;
        view.nodes->cell_nodes(cells[part][cell], cell_nodes);
        std::vector<unsigned int> node_points;
        if (degree > 1 && view.has_mechanics)
        {
          view.nodes->cell_points(cells[part][cell], node_positions);
          node_points = points_at_nodes(formulation, cell, node_positions);
        }
        for (const auto &corners : subcells)
        {
          std::array<unsigned int, 1u << dim> nodes{};
          for (unsigned int k = 0; k < corners.size(); ++k)
          {
            nodes[k] = partition.local_index(cell_nodes[corners[k]]);
            if (point_of_node[nodes[k]] < 0)
            {
              point_of_node[nodes[k]] = static_cast<std::int64_t>(piece.n_points());
              node_data.add(nodes[k], piece.points);
            }
            piece.connectivity.push_back(point_of_node[nodes[k]]);
          }

          const WeightedPoints mean =
              view.has_mechanics ? points_of_subcell(formulation, cell, corners, node_points)
                                 : WeightedPoints();
          point_data.add(mean.indices, mean.weights,
                         [&] { return deformation_gradient<dim>(view, nodes); });
        }
      }
    }

    node_data.write_to(piece);
    point_data.move_to(false, piece.cell_data);
    piece.cell_data.add("part", std::move(point_data.parts));
    piece.cell_data.add("owner rank",
                        std::vector<std::int64_t>(piece.n_cells(), Utilities::MPI::this_mpi_process(
                                                                       partition.communicator())));
    add_part_names(view, piece);
    return piece;
  }

  template <int dim>
  VtuPiece make_particle_piece(const OutputView<dim> &view, const PictureFields &requested)
  {
    VtuPiece piece(1, 1, requested.double_precision);
    const NodePartition &partition = *view.state->partition();
    const std::vector<std::uint64_t> &node_ids = view.nodes->persistent_ids();
    const NodalVector is_element_node = nodes_of_elements(view);

    NodeData<dim> node_data(view);
    PointData<dim> point_data(view, requested, true);
    std::vector<std::uint64_t> ids;
    std::vector<double> unsmoothed_velocities, supports, masses;
    std::vector<std::int64_t> is_shared;
    for (unsigned int part = 0; part < view.parts.size(); ++part)
    {
      const OutputPart<dim> &output_part = view.parts[part];
      if (output_part.particles == nullptr)
        continue;
      const Stencils &shape = *output_part.stencils;
      point_data.set_part(part);
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
      {
        const unsigned int node = shape.particle_node[i];
        piece.connectivity.push_back(static_cast<std::int64_t>(piece.n_points()));
        node_data.add(node, piece.points);
        point_data.add({i}, {1.},
                       [&] { return output_part.particles->deformation(i, view.state->position); });
        ids.push_back(node_ids[node]);
        masses.push_back(shape.mass[i]);
        is_shared.push_back(*is_element_node.node(node) > 0. ? 1 : 0);
        const Point<dim> support = output_part.particles->support(i);
        for (unsigned int d = 0; d < 3; ++d)
        {
          supports.push_back(d < dim ? support[d] : 0.);
          if (view.has_mechanics)
            unsmoothed_velocities.push_back(view.state->unsmoothed_velocity.node(node)[d]);
        }
      }
    }

    piece.point_data.add("persistent id", std::move(ids));
    node_data.write_to(piece);
    if (view.has_mechanics)
      piece.point_data.add("unsmoothed velocity", "L/T", 3, std::move(unsmoothed_velocities));
    point_data.move_to(true, piece.point_data);
    piece.point_data.add("support", "L", 3, std::move(supports));
    piece.point_data.add("mass", "M", 1, std::move(masses));
    piece.point_data.add("part", std::move(point_data.parts));
    piece.point_data.add("shared node", std::move(is_shared));
    piece.point_data.add(
        "owner rank", std::vector<std::int64_t>(piece.n_points(), Utilities::MPI::this_mpi_process(
                                                                      partition.communicator())));
    add_part_names(view, piece);
    return piece;
  }

  template VtuPiece make_cell_piece<2>(const OutputView<2> &, const PictureFields &);
  template VtuPiece make_cell_piece<3>(const OutputView<3> &, const PictureFields &);
  template VtuPiece make_particle_piece<2>(const OutputView<2> &, const PictureFields &);
  template VtuPiece make_particle_piece<3>(const OutputView<3> &, const PictureFields &);

  const OutputOfScene visualization_registration(0, "visualization", "Output/Write solution",
                                                 [](const Section &output)
                                                 { return output.get_bool("Write solution"); });

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Output, Visualization, "visualization",
                                  "Cells and particles with all their fields, for ParaView (.pvtu, "
                                  ".pvd).")
} // namespace tombolo
