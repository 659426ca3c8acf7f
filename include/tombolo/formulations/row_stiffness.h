// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/linearized_points.h>
#include <tombolo/formulations/mean_dilatation.h>
#include <tombolo/formulations/row_block.h>

#include <algorithm>
#include <array>
#include <functional>
#include <vector>

namespace tombolo
{
  /**
   * The consistent tangent of points whose gradients are sums over rows of Stencils: those of a
   * cell that share their dilatation, or one alone. The motion that F = Σ x_J ⊗ ∇φ_J and U = Σ Δt
   * v_J ⊗ ∇φ_J make of the points (rotation, strains, volumes) is changed by difference quotients
   * in each of their entries, and the stress follows by the tangent of the material, as in
   * CellStiffness. With P = V σ F⁻ᵀ the entries of the matrix are ∇φ_J · ∂P/∂F · ∇φ_K.
   */
  template <int dim, unsigned int n_points>
  class RowStiffness
  {
  public:
    /** The gradients of positions and displacements of the step by the rows, of n_lanes cells. */
    struct Gradients
    {
      Matrix3<Lanes> deformation[n_points];  ///< F
      Matrix3<Lanes> displacement[n_points]; ///< U
      Lanes volume[n_points];                ///< in the reference of the rows
      /** One where F changes with the positions, zero where it counts as the identity. */
      Lanes is_deformed = 1.;
      /** J of a point where it is a variable of its own, beside F; null: it follows from F. */
      const Lanes *volume_ratio = nullptr;
      /** With J: the modulus G of the energy V G W of OwnDilatation of det F / J. */
      double own_modulus = 0;
    };

    /** The tangent of a point whose J is a variable of its own, with the mean stress σ in the place
     * of its deviator: V is that of the reference. */
    struct RatioTerms
    {
      double force = 0;                     ///< V σ
      double derivative = 0;                ///< of it with J
      std::vector<double> with_position;    ///< of it, by node and component
      std::vector<double> force_derivative; ///< of f with J, by node and component
    };

    /** @p shares_volume: points of a cell share their dilatation and volumes follow from their
     * positions; else the volume of a point is that of the reference times its volume ratio. */
    RowStiffness(PartPoints &part, const bool shares_volume, const double time_increment)
        : shares_volume(shares_volume), linearized(part, time_increment),
          derivative(n_variables * n_variables)
    {}

    /** Finds the tangent of the points from @p first_point on. Advances their temperature, from @p
     * nodal_temperature where there is heat, and the variables of the material. */
    void find(const std::size_t first_point, const Gradients &gradients,
              const double *nodal_temperature)
    {
      linearized.begin(first_point);
      find_motion(gradients, motion);
      linearized.update(motion, nodal_temperature);
      find_derivative(gradients);
    }

    /** The equations of the cell in a lane, with the row of each of its points. */
    void hand_over(const unsigned int lane, const std::array<Stencils::Row, n_points> &rows,
                   const std::function<void(CellEquations &)> &take)
    {
      CellEquations equations;
      for (const Stencils::Row &row : rows)
        equations.nodes.insert(equations.nodes.end(), row.neighbour, row.neighbour + row.size);
      std::sort(equations.nodes.begin(), equations.nodes.end());
      equations.nodes.erase(std::unique(equations.nodes.begin(), equations.nodes.end()),
                            equations.nodes.end());
      const auto n_nodes = static_cast<unsigned int>(equations.nodes.size());
      constexpr unsigned int width = n_points * dim;
      gradients_of_nodes.assign(std::size_t(n_nodes) * width, 0.); // by node, point and component
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int k = 0; k < rows[q].size; ++k)
        {
          const std::size_t index = equations.index_of(rows[q].neighbour[k]);
          for (unsigned int d = 0; d < dim; ++d)
            gradients_of_nodes[index * width + q * dim + d] +=
                rows[q].gradient[k * Stencils::n_gradient + d];
        }
      // ∂P/∂F · ∇φ_K by entry of P, component and node K.
      const unsigned int n_rows = n_nodes * dim;
      products.assign(std::size_t(n_entries) * n_rows, 0.);
      for (unsigned int row = 0; row < n_entries; ++row)
        for (unsigned int q = 0; q < n_points; ++q)
          for (unsigned int k = 0; k < dim; ++k)
            for (unsigned int l = 0; l < dim; ++l)
            {
              const double value =
                  derivative[row * n_variables + q * n_of_point + k * dim + l][lane];
              double *const target = products.data() + std::size_t(row) * n_rows + k * n_nodes;
              for (unsigned int node = 0; node < n_nodes; ++node)
                target[node] += value * gradients_of_nodes[node * width + q * dim + l];
            }
      equations.matrix.assign(std::size_t(n_rows) * n_rows, 0.);
      equations.force.assign(n_rows, 0.);
      for (unsigned int node = 0; node < n_nodes; ++node)
        for (unsigned int i = 0; i < dim; ++i)
        {
          const unsigned int row = dim * node + i;
          double *const entries = equations.matrix.data() + std::size_t(row) * n_rows;
          for (unsigned int q = 0; q < n_points; ++q)
            for (unsigned int j = 0; j < dim; ++j)
            {
              const double gradient = gradients_of_nodes[node * width + q * dim + j];
              const unsigned int entry = q * n_of_point + i * dim + j;
              equations.force[row] += gradient * base_force[entry][lane];
              const double *const product = products.data() + std::size_t(entry) * n_rows;
              for (unsigned int k = 0; k < dim; ++k)
                for (unsigned int other = 0; other < n_nodes; ++other)
                  entries[dim * other + k] += gradient * product[k * n_nodes + other];
            }
        }
      if (has_ratio)
        find_ratio_terms(lane, n_nodes);
      take(equations);
    }

    /** Of the point of the last hand_over(), within it. */
    const RatioTerms &ratio_terms() const
    {
      return point_terms;
    }

  private:
    static constexpr unsigned int n_of_point = dim * dim;
    static constexpr unsigned int n_entries = n_points * n_of_point;
    static constexpr unsigned int n_variables = n_entries + 1; ///< the last is J

    void find_ratio_terms(const unsigned int lane, const unsigned int n_nodes)
    {
      point_terms.force = base_force[n_entries][lane];
      point_terms.derivative = derivative[n_entries * n_variables + n_entries][lane];
      point_terms.with_position.assign(std::size_t(n_nodes) * dim, 0.);
      point_terms.force_derivative.assign(std::size_t(n_nodes) * dim, 0.);
      for (unsigned int node = 0; node < n_nodes; ++node)
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
          {
            const double gradient = gradients_of_nodes[node * n_points * dim + j];
            const unsigned int entry = i * dim + j;
            point_terms.with_position[dim * node + i] +=
                gradient * derivative[n_entries * n_variables + entry][lane];
            point_terms.force_derivative[dim * node + i] +=
                gradient * derivative[entry * n_variables + n_entries][lane];
          }
    }

    struct Motion : LinearizedPoints<n_points>::Motion
    {
      Matrix3<Lanes> inverse_transpose[n_points];
      Lanes own_stress[n_points] = {}; ///< the derivative of the energy of d with ln d
    };

    void find_motion(const Gradients &gradients, Motion &result) const
    {
      Matrix3<Lanes> h[n_points];
      for (unsigned int q = 0; q < n_points; ++q)
      {
        Lanes det;
        const Matrix3<Lanes> inverse_deformation = inverse(gradients.deformation[q], det);
        result.inverse_transpose[q] = RowBlock::transposed(inverse_deformation);
        result.volume[q] = det * gradients.volume[q];
        h[q] = multiply(gradients.displacement[q], inverse_deformation);
        if (gradients.volume_ratio != nullptr)
        {
          result.own_stress[q] = gradients.own_modulus * gradients.volume[q] *
                                 OwnDilatation(det / *gradients.volume_ratio).slope;
        }
      }
      linearized.move(
          h, shares_volume,
          [&](MotionIncrement<Lanes>(&increments)[n_points])
          {
            if (shares_volume)
              MeanDilatation::share<dim>(linearized.is_logarithmic(), result.volume, increments);
            if (gradients.volume_ratio != nullptr)
              MeanDilatation::set_ratio<dim>(linearized.is_logarithmic(),
                                             *gradients.volume_ratio / linearized.old_ratio_of(0),
                                             increments[0]);
          },
          result);
      for (unsigned int q = 0; q < n_points && !shares_volume; ++q)
        result.volume[q] = gradients.volume[q] * result.volume_ratio[q];
    }
    /** P of @p changed, whose stress follows by the tangent, by point and entry. */
    void find_force(const Motion &changed, Lanes (&force)[n_variables]) const
    {
      constexpr unsigned int voigt[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
      Lanes integrated[n_points][6];
      linearized.integrate(motion, changed, integrated);
      const Lanes mean = shares_volume
                             ? MeanDilatation::mean_pressure<dim>(changed.volume, integrated)
                             : Lanes(0.);
      for (unsigned int q = 0; q < n_points; ++q)
      {
        if (has_ratio)
        {
          const Lanes mean_stress = (1. / dim) * MeanDilatation::trace_in_plane<dim>(integrated[q]);
          for (unsigned int i = 0; i < dim; ++i)
            integrated[q][i] += changed.own_stress[q] - mean_stress;
          force[n_entries] = (mean_stress - changed.own_stress[q]) / changed.volume_ratio[q];
        }
        if (shares_volume)
        {
          const Lanes difference = changed.volume[q] * mean -
                                   (1. / dim) * MeanDilatation::trace_in_plane<dim>(integrated[q]);
          for (unsigned int i = 0; i < dim; ++i)
            integrated[q][i] += difference;
        }
        for (unsigned int i = 0; i < dim; ++i)
          for (unsigned int j = 0; j < dim; ++j)
          {
            Lanes sum = 0.;
            for (unsigned int k = 0; k < dim; ++k)
              sum += integrated[q][voigt[i][k]] * changed.inverse_transpose[q](k, j);
            force[q * n_of_point + i * dim + j] = sum;
          }
      }
    }
    void find_derivative(const Gradients &gradients)
    {
      constexpr double change = 1e-7; // F is about one
      has_ratio = gradients.volume_ratio != nullptr;
      find_force(motion, base_force);
      Gradients changed_gradients = gradients;
      Motion changed;
      Lanes force[n_variables];
      const auto differentiate = [&](const unsigned int column, const Lanes &moved)
      {
        find_motion(changed_gradients, changed);
        find_force(changed, force);
        for (unsigned int row = 0; row < (has_ratio ? n_variables : n_entries); ++row)
          derivative[row * n_variables + column] = (force[row] - base_force[row]) / moved;
      };
      for (unsigned int q = 0; q < n_points; ++q)
        for (unsigned int k = 0; k < dim; ++k)
          for (unsigned int l = 0; l < dim; ++l)
          {
            Lanes &f = changed_gradients.deformation[q](k, l);
            Lanes &u = changed_gradients.displacement[q](k, l);
            const Lanes old_f = f, old_u = u;
            u = old_u + change;
            const Lanes moved = u - old_u; // the change after round-off
            f = old_f + gradients.is_deformed * moved;
            differentiate(q * n_of_point + k * dim + l, moved);
            f = old_f;
            u = old_u;
          }
      if (!has_ratio)
        return;
      const Lanes changed_ratio = *gradients.volume_ratio + change;
      changed_gradients.volume_ratio = &changed_ratio;
      differentiate(n_entries, changed_ratio - *gradients.volume_ratio);
    }

    const bool shares_volume;

    // Of the points at hand.
    LinearizedPoints<n_points> linearized;
    Motion motion;
    Lanes base_force[n_variables];
    bool has_ratio = false;
    RatioTerms point_terms;
    dealii::AlignedVector<Lanes> derivative; ///< of P with respect to F, row by row

    // Of the cell at hand.
    std::vector<double> gradients_of_nodes, products;
  };

} // namespace tombolo
