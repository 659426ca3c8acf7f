// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/exceptions.h>
#include <tombolo/formulations/elements/cell_integration.h>
#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/elements/cell_stiffness.h>
#include <tombolo/formulations/elements/element.h>
#include <tombolo/formulations/elements/eroding_cells.h>
#include <tombolo/formulations/elements/losing_cells.h>
#include <tombolo/formulations/point_stiffness.h>
#include <tombolo/state/records.h>

#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * A part of finite elements: everything a Formulation does, for one element type (see
   * ElementDefaults for what an element is), in batches of n_lanes cells. The cells and their
   * material points are CellPoints, the forces of their stresses CellIntegration.
   */
  template <int dim, typename Element>
  class CellFormulation
      : public LosingCells<dim, CellPoints<dim, Element>, CellIntegration<dim, Element>>,
        public ErodingCells<dim>
  {
  public:
    static void declare_parameters(dealii::ParameterHandler &handler)
    {
      Element::declare_parameters(handler);
      declare<PartPoints>(handler, Element::measure);
      declare<ErosionCriterion>(handler);
      declare<ConversionCriterion>(handler);
    }

    explicit CellFormulation(const Section &section) : Base(section), erosion(section) {}

    unsigned int degree() const override
    {
      return Element::degree;
    }

    MiddleNodes middle_nodes() const override
    {
      return MiddleNodes::means;
    }
    double cost_per_cell(const Material &material, const double /*box_ratio*/) const override
    {
      return StepCost::of_element(dim, Element::degree, Element::n_points, Element::cost_per_point,
                                  material);
    }

    void initialize(const PartSetup<dim> &setup) override;

    void courant_limits(const NodalVector &position,
                        std::vector<double> &time_steps) const override;

    EnergyAccounts energies() const override;

    void add_conduction(const NodalVector &position, const NodalVector &of_conductivity,
                        const NodalVector &temperature, NodalVector &heat_rate) const override
    {
      Assert(part_points.heat() != nullptr, dealii::ExcInternalError());
      add_conduction_of_cells(cell_points, *part_points.heat(), position, of_conductivity,
                              temperature, heat_rate);
    }

    void list(Records &records) override;

    bool erodes() const override
    {
      return erosion.is_on();
    }

    unsigned int find_failed_cells(const NodalVector &position) override;

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
      return this->n_cells() - cell_points.cells().n_present_cells() - this->n_converted_cells();
    }
    void add_nodes_of_removed_cells(
        std::vector<std::vector<dealii::types::global_dof_index>> &nodes_of_cells) const override;

    void deactivate_cells(const std::vector<unsigned int> &converted) override;

  private:
    using Points = CellPoints<dim, Element>;
    using Base = LosingCells<dim, Points, CellIntegration<dim, Element>>;
    using Base::cell_points, Base::criterion, Base::integration, Base::lost_cells,
        Base::part_points, Base::points;

    ErosionCriterion erosion;
    std::vector<unsigned int> failed_places; // of find_failed_cells(), ascending
  };

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::initialize(const PartSetup<dim> &setup)
  {
    part_points.initialize(setup.material, setup.heat, setup.has_mechanics);
    cell_points.take_cells(setup, Element::degree, Element::lumping, can_lose_cells());
    if (setup.has_mechanics)
    {
      std::vector<std::vector<double>> shape_values;
      for (const dealii::Point<dim> &point : Element::reference_points())
        shape_values.push_back(lagrange_values<dim>(Element::degree, point));
      AssertDimension(shape_values.size(), Element::n_points);
      cell_points.create_points(shape_values, cell_points.cells().n_batches_of_places());
    }
    integration.create_points();
    erosion.initialize(points(), setup.has_mechanics);
    criterion.initialize(points(), setup.has_mechanics);
    if (setup.has_mechanics)
      integration.set_initial_state();
    cell_points.release_initial_node_positions();
    if (!setup.has_mechanics)
      return;

    const std::vector<std::string> failures =
        texts_of_ranks(setup.communicator, integration.failure());
    for (const std::string &failure : failures)
      if (!failure.empty())
        throw InputError("The part \"" + setup.name + "\" cannot be made of this mesh: " + failure);
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::courant_limits(const NodalVector &position,
                                                     std::vector<double> &time_steps) const
  {
    constexpr double of_removed_cells = 1e300;
    const CellBatches<dim> &cells = cell_points.cells();
    time_steps.assign(this->n_cells(), of_removed_cells);
    const PointStiffness stiffness(part_points);
    for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
    {
      typename Points::NodeValues x;
      Lanes volume[Element::n_points];
      integration.find_volumes(batch, position, x, volume);
      Lanes total = 0.;
      for (const Lanes &of_point : volume)
        total += of_point;
      const Lanes time =
          characteristic_length<dim, Element::degree>(x, total) /
          (this->material().longitudinal_wave_speed() *
           square_root(stiffness.squared_speed(Points::first_point(batch), Element::n_points)));
      for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
        time_steps[cells.cell_at(batch * n_lanes + lane)] = time[lane];
    }
  }

  template <int dim, typename Element>
  EnergyAccounts CellFormulation<dim, Element>::energies() const
  {
    EnergyAccounts result = Base::energies();
    integration.add_energies(result);
    return result;
  }

  template <int dim, typename Element>
  unsigned int CellFormulation<dim, Element>::find_failed_cells(const NodalVector &position)
  {
    // A point with more than this part of its initial volume does not lose it in one stable step.
    constexpr double small_volume = 0.5;
    const double *const ratios = points().component(MaterialPoints::volume_ratio, 0);
    failed_places.clear();
    for (unsigned int place = 0; place < cell_points.cells().n_present_cells(); ++place)
    {
      bool is_large = true;
      for (unsigned int q = 0; q < Element::n_points; ++q)
        is_large = is_large && ratios[Points::point_at(place, q)] > small_volume;
      if (erosion.means().are_reached(points(), place, Element::n_points) ||
          (!is_large && !integration.is_volume_positive(place, position)))
        failed_places.push_back(place);
    }
    return static_cast<unsigned int>(failed_places.size());
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
    const double pending_before = this->pending_plastic_heat();
    double power = 0;
    for (const unsigned int place : failed_places)
      power += integration.internal_power(place, position, velocity, time_increment);

    std::vector<unsigned int> failed_cells;
    for (const unsigned int place : failed_places)
      failed_cells.push_back(cell_points.cells().cell_at(place));
    result.n_cells = static_cast<unsigned int>(failed_cells.size());
    failed_places.clear();
    lost_cells.remove(failed_cells, this->n_cells());
    cell_points.remove(lost_cells.flags(), points());

    EnergyAccounts lost = before;
    lost.add(energies(), -1.);
    this->keep_dissipated(lost);
    result.energy = lost.sum_of(EnergyKind::stored) + 0.5 * time_increment * power;
    result.pending_heat = pending_before - this->pending_plastic_heat();
    return result;
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::deactivate_cells(const std::vector<unsigned int> &converted)
  {
    if (converted.empty())
      return;
    lost_cells.convert(converted, this->n_cells());
    cell_points.remove(lost_cells.flags(), points());
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::add_nodes_of_removed_cells(
      std::vector<std::vector<dealii::types::global_dof_index>> &nodes_of_cells) const
  {
    for (unsigned int cell = 0; cell < this->n_cells(); ++cell)
      if (lost_cells.is_lost(cell) && !lost_cells.is_converted(cell))
        nodes_of_cells.push_back(this->nodes_of_cell(cell));
  }

  template <int dim, typename Element>
  void CellFormulation<dim, Element>::list(Records &records)
  {
    if (!can_lose_cells())
      return;
    records.archived(
        [this](StateArchive &archive)
        {
          if (lost_cells.serialize(this->n_cells(), part_points.heat() != nullptr, archive))
            cell_points.remove(lost_cells.flags(), points());
        });
  }
} // namespace tombolo
