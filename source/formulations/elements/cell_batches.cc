// SPDX-License-Identifier: LGPL-2.1-or-later
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/base/tensor.h>

#include <tombolo/formulations/elements/cell_batches.h>

#include <algorithm>
#include <map>

namespace tombolo
{
  namespace
  {
    std::vector<double> lagrange_values_1d(const unsigned int degree, const double x)
    {
      const QGaussLobatto<1> nodes(degree + 1);
      std::vector<double> values(degree + 1, 1.);
      for (unsigned int i = 0; i <= degree; ++i)
        for (unsigned int j = 0; j <= degree; ++j)
          if (j != i)
            values[i] *=
                (0.5 * (x + 1.) - nodes.point(j)[0]) / (nodes.point(i)[0] - nodes.point(j)[0]);
      return values;
    }

    /** The mass of a multilinear cell, lumped to its nodes. */
    template <int dim>
    class LumpedVolumes
    {
    public:
      LumpedVolumes(const unsigned int degree, const MassLumping lumping)
          : degree(degree), lumping(lumping)
      {
        if (lumping == MassLumping::gauss_lobatto)
          quadrature = QGaussLobatto<dim>(degree + 1);
        else
          quadrature = QGauss<dim>(degree + 1);
        for (const Point<dim> &point : quadrature.get_points())
        {
          Point<dim> on_reference_cell;
          for (unsigned int d = 0; d < dim; ++d)
            on_reference_cell[d] = 2. * point[d] - 1.;
          shape_values.push_back(lagrange_values<dim>(degree, on_reference_cell));
        }
      }

      /** The volumes of the nodes of a cell at these positions. */
      std::vector<double> operator()(const std::vector<Point<dim>> &points) const
      {
        std::vector<double> volumes(points.size(), 0.);
        for (unsigned int q = 0; q < quadrature.size(); ++q)
        {
          Tensor<2, dim> jacobian;
          for (unsigned int corner = 0; corner < GeometryInfo<dim>::vertices_per_cell; ++corner)
          {
            jacobian += outer_product(
                Tensor<1, dim>(points[node_of_corner<dim>(degree, corner)]),
                GeometryInfo<dim>::d_linear_shape_function_gradient(quadrature.point(q), corner));
          }
          const double volume = determinant(jacobian) * quadrature.weight(q);
          if (lumping == MassLumping::gauss_lobatto)
            volumes[q] = volume;
          else
            for (unsigned int k = 0; k < points.size(); ++k)
              volumes[k] += volume * shape_values[q][k];
        }
        return volumes;
      }

    private:
      unsigned int degree;
      MassLumping lumping;
      Quadrature<dim> quadrature;
      std::vector<std::vector<double>> shape_values;
    };

    /** The nodes of cells, cell by cell. */
    template <int dim>
    std::vector<types::global_dof_index>
    nodes_of(const std::vector<typename DoFHandler<dim>::active_cell_iterator> &cells,
             const Nodes<dim> &nodes)
    {
      std::vector<types::global_dof_index> result;
      std::vector<types::global_dof_index> cell_nodes;
      for (const auto &cell : cells)
      {
        nodes.cell_nodes(cell, cell_nodes);
        result.insert(result.end(), cell_nodes.begin(), cell_nodes.end());
      }
      return result;
    }

    IndexSet set_of(std::vector<types::global_dof_index> nodes, const types::global_dof_index n)
    {
      std::sort(nodes.begin(), nodes.end());
      nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
      IndexSet set(n);
      set.add_indices(nodes.begin(), nodes.end());
      set.compress();
      return set;
    }
  } // namespace

  template <int dim>
  std::vector<double> lagrange_values(const unsigned int degree, const Point<dim> &point)
  {
    std::vector<double> values(1, 1.);
    for (unsigned int d = 0; d < dim; ++d)
    {
      const std::vector<double> factors = lagrange_values_1d(degree, point[d]);
      std::vector<double> products;
      for (const double factor : factors)
        for (const double value : values)
          products.push_back(factor * value);
      values = products;
    }
    return values;
  }

  template <int dim>
  void CellBatches<dim>::reinit(const PartSetup<dim> &setup, const unsigned int degree,
                                const MassLumping lumping, const bool can_change,
                                const unsigned int most_groups)
  {
    const auto cells = setup.cells();
    all_cell_count = cell_count = static_cast<unsigned int>(cells.size());
    this->can_change = can_change;
    this->most_groups = most_groups;
    valid_lanes.assign(padded_to_lanes(cell_count) / n_lanes, n_lanes);
    if (cell_count % n_lanes != 0)
      valid_lanes.back() = cell_count % n_lanes;
    all_groups = {{1, 0, n_batches()}};
    nodes_of_cells.clear();
    slots.clear();
    present_cells.clear();
    node_count = Utilities::pow(degree + 1, dim);
    const std::size_t n_entries = std::size_t(node_count) * padded_to_lanes(cell_count);

    const std::vector<types::global_dof_index> all_nodes = nodes_of(cells, *setup.nodes);
    node_set = set_of(all_nodes, setup.nodes->dof_handler().n_dofs());
    const auto number_in_set = [&](const unsigned int cell, const unsigned int k)
    {
      return static_cast<unsigned int>(
          node_set.index_within_set(all_nodes[std::size_t(cell) * node_count + k]));
    };

    const LumpedVolumes<dim> lumped_volumes(degree, lumping);
    node_mass.assign(node_set.n_elements(), 0.);
    cell_mass.clear();
    set_nodes.resize(n_entries);
    positions.resize(n_entries * dim);
    std::vector<Point<dim>> points;
    for (unsigned int c = 0; c < padded_to_lanes(cell_count); ++c)
    {
      const unsigned int cell = std::min(c, cell_count - 1);
      setup.nodes->cell_points(cells[cell], points);
      for (unsigned int k = 0; k < node_count; ++k)
      {
        const std::size_t entry = (std::size_t(c / n_lanes) * node_count + k) * n_lanes;
        set_nodes[entry + c % n_lanes] = number_in_set(cell, k);
        for (unsigned int d = 0; d < dim; ++d)
          positions[entry * dim + d * n_lanes + c % n_lanes] = points[k][d];
      }
      if (c >= cell_count)
        continue;
      const std::vector<double> volumes = lumped_volumes(points);
      for (unsigned int k = 0; k < node_count; ++k)
      {
        const unsigned int node = number_in_set(cell, k);
        const double mass = setup.material->density() * volumes[k];
        node_mass[node] += mass;
        if (can_change)
          nodes_of_cells.push_back(node);
        cell_mass.push_back(mass);
      }
    }
  }

  template <int dim>
  void CellBatches<dim>::remove(const std::vector<bool> &is_removed)
  {
    Assert(is_removed.size() == all_cell_count, ExcInternalError());
    std::vector<unsigned int> present;
    for (unsigned int cell = 0; cell < all_cell_count; ++cell)
      if (!is_removed[cell])
        present.push_back(cell);
    arrange({present});
    all_groups = {{1, 0, n_batches()}};

    std::fill(node_mass.begin(), node_mass.end(), 0.);
    for (const unsigned int cell : present)
      add_mass_of_cell(cell);
  }

  template <int dim>
  void CellBatches<dim>::group(const std::vector<unsigned int> &group_of_cells)
  {
    Assert(group_of_cells.size() == all_cell_count, ExcInternalError());
    std::map<unsigned int, std::vector<unsigned int>> cells_of_groups;
    for (unsigned int cell = 0; cell < all_cell_count; ++cell)
      if (slot_of(cell) < n_batches() * n_lanes)
        cells_of_groups[group_of_cells[cell]].push_back(cell);
    if (cells_of_groups.empty())
      cells_of_groups[1];
    Assert(cells_of_groups.size() <= most_groups, ExcInternalError());
    std::vector<std::vector<unsigned int>> lists;
    all_groups.clear();
    unsigned int next = 0;
    for (const auto &[number, cells] : cells_of_groups)
    {
      const unsigned int first = next;
      next += padded_to_lanes(static_cast<unsigned int>(cells.size())) / n_lanes;
      all_groups.push_back({number, first, next});
      lists.push_back(cells);
    }
    arrange(lists);
  }

  template <int dim>
  void CellBatches<dim>::arrange(const std::vector<std::vector<unsigned int>> &lists)
  {
    Assert(can_change, ExcInternalError());
    present_cells.clear();
    valid_lanes.clear();
    constexpr unsigned int none = numbers::invalid_unsigned_int;
    slots.assign(all_cell_count, none);
    cell_count = 0;
    for (const std::vector<unsigned int> &cells : lists)
    {
      for (const unsigned int cell : cells)
      {
        slots[cell] = static_cast<unsigned int>(present_cells.size());
        present_cells.push_back(cell);
      }
      cell_count += static_cast<unsigned int>(cells.size());
      for (unsigned int i = 0; i < cells.size(); i += n_lanes)
        valid_lanes.push_back(std::min(n_lanes, static_cast<unsigned int>(cells.size()) - i));
      present_cells.resize(n_batches() * n_lanes, cells.empty() ? 0 : cells.back());
    }
    unsigned int next = n_batches() * n_lanes;
    for (unsigned int &slot : slots)
      if (slot == none)
        slot = next++;

    set_nodes.resize(std::size_t(node_count) * present_cells.size());
    for (unsigned int c = 0; c < present_cells.size(); ++c)
      for (unsigned int k = 0; k < node_count; ++k)
        set_nodes[(std::size_t(c / n_lanes) * node_count + k) * n_lanes + c % n_lanes] =
            nodes_of_cells[std::size_t(present_cells[c]) * node_count + k];
    if (!set_to_local.empty())
      find_local_nodes();
  }

  template <int dim>
  void CellBatches<dim>::add_mass_of_cell(const unsigned int cell)
  {
    const std::size_t first = std::size_t(cell) * node_count;
    for (unsigned int k = 0; k < node_count; ++k)
      node_mass[nodes_of_cells[first + k]] += cell_mass[first + k];
  }

  template <int dim>
  std::vector<types::global_dof_index>
  CellBatches<dim>::nodes_of_cell(const unsigned int cell) const
  {
    std::vector<types::global_dof_index> result;
    for (unsigned int k = 0; k < node_count; ++k)
      result.push_back(
          node_set.nth_index_in_set(nodes_of_cells[std::size_t(cell) * node_count + k]));
    return result;
  }

  template <int dim>
  void CellBatches<dim>::set_masses(const std::vector<double> &cell_masses)
  {
    Assert(can_change && cell_masses.size() == cell_mass.size(), ExcInternalError());
    cell_mass = cell_masses;
    std::fill(node_mass.begin(), node_mass.end(), 0.);
    for (unsigned int batch = 0; batch < n_batches(); ++batch)
      for (unsigned int lane = 0; lane < n_valid(batch); ++lane)
        add_mass_of_cell(cell_at(batch * n_lanes + lane));
  }

  template <int dim>
  void CellBatches<dim>::set_partition(const NodePartition &partition)
  {
    set_to_local.clear();
    set_to_local.reserve(node_set.n_elements());
    for (const types::global_dof_index node : node_set)
      set_to_local.push_back(partition.local_index(node));
    find_local_nodes();
  }

  template <int dim>
  void CellBatches<dim>::find_local_nodes()
  {
    local_nodes.resize(set_nodes.size());
    std::transform(set_nodes.begin(), set_nodes.end(), local_nodes.begin(),
                   [&](const unsigned int node) { return set_to_local[node]; });
  }

  template <int dim>
  void CellBatches<dim>::add_mass(NodalVector &mass) const
  {
    Assert(mass.n_slots_per_node() == 1, ExcInternalError());
    for (std::size_t i = 0; i < node_mass.size(); ++i)
      *mass.node(set_to_local[i]) += node_mass[i];
  }

  template <int dim>
  void CellBatches<dim>::add_extra_mass(const std::vector<double> &factors, NodalVector &mass) const
  {
    Assert(mass.n_slots_per_node() == 1, ExcInternalError());
    AssertDimension(cell_mass.size(), std::size_t(all_cell_count) * node_count);
    for (unsigned int batch = 0; batch < n_batches(); ++batch)
      for (unsigned int lane = 0; lane < n_valid(batch); ++lane)
      {
        const unsigned int cell = cell_at(batch * n_lanes + lane);
        for (unsigned int k = 0; k < node_count; ++k)
          *mass.node(nodes(batch)[k * n_lanes + lane]) +=
              (factors[cell] - 1.) * cell_mass[std::size_t(cell) * node_count + k];
      }
  }

  template std::vector<double> lagrange_values<2>(unsigned int, const Point<2> &);
  template std::vector<double> lagrange_values<3>(unsigned int, const Point<3> &);
  template class CellBatches<2>;
  template class CellBatches<3>;
} // namespace tombolo
