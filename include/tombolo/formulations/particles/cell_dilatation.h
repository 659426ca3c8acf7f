// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/fetch_ahead.h>
#include <tombolo/approximation/row_sharing.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/base/exceptions.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/mean_dilatation.h>
#include <tombolo/formulations/row_block.h>
#include <tombolo/formulations/row_stiffness.h>
#include <tombolo/materials/kinematics.h>
#include <tombolo/materials/logarithmic_strain.h>
#include <tombolo/materials/material.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/node_partition.h>

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/tensor.h>

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * The dilatation of particles by that of the cells around them. With the mean gradient g_cJ of
   * the function of node J in cell c, V_cI the share of particle I in its volume, all of the
   * initial configuration,
   *
   * @verbatim
   *   F_c = Σ_J x_J ⊗ g_cJ,   J_c = det F_c,   J_I = Σ_c V_cI J_c / V_I,   V_I = Σ_c V_cI
   * @endverbatim
   *
   * The deviator of a particle follows its own gradient, its volume ratio is J_I. What the cells
   * around a particle differ from J_I by has the energy Σ_I Σ_c ½ V_cI K (J_c - J_I)², with the
   * bulk modulus K of the material: for small strains the pressure has the energy ½ K (J_c - 1)² of
   * each cell, while the state of the material, its equation of state and its temperature are those
   * of particles. With the mean stress σ_I of a particle, the force of a cell is
   *
   * @verbatim
   *   f_J = - Σ_c P_c cof(F_c) g_cJ,   P_c = Σ_I V_cI (σ_I + K (J_c - J_I))
   * @endverbatim
   *
   * since the derivatives of J_I cancel in the second term. The ratio d = det F_I / J_I of the
   * determinant of the own F_I of a particle has the energy V_I G W(d) of OwnDilatation: without it
   * only the deviator would keep a particle at an edge from being turned inside out. All are
   * functions of the positions alone. A rank has the cells of its particles, those of other ranks
   * among them, and adds the contributions of its particles to P_c.
   */
  template <int dim>
  class CellDilatation
  {
  public:
    using Node = dealii::types::global_dof_index;

    /** A cell and the shares of particles of this rank in it. */
    struct Cell
    {
      std::vector<Node> nodes;
      std::vector<dealii::Tensor<1, dim>> gradient;        ///< g_cJ [1/L]
      std::vector<std::pair<unsigned int, double>> shares; ///< own particles and V_cI [L^dim]
    };

    /** Resets to the cells around @p n_particles particles, which @p for_cells(use) passes to use;
     * with @p rounds, g_cJ are kept in single precision. */
    template <typename ForCells>
    void reset(const ForCells &for_cells, const unsigned int n_particles, const bool rounds = false)
    {
      cells = Stencils();
      cell_nodes.clear();
      cell_volume.clear();
      cells.row_start = {0};
      RowSharing kept;
      std::vector<double> value, gradient;
      std::vector<std::pair<unsigned int, double>> shares; // by cell
      std::vector<unsigned int> cell_of_share;
      share_begin.assign(n_particles + std::size_t(1), 0);
      for_cells(
          [&](const Cell &cell)
          {
            cell_nodes.insert(cell_nodes.end(), cell.nodes.begin(), cell.nodes.end());
            cells.row_start.push_back(cell_nodes.size());
            value.assign(cell.nodes.size(), 0.);
            gradient.assign(Stencils::n_gradient * cell.nodes.size(), 0.);
            for (std::size_t k = 0; k < cell.nodes.size(); ++k)
              for (unsigned int d = 0; d < dim; ++d)
                gradient[Stencils::n_gradient * k + d] = cell.gradient[k][d];
            cells.coefficient_start.push_back(
                kept.add(static_cast<unsigned int>(value.size()), value.data(), gradient.data()));
            cell_volume.push_back(0.);
            for (const auto &share : cell.shares)
            {
              shares.push_back(share);
              cell_of_share.push_back(static_cast<unsigned int>(cell_volume.size() - 1));
              ++share_begin[share.first + 1];
              cell_volume.back() += share.second;
            }
          });
      const std::size_t n_cells = cell_volume.size();
      kept.store(cells);
      cells.particle_node.resize(n_cells);
      cells.neighbour.resize(cell_nodes.size());
      if (rounds)
        cells.round();
      cofactor.resize(3 * node_stride * n_cells);
      for (dealii::AlignedVector<double> *const cell_values : {&jacobian, &rate, &pressure})
      {
        cell_values->resize(n_cells);
        cell_values->fill(0.);
      }

      std::partial_sum(share_begin.begin(), share_begin.end(), share_begin.begin());
      share_cell.resize(shares.size());
      share_volume.resize(shares.size());
      volume.assign(padded_to_lanes(n_particles), 1.);
      std::fill_n(volume.begin(), n_particles, 0.);
      std::vector<unsigned int> next(share_begin);
      for (std::size_t s = 0; s < shares.size(); ++s)
      {
        const auto &[particle, volume_of_share] = shares[s];
        const unsigned int entry = next[particle]++;
        share_cell[entry] = cell_of_share[s];
        share_volume[entry] = volume_of_share;
        volume[particle] += volume_of_share;
      }
      ratio_of_particle.resize(padded_to_lanes(n_particles));
      own_energy.resize(padded_to_lanes(n_particles));
      own_energy.fill(0.);
      share_begin.resize(padded_to_lanes(n_particles) + 1, share_begin.back());
    }

    void set_material(const Material &material)
    {
      bulk_modulus = material.bulk_modulus();
      shear_modulus = material.shear_modulus();
    }

    bool is_on() const
    {
      return !share_begin.empty();
    }

    void set_partition(const NodePartition &partition)
    {
      std::transform(cell_nodes.begin(), cell_nodes.end(), cells.neighbour.begin(),
                     [&](const Node node) { return partition.local_index(node); });
      for (unsigned int c = 0; c < cells.n_particles(); ++c)
        cells.particle_node[c] = cells.neighbour[cells.row_start[c]];
    }

    /** Finds F_c and J_c at these positions (current ghosts). */
    void find(const NodalVector &position)
    {
      pressure.fill(0.); // an evaluation that failed has left its sums
      const unsigned int n_cells = cells.n_particles();
      alignas(64) double deformation_columns[n_lanes][3][node_stride] = {};
      alignas(64) double det[n_lanes];
      for (unsigned int first = 0; first < n_cells; first += n_lanes)
      {
        const unsigned int n = std::min<unsigned int>(n_lanes, n_cells - first);
        for (unsigned int lane = 0; lane < n; ++lane)
        {
          fetch_ahead(cells, first + lane, position.data());
          NodeLanes f[3] = {0., 0., 0.};
          RowBlock::add_row(cells.row_of_gradients(first + lane), position.data(),
                            load_node(position.node(cells.particle_node[first + lane])), f);
          for (unsigned int j = 0; j < 3; ++j)
            store_node(f[j], deformation_columns[lane][j]);
        }
        Matrix3<Lanes> f = RowBlock::load_columns(deformation_columns[0][0]);
        if constexpr (dim == 2)
          f(2, 2) = 1.;
        Matrix3<Lanes> cofactors;
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = 0; j < 3; ++j)
          {
            const unsigned int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3,
                               j2 = (j + 2) % 3;
            cofactors(i, j) = f(i1, j1) * f(i2, j2) - f(i1, j2) * f(i2, j1);
          }
        store_lanes(
            f(0, 0) * cofactors(0, 0) + f(0, 1) * cofactors(0, 1) + f(0, 2) * cofactors(0, 2), det);
        alignas(64) double columns[n_lanes][3][node_stride];
        RowBlock::store_columns(cofactors, columns[0][0]);
        std::copy_n(columns[0][0], 3 * node_stride * std::size_t(n),
                    cofactor.data() + 3 * node_stride * std::size_t(first));
        std::copy_n(det, n, jacobian.data() + first);
      }
      for (unsigned int i = 0; i + 1 < share_begin.size(); ++i)
      {
        double sum = 0;
        for (unsigned int s = share_begin[i]; s < share_begin[i + 1]; ++s)
          sum += share_volume[s] * jacobian[share_cell[s]];
        ratio_of_particle[i] = share_begin[i] < share_begin[i + 1] ? sum / volume[i] : 1.;
      }
    }

    /** J_I of n_lanes particles from @p first on; one for lanes without a particle. */
    Lanes ratio(const unsigned int first) const
    {
      return load_lanes(&ratio_of_particle[first]);
    }

    /** Sets the dilatation of n_lanes @p motion to that of J_I, of @p old_ratio before the step. */
    void share(const unsigned int first, const Lanes &old_ratio, const bool is_logarithmic,
               MotionIncrement<Lanes> &motion) const
    {
      MeanDilatation::set_ratio<dim>(is_logarithmic, ratio(first) / old_ratio, motion);
    }

    /** Removes the mean stress from @p stress of n_lanes particles from @p first on, which is
     * multiplied by the present volume. Adds the stress of d, with the determinant @p own of F_I,
     * and adds to P_c the terms of both and of the differences of the cells. */
    void collect(const unsigned int first, const Lanes &own, Lanes (&stress)[6])
    {
      const Lanes shared = ratio(first), initial_volume = load_lanes(&volume[first]);
      const OwnDilatation own_dilatation(own / shared);
      const Lanes own_stress = shear_modulus * initial_volume * own_dilatation.slope;
      store_lanes(shear_modulus * initial_volume * own_dilatation.energy, &own_energy[first]);
      const Lanes mean_stress = (1. / dim) * MeanDilatation::trace_in_plane<dim>(stress);
      for (unsigned int i = 0; i < dim; ++i)
        stress[i] += own_stress - mean_stress;
      add_pressures(first, (mean_stress - own_stress) / (shared * initial_volume) -
                               bulk_modulus * (shared - 1.));
    }

    /** Adds the forces of P_c after collect(), and resets the sums. */
    void add_force(NodalVector &force)
    {
      subtract_pressures([&](const unsigned int c)
                         { return bulk_modulus * cell_volume[c] * (jacobian[c] - 1.); },
                         force);
    }

    /** G [M/(L T^2)]. */
    double modulus_of_own() const
    {
      return shear_modulus;
    }

    /** Adds the terms of the J_I of @p particle, and of the differences of its cells, to the
     * equations of its row, at the positions of the last find(). */
    void add_tangent(const unsigned int particle,
                     const typename RowStiffness<dim, 1>::RatioTerms &terms,
                     CellEquations &equations) const
    {
      const std::size_t n_rows = equations.force.size();
      const unsigned int lanes_of_particle = particle / n_lanes * n_lanes;
      const double mean_ratio = ratio(lanes_of_particle)[particle - lanes_of_particle];
      const double stress = terms.force / volume[particle];
      std::vector<double> mean_gradient(n_rows, 0.), cell_gradient(n_rows);
      for (unsigned int s = share_begin[particle]; s < share_begin[particle + 1]; ++s)
      {
        const unsigned int c = share_cell[s];
        const Stencils::Row row = cells.row_of_gradients(c);
        const double *const columns = cofactor.data() + 3 * node_stride * std::size_t(c);
        std::vector<std::size_t> first_rows;
        std::vector<dealii::Tensor<1, dim>> areas; // cof(F_c) g_cJ
        for (unsigned int k = 0; k < row.size; ++k)
        {
          first_rows.push_back(equations.index_of(row.neighbour[k]) * dim);
          areas.emplace_back();
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int j = 0; j < dim; ++j)
              areas.back()[i] +=
                  columns[j * node_stride + i] * row.gradient[Stencils::n_gradient * k + j];
        }
        std::fill(cell_gradient.begin(), cell_gradient.end(), 0.);
        for (unsigned int k = 0; k < row.size; ++k)
          for (unsigned int i = 0; i < dim; ++i)
            cell_gradient[first_rows[k] + i] += areas[k][i];
        const double difference = jacobian[c] - mean_ratio;
        const double area_factor =
            share_volume[s] * (stress + bulk_modulus * difference) / jacobian[c];
        for (unsigned int k = 0; k < row.size; ++k)
          for (unsigned int i = 0; i < dim; ++i)
            for (unsigned int l = 0; l < row.size; ++l)
              for (unsigned int j = 0; j < dim; ++j)
                equations.matrix[(first_rows[k] + i) * n_rows + first_rows[l] + j] +=
                    area_factor * (areas[k][i] * areas[l][j] - areas[k][j] * areas[l][i]) +
                    share_volume[s] * bulk_modulus * areas[k][i] * areas[l][j];
        for (std::size_t i = 0; i < n_rows; ++i)
        {
          mean_gradient[i] += share_volume[s] / volume[particle] * cell_gradient[i];
          equations.force[i] += share_volume[s] * bulk_modulus * difference * cell_gradient[i];
        }
      }
      // The bulk modulus acts on the difference between cells and the mean.
      const double square_factor = terms.derivative - bulk_modulus * volume[particle];
      for (std::size_t i = 0; i < n_rows; ++i)
      {
        equations.force[i] += terms.force * mean_gradient[i];
        for (std::size_t j = 0; j < n_rows; ++j)
          equations.matrix[i * n_rows + j] +=
              mean_gradient[i] * (square_factor * mean_gradient[j] + terms.with_position[j]) +
              terms.force_derivative[i] * mean_gradient[j];
      }
    }

    /** Energy of the differences of cells and of the own determinants, over the particles of this
     * rank, at the last find() and collect() [M L^2/T^2]. */
    double energy() const
    {
      double sum = 0;
      for (unsigned int first = 0; first + 1 < share_begin.size(); first += n_lanes)
      {
        const Lanes particle_ratios = ratio(first);
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          for (unsigned int s = share_begin[first + lane]; s < share_begin[first + lane + 1]; ++s)
          {
            const double difference = jacobian[share_cell[s]] - particle_ratios[lane];
            sum += share_volume[s] * difference * difference;
          }
      }
      double own_sum = 0;
      for (const double energy_of_particle : own_energy)
        own_sum += energy_of_particle;
      return 0.5 * bulk_modulus * sum + own_sum;
    }

    /** @name The linear response to velocities at the positions of the last find() */
    ///@{
    /** Finds the rates of J_c. */
    void find_rates(const NodalVector &velocity)
    {
      for (unsigned int c = 0; c < cells.n_particles(); ++c)
      {
        fetch_ahead(cells, c, velocity.data());
        const double *const cofactors = cofactor.data() + 3 * node_stride * std::size_t(c);
        NodeLanes h[3] = {0., 0., 0.};
        RowBlock::add_row(cells.row_of_gradients(c), velocity.data(), NodeLanes(0.), h);
        NodeLanes sum = 0.;
        for (unsigned int j = 0; j < 3; ++j)
          sum += h[j] * load_node(cofactors + j * node_stride);
        rate[c] = sum[0] + sum[1] + sum[2];
      }
    }
    /** Sets the trace of @p gradient of n_lanes particles to the rate of ln J_I. Sets @p mean_rate
     * to the rate of J_I, and returns the rate of ln d. */
    Lanes share_rate(const unsigned int first, Matrix3<Lanes> &gradient, Lanes &mean_rate) const
    {
      mean_rate = mean(rate, first);
      const Lanes difference = mean_rate / ratio(first) - MeanDilatation::trace<dim>(gradient);
      for (unsigned int i = 0; i < dim; ++i)
        gradient(i, i) += (1. / dim) * difference;
      return -difference;
    }
    /** collect() of rates; @p stress is multiplied by minus the present volume. */
    void collect_rates(const unsigned int first, const Lanes &own, const Lanes &mean_rate,
                       const Lanes &rate_of_own, Lanes (&stress)[6])
    {
      const Lanes initial_volume = load_lanes(&volume[first]);
      const Lanes own_stress = shear_modulus * initial_volume *
                               OwnDilatation(own / ratio(first)).stiffness * rate_of_own;
      const Lanes mean_stress = (1. / dim) * MeanDilatation::trace_in_plane<dim>(stress);
      for (unsigned int i = 0; i < dim; ++i)
        stress[i] -= own_stress + mean_stress;
      add_pressures(first, (mean_stress + own_stress) / (ratio(first) * initial_volume) +
                               bulk_modulus * mean_rate);
    }
    /** Adds their forces, and resets the sums. */
    void add_force_of_rates(NodalVector &force)
    {
      subtract_pressures(
          [&](const unsigned int c) { return -bulk_modulus * cell_volume[c] * rate[c]; }, force);
    }
    ///@}

  private:
    /** Σ V_cI y_c / V_I. */
    Lanes mean(const dealii::AlignedVector<double> &cell_values, const unsigned int first) const
    {
      alignas(64) double sum[n_lanes];
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
      {
        double weighted_sum = 0;
        for (unsigned int s = share_begin[first + lane]; s < share_begin[first + lane + 1]; ++s)
          weighted_sum += share_volume[s] * cell_values[share_cell[s]];
        sum[lane] = weighted_sum / volume[first + lane];
      }
      return load_lanes(sum);
    }
    /** Adds V_cI times the values of n_lanes particles from @p first on to P_c. */
    void add_pressures(const unsigned int first, const Lanes &particle_values)
    {
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
      {
        const double value = particle_values[lane];
        for (unsigned int s = share_begin[first + lane]; s < share_begin[first + lane + 1]; ++s)
          pressure[share_cell[s]] += share_volume[s] * value;
      }
    }
    /** Subtracts P_c cof(F_c) g_cJ, with @p cell_pressure(c) in P_c, and resets the sums. */
    template <typename CellPressure>
    void subtract_pressures(const CellPressure &cell_pressure, NodalVector &force)
    {
      alignas(64) double columns[3 * node_stride];
      for (unsigned int c = 0; c < cells.n_particles(); ++c)
      {
        fetch_ahead(cells, c, force.data());
        const double *const cofactors = cofactor.data() + 3 * node_stride * std::size_t(c);
        const double total_pressure = pressure[c] + cell_pressure(c);
        for (unsigned int k = 0; k < 3 * node_stride; ++k)
          columns[k] = total_pressure * cofactors[k];
        RowBlock::subtract_row(cells.row_of_gradients(c), columns, force.data());
      }
      pressure.fill(0.);
    }

    Stencils cells;               ///< rows of g_cJ; its particles are the first nodes of cells
    std::vector<Node> cell_nodes; ///< by entry of a row
    dealii::AlignedVector<double> cofactor; ///< of F_c, three columns of node_stride a cell
    dealii::AlignedVector<double> jacobian; ///< J_c
    dealii::AlignedVector<double> rate;     ///< of J_c
    dealii::AlignedVector<double> pressure; ///< P_c
    std::vector<double> cell_volume;        ///< Σ_I V_cI over the particles of this rank
    dealii::AlignedVector<double> ratio_of_particle; ///< J_I

    std::vector<unsigned int> share_begin; ///< by particle, first of its entries below
    std::vector<unsigned int> share_cell;
    std::vector<double> share_volume;         ///< V_cI
    std::vector<double> volume;               ///< V_I
    dealii::AlignedVector<double> own_energy; ///< of each particle, at the last collect()
    double bulk_modulus = 0, shear_modulus = 0;
  };
} // namespace tombolo
