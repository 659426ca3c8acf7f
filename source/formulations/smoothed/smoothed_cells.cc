// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/smoothed_cells.h>

#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/smoothed/smoothed_conduction.h>
#include <tombolo/formulations/smoothed/smoothed_limits.h>
#include <tombolo/formulations/smoothed/smoothed_stiffness.h>
#include <tombolo/formulations/step_cost.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void SmoothedCells<dim>::declare_parameters(ParameterHandler &handler)
  {
    SmoothedGradients<dim>::declare_parameters(handler);
    SmoothedIntegration<dim>::declare_parameters(handler);
    RefillSettings::declare_parameters<dim>(handler);
    ConversionCriterion::declare_parameters(handler);
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
  void SmoothedCells<dim>::add_internal_force(const MechanicalInput &input, NodalVector &force)
  {
    integration.add_internal_force(input, force);
  }

  template <int dim>
  void SmoothedCells<dim>::apply_elastic_stiffness(const NodalVector &position,
                                                   const NodalVector &velocity,
                                                   const double time_step, NodalVector &force) const
  {
    integration.apply_elastic_stiffness(position, velocity, time_step, force);
  }

  template <int dim>
  void
  SmoothedCells<dim>::find_cell_equations(const MechanicalInput &input,
                                          const std::function<void(const CellEquations &)> &take)
  {
    find_smoothed_equations(rows, cells, integration.row_material(), input, take);
  }

  template <int dim>
  void SmoothedCells<dim>::find_couplings(const NodeGroupAction &use) const
  {
    find_smoothed_couplings(rows, n_cells(), use);
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
  void SmoothedCells<dim>::add_conduction(const NodalVector &position,
                                          const NodalVector &of_conductivity,
                                          const NodalVector &temperature,
                                          NodalVector &heat_rate) const
  {
    add_smoothed_conduction(rows, cells, heat->conductivity(), position, of_conductivity,
                            temperature, heat_rate);
  }

  template <int dim>
  StepLimit SmoothedCells<dim>::diffusion_limit(const NodalVector &position) const
  {
    return smoothed_diffusion_limit(cells, heat->largest_diffusivity() / material().density(),
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

  template <int dim>
  const std::vector<Point<dim>> &SmoothedCells<dim>::initial_point_positions() const
  {
    return initial_points;
  }

  template <int dim>
  const MaterialPoints &SmoothedCells<dim>::points() const
  {
    return integration.points();
  }

  template <int dim>
  MaterialPoints &SmoothedCells<dim>::points()
  {
    return integration.points();
  }

  template <int dim>
  unsigned int SmoothedCells<dim>::n_points_per_cell() const
  {
    return has_points ? rows.n_points_per_cell() : 0;
  }

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Formulation, SmoothedCells, "smoothed cells",
      "element-free Galerkin cells of degree 1: convex approximation with smoothed gradients")
} // namespace tombolo
