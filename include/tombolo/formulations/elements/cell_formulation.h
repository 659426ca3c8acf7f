// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/formulations/elements/cell_integration.h>
#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/elements/element.h>
#include <tombolo/formulations/elements/eroding_cells.h>
#include <tombolo/formulations/elements/grouped_cells.h>
#include <tombolo/formulations/linearized_points.h>
#include <tombolo/state/records.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The consistent tangent of the forces of CellIntegration, cell by cell: the motion (gradients,
   * rotation, volumes, logarithmic strains, shared dilatation, hourglass forces and their limit) is
   * changed by difference quotients of the element's own functions, and the stress follows by the
   * tangent of the material. So it is that of the algorithm for every element and both measures of
   * strain, to the digits of a difference quotient, and costs dim times as many evaluations of the
   * element as it has nodes, but one of the material.
   */
  template <int dim, typename Element>
  class CellStiffness
  {
  public:
    using Integration = CellIntegration<dim, Element>;
    using Points = CellPoints<dim, Element>;

    /** Advances the temperature of @p points and the variables of the material. */
    CellStiffness(Integration &integration, const MechanicalInput &input)
        : integration(integration), points(integration.cell_points), input(input),
          linearized(integration.part_points, input.time_increment)
    {}

    void find(const std::function<void(const CellEquations &)> &take)
    {
      for (unsigned int batch = 0; batch < points.cells().n_batches(); ++batch)
      {
        begin(batch);
        update_stress(batch);
        find_columns();
        hand_over(batch, take);
      }
    }

  private:
    using NodeValues = typename Points::NodeValues;
    static constexpr unsigned int n_nodes = Points::n_nodes;
    static constexpr unsigned int n_points = Points::n_points;
    static constexpr unsigned int points_per_batch = Points::points_per_batch;
    static constexpr unsigned int n_rows = n_nodes * dim;

    struct Motion : LinearizedPoints<n_points>::Motion
    {
      typename Element::Work work;
    };

    /** Reads the state of a batch at the start of the step, and its motion. */
    void begin(const unsigned int batch)
    {
      first = Points::first_point(batch);
      points.gather(batch, *input.position, x);
      points.gather(batch, *input.velocity, v);
      linearized.begin(first);
      find_motion(motion);
    }

    void find_motion(Motion &result) const
    {
      Matrix3<Lanes> gradient[n_points];
      integration.element.evaluate(x, v, result.work, result.volume, gradient);
      integration.element.separate(result.work, gradient);
      for (Matrix3<Lanes> &point_gradient : gradient)
        for (Lanes &entry : point_gradient.entry)
          entry *= input.time_increment;
      linearized.move(
          gradient, Element::shares_volume,
          [&](MotionIncrement<Lanes>(&motions)[n_points])
          { integration.share(result.work, motions); },
          result);
    }

    void update_stress(const unsigned int batch)
    {
      MaterialPoints &material_points = integration.part_points.points();
      alignas(64) double plastic_strain[points_per_batch];
      alignas(64) double nodal_temperature[points_per_batch];
      if (integration.part_points.heating().is_on())
        points.interpolate(batch, *input.temperature, nodal_temperature);
      const bool limits_forces = Element::limits_forces && integration.plastic_flow.is_possible();
      if (limits_forces)
        integration.plastic_flow.keep(material_points, first, points_per_batch, plastic_strain);
      linearized.update(motion, nodal_temperature);

      for (unsigned int q = 0; q < n_points; ++q)
      {
        for (unsigned int c = 0; c < 6; ++c)
          store_lanes(linearized.stress[q][c] / motion.volume_ratio[q],
                      material_points.component(MaterialPoints::stress, c) + first + q * n_lanes);
        flow_stress[q] = 0.;
        if (limits_forces)
          flow_stress[q] = integration.plastic_flow.stress(material_points, first + q * n_lanes,
                                                           plastic_strain + q * n_lanes);
      }
    }

    /** The internal forces of @p changed, whose stress follows by the tangent. */
    void find_force(Motion &changed, NodeValues &force)
    {
      Lanes integrated[n_points][6];
      linearized.integrate(motion, changed, integrated);
      const std::vector<double *> own = integration.copy_variables(first, variables);
      integration.element.advance(changed.work, changed.spin, input.time_increment, own.data());
      if (Element::limits_forces && integration.plastic_flow.is_possible())
        integration.element.limit(changed.work, flow_stress, own.data());
      integration.element.integrate(changed.work, integrated, force);
    }

    void find_columns()
    {
      Motion changed = motion;
      NodeValues force;
      find_force(changed, base_force);
      Lanes volume = 0.;
      for (unsigned int q = 0; q < n_points; ++q)
        volume += motion.volume[q];
      const Lanes change([&](const auto lane)
                         { return 1e-7 * std::pow(std::abs(volume[lane]) + 1e-300, 1. / dim); });
      for (unsigned int k = 0; k < n_nodes; ++k)
        for (unsigned int d = 0; d < dim; ++d)
        {
          const Lanes position = x[k][d], velocity = v[k][d];
          x[k][d] = position + change;
          const Lanes moved = x[k][d] - position; // the change after round-off
          v[k][d] = velocity + moved / input.time_increment;
          find_motion(changed);
          find_force(changed, force);
          x[k][d] = position;
          v[k][d] = velocity;
          for (unsigned int j = 0; j < n_nodes; ++j)
            for (unsigned int e = 0; e < dim; ++e)
              matrix[dim * j + e][dim * k + d] = (force[j][e] - base_force[j][e]) / moved;
        }
    }

    void hand_over(const unsigned int batch, const std::function<void(const CellEquations &)> &take)
    {
      CellEquations equations;
      equations.nodes.resize(n_nodes);
      equations.matrix.resize(n_rows * n_rows);
      equations.force.resize(n_rows);
      for (unsigned int lane = 0; lane < points.cells().n_valid(batch); ++lane)
      {
        for (unsigned int k = 0; k < n_nodes; ++k)
        {
          equations.nodes[k] = points.cells().nodes(batch)[k * n_lanes + lane];
          for (unsigned int d = 0; d < dim; ++d)
            equations.force[dim * k + d] = base_force[k][d][lane];
        }
        for (unsigned int row = 0; row < n_rows; ++row)
          for (unsigned int column = 0; column < n_rows; ++column)
            equations.matrix[row * n_rows + column] = matrix[row][column][lane];
        take(equations);
      }
    }

    Integration &integration;
    const Points &points;
    const MechanicalInput &input;

    // Of the batch at hand.
    std::size_t first = 0;
    NodeValues x, v;
    LinearizedPoints<n_points> linearized;
    Motion motion;
    Lanes flow_stress[n_points];
    dealii::AlignedVector<double> variables; ///< of the element, scratch
    Lanes base_force[n_nodes][dim];
    Lanes matrix[n_rows][n_rows];
  };

  template <int dim, typename Element>
  void CellIntegration<dim, Element>::find_cell_equations(
      const MechanicalInput &input, const std::function<void(const CellEquations &)> &take)
  {
    std::make_unique<CellStiffness<dim, Element>>(*this, input)->find(take);
  }

  /** A part of finite elements: everything a Formulation does, for one element type (see
   * ElementDefaults for what an element is), in batches of n_lanes cells. */
  template <int dim, typename Element>
  class CellFormulation : public CellIntegration<dim, Element>,
                          public ErodingCells<dim>,
                          public GroupedCells<dim>
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
    StepCost step_cost(const Material &material, const double /*box_ratio*/) const override
    {
      return StepCosts::element_cost(dim, Element::degree, Element::n_points,
                                     Element::cost_per_point, material);
    }

    void initialize(const PartSetup<dim> &setup) override
    {
      part_points.initialize(setup.material, setup.heat, setup.has_mechanics);
      cell_points.set_cells(setup, Element::degree, Element::lumping,
                            can_lose_cells() || is_to_be_grouped,
                            is_to_be_grouped ? GroupedCells<dim>::most_groups : 2);
      if (setup.has_mechanics)
      {
        std::vector<std::vector<double>> shape_values;
        for (const dealii::Point<dim> &point : Element::reference_points())
          shape_values.push_back(lagrange_values<dim>(Element::degree, point));
        AssertDimension(shape_values.size(), Element::n_points);
        cell_points.create_points(shape_values, cell_points.cells().n_batches_of_slots());
      }
      this->create_points();
      erosion.initialize(points(), setup.has_mechanics);
      criterion.initialize(points(), setup.has_mechanics);
      if (setup.has_mechanics)
        this->set_initial_state();
      cell_points.cells().release_initial_positions();
      if (!setup.has_mechanics)
        return;

      std::string failure = this->failure();
      if (!failure.empty())
        failure = "The part \"" + setup.name + "\" cannot be made of this mesh: " + failure;
      throw_on_all_ranks<InputError>(failure, setup.communicator);
    }

    void courant_limits(const NodalVector &position, std::vector<double> &time_steps) const override
    {
      const auto length_of = [&](const unsigned int batch)
      {
        typename Points::NodeValues x;
        Lanes volume[Element::n_points];
        this->find_volumes(batch, position, x, volume);
        Lanes total = 0.;
        for (const Lanes &point_volume : volume)
          total += point_volume;
        return characteristic_length<dim, Element::degree>(x, total);
      };
      this->find_courant_limits(length_of, time_steps);
    }

    void add_conduction(const NodalVector &position, const NodalVector &conductivity_temperature,
                        const NodalVector &temperature, NodalVector &heat_rate) const override
    {
      Assert(part_points.heat() != nullptr, dealii::ExcInternalError());
      add_conduction_of_cells(cell_points, *part_points.heat(), position, conductivity_temperature,
                              temperature, heat_rate);
    }

    void list(Records &records) override
    {
      if (!can_lose_cells())
        return;
      records.archived(
          [this](StateArchive &archive)
          {
            if (lost_cells.serialize(this->n_cells(), part_points.heat() != nullptr, archive))
              remove_lost_cells();
          });
    }

    bool erodes() const override
    {
      return !erosion.empty();
    }

    std::vector<unsigned int> find_failed_cells(const NodalVector &position) const override
    {
      // A point with more than this part of its initial volume does not lose it in one stable step.
      constexpr double small_volume = 0.5;
      const CellBatches<dim> &cells = cell_points.cells();
      const double *const ratios = points().component(MaterialPoints::volume_ratio, 0);
      std::vector<unsigned int> failed;
      for (unsigned int batch = 0; batch < cells.n_batches(); ++batch)
      {
        unsigned int n_small[n_lanes] = {};
        for (unsigned int i = 0; i < Points::points_per_batch; ++i)
          n_small[i % n_lanes] += ratios[Points::first_point(batch) + i] > small_volume ? 0 : 1;
        const bool may_fail = erosion.may_be_reached(points(), batch, Element::n_points);
        for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
        {
          const bool is_small = n_small[lane] > 0;
          if (!is_small && !may_fail)
            continue;
          const unsigned int slot = batch * n_lanes + lane, cell = cells.cell_at(slot);
          // It could lose its volume before its next step.
          const bool is_late = !step_ratios.empty() && step_ratios[cell] > 1;
          if (erosion.are_reached(points(), slot, Element::n_points) ||
              (is_small && (is_late || !this->is_volume_positive(slot, position))))
            failed.push_back(cell);
        }
      }
      std::sort(failed.begin(), failed.end());
      return failed;
    }

    RemovedCells remove_cells(const std::vector<unsigned int> &failed, const NodalVector &position,
                              const NodalVector &velocity, const double time_increment) override
    {
      RemovedCells result;
      if (failed.empty())
        return result;
      const EnergyAccounts before = this->energies();
      const double pending_before = this->pending_plastic_heat();
      double power = 0;
      for (const unsigned int cell : failed)
        power += this->internal_power(cell_points.cells().slot_of(cell), position, velocity,
                                      time_increment);

      result.n_cells = static_cast<unsigned int>(failed.size());
      lost_cells.remove(failed, this->n_cells());
      remove_lost_cells();

      EnergyAccounts lost = before;
      lost.add(this->energies(), -1.);
      this->keep_dissipated(lost);
      result.energy = lost.sum_of(EnergyKind::stored) + 0.5 * time_increment * power;
      result.pending_heat = pending_before - this->pending_plastic_heat();
      return result;
    }

    bool is_removed(const unsigned int cell) const override
    {
      return lost_cells.is_lost(cell);
    }
    bool can_lose_cells() const override
    {
      return !erosion.empty() || criterion.is_on();
    }
    unsigned int n_removed_cells() const override
    {
      return this->n_cells() - cell_points.cells().n_present_cells() - this->n_converted_cells();
    }

    void add_nodes_of_removed_cells(
        std::vector<std::vector<dealii::types::global_dof_index>> &nodes_of_cells) const override
    {
      for (unsigned int cell = 0; cell < this->n_cells(); ++cell)
        if (lost_cells.is_lost(cell) && !lost_cells.is_converted(cell))
          nodes_of_cells.push_back(this->nodes_of_cell(cell));
    }

    void deactivate_cells(const std::vector<unsigned int> &converted) override
    {
      if (converted.empty())
        return;
      lost_cells.convert(converted, this->n_cells());
      remove_lost_cells();
    }

    void prepare_groups() override
    {
      is_to_be_grouped = true;
    }
    void set_step_ratios(const std::vector<unsigned int> &cell_ratios) override
    {
      step_ratios = cell_ratios;
      cell_points.group(step_ratios, points());
    }
    const std::vector<typename GroupedCells<dim>::Group> &groups() const override
    {
      return cell_points.cells().groups();
    }
    std::vector<unsigned int>
    nodes_of(const typename GroupedCells<dim>::Group &group) const override
    {
      const CellBatches<dim> &cells = cell_points.cells();
      std::vector<unsigned int> nodes;
      for (unsigned int batch = group.first_batch; batch < group.end_batch; ++batch)
        for (unsigned int k = 0; k < Points::n_nodes; ++k)
          for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
            nodes.push_back(cells.nodes(batch)[k * n_lanes + lane]);
      return nodes;
    }
    void add_force_of_group(const MechanicalInput &input,
                            const typename GroupedCells<dim>::Group &group,
                            NodalVector &force) override
    {
      this->add_internal_force(input, group, force);
    }
    void apply_stiffness_of_group(const NodalVector &position, const NodalVector &velocity,
                                  const double time_step,
                                  const typename GroupedCells<dim>::Group &group,
                                  NodalVector &force) const override
    {
      const double ratio = group.number;
      this->apply_elastic_stiffness(position, velocity, ratio * time_step, group, ratio * ratio,
                                    force);
    }

  private:
    using Points = CellPoints<dim, Element>;
    using Base = CellIntegration<dim, Element>;
    using Base::cell_points, Base::criterion, Base::lost_cells, Base::part_points, Base::points;

    void remove_lost_cells()
    {
      cell_points.remove(lost_cells.flags(), points());
      if (!step_ratios.empty())
        cell_points.group(step_ratios, points());
    }

    ErosionCriterion erosion;
    std::vector<unsigned int> step_ratios; // of cells; empty: one
    bool is_to_be_grouped = false;
  };
} // namespace tombolo
