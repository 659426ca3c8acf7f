// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/part_layer.h>

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <numeric>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** Concatenates the values of all ranks in their order. Collective. */
    template <typename Value>
    std::vector<Value> of_all_ranks(const std::vector<Value> &of_rank, const MPI_Comm communicator)
    {
      std::vector<Value> result;
      for (const std::vector<Value> &values : Utilities::MPI::all_gather(communicator, of_rank))
        result.insert(result.end(), values.begin(), values.end());
      return result;
    }

    /** The same of numbers, in every step. @p n_of_rank are the lengths on all ranks. */
    std::vector<double> gather_numbers(const std::vector<double> &of_rank,
                                       const std::vector<int> &n_of_rank,
                                       const MPI_Comm communicator)
    {
      std::vector<int> begin(n_of_rank.size() + 1, 0);
      std::partial_sum(n_of_rank.begin(), n_of_rank.end(), begin.begin() + 1);
      std::vector<double> result(static_cast<std::size_t>(begin.back()));
      MPI_Allgatherv(of_rank.data(), static_cast<int>(of_rank.size()), MPI_DOUBLE, result.data(),
                     n_of_rank.data(), begin.data(), MPI_DOUBLE, communicator);
      return result;
    }

    /** Whether the part ends at a face of one of its cells, as far as this rank knows: beyond ghost
     * cells it does not. */
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
  struct PartLayer<dim>::Survey
  {
    /** Global and persistent number of nodes, by their owners. */
    std::vector<std::uint64_t> nodes;
    std::vector<double> positions;
    /** Global numbers of the nodes of cells and a bit for each face, by the owners of cells. */
    std::vector<std::uint64_t> cells;
    std::vector<double> sizes;
  };

  template <int dim>
  PartLayer<dim>::PartLayer(const Nodes<dim> &nodes, const Selector &is_of_part)
      : communicator(nodes.communicator())
  {
    Survey survey;
    std::vector<types::global_dof_index> cell_nodes;
    std::vector<Point<dim>> points;
    std::map<types::global_dof_index, Point<dim>> owned_points;
    for (const auto &cell : nodes.dof_handler().active_cell_iterators())
    {
      if (cell->is_artificial() || !is_of_part(cell))
        continue;
      std::uint64_t mask = 0;
      for (const unsigned int f : cell->face_indices())
        if (is_end<dim>(nodes, cell, f, is_of_part))
          mask |= std::uint64_t(1) << f;
      if (mask == 0)
        continue;
      nodes.cell_nodes(cell, cell_nodes);
      nodes.cell_points(cell, points);
      for (unsigned int k = 0; k < n_corners; ++k)
        if (nodes.owned().is_element(cell_nodes[k]))
          owned_points[cell_nodes[k]] = points[k];
      if (!cell->is_locally_owned())
        continue;
      survey.cells.insert(survey.cells.end(), cell_nodes.begin(), cell_nodes.end());
      survey.cells.push_back(mask);
      survey.sizes.push_back(cell->minimum_vertex_distance());
    }
    for (const auto &[node, point] : owned_points)
    {
      survey.nodes.push_back(node);
      survey.nodes.push_back(nodes.persistent_ids()[nodes.owned().index_within_set(node)]);
      for (unsigned int d = 0; d < dim; ++d)
        survey.positions.push_back(point[d]);
    }
    take_survey(
        {of_all_ranks(survey.nodes, communicator), of_all_ranks(survey.positions, communicator),
         of_all_ranks(survey.cells, communicator), of_all_ranks(survey.sizes, communicator)});

    std::vector<unsigned int> numbers_of_owned;
    for (unsigned int number = 0; number < global_numbers.size(); ++number)
      if (nodes.owned().is_element(global_numbers[number]))
      {
        owned_nodes.push_back({number, 0});
        numbers_of_owned.push_back(number);
      }
    received = of_all_ranks(numbers_of_owned, communicator);
    n_owned_of_rank =
        Utilities::MPI::all_gather(communicator, static_cast<int>(numbers_of_owned.size()));

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
          corners[k] = layer_cells[c][nodes.face_places(f)[k]];
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
  void PartLayer<dim>::take_survey(const Survey &survey)
  {
    struct Known
    {
      std::uint64_t id;
      std::size_t place; // in the survey
    };
    std::map<std::uint64_t, Known> by_global_number;
    for (std::size_t k = 0; k < survey.nodes.size() / 2; ++k)
      by_global_number[survey.nodes[2 * k]] = {survey.nodes[2 * k + 1], k};

    // Nodes of cells, and cells, in the order of persistent numbers.
    std::map<std::uint64_t, std::uint64_t> global_number_by_id;
    constexpr std::size_t stride = n_corners + 1;
    struct Record
    {
      std::array<std::uint64_t, n_corners> ids;
      std::size_t place;
    };
    std::vector<Record> records(survey.sizes.size());
    for (std::size_t c = 0; c < records.size(); ++c)
    {
      records[c].place = c;
      for (unsigned int k = 0; k < n_corners; ++k)
      {
        const std::uint64_t global = survey.cells[stride * c + k];
        records[c].ids[k] = by_global_number.at(global).id;
        global_number_by_id[records[c].ids[k]] = global;
      }
    }
    std::sort(records.begin(), records.end(),
              [](const Record &a, const Record &b) { return a.ids < b.ids; });

    std::map<std::uint64_t, unsigned int> number_by_id;
    for (const auto &[id, global] : global_number_by_id)
    {
      number_by_id[id] = static_cast<unsigned int>(initial_positions.size());
      global_numbers.push_back(static_cast<types::global_dof_index>(global));
      Tensor<1, dim> position;
      for (unsigned int d = 0; d < dim; ++d)
        position[d] = survey.positions[dim * by_global_number.at(global).place + d];
      initial_positions.push_back(position);
    }
    for (const Record &record : records)
    {
      Cell cell;
      for (unsigned int k = 0; k < n_corners; ++k)
        cell[k] = number_by_id.at(record.ids[k]);
      layer_cells.push_back(cell);
      sizes.push_back(survey.sizes[record.place]);
      masks.push_back(static_cast<unsigned int>(survey.cells[stride * record.place + n_corners]));
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
  bool PartLayer<dim>::has_node(const unsigned int node) const
  {
    return std::binary_search(local_nodes.begin(), local_nodes.end(), node);
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
    std::vector<double> of_rank(n_values * owned_nodes.size());
    for (std::size_t k = 0; k < owned_nodes.size(); ++k)
      fill(owned_nodes[k].node, &of_rank[n_values * k]);
    std::vector<int> lengths = n_owned_of_rank;
    for (int &length : lengths)
      length *= static_cast<int>(n_values);
    const std::vector<double> of_ranks = gather_numbers(of_rank, lengths, communicator);
    std::vector<double> result(n_values * n_nodes());
    for (std::size_t k = 0; k < received.size(); ++k)
      std::copy_n(&of_ranks[n_values * k], n_values, &result[n_values * received[k]]);
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
    // Few nodes have anything to give: each is sent with its number.
    std::vector<double> given;
    for (std::size_t number = 0; number < n_nodes(); ++number)
    {
      const auto begin = values.begin() + static_cast<std::ptrdiff_t>(n_values * number);
      if (std::all_of(begin, begin + n_values, [](const double value) { return value == 0.; }))
        continue;
      given.push_back(static_cast<double>(number));
      given.insert(given.end(), begin, begin + n_values);
    }
    const int length = static_cast<int>(given.size());
    std::vector<int> lengths(n_owned_of_rank.size());
    MPI_Allgather(&length, 1, MPI_INT, lengths.data(), 1, MPI_INT, communicator);
    const std::vector<double> of_ranks = gather_numbers(given, lengths, communicator);
    std::fill(values.begin(), values.end(), 0.);
    for (std::size_t k = 0; k < of_ranks.size(); k += n_values + 1)
    {
      const auto number = static_cast<std::size_t>(of_ranks[k]);
      for (unsigned int v = 0; v < n_values; ++v)
        values[n_values * number + v] += of_ranks[k + 1 + v];
    }
    fill_images(n_values, kind, values);
  }

  template class PartLayer<2>;
  template class PartLayer<3>;
} // namespace tombolo
