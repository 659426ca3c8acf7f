// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/elements/cell_points.h>
#include <tombolo/formulations/elements/element_modes.h>
#include <tombolo/formulations/elements/lagrange_hexahedron.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/materials/thermal_properties.h>

#include <algorithm>
#include <array>
#include <vector>

namespace tombolo
{
  /** Values and derivatives of the Lagrange polynomials of a degree at the points of a line rule:
   * two Gauss points for degree 1; for others the nodes themselves, as in LagrangeHexahedron. */
  template <unsigned int degree>
  struct ConductionLine
  {
    static constexpr unsigned int n = degree + 1;
    std::array<double, n> weights{};
    std::array<std::array<double, n>, n> value{};      ///< [point][polynomial]
    std::array<std::array<double, n>, n> derivative{}; ///< [point][polynomial]

    constexpr ConductionLine()
    {
      if constexpr (degree == 1)
      {
        constexpr double gauss_point = 0.57735026918962576451; // 1/√3
        for (unsigned int q = 0; q < 2; ++q)
          for (unsigned int m = 0; m < 2; ++m)
          {
            const double sign = m == 0 ? -1. : 1.;
            weights[q] = 1.;
            value[q][m] = 0.5 * (1. + sign * (q == 0 ? -gauss_point : gauss_point));
            derivative[q][m] = 0.5 * sign;
          }
      }
      else
      {
        const GaussLobattoLine<degree> line;
        weights = line.weights;
        derivative = line.derivative;
        for (unsigned int q = 0; q < n; ++q)
          value[q][q] = 1.;
      }
    }
  };

  /**
   * The conduction of heat in a cell, for every element of a degree: it needs full integration also
   * where the mechanics does with one point, since one point does not resist hourglass modes of the
   * temperature. Eight cells at a time; nodes and points are lexicographic, x fastest.
   */
  template <int dim, unsigned int degree>
  class ConductionElement
  {
  public:
    static constexpr unsigned int n_nodes =
        static_cast<unsigned int>(dealii::Utilities::pow(degree + 1, dim));
    static constexpr unsigned int n_points = n_nodes;

    /** Adds -Σ_q V_q k_q ∇θ · ∇N_k to @p heat_rate, with k_q from @p conductivity, a function of
     * Lanes, at the temperatures @p conductivity_temperature. */
    template <typename Conductivity>
    static void add_conduction(const Lanes (&x)[n_nodes][dim],
                               const Lanes (&conductivity_temperature)[n_nodes],
                               const Lanes (&temperature)[n_nodes],
                               const Conductivity &conductivity, Lanes (&heat_rate)[n_nodes])
    {
      for (unsigned int q = 0; q < n_points; ++q)
      {
        Lanes jacobian[dim][dim], reference_gradient[dim];
        Lanes temperature_of_conductivity = 0.;
        double weight = 1.;
        for (unsigned int a = 0; a < dim; ++a)
        {
          weight *= line.weights[position(q, a)];
          reference_gradient[a] = 0.;
          for (unsigned int i = 0; i < dim; ++i)
            jacobian[i][a] = 0.;
        }
        for_nodes_of(q,
                     [&](const unsigned int k, const double shape, const double(&derivative)[dim])
                     {
                       temperature_of_conductivity += shape * conductivity_temperature[k];
                       for (unsigned int a = 0; a < dim; ++a)
                       {
                         reference_gradient[a] += derivative[a] * temperature[k];
                         for (unsigned int i = 0; i < dim; ++i)
                           jacobian[i][a] += derivative[a] * x[k][i];
                       }
                     });
        Lanes inverse[dim][dim]; // ∂ξ_a/∂x_j
        const Lanes volume = weight * invert(jacobian, inverse);
        const Lanes factor = volume * conductivity(temperature_of_conductivity);
        Lanes flux[dim];
        for (unsigned int j = 0; j < dim; ++j)
        {
          Lanes gradient = inverse[0][j] * reference_gradient[0];
          for (unsigned int a = 1; a < dim; ++a)
            gradient += inverse[a][j] * reference_gradient[a];
          flux[j] = factor * gradient;
        }
        Lanes reference_flux[dim];
        for (unsigned int a = 0; a < dim; ++a)
        {
          reference_flux[a] = inverse[a][0] * flux[0];
          for (unsigned int j = 1; j < dim; ++j)
            reference_flux[a] += inverse[a][j] * flux[j];
        }
        for_nodes_of(q,
                     [&](const unsigned int k, const double, const double(&derivative)[dim])
                     {
                       for (unsigned int a = 0; a < dim; ++a)
                         heat_rate[k] -= derivative[a] * reference_flux[a];
                     });
      }
    }

  private:
    static constexpr ConductionLine<degree> line{};

    static constexpr unsigned int stride(const unsigned int a)
    {
      return a == 0 ? 1 : a == 1 ? degree + 1 : (degree + 1) * (degree + 1);
    }

    static constexpr unsigned int position(const unsigned int point, const unsigned int a)
    {
      return point / stride(a) % (degree + 1);
    }

    /** Calls @p act with the nodes whose functions are not zero at a point to first order. */
    template <typename Act>
    static void for_nodes_of(const unsigned int q, const Act &act)
    {
      if constexpr (degree == 1)
      {
        for (unsigned int k = 0; k < n_nodes; ++k)
        {
          double shape = 1., derivative[dim];
          for (unsigned int a = 0; a < dim; ++a)
          {
            shape *= line.value[position(q, a)][position(k, a)];
            derivative[a] = 1.;
            for (unsigned int b = 0; b < dim; ++b)
              derivative[a] *= b == a ? line.derivative[position(q, b)][position(k, b)]
                                      : line.value[position(q, b)][position(k, b)];
          }
          act(k, shape, derivative);
        }
      }
      else
      {
        // Nodes on the lines through the point; the point itself is on all of them.
        for (unsigned int a = 0; a < dim; ++a)
        {
          const unsigned int at = position(q, a);
          const unsigned int first = q - at * stride(a);
          for (unsigned int m = 0; m <= degree; ++m)
          {
            double derivative[dim] = {};
            derivative[a] = line.derivative[at][m];
            act(first + m * stride(a), a == 0 && m == at ? 1. : 0., derivative);
          }
        }
      }
    }
  };

  /** Formulation::add_conduction() of cells with the conductivity of @p properties. */
  template <int dim, typename Element>
  void add_conduction_of_cells(const CellPoints<dim, Element> &points,
                               const ThermalProperties &properties, const NodalVector &position,
                               const NodalVector &conductivity_temperature,
                               const NodalVector &temperature, NodalVector &heat_rate)
  {
    using Points = CellPoints<dim, Element>;
    const TemperatureTable &table = properties.conductivity();
    if (table.largest() == 0.)
      return;
    const double constant = table.value(0.);
    const auto conductivity = [&](const Lanes &at) -> Lanes
    {
      if (table.is_constant())
        return constant;
      alignas(64) double temperatures[n_lanes], values[n_lanes];
      store_lanes(at, temperatures);
      table.evaluate(n_lanes, temperatures, values);
      return load_lanes(values);
    };
    for (unsigned int batch = 0; batch < points.cells().n_batches(); ++batch)
    {
      typename Points::NodeValues x;
      typename Points::ScalarValues at, theta, rate;
      points.gather(batch, position, x);
      points.gather(batch, conductivity_temperature, at);
      points.gather(batch, temperature, theta);
      for (unsigned int k = 0; k < Points::n_nodes; ++k)
        rate[k] = 0.;
      ConductionElement<dim, Element::degree>::add_conduction(x, at, theta, conductivity, rate);
      const unsigned int *const nodes = points.cells().nodes(batch);
      for (unsigned int k = 0; k < Points::n_nodes; ++k)
        for (unsigned int lane = 0; lane < points.cells().n_valid(batch); ++lane)
          *heat_rate.node(nodes[k * n_lanes + lane]) += rate[k][lane];
    }
  }

  /** Formulation::diffusion_limit() of cells with this largest @p diffusivity [L^2/T]: conduction
   * is stiff along the shortest distance between nodes. */
  template <int dim>
  StepLimit diffusion_limit_of_cells(const CellBatches<dim> &cells, const double diffusivity,
                                     const NodalVector &position)
  {
    const unsigned int n_nodes = cells.n_nodes_per_cell();
    StepLimit limit;
    limit.entity = "cell";
    for (unsigned int batch = 0; batch < cells.n_batches() && diffusivity != 0.; ++batch)
      for (unsigned int lane = 0; lane < cells.n_valid(batch); ++lane)
      {
        const auto node = [&](const unsigned int k)
        { return position.node(cells.nodes(batch)[k * n_lanes + lane]); };
        double shortest = 1e300;
        dealii::Point<3> centre;
        for (unsigned int k = 0; k < n_nodes; ++k)
        {
          for (unsigned int other = 0; other < k; ++other)
          {
            double squared = 0;
            for (unsigned int d = 0; d < dim; ++d)
              squared += (node(k)[d] - node(other)[d]) * (node(k)[d] - node(other)[d]);
            shortest = std::min(shortest, squared);
          }
          for (unsigned int d = 0; d < dim; ++d)
            centre[d] += node(k)[d] / n_nodes;
        }
        if (shortest / (2. * diffusivity) < limit.time_step)
        {
          limit.time_step = shortest / (2. * diffusivity);
          limit.position = centre;
        }
      }
    return limit;
  }

  /** The common base of parts whose points are in their cells; Points are PointsInCells. */
  template <int dim, typename Points>
  class CellPart : public Formulation<dim>
  {
  public:
    dealii::IndexSet required_nodes() const override
    {
      return cell_points.cells().required_nodes();
    }
    void set_partition(const NodePartition &partition) override
    {
      cell_points.cells().set_partition(partition);
    }
    void add_mass(NodalVector &mass) const override
    {
      cell_points.cells().add_mass(mass);
    }
    void add_extra_mass(const std::vector<double> &inertia, NodalVector &mass) const override
    {
      cell_points.cells().add_extra_mass(inertia, mass);
    }
    StepLimit diffusion_limit(const NodalVector &position) const override
    {
      return diffusion_limit_of_cells(
          cell_points.cells(),
          part_points.heat()->largest_diffusivity() / part_points.material().density(), position);
    }
    void add_plastic_heat(NodalVector &heat) override
    {
      cell_points.add_plastic_heat(part_points, heat);
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
    unsigned int n_cells() const override
    {
      return cell_points.cells().n_cells();
    }
    unsigned int n_points_per_cell() const override
    {
      return cell_points.n_points_per_cell();
    }
    unsigned int point_of_cell(const unsigned int cell, const unsigned int q) const override
    {
      return cell_points.point_of_slot(cell_points.cells().slot_of(cell), q);
    }

    void fill_unused_lanes(const unsigned int field) override
    {
      cell_points.fill_unused_lanes(part_points.points(), field);
    }

  protected:
    using Formulation<dim>::part_points;
    Points cell_points;
  };
} // namespace tombolo
