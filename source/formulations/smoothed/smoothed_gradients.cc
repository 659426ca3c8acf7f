// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_gradients.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/row_block.h>
#include <tombolo/formulations/smoothed/smoothed_row_builder.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  SmoothedGradients<dim>::SmoothedGradients(const Entries &e)
  {
    const std::string name =
        e.choice("Kernel", "cubic spline", Registry<Kernel>::instance().selection(),
                 "The kernel of the convex approximation.");
    if (!e.declares())
      kernel = Registry<Kernel>::instance().create(name, e.section());
    dilation = e.number("Dilation", "1.1", any_number(), "",
                        "Half width of a support over the largest distance to a neighbouring node, "
                        "axis by axis; 1.05 to 2. 1.1 has the waves of elements; 1.5 halves static "
                        "errors and has longer steps, at three times the cost.");
    e.refuse(!(dilation >= 1.05 && dilation <= 2.), "Dilation",
             "allowed is a number from 1.05 to 2; below, cells have points that no support "
             "reaches, and above, weak modes appear");
    rule = smoothed_integration_rule(
        e.choice("Integration", "smoothed", "smoothed|one point",
                 "smoothed: four sub-cells a cell, with gradients from the functions on their "
                 "facets, which pass the patch test in every mesh; one point: the gradients at the "
                 "middle of the cell, as in Wu et al. 2015, which are exact on lattices only."));
    shares_of_points = corner_shares_of_points<dim>(rule);
  }

  template <int dim>
  void SmoothedGradients<dim>::initialize(const PartSetup<dim> &setup,
                                          const NodalVector *const position)
  {
    // Void cells change, and what they are to their neighbours.
    if (position == nullptr || setup.void_cells != nullptr || !surroundings)
      surroundings = std::make_shared<const CellSurroundings<dim>>(setup, dilation);
    const std::vector<SmoothedCell<dim>> &cells = surroundings->cells;
    SmoothedRowBuilder<dim> builder(*surroundings, ConvexApproximation<dim>(kernel),
                                    MovedConvexValues<dim>(kernel), position);
    std::vector<SmoothedRow<dim>> rows_of_cells;
    rows_of_cells.reserve(cells.size() * n_points_per_cell());
    std::vector<types::global_dof_index> first_node;
    std::string failure;
    for (std::size_t c = 0; c < cells.size() && failure.empty(); ++c)
      if (!cells[c].is_void)
      {
        failure = builder.add_cell(c, rule, rows_of_cells);
        first_node.push_back(cells[c].nodes.front());
      }
    if (!failure.empty())
      failure = "The part \"" + setup.name + "\" cannot be made of this mesh: " + failure;
    throw_on_all_ranks<InputError>(failure, setup.communicator);

    if (position == nullptr || node_set.size() == 0)
      find_node_set(rows_of_cells, setup.nodes->dof_handler().n_dofs());
    arrange(rows_of_cells, first_node);
    if (!can_move)
      surroundings.reset();
  }

  template <int dim>
  void SmoothedGradients<dim>::find_node_set(const std::vector<SmoothedRow<dim>> &rows_of_cells,
                                             const types::global_dof_index n_nodes)
  {
    // Single indices out of order make the time of an IndexSet quadratic.
    std::vector<types::global_dof_index> required;
    for (const SmoothedRow<dim> &row : rows_of_cells)
      for (const auto &entry : row.entries)
        required.push_back(entry.first);
    for (const SmoothedCell<dim> &cell : surroundings->cells)
      required.insert(required.end(), cell.nodes.begin(), cell.nodes.end());
    const std::vector<bool> is_neighbour =
        can_move ? surroundings->reaches_cells() : std::vector<bool>();
    for (std::size_t k = 0; k < is_neighbour.size(); ++k)
      if (is_neighbour[k])
        required.push_back(surroundings->cloud.node[k]);
    std::sort(required.begin(), required.end());
    required.erase(std::unique(required.begin(), required.end()), required.end());
    node_set = IndexSet(n_nodes);
    node_set.add_indices(required.begin(), required.end());
    node_set.compress();
  }

  template <int dim>
  void SmoothedGradients<dim>::arrange(const std::vector<SmoothedRow<dim>> &rows_of_cells,
                                       const std::vector<types::global_dof_index> &first_node)
  {
    const unsigned int n_points = n_points_per_cell();
    const auto n_cells = static_cast<unsigned int>(first_node.size());
    const std::size_t n_rows = std::size_t(padded_to_lanes(n_cells)) * n_points;
    rows = Stencils();
    neighbour_nodes.clear();
    row_nodes.clear();
    point_volumes.assign(n_rows, 0.);
    rows.row_start.assign(1, 0);
    for (std::size_t row = 0; row < n_rows; ++row)
    {
      const auto lane = static_cast<unsigned int>(row % n_lanes);
      const auto q = static_cast<unsigned int>(row / n_lanes % n_points);
      // Unused lanes repeat the last cell.
      const auto cell = std::min(
          static_cast<unsigned int>(row / n_lanes / n_points) * n_lanes + lane, n_cells - 1);
      row_nodes.push_back(first_node[cell]);
      const SmoothedRow<dim> &found = rows_of_cells[std::size_t(cell) * n_points + q];
      point_volumes[row] = found.volume;
      for (const auto &entry : found.entries)
      {
        neighbour_nodes.push_back(entry.first);
        for (unsigned int d = 0; d < Stencils::n_gradient; ++d)
          rows.gradient.push_back(d < dim ? entry.second[d] : 0.);
      }
      rows.row_start.push_back(neighbour_nodes.size());
    }
    rows.gradient.push_back(0.);
    rows.coefficient_start.assign(rows.row_start.begin(), rows.row_start.end() - 1);
    rows.value.resize(neighbour_nodes.size());
    rows.neighbour.resize(neighbour_nodes.size());
    rows.particle_node.resize(row_nodes.size());
  }

  template <int dim>
  void SmoothedGradients<dim>::add_conduction(const CellBatches<dim> &cells,
                                              const TemperatureTable &conductivity,
                                              const NodalVector &position,
                                              const NodalVector &of_conductivity,
                                              const NodalVector &temperature,
                                              NodalVector &heat_rate) const
  {
    if (conductivity.largest() == 0.)
      return;
    const unsigned int n_points = n_points_per_cell();
    std::vector<double> at_points(std::size_t(n_points) * n_lanes);
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      interpolate_at_points(cells.nodes(batch), shares_of_points, of_conductivity,
                            at_points.data());
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
        {
          const unsigned int number = (batch * n_points + q) * n_lanes + lane;
          const double conducted =
              point_volumes[number] * conductivity.value(at_points[q * n_lanes + lane]);
          RowBlock::conduct<dim>(
              rows, number, false, position, temperature,
              [conducted](const double det) { return conducted * det; }, heat_rate);
        }
    }
  }

  template <int dim>
  void SmoothedGradients<dim>::find_couplings(const unsigned int n_cells,
                                              const NodeGroupAction &use) const
  {
    const unsigned int n_points = n_points_per_cell();
    std::vector<unsigned int> group;
    for (unsigned int cell = 0; cell < n_cells; ++cell)
    {
      group.clear();
      for (unsigned int q = 0; q < n_points; ++q)
      {
        const Stencils::Row row = rows.row(point_in_lanes(cell, n_points, q));
        group.insert(group.end(), row.neighbour, row.neighbour + row.size);
      }
      std::sort(group.begin(), group.end());
      group.erase(std::unique(group.begin(), group.end()), group.end());
      use(group);
    }
  }

  template <int dim>
  void SmoothedGradients<dim>::set_partition(const NodePartition &partition)
  {
    for (std::size_t k = 0; k < neighbour_nodes.size(); ++k)
      rows.neighbour[k] = partition.local_index(neighbour_nodes[k]);
    for (std::size_t row = 0; row < row_nodes.size(); ++row)
      rows.particle_node[row] = partition.local_index(row_nodes[row]);
  }

  template class SmoothedGradients<2>;
  template class SmoothedGradients<3>;
} // namespace tombolo
