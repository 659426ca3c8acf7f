// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/solution_pieces.h>

#include <tombolo/formulations/elements/eroding_cells.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();

    const std::vector<std::string> vector_components = {"x", "y", "z"};
    const std::vector<std::string> tensor_components = {"xx", "yy", "zz", "yz", "xz", "xy"};
    const std::vector<std::string> matrix_components = {"xx", "xy", "xz", "yx", "yy",
                                                        "yz", "zx", "zy", "zz"};

    std::vector<std::string> component_names(const unsigned int n_components)
    {
      switch (n_components)
      {
      case 3:
        return vector_components;
      case 6:
        return tensor_components;
      case 9:
        return matrix_components;
      default:
        return {};
      }
    }

    double pressure(const double *const stress)
    {
      return -(stress[0] + stress[1] + stress[2]) / 3;
    }

    double von_mises_stress(const double *const stress)
    {
      const double a = stress[0] - stress[1], b = stress[1] - stress[2], c = stress[2] - stress[0];
      const double shear = stress[3] * stress[3] + stress[4] * stress[4] + stress[5] * stress[5];
      return std::sqrt(0.5 * (a * a + b * b + c * c) + 3 * shear);
    }

    /** xx, yy, zz, yz, xz, xy. */
    std::array<double, 6> components_of(const SymmetricTensor<2, 3> &tensor)
    {
      return {{tensor[0][0], tensor[1][1], tensor[2][2], tensor[1][2], tensor[0][2], tensor[0][1]}};
    }

    /** Adds the names of all parts, of elements and of particles, since `part` is an index among
     * all. */
    template <int dim>
    void add_part_names(const OutputView<dim> &view, VtuPiece &piece)
    {
      std::vector<std::string> names;
      for (const OutputPart<dim> &part : view.parts)
        names.push_back(part.name);
      piece.add_names("part names", names);
    }

    /** The fields of all material points of the parts of elements, or of @p particles: the standard
     * fields, then internal variables by name; the same on all ranks. */
    template <int dim>
    std::vector<FieldDescription> point_fields(const OutputView<dim> &view, const bool particles)
    {
      std::vector<FieldDescription> result;
      if (!view.has_mechanics)
        return result;
      for (const OutputPart<dim> &part : view.parts)
        if ((part.particles != nullptr) == particles)
          for (const FieldDescription &field : part.formulation->points().fields())
          {
            const auto known = std::find_if(result.begin(), result.end(),
                                            [&](const FieldDescription &other)
                                            { return other.name == field.name; });
            if (known == result.end())
              result.push_back(field);
            else
              AssertThrow(known->n_components == field.n_components,
                          ExcMessage("Two materials have an internal variable \"" + field.name +
                                     "\" of different numbers of components."));
          }
      return result;
    }

    /**
     * Values of all fields of material points, and pressure, von Mises stress and exact stress, for
     * each entity (cell or particle): the weighted mean of one or several points.
     */
    template <int dim>
    class PointData
    {
    public:
      PointData(const OutputView<dim> &view, const bool particles)
          : view(view), fields(point_fields(view, particles)), values(fields.size())
      {}

      /** Sets the part of the points of the following add(). */
      void set_part(const unsigned int index)
      {
        part_index = index;
        points = &view.parts[index].formulation->points();
        initial_positions = &view.parts[index].formulation->initial_point_positions();
        const auto &own_fields = points->fields();
        own_field.clear();
        for (const FieldDescription &field : fields)
        {
          const auto own =
              std::find_if(own_fields.begin(), own_fields.end(),
                           [&](const FieldDescription &other) { return other.name == field.name; });
          own_field.push_back(own == own_fields.end()
                                  ? -1
                                  : static_cast<int>(std::distance(own_fields.begin(), own)));
        }
      }

      /** Adds an entity with the weighted mean over points. */
      void add(const std::vector<unsigned int> &indices, const std::vector<double> &weights)
      {
        double sum = 0;
        for (const double weight : weights)
          sum += weight;
        for (std::size_t f = 0; f < fields.size(); ++f)
          for (unsigned int c = 0; c < fields[f].n_components; ++c)
          {
            double mean = own_field[f] < 0 ? nan : 0.;
            if (own_field[f] >= 0)
            {
              const double *const component =
                  points->component(static_cast<unsigned int>(own_field[f]), c);
              for (std::size_t i = 0; i < indices.size(); ++i)
                mean += weights[i] / sum * component[indices[i]];
            }
            values[f].push_back(mean);
          }
        parts.push_back(part_index);
        if (fields.empty())
          return;
        const double *const stress = &*(values[MaterialPoints::stress].end() - 6);
        pressures.push_back(pressure(stress));
        von_mises_stresses.push_back(von_mises_stress(stress));
        if (view.exact_stress)
        {
          std::array<double, 6> mean{};
          for (std::size_t i = 0; i < indices.size(); ++i)
          {
            const auto exact =
                components_of(view.exact_stress((*initial_positions)[indices[i]], view.time));
            for (unsigned int c = 0; c < 6; ++c)
              mean[c] += weights[i] / sum * exact[c];
          }
          exact_stresses.insert(exact_stresses.end(), mean.begin(), mean.end());
        }
      }

      /** Calls @p add with name, number of components, values and names of components of each
       * field, in the order of the files. Cells leave the volume out, since a mean of the volumes
       * of points has no meaning. */
      template <typename Add>
      void write_to(const bool with_volume, const Add &add)
      {
        for (std::size_t f = 0; f < fields.size(); ++f)
        {
          if (f == MaterialPoints::volume && !with_volume)
            continue;
          add(fields[f].name, fields[f].n_components, std::move(values[f]),
              component_names(fields[f].n_components));
          if (f == MaterialPoints::stress)
          {
            if (view.exact_stress)
              add("exact stress", 6u, std::move(exact_stresses), tensor_components);
            add("pressure", 1u, std::move(pressures), std::vector<std::string>());
            add("von Mises stress", 1u, std::move(von_mises_stresses), std::vector<std::string>());
          }
        }
      }

      std::vector<std::int64_t> parts; ///< of each entity

    private:
      const OutputView<dim> &view;
      std::vector<FieldDescription> fields;
      std::vector<std::vector<double>> values;
      std::vector<double> pressures, von_mises_stresses, exact_stresses;

      unsigned int part_index = 0;
      const MaterialPoints *points = nullptr;
      const std::vector<Point<dim>> *initial_positions = nullptr;
      std::vector<int> own_field; ///< the number of each field in this part, or -1
    };

    /** Positions, motion and temperatures of nodes. */
    struct NodeData
    {
      template <int dim>
      void add(const OutputView<dim> &view, const unsigned int node, std::vector<double> &points)
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
        }
        if (view.heat != nullptr)
          temperatures.push_back(*view.heat->present_temperature.node(node));
        if (view.exact_temperature)
        {
          Point<dim> location;
          for (unsigned int d = 0; d < dim; ++d)
            location[d] = initial[d];
          exact_temperatures.push_back(view.exact_temperature(location, view.time));
        }
      }

      template <int dim>
      void write_to(const OutputView<dim> &view, VtuPiece &piece)
      {
        if (view.has_mechanics)
        {
          piece.add_point_data("initial position", 3, std::move(initial_positions),
                               vector_components);
          piece.add_point_data("displacement", 3, std::move(displacements), vector_components);
          piece.add_point_data("velocity", 3, std::move(velocities), vector_components);
        }
        // With mechanics, material points have a "temperature" of their own.
        const std::string name = view.has_mechanics ? "nodal temperature" : "temperature";
        if (view.heat != nullptr)
          piece.add_point_data(name, 1, std::move(temperatures));
        if (view.exact_temperature)
          piece.add_point_data("exact " + name, 1, std::move(exact_temperatures));
      }

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

    template <int dim>
    bool is_removed(const Formulation<dim> &formulation, const unsigned int cell)
    {
      const auto *const eroding = dynamic_cast<const ErodingCells<dim> *>(&formulation);
      return eroding != nullptr && eroding->is_removed(cell);
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

    /** Positive at owned nodes of elements that are not removed. Collective. */
    template <int dim>
    NodalVector nodes_of_elements(const OutputView<dim> &view)
    {
      NodalVector result;
      result.reinit(view.state->partition(), 1);
      const auto cells = cells_of_parts(view);
      std::vector<types::global_dof_index> cell_nodes;
      for (unsigned int part = 0; part < view.parts.size(); ++part)
      {
        for (unsigned int cell = 0; cell < cells[part].size(); ++cell)
        {
          if (is_removed(*view.parts[part].formulation, cell))
            continue;
          view.nodes->cell_nodes(cells[part][cell], cell_nodes);
          for (const auto node : cell_nodes)
            *result.node(view.state->partition()->local_index(node)) = 1.;
        }
      }
      result.add_to_owners();
      return result;
    }
  } // namespace

  template <int dim>
  VtuPiece make_cell_piece(const OutputView<dim> &view, const bool double_precision)
  {
    VtuPiece piece(dim == 2 ? 9 : 12, 1u << dim, double_precision);
    const NodePartition &partition = *view.state->partition();
    const unsigned int degree = view.nodes->degree();
    const auto subcells = linear_cells<dim>(degree);
    const auto cells = cells_of_parts(view);

    NodeData node_data;
    PointData<dim> point_data(view, false);
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
        if (is_removed(formulation, cell))
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
          for (const unsigned int corner : corners)
          {
            const unsigned int node = partition.local_index(cell_nodes[corner]);
            if (point_of_node[node] < 0)
            {
              point_of_node[node] = static_cast<std::int64_t>(piece.n_points());
              node_data.add(view, node, piece.points);
            }
            piece.connectivity.push_back(point_of_node[node]);
          }

          const WeightedPoints mean =
              view.has_mechanics ? points_of_subcell(formulation, cell, corners, node_points)
                                 : WeightedPoints();
          point_data.add(mean.indices, mean.weights);
        }
      }
    }

    node_data.write_to(view, piece);
    point_data.write_to(false, [&](auto &&...arguments)
                        { piece.add_cell_data(std::forward<decltype(arguments)>(arguments)...); });
    piece.add_cell_data("part", std::move(point_data.parts));
    piece.add_cell_data("owner rank",
                        std::vector<std::int64_t>(piece.n_cells(), Utilities::MPI::this_mpi_process(
                                                                       partition.communicator())));
    add_part_names(view, piece);
    return piece;
  }

  template <int dim>
  VtuPiece make_particle_piece(const OutputView<dim> &view, const bool double_precision)
  {
    VtuPiece piece(1, 1, double_precision);
    const NodePartition &partition = *view.state->partition();
    const std::vector<std::uint64_t> &node_ids = view.nodes->persistent_ids();
    const NodalVector is_element_node = nodes_of_elements(view);

    NodeData node_data;
    PointData<dim> point_data(view, true);
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
        node_data.add(view, node, piece.points);
        point_data.add({i}, {1.});
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

    piece.add_point_data("persistent id", std::move(ids));
    node_data.write_to(view, piece);
    if (view.has_mechanics)
      piece.add_point_data("unsmoothed velocity", 3, std::move(unsmoothed_velocities),
                           vector_components);
    point_data.write_to(true, [&](auto &&...arguments)
                        { piece.add_point_data(std::forward<decltype(arguments)>(arguments)...); });
    piece.add_point_data("support", 3, std::move(supports), vector_components);
    piece.add_point_data("mass", 1, std::move(masses));
    piece.add_point_data("part", std::move(point_data.parts));
    piece.add_point_data("shared node", std::move(is_shared));
    piece.add_point_data(
        "owner rank", std::vector<std::int64_t>(piece.n_points(), Utilities::MPI::this_mpi_process(
                                                                      partition.communicator())));
    add_part_names(view, piece);
    return piece;
  }

  template VtuPiece make_cell_piece<2>(const OutputView<2> &, bool);
  template VtuPiece make_cell_piece<3>(const OutputView<3> &, bool);
  template VtuPiece make_particle_piece<2>(const OutputView<2> &, bool);
  template VtuPiece make_particle_piece<3>(const OutputView<3> &, bool);
} // namespace tombolo
