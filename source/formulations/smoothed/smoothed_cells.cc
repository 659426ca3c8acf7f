// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_cells.h>

#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/formulations/elements/cell_conduction.h>
#include <tombolo/formulations/elements/cell_conversion.h>
#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/step_cost.h>
#include <tombolo/state/records.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** The initial positions of the points of cells, in batches, with the @p shares of the corners
     * of a cell in each of its points, [q][k]. While the cells know their initial positions. */
    template <int dim>
    std::vector<Point<dim>> initial_points_of(const CellBatches<dim> &cells,
                                              const std::vector<std::vector<double>> &shares)
    {
      const auto n_points = static_cast<unsigned int>(shares.size());
      std::vector<Point<dim>> result(std::size_t(padded_to_lanes(cells.n_cells())) * n_points);
      for (unsigned int cell = 0; cell < padded_to_lanes(cells.n_cells()); ++cell)
        for (unsigned int q = 0; q < n_points; ++q)
          for (unsigned int k = 0; k < shares[q].size(); ++k)
            for (unsigned int d = 0; d < dim; ++d)
              result[point_in_lanes(cell, n_points, q)][d] +=
                  shares[q][k] *
                  cells.initial_positions(cell / n_lanes)[(k * dim + d) * n_lanes + cell % n_lanes];
      return result;
    }
  } // namespace

  template <int dim>
  void SmoothedCells<dim>::declare_parameters(ParameterHandler &handler)
  {
    declare<SmoothedGradients<dim>>(handler);
    SmoothedIntegration<dim>::declare_parameters(handler);
    RefillSettings::declare_parameters<dim>(handler);
    declare<ConversionCriterion>(handler);
  }

  template <int dim>
  SmoothedCells<dim>::SmoothedCells(const Section &section)
      : LosingCells<dim>(section), rows(section), integration(section), refilled(section)
  {}

  template <int dim>
  double SmoothedCells<dim>::cost_per_cell(const Material &material,
                                           const double /*box_ratio*/) const
  {
    constexpr double cost_per_point = 60.; // of an element's, by the time of a step
    return StepCost::of_element(dim, 1, rows.n_points_per_cell(), cost_per_point, material);
  }

  template <int dim>
  void SmoothedCells<dim>::initialize(const PartSetup<dim> &setup)
  {
    heat = setup.heat;
    has_points = setup.has_mechanics;
    cells.reinit(setup, 1, MassLumping::row_sum, refill().is_on() || criterion.is_on());
    const PartSetup<dim> &with_void = refilled.initialize(setup, criterion);
    hanging_masses.initialize(with_void);
    if (refill().is_on())
      rows.prepare_positions();
    rows.initialize(with_void);
    initial_points.clear();
    if (has_points)
      initial_points = initial_points_of(cells, rows.corner_shares());
    if (void_cells().is_on())
    {
      take_void_cells();
      refilled.take_masses(cells);
    }
    integration.initialize(with_void, rows, cells);
    criterion.initialize(points(), has_points);
    cells.release_initial_positions();
  }

  template <int dim>
  IndexSet SmoothedCells<dim>::required_nodes() const
  {
    IndexSet nodes = rows.required_nodes();
    nodes.add_indices(cells.required_nodes());
    nodes.add_indices(hanging_masses.required_nodes());
    return nodes;
  }

  template <int dim>
  void SmoothedCells<dim>::set_partition(const NodePartition &partition)
  {
    cells.set_partition(partition);
    hanging_masses.set_partition(partition);
    rows.set_partition(partition);
  }

  template <int dim>
  void SmoothedCells<dim>::add_mass(NodalVector &mass) const
  {
    cells.add_mass(mass);
    hanging_masses.add_mass(mass);
  }

  template <int dim>
  void SmoothedCells<dim>::for_batches(
      const NodalVector &position,
      const std::function<void(unsigned int, const CellNodes &)> &use) const
  {
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      CellNodes x;
      for (unsigned int k = 0; k < n_corners; ++k)
        gather_nodes<dim>(position.data(), cells.nodes(batch) + k * n_lanes, x[k]);
      use(batch, x);
    }
  }

  template <int dim>
  void SmoothedCells<dim>::courant_limits(const NodalVector &position,
                                          std::vector<double> &time_steps) const
  {
    time_steps.assign(n_cells(), 1e300);
    const double *const volumes = points().component(MaterialPoints::volume, 0);
    for_batches(position,
                [&](const unsigned int batch, const CellNodes &x)
                {
                  Lanes total = 0.;
                  for (unsigned int q = 0; q < n_points_per_cell(); ++q)
                    total += load_lanes(volumes +
                                        (std::size_t(batch) * n_points_per_cell() + q) * n_lanes);
                  const Lanes time = characteristic_length<dim, 1>(x, total) /
                                     (material().longitudinal_wave_speed() *
                                      square_root(integration.squared_speed(batch)));
                  for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
                    time_steps[cells.cell_at(batch * n_lanes + lane)] = time[lane];
                });
  }

  template <int dim>
  void SmoothedCells<dim>::add_extra_mass(const std::vector<double> &inertia,
                                          NodalVector &mass) const
  {
    cells.add_extra_mass(inertia, mass);
    hanging_masses.add_extra_mass(inertia, mass);
  }

  template <int dim>
  EnergyAccounts SmoothedCells<dim>::energies() const
  {
    EnergyAccounts result = integration.energies();
    result.add(lost_cells.dissipated());
    return result;
  }

  template <int dim>
  StepLimit SmoothedCells<dim>::diffusion_limit(const NodalVector &position) const
  {
    return diffusion_limit_of_cells(cells, heat->largest_diffusivity() / material().density(),
                                    position);
  }

  template <int dim>
  void SmoothedCells<dim>::add_plastic_heat(NodalVector &to_nodes)
  {
    std::vector<double> of_cells;
    integration.add_plastic_heat(to_nodes, of_cells);
    hanging_masses.add_shares(of_cells, to_nodes);
  }

  template <int dim>
  void SmoothedCells<dim>::point_positions(const NodalVector &position,
                                           std::vector<Point<dim>> &positions) const
  {
    positions.assign(points().size(), Point<dim>());
    if (!has_points)
      return;
    for_batches(
        position,
        [&](const unsigned int batch, const CellNodes &x)
        {
          for (unsigned int q = 0; q < n_points_per_cell(); ++q)
            for (unsigned int lane = 0; lane < n_lanes; ++lane)
              for (unsigned int k = 0; k < n_corners; ++k)
                for (unsigned int d = 0; d < dim; ++d)
                  positions[(std::size_t(batch) * n_points_per_cell() + q) * n_lanes + lane][d] +=
                      rows.corner_shares()[q][k] * x[k][d][lane];
        });
  }

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Formulation, SmoothedCells, "smoothed cells",
      "element-free Galerkin cells of degree 1: convex approximation with smoothed gradients")

  template <int dim>
  std::vector<unsigned int> SmoothedCells<dim>::distorted_cells(const NodalVector &position) const
  {
    std::vector<unsigned int> result, points(n_points_per_cell());
    for (unsigned int cell = 0; cell < n_cells(); ++cell)
    {
      if (is_removed(cell))
        continue;
      for (unsigned int q = 0; q < points.size(); ++q)
        points[q] = point_of_cell(cell, q);
      if (refilled.is_distorted(rows.stencils(), points, position))
        result.push_back(cell);
    }
    return result;
  }

  template <int dim>
  void SmoothedCells<dim>::set_void_cells(const std::vector<bool> &is_void)
  {
    refilled.set_void_cells(is_void);
    take_void_cells();
  }

  template <int dim>
  void SmoothedCells<dim>::take_void_cells()
  {
    const unsigned int n_points = n_points_per_cell();
    const std::vector<unsigned int> from =
        remove_cells(void_cells().of_cells(), n_points, cells, integration.points());
    const std::vector<Point<dim>> old = initial_points;
    initial_points.assign(from.size() * n_points, Point<dim>());
    for (unsigned int cell = 0; cell < n_cells(); ++cell)
      for (unsigned int q = 0; q < n_points; ++q)
        initial_points[point_of_cell(cell, q)] = old[point_at(from[cells.place(cell)], q)];
  }

  template <int dim>
  std::vector<types::global_dof_index>
  SmoothedCells<dim>::nodes_of_cell(const unsigned int cell) const
  {
    return cells.nodes_of_cell(cell);
  }

  template <int dim>
  std::vector<double> SmoothedCells<dim>::masses_of_cells() const
  {
    std::vector<double> result;
    for (unsigned int cell = 0; cell < n_cells(); ++cell)
      for (unsigned int k = 0; k < n_corners; ++k)
        result.push_back(cells.mass_of_node(cell, k));
    return result;
  }

  template <int dim>
  void SmoothedCells<dim>::add_hanging_masses(NodalVector &mass) const
  {
    hanging_masses.add_mass(mass);
  }

  template <int dim>
  void SmoothedCells<dim>::set_masses(const std::vector<double> &of_cells)
  {
    cells.set_masses(of_cells);
  }

  template <int dim>
  void SmoothedCells<dim>::renew_reference(const NodalVector &position)
  {
    rows.initialize(refilled.setup(), &position);
    if (criterion.is_on())
      reference = position.copy();
  }

  template <int dim>
  std::vector<unsigned int>
  SmoothedCells<dim>::find_converting_cells(const NodalVector &position) const
  {
    std::vector<bool> converts(cells.n_present_cells(), false);
    mark_by_points(criterion, points(), n_points_per_cell(), converts);
    mark_by_shape(criterion, cells, 1, position, converts);
    std::vector<double> time_steps;
    if (criterion.time_step())
      courant_limits(position, time_steps);
    for (unsigned int place = 0; place < converts.size() && criterion.time_step(); ++place)
      if (!(time_steps[cells.cell_at(place)] >= *criterion.time_step()))
        converts[place] = true;
    return cells_at(cells, converts);
  }

  template <int dim>
  void SmoothedCells<dim>::add_state(const std::vector<unsigned int> &converted,
                                     StateTransfer &state) const
  {
    add_state_of_cells(cells, points(), integration.heating(), material().density(),
                       rows.corner_shares(), converted, state);
  }

  template <int dim>
  void SmoothedCells<dim>::take_converted_cells(const std::vector<unsigned int> &converted)
  {
    lost_cells.convert(converted, n_cells());
    set_void_cells(lost_cells.flags());
    refilled.take_masses(cells);
    // Functions of the cells that are left end where those are that have become particles.
    rows.initialize(refilled.setup(), reference.partition() != nullptr ? &reference : nullptr);
  }

  template <int dim>
  SmoothedPointState<dim> SmoothedCells<dim>::point_state()
  {
    return {integration.points(), integration.material().density(), integration.heating(), rows,
            cells};
  }

  template <int dim>
  void SmoothedCells<dim>::list(Records &records)
  {
    records.archived(
        [this](StateArchive &archive)
        {
          if (criterion.is_on())
            lost_cells.serialize(n_cells(), heat != nullptr, archive);
          if (!refill().is_on())
            return;
          std::vector<double> masses = masses_of_cells();
          archive.rows("mass of corners", n_corners, masses);
          if (archive.is_reading())
            cells.set_masses(masses);
        });
  }

  template class SmoothedCells<2>;
  template class SmoothedCells<3>;
} // namespace tombolo
