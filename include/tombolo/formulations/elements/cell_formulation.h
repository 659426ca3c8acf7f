// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/formulations/elements/cell_conduction.h>
#include <tombolo/formulations/elements/cell_conversion.h>
#include <tombolo/formulations/elements/cell_integration.h>
#include <tombolo/formulations/elements/cell_points.h>
#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/elements/cell_stiffness.h>
#include <tombolo/formulations/elements/element.h>
#include <tombolo/formulations/elements/eroding_cells.h>
#include <tombolo/formulations/elements/erosion_criterion.h>
#include <tombolo/formulations/elements/losing_cells.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/point_stiffness.h>
#include <tombolo/state/records.h>

#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /** Calls @p use with each batch, its nodal positions and the times that longitudinal waves take
   * through its cells: their lengths over the wave speed, eq. (41) without its factor. */
  template <int dim, typename Element, typename Use>
  void for_crossing_times(const CellPoints<dim, Element> &points,
                          const CellIntegration<dim, Element> &integration,
                          const NodalVector &position, const Use &use)
  {
    using Points = CellPoints<dim, Element>;
    const PointStiffness stiffness(integration.material(), points.material_points(),
                                   StrainMeasure::rate);
    for (unsigned int batch = 0; batch < points.cells().n_batches(); ++batch)
    {
      typename Points::NodeValues x;
      Lanes volume[Points::n_points];
      integration.find_volumes(points, batch, position, x, volume);

      // Where the moduli are constant the density is not: c grows with √J.
      Lanes total = 0., largest_ratio = 0.;
      for (unsigned int q = 0; q < Points::n_points; ++q)
      {
        total += volume[q];
        largest_ratio =
            max(largest_ratio, stiffness.squared_speed(Points::first_point(batch) + q * n_lanes));
      }
      const Lanes time =
          characteristic_length<dim, Element::degree>(x, total) /
          (integration.material().longitudinal_wave_speed() * square_root(largest_ratio));
      use(batch, x, time);
    }
  }

  /** Formulation::courant_limits() of cells. */
  template <int dim, typename Element>
  void find_crossing_times(const CellPoints<dim, Element> &points,
                           const CellIntegration<dim, Element> &integration,
                           const NodalVector &position, std::vector<double> &time_steps)
  {
    constexpr double of_removed_cells = 1e300;
    const CellBatches<dim> &cells = points.cells();
    time_steps.assign(cells.n_cells(), of_removed_cells);
    for_crossing_times(points, integration, position,
                       [&](const unsigned int batch,
                           const typename CellPoints<dim, Element>::NodeValues &, const Lanes &time)
                       {
                         for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
                           time_steps[cells.cell_at(batch * n_lanes + lane)] = time[lane];
                       });
  }

  /** The places, ascending, of the cells that fulfil the criterion or whose volume is no longer
   * positive at these positions. Only if the criterion is on. */
  template <int dim, typename Element>
  std::vector<unsigned int> find_failed_places(const CellPoints<dim, Element> &points,
                                               const CellIntegration<dim, Element> &integration,
                                               const ErosionCriterion &erosion,
                                               const NodalVector &position)
  {
    using Points = CellPoints<dim, Element>;
    // A point with more than this part of its initial volume does not lose it in one stable step.
    constexpr double small_volume = 0.5;
    std::vector<unsigned int> failed_places;
    const double *const ratios =
        points.material_points().component(MaterialPoints::volume_ratio, 0);
    for (unsigned int batch = 0; batch < points.cells().n_batches(); ++batch)
    {
      const std::size_t first = Points::first_point(batch);
      Lanes ratio = load_lanes(ratios + first), reaches = 0.;
      for (unsigned int i = 0; i < Points::points_per_batch; i += n_lanes)
        ratio = min(ratio, load_lanes(ratios + first + i));
      for (const ErosionCriterion::Limit &limit : erosion.limits())
      {
        const double *const values = points.material_points().component(limit.field, 0) + first;
        Lanes mean = 0.;
        for (unsigned int i = 0; i < Points::points_per_batch; i += n_lanes)
          mean += load_lanes(values + i);
        mean /= double(Points::n_points);
        where(mean >= limit.value, reaches) = 1.;
      }
      if (all_of(reaches < 1. && ratio > small_volume))
        continue;
      for (unsigned int lane = 0; lane < points.cells().n_valid(batch); ++lane)
        if (reaches[lane] >= 1. ||
            (!(ratio[lane] > small_volume) &&
             !integration.is_volume_positive(points, batch * n_lanes + lane, position)))
          failed_places.push_back(batch * n_lanes + lane);
    }
    return failed_places;
  }

  /**
   * A part of finite elements: everything a Formulation does, for one element type (see
   * ElementDefaults for what an element is), in batches of n_lanes cells. The cells and their
   * material points are CellPoints, the stresses and their forces CellIntegration.
   */
  template <int dim, typename Element>
  class CellFormulation : public Formulation<dim>, public ErodingCells<dim>, public LosingCells<dim>
  {
  public:
    static void declare_parameters(dealii::ParameterHandler &handler)
    {
      CellIntegration<dim, Element>::declare_parameters(handler);
      declare<ErosionCriterion>(handler);
      declare<ConversionCriterion>(handler);
    }

    explicit CellFormulation(const Section &section)
        : LosingCells<dim>(section), integration(section), erosion(section)
    {}

    explicit CellFormulation(const Element &element) : integration(element) {}

    unsigned int degree() const override
    {
      return Element::degree;
    }

    MiddleNodes middle_nodes() const override
    {
      return MiddleNodes::means;
    }
    bool can_be_divided() const override
    {
      return true;
    }
    void find_volumes(const NodalVector &position, const std::vector<bool> &are_new) override;

    double cost_per_cell(const Material &material, const double /*box_ratio*/) const override
    {
      return StepCost::of_element(dim, Element::degree, Element::n_points, Element::cost_per_point,
                                  material);
    }

    void initialize(const PartSetup<dim> &setup) override;

    dealii::IndexSet required_nodes() const override
    {
      return cell_points.cells().required_nodes();
    }

    void set_partition(const NodePartition &partition) override
    {
      cell_points.set_partition(partition);
    }

    void add_mass(NodalVector &mass) const override
    {
      cell_points.cells().add_mass(mass);
    }

    void add_internal_force(const MechanicalInput &input, NodalVector &force) override
    {
      integration.add_internal_force(input, cell_points, force);
    }

    std::string failure() const override
    {
      return integration.failure();
    }

    void apply_elastic_stiffness(const NodalVector &position, const NodalVector &velocity,
                                 const double time_step, NodalVector &force) const override
    {
      integration.apply_elastic_stiffness(cell_points, position, velocity, time_step, force);
    }

    void find_cell_equations(const MechanicalInput &input,
                             const std::function<void(const CellEquations &)> &take) override
    {
      const auto stiffness =
          std::make_unique<CellStiffness<dim, Element>>(integration, cell_points, input);
      stiffness->find(take);
    }

    std::optional<std::string> unfit_to_linearize() const override
    {
      return CellStiffness<dim, Element>::unfit_to_linearize(integration);
    }

    void courant_limits(const NodalVector &position, std::vector<double> &time_steps) const override
    {
      find_crossing_times(cell_points, integration, position, time_steps);
    }

    void add_extra_mass(const std::vector<double> &inertia, NodalVector &mass) const override
    {
      cell_points.cells().add_extra_mass(inertia, mass);
    }

    EnergyAccounts energies() const override;

    void add_conduction(const NodalVector &position, const NodalVector &of_conductivity,
                        const NodalVector &temperature, NodalVector &heat_rate) const override
    {
      Assert(thermal_properties != nullptr, dealii::ExcInternalError());
      add_conduction_of_cells(cell_points, *thermal_properties, position, of_conductivity,
                              temperature, heat_rate);
    }

    StepLimit diffusion_limit(const NodalVector &position) const override
    {
      return diffusion_limit_of_cells(
          cell_points.cells(), thermal_properties->largest_diffusivity() / material().density(),
          position);
    }

    void add_plastic_heat(NodalVector &heat) override
    {
      integration.add_plastic_heat(cell_points, heat);
    }

    double pending_plastic_heat() const override
    {
      return integration.heating().pending(points());
    }

    void point_positions(const NodalVector &position,
                         std::vector<dealii::Point<dim>> &positions) const override
    {
      cell_points.find_positions(position, positions);
    }

    const std::vector<dealii::Point<dim>> &initial_point_positions() const override
    {
      return cell_points.initial_positions();
    }

    const MaterialPoints &points() const override
    {
      return cell_points.material_points();
    }
    MaterialPoints &points() override
    {
      return cell_points.material_points();
    }
    const Material &material() const override
    {
      return integration.material();
    }

    unsigned int n_cells() const override
    {
      return cell_points.cells().n_cells();
    }
    unsigned int n_points_per_cell() const override
    {
      return has_points ? Element::n_points : 0;
    }
    unsigned int point_of_cell(const unsigned int cell, const unsigned int q) const override
    {
      return Points::point_at(cell_points.cells().place(cell), q);
    }

    void list(Records &records) override;

    bool erodes() const override
    {
      return erosion.is_on();
    }

    unsigned int find_failed_cells(const NodalVector &position) override
    {
      failed_places = find_failed_places(cell_points, integration, erosion, position);
      return static_cast<unsigned int>(failed_places.size());
    }

    RemovedCells remove_failed_cells(const NodalVector &position, const NodalVector &velocity,
                                     double time_increment) override;

    bool is_removed(const unsigned int cell) const override
    {
      return lost_cells.is_lost(cell);
    }
    bool can_lose_cells() const override
    {
      return erosion.is_on() || criterion.is_on();
    }
    unsigned int n_removed_cells() const override
    {
      return n_cells() - cell_points.cells().n_present_cells() - this->n_converted_cells();
    }
    void add_nodes_of_removed_cells(
        std::vector<std::vector<dealii::types::global_dof_index>> &nodes_of_cells) const override;

    std::vector<unsigned int> find_converting_cells(const NodalVector &position) const override;

    void add_state(const std::vector<unsigned int> &converted, StateTransfer &state) const override
    {
      add_state_of_cells(cell_points.cells(), points(), integration.heating(), material().density(),
                         cell_points.shape_values_at_points(), converted, state);
    }

    void deactivate_cells(const std::vector<unsigned int> &converted) override;

    std::vector<dealii::types::global_dof_index>
    nodes_of_cell(const unsigned int cell) const override
    {
      return cell_points.cells().nodes_of_cell(cell);
    }

  private:
    using Points = CellPoints<dim, Element>;

    Points cell_points;
    CellIntegration<dim, Element> integration;
    std::shared_ptr<const ThermalProperties> thermal_properties;
    ErosionCriterion erosion;
    bool has_points = true;
    std::vector<unsigned int> failed_places; // of find_failed_cells(), ascending
    using LosingCells<dim>::criterion;
    using LosingCells<dim>::lost_cells;
  };

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::initialize(const PartSetup<dim> &setup)
  {
    thermal_properties = setup.heat;
    has_points = setup.has_mechanics;
    cell_points.take_cells(setup, can_lose_cells());
    integration.create_points(setup, cell_points);
    erosion.initialize(points(), has_points);
    criterion.initialize(points(), has_points);
    if (has_points)
      integration.set_initial_state(cell_points);
    cell_points.release_initial_node_positions();
    if (!has_points)
      return;

    const std::vector<std::string> failures =
        texts_of_ranks(setup.communicator, integration.failure());
    for (const std::string &failure : failures)
      if (!failure.empty())
        throw InputError("The part \"" + setup.name + "\" cannot be made of this mesh: " + failure);
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::find_volumes(const NodalVector &position,
                                                   const std::vector<bool> &are_new)
  {
    typename CellIntegration<dim, Element>::NodeValues x;
    Lanes volume[Element::n_points];
    for (unsigned int batch = 0; batch < cell_points.cells().n_batches(); ++batch)
    {
      integration.find_volumes(cell_points, batch, position, x, volume);
      LogarithmicPoints::take_volumes(points(), CellPoints<dim, Element>::first_point(batch),
                                      volume, integration.shares_volume(), are_new);
    }
  }

  template <int dim, typename Element>
  EnergyAccounts CellFormulation<dim, Element>::energies() const
  {
    EnergyAccounts result = integration.energies(cell_points);
    if (thermal_properties)
      result.add("thermal work", EnergyKind::external,
                 integral_over_initial_volume(points(), "thermal work"));
    result.add(lost_cells.dissipated());
    return result;
  }

  template <int dim, typename Element>
  RemovedCells CellFormulation<dim, Element>::remove_failed_cells(const NodalVector &position,
                                                                  const NodalVector &velocity,
                                                                  const double time_increment)
  {
    RemovedCells result;
    if (failed_places.empty())
      return result;
    const EnergyAccounts before = energies();
    const double pending_before = pending_plastic_heat();
    double power = 0;
    for (const unsigned int place : failed_places)
      power += integration.internal_power(cell_points, place, position, velocity, time_increment);

    std::vector<unsigned int> failed_cells;
    for (const unsigned int place : failed_places)
      failed_cells.push_back(cell_points.cells().cell_at(place));
    result.n_cells = static_cast<unsigned int>(failed_cells.size());
    failed_places.clear();
    lost_cells.remove(failed_cells, n_cells());
    cell_points.remove(lost_cells.flags());

    EnergyAccounts lost = before;
    lost.add(energies(), -1.);
    this->keep_dissipated(lost);
    result.energy = lost.sum_of(EnergyKind::stored) + 0.5 * time_increment * power;
    result.pending_heat = pending_before - pending_plastic_heat();
    return result;
  }

  template <int dim, typename Element>
  std::vector<unsigned int>
  CellFormulation<dim, Element>::find_converting_cells(const NodalVector &position) const
  {
    const CellBatches<dim> &cells = cell_points.cells();
    std::vector<bool> converts(cells.n_present_cells(), false);
    mark_by_points(criterion, points(), Element::n_points, converts);
    mark_by_shape(criterion, cells, Element::degree, position, converts);
    if (criterion.time_step())
      for_crossing_times(
          cell_points, integration, position,
          [&](const unsigned int batch, const typename Points::NodeValues &, const Lanes &time)
          {
            for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
              if (!(time[lane] >= *criterion.time_step()))
                converts[batch * n_lanes + lane] = true;
          });
    return cells_at(cells, converts);
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::deactivate_cells(const std::vector<unsigned int> &converted)
  {
    if (converted.empty())
      return;
    lost_cells.convert(converted, n_cells());
    cell_points.remove(lost_cells.flags());
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::add_nodes_of_removed_cells(
      std::vector<std::vector<dealii::types::global_dof_index>> &nodes_of_cells) const
  {
    for (unsigned int cell = 0; cell < n_cells(); ++cell)
      if (lost_cells.is_lost(cell) && !lost_cells.is_converted(cell))
        nodes_of_cells.push_back(nodes_of_cell(cell));
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::list(Records &records)
  {
    if (!can_lose_cells())
      return;
    records.archived(
        [this](StateArchive &archive)
        {
          if (lost_cells.serialize(n_cells(), thermal_properties != nullptr, archive))
            cell_points.remove(lost_cells.flags());
        });
  }
} // namespace tombolo
