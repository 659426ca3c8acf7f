// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/part_surface.h>

#include <tombolo/base/on_ranks.h>

#include <deal.II/base/geometry_info.h>

#include <algorithm>
#include <map>
#include <numeric>

namespace tombolo
{
  namespace
  {
    /** Whether the part ends at a face of its cells; beyond ghost cells it does not. */
    template <int dim>
    bool is_end(const Nodes<dim> &nodes, const typename Nodes<dim>::Cell &cell,
                const unsigned int face, const typename PartLayer<dim>::Selector &is_of_part)
    {
      if (cell->face(face)->at_boundary())
        return nodes.is_outer_face(cell, face);
      const typename Nodes<dim>::Cell neighbour = cell->neighbor(face);
      return neighbour->is_artificial() || !is_of_part(neighbour);
    }
  } // namespace

  template <int dim>
  PartLayer<dim>::PartLayer(const Nodes<dim> &nodes, const Selector &is_of_part)
      : communicator(nodes.communicator())
  {
    std::vector<SurveyNode> survey_nodes;
    std::vector<SurveyCell> survey_cells;
    std::vector<types::global_dof_index> cell_nodes;
    std::vector<Point<dim>> points;
    std::map<types::global_dof_index, Point<dim>> owned_points;
    for (const auto &cell : nodes.dof_handler().active_cell_iterators())
    {
      if (cell->is_artificial() || !is_of_part(cell))
        continue;
      SurveyCell survey_cell{{}, 0, cell->minimum_vertex_distance()};
      for (const unsigned int f : cell->face_indices())
        if (is_end<dim>(nodes, cell, f, is_of_part))
          survey_cell.mask |= 1u << f;
      if (survey_cell.mask == 0)
        continue;
      nodes.cell_nodes(cell, cell_nodes);
      nodes.cell_points(cell, points);
      for (unsigned int k = 0; k < n_corners; ++k)
        if (nodes.owned().is_element(cell_nodes[k]))
          owned_points[cell_nodes[k]] = points[k];
      std::copy_n(cell_nodes.begin(), n_corners, survey_cell.nodes.begin());
      if (cell->is_locally_owned())
        survey_cells.push_back(survey_cell);
    }
    for (const auto &[node, point] : owned_points)
    {
      survey_nodes.push_back(
          {node, nodes.persistent_ids()[nodes.owned().index_within_set(node)], point});
    }
    read_survey(from_all_ranks(survey_nodes, communicator),
                from_all_ranks(survey_cells, communicator));
    std::vector<unsigned int> numbers_of_owned;
    for (unsigned int number = 0; number < global_numbers.size(); ++number)
      if (nodes.owned().is_element(global_numbers[number]))
      {
        owned_nodes.push_back({number, 0});
        numbers_of_owned.push_back(number);
      }
    received = from_all_ranks(numbers_of_owned, communicator, begin_of_rank);

    add_facets(nodes);
    add_images(nodes);
    faces.vertices = initial_positions;
  }

  template <int dim>
  void PartLayer<dim>::add_facets(const Nodes<dim> &nodes)
  {
    for (std::size_t c = 0; c < layer_cells.size(); ++c)
      for (unsigned int f = 0; f < 2 * dim; ++f)
      {
        if (((masks[c] >> f) & 1u) == 0)
          continue;
        std::array<unsigned int, n_corners / 2> corners;
        for (unsigned int k = 0; k < n_corners / 2; ++k)
          corners[k] = layer_cells[c][nodes.face_node_indices(f)[k]];
        if constexpr (dim == 2)
          faces.facets.push_back({{corners[0], corners[1]}});
        else
        {
          faces.facets.push_back({{corners[0], corners[1], corners[3]}});
          faces.facets.push_back({{corners[0], corners[3], corners[2]}});
        }
        cells_of_facets.resize(faces.facets.size(), static_cast<unsigned int>(c));
      }
  }

  template <int dim>
  void PartLayer<dim>::add_images(const Nodes<dim> &nodes)
  {
    const Images &all = *nodes.images();
    std::vector<unsigned int> mirrors; // of nodes, as bits
    unsigned int touched = 0;
    for (const Tensor<1, dim> &x : initial_positions)
    {
      mirrors.push_back(all.at(Point<dim>(x), 1e-6 * sizes.front()));
      touched |= mirrors.back();
    }
    const auto n_nodes = static_cast<unsigned int>(initial_positions.size());
    const std::size_t n_cells = layer_cells.size(), n_facets = faces.facets.size();
    std::map<unsigned int, std::vector<unsigned int>> numbers; // of nodes, by combination
    numbers[0].resize(n_nodes);
    std::iota(numbers[0].begin(), numbers[0].end(), 0u);
    for (const unsigned int through : all.combinations())
    {
      if ((through & touched) != through)
        continue;
      std::vector<unsigned int> number(n_nodes);
      for (unsigned int node = 0; node < n_nodes; ++node)
        if (const unsigned int others = through & ~mirrors[node]; others != through)
          number[node] = numbers.at(others)[node]; // it is its own image in the rest
        else
        {
          number[node] = static_cast<unsigned int>(initial_positions.size());
          images.push_back({node, all.map(through)});
          const Images::Map &map = images.back().map;
          Tensor<1, dim> x;
          for (unsigned int d = 0; d < dim; ++d)
            x[d] = map.sign[d] * initial_positions[node][d] + map.offset[d];
          initial_positions.push_back(x);
        }
      numbers[through] = number;
      const auto first_cell = static_cast<unsigned int>(layer_cells.size());
      for (std::size_t c = 0; c < n_cells; ++c)
      {
        Cell cell;
        for (unsigned int k = 0; k < n_corners; ++k)
          cell[k] = number[layer_cells[c][k]];
        layer_cells.push_back(cell);
        sizes.push_back(sizes[c]);
      }
      for (std::size_t f = 0; f < n_facets; ++f)
      {
        auto facet = faces.facets[f];
        for (unsigned int &vertex : facet.vertex)
          vertex = number[vertex];
        faces.facets.push_back(facet);
        cells_of_facets.push_back(first_cell + cells_of_facets[f]);
      }
    }
  }

  template <int dim>
  void PartLayer<dim>::fill_images(const unsigned int n_values, const Quantity kind,
                                   std::vector<double> &values) const
  {
    const std::size_t first = n_nodes() - images.size();
    for (std::size_t i = 0; i < images.size(); ++i)
      for (unsigned int v = 0; v < n_values; ++v)
      {
        const double source = values[n_values * images[i].source + v];
        const bool is_even = kind == Quantity::scalar || kind == Quantity::scalars;
        values[n_values * (first + i) + v] =
            (is_even ? 1. : images[i].map.sign[v]) * source +
            (kind == Quantity::position ? images[i].map.offset[v] : 0.);
      }
  }

  template <int dim>
  void PartLayer<dim>::read_survey(const std::vector<SurveyNode> &nodes,
                                   std::vector<SurveyCell> cells)
  {
    std::map<std::uint64_t, const SurveyNode *> by_global_number, by_id;
    for (const SurveyNode &node : nodes)
      by_global_number[node.global_number] = &node;
    // Nodes of cells, and cells, in the order of persistent numbers.
    for (SurveyCell &cell : cells)
      for (std::uint64_t &node : cell.nodes)
      {
        const SurveyNode *const survey_node = by_global_number.at(node);
        by_id[survey_node->id] = survey_node;
        node = survey_node->id;
      }
    std::sort(cells.begin(), cells.end(),
              [](const SurveyCell &a, const SurveyCell &b) { return a.nodes < b.nodes; });
    std::map<std::uint64_t, unsigned int> number_by_id;
    for (const auto &[id, node] : by_id)
    {
      number_by_id[id] = static_cast<unsigned int>(initial_positions.size());
      global_numbers.push_back(static_cast<types::global_dof_index>(node->global_number));
      initial_positions.push_back(node->position);
    }
    for (const SurveyCell &survey_cell : cells)
    {
      layer_cells.emplace_back();
      for (unsigned int k = 0; k < n_corners; ++k)
        layer_cells.back()[k] = number_by_id.at(survey_cell.nodes[k]);
      sizes.push_back(survey_cell.size);
      masks.push_back(survey_cell.mask);
    }
  }

  template <int dim>
  void PartLayer<dim>::set_partition(const NodePartition &partition)
  {
    local_nodes.clear();
    for (OwnedNode &owned : owned_nodes)
    {
      owned.node = partition.local_index(global_numbers[owned.number]);
      local_nodes.push_back(owned.node);
    }
    std::sort(local_nodes.begin(), local_nodes.end());
  }

  template <int dim>
  typename PartLayer<dim>::Weights
  PartLayer<dim>::weights(const Tensor<1, dim> &point, const unsigned int cell,
                          const std::vector<Tensor<1, dim>> &positions) const
  {
    constexpr unsigned int most_iterations = 20;
    constexpr double farthest = 3., tolerance = 1e-15;
    using Geometry = GeometryInfo<dim>;
    const Cell &nodes = layer_cells[cell];
    Point<dim> xi;
    for (unsigned int d = 0; d < dim; ++d)
      xi[d] = 0.5;
    const Point<dim> middle = xi;
    Weights result;
    const auto step_at = [&](const Point<dim> &at, Tensor<2, dim> &inverse)
    {
      Tensor<1, dim> rest = point;
      Tensor<2, dim> jacobian;
      for (unsigned int c = 0; c < n_corners; ++c)
      {
        result[c] = Geometry::d_linear_shape_function(at, c);
        rest -= result[c] * positions[nodes[c]];
        jacobian +=
            outer_product(positions[nodes[c]], Geometry::d_linear_shape_function_gradient(at, c));
      }
      inverse = invert(jacobian);
      return inverse * rest;
    };
    Tensor<2, dim> inverse;
    double last = 1e300;
    for (unsigned int i = 0; i < most_iterations; ++i)
    {
      const Tensor<1, dim> step = step_at(xi, inverse);
      const double size = step.norm();
      // Round-off is reached where steps do not become smaller any more.
      if (size < tolerance || (size < 1e-12 && size >= 0.5 * last))
        return result;
      last = size;
      xi += step;
      if (!((xi - middle).norm() < farthest))
        break;
    }
    // Linear about the middle of a cell that is too distorted: the sums hold all the same.
    const Tensor<1, dim> step = step_at(middle, inverse);
    for (unsigned int c = 0; c < n_corners; ++c)
      result[c] += Geometry::d_linear_shape_function_gradient(middle, c) * step;
    return result;
  }

  template <int dim>
  std::vector<double>
  PartLayer<dim>::gather(const unsigned int n_values, const Quantity kind,
                         const std::function<void(unsigned int, double *)> &fill) const
  {
    std::vector<double> rank_values(n_values * owned_nodes.size());
    for (std::size_t k = 0; k < owned_nodes.size(); ++k)
      fill(owned_nodes[k].node, &rank_values[n_values * k]);
    const std::vector<double> all_values =
        from_all_ranks(rank_values, n_values, begin_of_rank, communicator);
    std::vector<double> result(n_values * n_nodes());
    for (std::size_t k = 0; k < received.size(); ++k)
      std::copy_n(&all_values[n_values * k], n_values, &result[n_values * received[k]]);
    fill_images(n_values, kind, result);
    return result;
  }

  template <int dim>
  void PartLayer<dim>::sum(const unsigned int n_values, const Quantity kind,
                           std::vector<double> &values) const
  {
    const std::size_t first = n_nodes() - images.size();
    for (std::size_t i = 0; i < images.size(); ++i)
      for (unsigned int v = 0; v < n_values; ++v)
      {
        double &value = values[n_values * (first + i) + v];
        values[n_values * images[i].source + v] +=
            kind == Quantity::vector ? images[i].map.sign[v] * value : value;
        value = 0.;
      }
    // Few nodes have values other than zero: each is sent with its number.
    std::vector<double> sent;
    for (std::size_t number = 0; number < n_nodes(); ++number)
    {
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(n_values * number);
      if (std::all_of(begin, begin + n_values, [](const double value) { return value == 0.; }))
        continue;
      sent.push_back(static_cast<double>(number));
      sent.insert(sent.end(), begin, begin + n_values);
    }
    const std::vector<double> all_values = from_all_ranks(sent, communicator);
    std::fill(values.begin(), values.end(), 0.);
    for (std::size_t k = 0; k < all_values.size(); k += n_values + 1)
    {
      const auto number = static_cast<std::size_t>(all_values[k]);
      for (unsigned int v = 0; v < n_values; ++v)
        values[n_values * number + v] += all_values[k + 1 + v];
    }
    fill_images(n_values, kind, values);
  }

  template class PartLayer<2>;
  template class PartLayer<3>;
  template class OutwardAreas<2>;
  template class OutwardAreas<3>;
} // namespace tombolo
