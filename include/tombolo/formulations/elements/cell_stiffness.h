// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>

#include <tombolo/formulations/elements/cell_integration.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/linearized_points.h>

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

    /** Advances the temperature of @p points and whatever the material remembers. */
    CellStiffness(Integration &integration, const MechanicalInput &input)
        : integration(integration), points(integration.points), input(input),
          linearized(integration.part, input.time_increment)
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

    /** Takes the state of a batch at the start of the step, and its motion. */
    void begin(unsigned int batch);
    void find_motion(Motion &motion) const;
    void update_stress(unsigned int batch);
    /** The internal forces of @p changed, whose stress follows by the tangent. */
    void find_force(Motion &changed, NodeValues &force);
    void find_columns();
    void hand_over(unsigned int batch, const std::function<void(const CellEquations &)> &take);

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
  void CellStiffness<dim, Element>::begin(const unsigned int batch)
  {
    first = Points::first_point(batch);
    points.gather(batch, *input.position, x);
    points.gather(batch, *input.velocity, v);
    linearized.begin(first);
    find_motion(motion);
  }

  template <int dim, typename Element>
  void CellStiffness<dim, Element>::find_motion(Motion &result) const
  {
    Matrix3<Lanes> gradient[n_points];
    integration.element.evaluate(x, v, result.work, result.volume, gradient);
    integration.element.separate(result.work, gradient);
    for (Matrix3<Lanes> &of_point : gradient)
      for (Lanes &entry : of_point.entry)
        entry *= input.time_increment;
    linearized.move(
        gradient, Element::shares_volume,
        [&](MotionIncrement<Lanes>(&motions)[n_points])
        { integration.share(result.work, motions); },
        result);
  }

  template <int dim, typename Element>
  void CellStiffness<dim, Element>::update_stress(const unsigned int batch)
  {
    MaterialPoints &material_points = integration.part.points();
    alignas(64) double plastic_strain[points_per_batch];
    alignas(64) double nodal_temperature[points_per_batch];
    if (integration.part.heating().is_on())
      points.interpolate(batch, *input.temperature, nodal_temperature);
    const bool limits_forces = Element::limits_forces && integration.plastic_flow.is_possible();
    if (limits_forces)
      integration.plastic_flow.keep(material_points, first, points_per_batch, plastic_strain);
    linearized.update(motion, nodal_temperature);

    for (unsigned int q = 0; q < n_points; ++q)
    {
      for (unsigned int c = 0; c < 6; ++c)
      {
        const Lanes &stress = linearized.stress[q][c];
        store_lanes(linearized.is_logarithmic() ? stress / motion.volume_ratio[q] : stress,
                    material_points.component(MaterialPoints::stress, c) + first + q * n_lanes);
      }
      flow_stress[q] = 0.;
      if (limits_forces)
        flow_stress[q] = integration.plastic_flow.stress(material_points, first + q * n_lanes,
                                                         plastic_strain + q * n_lanes);
    }
  }

  template <int dim, typename Element>
  void CellStiffness<dim, Element>::find_force(Motion &changed, NodeValues &force)
  {
    Lanes integrated[n_points][6];
    linearized.integrate(motion, changed, integrated);
    const std::vector<double *> own = integration.copy_variables(first, variables);
    integration.element.advance(changed.work, changed.spin, input.time_increment, own.data());
    if (Element::limits_forces && integration.plastic_flow.is_possible())
      integration.element.limit(changed.work, flow_stress, own.data());
    integration.element.integrate(changed.work, integrated, force);
  }

  template <int dim, typename Element>
  void CellStiffness<dim, Element>::find_columns()
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
        const Lanes moved = x[k][d] - position; // what is left of it after round-off
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

  template <int dim, typename Element>
  void
  CellStiffness<dim, Element>::hand_over(const unsigned int batch,
                                         const std::function<void(const CellEquations &)> &take)
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

  template <int dim, typename Element>
  void CellIntegration<dim, Element>::find_cell_equations(
      const MechanicalInput &input, const std::function<void(const CellEquations &)> &take)
  {
    std::make_unique<CellStiffness<dim, Element>>(*this, input)->find(take);
  }
} // namespace tombolo
