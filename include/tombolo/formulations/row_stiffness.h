// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/elements/stiff_cells.h>
#include <tombolo/formulations/logarithmic_points.h>
#include <tombolo/formulations/mean_dilatation.h>
#include <tombolo/formulations/row_block.h>
#include <tombolo/formulations/row_material.h>
#include <tombolo/materials/material_tangent.h>

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
    /** What the rows make of positions and displacements of the step, of n_lanes cells. */
    struct Gradients
    {
      Matrix3<Lanes> deformation[n_points];  ///< F
      Matrix3<Lanes> displacement[n_points]; ///< U
      Lanes volume[n_points];                ///< in the reference of the rows
      /** One where F changes with the positions, zero where it counts as the identity. */
      Lanes is_deformed = 1.;
    };

    RowStiffness(const RowMaterial &of_part, const double time_increment)
        : part(of_part), time_increment(time_increment),
          is_logarithmic(of_part.measure == StrainMeasure::logarithmic), tangent_values(36 * size),
          derivative(n_entries * n_entries)
    {
      for (unsigned int entry = 0; entry < 36; ++entry)
        tangent[entry] = tangent_values.data() + entry * size;
    }

    /** Finds the tangent of the points from @p first_point on. Advances their temperature, from @p
     * nodal_temperature where there is heat, and what the material remembers. */
    void find(const std::size_t first_point, const Gradients &gradients,
              const double *nodal_temperature)
    {
      first = first_point;
      begin(gradients);
      update_stress(nodal_temperature);
      find_derivative(gradients);
    }

    /** The equations of the cell in a lane, with the row of each of its points. */
    void hand_over(unsigned int lane, const std::array<Stencils::Row, n_points> &rows,
                   const std::function<void(const CellEquations &)> &take);

  private:
    static constexpr unsigned int size = n_points * n_lanes;
    static constexpr unsigned int n_of_point = dim * dim;
    static constexpr unsigned int n_entries = n_points * n_of_point;

    /** What the motion makes of the points before the material answers. */
    struct Motion
    {
      Matrix3<Lanes> inverse_transpose[n_points];
      Lanes strain[n_points][6];
      Lanes stress[n_points][6]; ///< rotated; Kirchhoff's where the strain is logarithmic
      Lanes volume[n_points], volume_ratio[n_points], work_factor[n_points];
    };

    double *component(const unsigned int field, const unsigned int c)
    {
      return part.points->component(field, c) + first;
    }

    void begin(const Gradients &gradients);
    void find_motion(const Gradients &gradients, Motion &motion) const;
    void update_stress(const double *nodal_temperature);
    /** P of @p changed, whose stress follows by the tangent, by point and entry. */
    void find_force(const Motion &changed, Lanes (&force)[n_entries]) const;
    void find_derivative(const Gradients &gradients);

    RowMaterial part;
    double time_increment;
    bool is_logarithmic;

    // Of the points at hand.
    std::size_t first = 0;
    Lanes old_volume[n_points], old_ratio[n_points], old_stress[n_points][6];
    Lanes bulk[n_points], shear[n_points]; ///< at the temperature of the start
    Lanes elastic_strain[n_points][6];
    alignas(64) double former_volume[size];
    Motion motion;
    Lanes stress[n_points][6]; ///< at the end of the step, Kirchhoff's or Cauchy's
    dealii::AlignedVector<double> tangent_values;
    MaterialTangent tangent;
    Lanes base_force[n_entries];
    dealii::AlignedVector<Lanes> derivative; ///< of P with respect to F, row by row

    // Of the cell at hand.
    std::vector<double> gradients_of_nodes, products;
  };

  template <int dim, unsigned int n_points>
  void RowStiffness<dim, n_points>::begin(const Gradients &gradients)
  {
    alignas(64) double bulk_at[size], shear_at[size];
    const double *const temperature = part.plastic_heating->temperature(*part.points);
    part.material->elastic_moduli(size, temperature == nullptr ? nullptr : temperature + first,
                                  bulk_at, shear_at);
    std::copy_n(component(MaterialPoints::volume, 0), size, former_volume);
    for (unsigned int q = 0; q < n_points; ++q)
    {
      const unsigned int i = q * n_lanes;
      bulk[q] = load_lanes(bulk_at + i);
      shear[q] = load_lanes(shear_at + i);
      old_volume[q] = load_lanes(component(MaterialPoints::volume, 0) + i);
      old_ratio[q] = load_lanes(component(MaterialPoints::volume_ratio, 0) + i);
      for (unsigned int c = 0; c < 6; ++c)
      {
        old_stress[q][c] = load_lanes(component(MaterialPoints::stress, c) + i);
        if (is_logarithmic)
          old_stress[q][c] *= old_ratio[q];
      }
      elastic_strain_of(old_stress[q], bulk[q], shear[q], elastic_strain[q]);
    }
    find_motion(gradients, motion);
  }

  template <int dim, unsigned int n_points>
  void RowStiffness<dim, n_points>::find_motion(const Gradients &gradients, Motion &result) const
  {
    MotionIncrement<Lanes> increments[n_points];
    for (unsigned int q = 0; q < n_points; ++q)
    {
      Lanes det;
      const Matrix3<Lanes> inverse_deformation = inverse(gradients.deformation[q], det);
      result.inverse_transpose[q] = RowBlock::transposed(inverse_deformation);
      result.volume[q] = det * gradients.volume[q];
      const Matrix3<Lanes> h = multiply(gradients.displacement[q], inverse_deformation);
      increments[q] =
          is_logarithmic ? logarithmic_increment(h, elastic_strain[q]) : motion_increment(h);
    }
    Lanes growth = 1.;
    if (part.shares_volume && is_logarithmic)
    {
      growth = LogarithmicPoints::growth_of_cell(former_volume, result.volume);
      MeanDilatation::share_logarithmic<dim>(result.volume, increments);
    }
    else if (part.shares_volume)
      MeanDilatation::share_strain<dim>(result.volume, increments);
    for (unsigned int q = 0; q < n_points; ++q)
    {
      for (unsigned int c = 0; c < 6; ++c)
      {
        result.strain[q][c] = increments[q].strain[c];
        result.stress[q][c] = old_stress[q][c];
      }
      rotate(increments[q].spin, result.stress[q]);
      result.volume_ratio[q] = old_ratio[q] * increments[q].volume_factor;
      result.work_factor[q] = work_factor(increments[q]);
      if (!part.shares_volume)
        result.volume[q] = gradients.volume[q] * result.volume_ratio[q];
      else if (is_logarithmic)
        result.volume[q] = old_volume[q] * growth;
    }
  }

  template <int dim, unsigned int n_points>
  void RowStiffness<dim, n_points>::update_stress(const double *const nodal_temperature)
  {
    alignas(64) double new_stress[6][size], strain[6][size];
    alignas(64) double factor[size], ratio[size], temperature_increment[size];
    MaterialBatch batch;
    batch.n = size;
    batch.time_increment = time_increment;
    batch.measure = part.measure;
    for (unsigned int c = 0; c < 6; ++c)
    {
      for (unsigned int q = 0; q < n_points; ++q)
      {
        store_lanes(motion.stress[q][c], new_stress[c] + q * n_lanes);
        store_lanes(motion.strain[q][c], strain[c] + q * n_lanes);
      }
      batch.stress[c] = new_stress[c];
      batch.strain_increment[c] = strain[c];
    }
    for (unsigned int q = 0; q < n_points; ++q)
    {
      store_lanes(motion.volume_ratio[q], ratio + q * n_lanes);
      store_lanes(is_logarithmic ? motion.work_factor[q] : motion.volume_ratio[q],
                  factor + q * n_lanes);
    }
    batch.volume_ratio = factor;
    batch.relative_volume = ratio;
    for (double *const variable : part.variables)
      batch.internal_variables.push_back(variable + first);
    if (part.plastic_heating->is_on())
    {
      part.plastic_heating->advance(*part.points, first, size, nodal_temperature,
                                    time_increment == 0., temperature_increment);
      batch.temperature = part.plastic_heating->temperature(*part.points) + first;
      batch.temperature_increment = temperature_increment;
    }
    update_stress_and_tangent(*part.material, batch, tangent);
    for (unsigned int q = 0; q < n_points; ++q)
      for (unsigned int c = 0; c < 6; ++c)
        stress[q][c] = load_lanes(new_stress[c] + q * n_lanes);
  }

  template <int dim, unsigned int n_points>
  void RowStiffness<dim, n_points>::find_force(const Motion &changed,
                                               Lanes (&force)[n_entries]) const
  {
    constexpr unsigned int place[3][3] = {{0, 5, 4}, {5, 1, 3}, {4, 3, 2}};
    Lanes integrated[n_points][6];
    for (unsigned int q = 0; q < n_points; ++q)
    {
      Lanes turned[6], strain[6];
      for (unsigned int c = 0; c < 6; ++c)
        turned[c] = changed.stress[q][c] - motion.stress[q][c];
      elastic_strain_of(turned, bulk[q], shear[q], strain);
      for (unsigned int c = 0; c < 6; ++c)
        strain[c] += changed.strain[q][c] - motion.strain[q][c];
      const Lanes volume =
          is_logarithmic ? changed.volume[q] / changed.volume_ratio[q] : changed.volume[q];
      for (unsigned int c = 0; c < 6; ++c)
      {
        Lanes sum = stress[q][c];
        for (unsigned int e = 0; e < 6; ++e)
          sum += load_lanes(tangent[6 * c + e] + q * n_lanes) * strain[e];
        integrated[q][c] = volume * sum;
      }
    }
    const Lanes mean = part.shares_volume
                           ? MeanDilatation::mean_pressure<dim>(changed.volume, integrated)
                           : Lanes(0.);
    for (unsigned int q = 0; q < n_points; ++q)
    {
      if (part.shares_volume)
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
            sum += integrated[q][place[i][k]] * changed.inverse_transpose[q](k, j);
          force[q * n_of_point + i * dim + j] = sum;
        }
    }
  }

  template <int dim, unsigned int n_points>
  void RowStiffness<dim, n_points>::find_derivative(const Gradients &gradients)
  {
    constexpr double change = 1e-7; // F is about one
    find_force(motion, base_force);
    Gradients changed_gradients = gradients;
    Motion changed;
    Lanes force[n_entries];
    for (unsigned int q = 0; q < n_points; ++q)
      for (unsigned int k = 0; k < dim; ++k)
        for (unsigned int l = 0; l < dim; ++l)
        {
          Lanes &f = changed_gradients.deformation[q](k, l);
          Lanes &u = changed_gradients.displacement[q](k, l);
          const Lanes old_f = f, old_u = u;
          u = old_u + change;
          const Lanes moved = u - old_u; // what is left of it after round-off
          f = old_f + gradients.is_deformed * moved;
          find_motion(changed_gradients, changed);
          find_force(changed, force);
          f = old_f;
          u = old_u;
          const unsigned int column = q * n_of_point + k * dim + l;
          for (unsigned int row = 0; row < n_entries; ++row)
            derivative[row * n_entries + column] = (force[row] - base_force[row]) / moved;
        }
  }

  template <int dim, unsigned int n_points>
  void
  RowStiffness<dim, n_points>::hand_over(const unsigned int lane,
                                         const std::array<Stencils::Row, n_points> &rows,
                                         const std::function<void(const CellEquations &)> &take)
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
        const auto place =
            std::lower_bound(equations.nodes.begin(), equations.nodes.end(), rows[q].neighbour[k]) -
            equations.nodes.begin();
        for (unsigned int d = 0; d < dim; ++d)
          gradients_of_nodes[std::size_t(place) * width + q * dim + d] +=
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
            const double value = derivative[row * n_entries + q * n_of_point + k * dim + l][lane];
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
    take(equations);
  }
} // namespace tombolo
