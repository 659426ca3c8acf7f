// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/simd/unroll.h>
#include <tombolo/formulations/elements/cell_formulation.h>
#include <tombolo/formulations/elements/cell_size.h>
#include <tombolo/formulations/elements/element.h>
#include <tombolo/formulations/elements/element_modes.h>

#include <algorithm>
#include <vector>

namespace tombolo
{
  /**
   * Hexahedron (quadrilateral) with one integration point: the exact mean gradient over the cell,
   * with hourglass control (Flanagan and Belytschko, Int. J. Numer. Meth. Engng 17, 679-706, 1981).
   * The hourglass shape vectors γ_αI = (h_αI - Σ_j (Σ_J h_αJ x_jJ) b_jI) / √2^dim are orthogonal to
   * linear fields in the current geometry; the generalized rate is q̇_iα = Σ_I γ_αI v_iI and the
   * nodal force -Σ_α Q_iα γ_αI with Q̇ = k q̇ in the frame that turns with the material, k = κ/2 (K
   * + 4G/3) Σ (V b_iI)² / V, in the initial geometry so that ½ Q²/k is an energy.
   */
  template <int dim>
  class OnePointHexahedron : public ElementDefaults
  {
  public:
    /** Hourglass forces follow the rate whatever the strain: the dearer measure gains nothing. */
    static constexpr StrainMeasure measure = StrainMeasure::rate;
    static constexpr unsigned int degree = 1;
    static constexpr unsigned int n_nodes = 1 << dim;
    static constexpr unsigned int n_points = 1;
    static constexpr unsigned int n_hourglass_modes = n_nodes - 1 - dim;

    struct Work
    {
      Lanes gradient[n_nodes][dim]; // of the modes, integrated; none of the first and last
      Lanes coordinates[n_hourglass_modes][dim]; // hourglass modes of the positions
      Lanes rates[n_hourglass_modes][dim];       // q̇
      Lanes forces[n_hourglass_modes][dim];      // Q
      Lanes work_of_step;                        // Σ Q Δq of the elastic forces
      Lanes volume;
      Lanes inverse_volume;
    };

    static void declare_parameters(const Entries &e)
    {
      declare<OnePointHexahedron>(e);
    }

    explicit OnePointHexahedron(const Entries &e)
    {
      coefficient = e.number(
          "Hourglass stiffness", "0.05", between(0., 1.), "1",
          "Modes without strain at the one point are resisted by an elastic force that turns "
          "with the material (Flanagan and Belytschko 1981): its coefficient, of the modulus of "
          "plane waves, at most of four shear moduli; 0.03 to 0.05 is usual.");
      hourglass_limit =
          e.number("Hourglass limit", "0.5", between(0., 1000.), "",
                   "The elastic hourglass force of a cell that flows plastically is at most this "
                   "multiple of the one that belongs to its flow stress; 0 is no limit.");
    }
    /** Without a limit. */
    explicit OnePointHexahedron(const double coefficient) : coefficient(coefficient) {}

    static std::vector<dealii::Point<dim>> reference_points()
    {
      return {dealii::Point<dim>()};
    }

    std::vector<FieldDescription> variables() const
    {
      std::vector<FieldDescription> fields;
      for (unsigned int alpha = 1; alpha <= n_hourglass_modes; ++alpha)
        fields.push_back({"hourglass force " + std::to_string(alpha), "M L/T^2",
                          FieldLocation::material_point, 3, true, 0., true, OnDivision::reset});
      fields.push_back(
          {"hourglass stiffness", "M/T^2", FieldLocation::material_point, 1, false, 0., true});
      fields.push_back({"hourglass dissipation", "M L^2/T^2", FieldLocation::material_point, 1,
                        true, 0., true, OnDivision::shared});
      return fields;
    }

    void set_material(const Material &material)
    {
      // Hourglass modes bend the cell, which a nearly incompressible material must not resist by
      // its bulk modulus: the cap is K + 4G/3 at ν = 1/3.
      modulus = std::min(material.bulk_modulus() + 4. / 3. * material.shear_modulus(),
                         4. * material.shear_modulus());
      shear_modulus = material.shear_modulus();
    }

    void evaluate(const Lanes (&x)[n_nodes][dim], const Lanes (&v)[n_nodes][dim], Work &work,
                  Lanes (&volume)[1], Matrix3<Lanes> (&gradient)[1]) const
    {
      constexpr double to_mean = 1. / n_nodes;
      Lanes position_modes[n_nodes][dim], velocity_modes[n_nodes][dim];
      TOMBOLO_UNROLL
      for (unsigned int d = 0; d < dim; ++d)
      {
        Lanes x_modes[n_nodes], v_modes[n_nodes];
        TOMBOLO_UNROLL
        for (unsigned int k = 0; k < n_nodes; ++k)
        {
          x_modes[k] = x[k][d];
          v_modes[k] = v[k][d];
        }
        sum_to_modes(x_modes);
        sum_to_modes(v_modes);
        TOMBOLO_UNROLL
        for (unsigned int k = 1; k < n_nodes; ++k)
        {
          position_modes[k][d] = to_mean * x_modes[k];
          velocity_modes[k][d] = to_mean * v_modes[k];
        }
      }
      volume_gradient(position_modes, work.gradient, volume[0]);
      work.volume = volume[0];

      const Lanes inverse_volume = 1. / volume[0];
      work.inverse_volume = inverse_volume;
      gradient[0] = zero_matrix<Lanes>();
      TOMBOLO_UNROLL
      for (unsigned int i = 0; i < dim; ++i)
        TOMBOLO_UNROLL
      for (unsigned int j = 0; j < dim; ++j)
      {
        Lanes sum = velocity_modes[1][i] * work.gradient[1][j];
        TOMBOLO_UNROLL
        for (unsigned int m = 2; m < n_nodes - 1; ++m)
          sum += velocity_modes[m][i] * work.gradient[m][j];
        gradient[0](i, j) = sum * inverse_volume;
      }

      unsigned int alpha = 0;
      TOMBOLO_UNROLL
      for (unsigned int m = 3; m < n_nodes; ++m)
        if (is_hourglass_mode(m))
        {
          TOMBOLO_UNROLL
          for (unsigned int i = 0; i < dim; ++i)
          {
            work.coordinates[alpha][i] = position_modes[m][i];
            Lanes rate = velocity_modes[m][i];
            TOMBOLO_UNROLL
            for (unsigned int j = 0; j < dim; ++j)
              rate -= position_modes[m][j] * gradient[0](i, j);
            work.rates[alpha][i] = root_of_n_nodes * rate;
          }
          ++alpha;
        }
    }

    void integrate(const Work &work, const Lanes (&stress)[1][6],
                   Lanes (&force)[n_nodes][dim]) const
    {
      // Σ_α Q_iα γ_αI: the part of γ along the mean gradient acts like a stress, the rest on the
      // hourglass modes alone.
      constexpr unsigned int component[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
      TOMBOLO_UNROLL
      for (unsigned int i = 0; i < dim; ++i)
      {
        Lanes row[dim];
        TOMBOLO_UNROLL
        for (unsigned int j = 0; j < dim; ++j)
        {
          Lanes hourglass = work.forces[0][i] * work.coordinates[0][j];
          TOMBOLO_UNROLL
          for (unsigned int alpha = 1; alpha < n_hourglass_modes; ++alpha)
            hourglass += work.forces[alpha][i] * work.coordinates[alpha][j];
          row[j] = (stress[0][component[i][j]] - root_of_n_nodes * hourglass) *
                   work.inverse_volume * (1. / n_nodes);
        }
        Lanes modes[n_nodes];
        modes[0] = 0.;
        unsigned int alpha = 0;
        TOMBOLO_UNROLL
        for (unsigned int m = 1; m < n_nodes; ++m)
        {
          modes[m] = is_hourglass_mode(m) ? (1. / root_of_n_nodes) * work.forces[alpha++][i] : 0.;
          if (m < n_nodes - 1)
            TOMBOLO_UNROLL
          for (unsigned int j = 0; j < dim; ++j)
            modes[m] += row[j] * work.gradient[m][j];
        }
        expand_to_nodes(modes);
        TOMBOLO_UNROLL
        for (unsigned int k = 0; k < n_nodes; ++k)
          force[k][i] = modes[k];
      }
    }

    void initialize_variables(const Work &work, ElementVariables variables) const
    {
      Lanes squared_gradient = 0.; // Σ (V b_iI)² over directions and nodes
      for (unsigned int m = 1; m < n_nodes - 1; ++m)
        for (unsigned int d = 0; d < dim; ++d)
          squared_gradient += work.gradient[m][d] * work.gradient[m][d];
      store_lanes(0.5 * coefficient * modulus * ((1. / n_nodes) * squared_gradient) / work.volume,
                  variables[3 * n_hourglass_modes]);
    }

    void advance(Work &work, const Lanes (&spin)[1][3], const double time_increment,
                 ElementVariables variables) const
    {
      // What the gradient at the end of the step leaves of the motion has the directions of the
      // body at its beginning.
      const Matrix3<Lanes> turn = rotation_of(spin[0]);
      const Lanes factor = load_lanes(variables[3 * n_hourglass_modes]) * time_increment;
      work.work_of_step = 0.;
      TOMBOLO_UNROLL
      for (unsigned int alpha = 0; alpha < n_hourglass_modes; ++alpha)
      {
        Lanes old[dim];
        TOMBOLO_UNROLL
        for (unsigned int i = 0; i < dim; ++i)
        {
          old[i] = load_lanes(variables[3 * alpha + i]) + factor * work.rates[alpha][i];
          work.work_of_step += old[i] * work.rates[alpha][i] * time_increment;
        }
        TOMBOLO_UNROLL
        for (unsigned int i = 0; i < dim; ++i)
        {
          Lanes sum = turn(i, 0) * old[0];
          TOMBOLO_UNROLL
          for (unsigned int j = 1; j < dim; ++j)
            sum += turn(i, j) * old[j];
          work.forces[alpha][i] = sum;
          store_lanes(sum, variables[3 * alpha + i]);
        }
      }
    }

    static constexpr bool limits_forces = true;

    /** Hourglass modes bend the cell, and a cell that flows bends at no more than its flow stress:
     * their energy is at most κ σ²/(6G) V times the square of the limit. The energy removed, less
     * the half of the step's work that the smaller force did not do, is booked as dissipated. */
    void limit(Work &work, const Lanes (&flow_stress)[1], ElementVariables variables) const
    {
      if (hourglass_limit == 0. || none_of(flow_stress[0] > 0.))
        return;
      const Lanes stiffness = load_lanes(variables[3 * n_hourglass_modes]);
      Lanes squared = 0.;
      for (unsigned int c = 0; c < 3 * n_hourglass_modes; ++c)
        squared += load_lanes(variables[c]) * load_lanes(variables[c]);
      const Lanes energy = 0.5 * squared / stiffness;
      const Lanes most = (hourglass_limit * hourglass_limit * coefficient / (6. * shear_modulus)) *
                         flow_stress[0] * flow_stress[0] * work.volume;
      Lanes share = 1.;
      where(flow_stress[0] > 0. && energy > most, share) = most / energy;
      double *const dissipated = variables[3 * n_hourglass_modes + 1];
      const Lanes factor = square_root(share);
      Lanes removed_energy = 0.;
      where(share < 1., removed_energy) = energy - most - 0.5 * (1. - factor) * work.work_of_step;
      store_lanes(load_lanes(dissipated) + removed_energy, dissipated);
      for (unsigned int alpha = 0; alpha < n_hourglass_modes; ++alpha)
        for (unsigned int i = 0; i < dim; ++i)
        {
          work.forces[alpha][i] *= factor;
          store_lanes(work.forces[alpha][i], variables[3 * alpha + i]);
        }
    }

    void linearize(Work &work, const double /*time_step*/, ConstElementVariables variables) const
    {
      const Lanes factor = load_lanes(variables[3 * n_hourglass_modes]);
      TOMBOLO_UNROLL
      for (unsigned int alpha = 0; alpha < n_hourglass_modes; ++alpha)
        TOMBOLO_UNROLL
      for (unsigned int i = 0; i < dim; ++i)
        work.forces[alpha][i] = factor * work.rates[alpha][i];
    }

    void add_energies(ConstElementVariables variables, Lanes &stored, Lanes &dissipated) const
    {
      if (coefficient == 0.)
        return;
      Lanes sum = 0.;
      for (unsigned int c = 0; c < 3 * n_hourglass_modes; ++c)
        sum += load_lanes(variables[c]) * load_lanes(variables[c]);
      stored += 0.5 * sum / load_lanes(variables[3 * n_hourglass_modes]);
      dissipated += load_lanes(variables[3 * n_hourglass_modes + 1]);
    }

  private:
    static constexpr double root_of_n_nodes = dim == 3 ? 2.8284271247461900976 : 2.;

    double coefficient; // κ
    double modulus = 0; // K + 4G/3, at most 4G [M/(L T^2)]
    double shear_modulus = 0;
    double hourglass_limit = 0; // zero: none
  };
} // namespace tombolo
