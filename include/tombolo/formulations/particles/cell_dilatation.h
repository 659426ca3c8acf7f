// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/aligned_vector.h>
#include <deal.II/base/tensor.h>

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/row_stiffness.h>
#include <tombolo/materials/kinematics.h>
#include <tombolo/materials/material.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/node_partition.h>

#include <cstddef>
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
   * since the derivatives of J_I cancel in the second term. What the determinant of the own F_I of
   * a particle is beside J_I, d = det F_I / J_I, has the energy V_I G W(d) of
   * OwnDilatation: without it only the deviator would keep a particle at an edge from being turned
   * inside out. All are functions of the positions alone. A rank has the
   * cells of its particles, those of other ranks among them, and adds what its particles give to
   * P_c.
   */
  template <int dim>
  class CellDilatation
  {
  public:
    using Node = dealii::types::global_dof_index;

    /** A cell with what particles of this rank have of it. */
    struct Cell
    {
      std::vector<Node> nodes;
      std::vector<dealii::Tensor<1, dim>> gradient; ///< g_cJ [1/L]
      std::vector<std::pair<unsigned int, double>>
          shares; ///< particles of this rank and V_cI [L^dim]
    };

    /** Begins anew with these cells around @p n_particles particles. */
    void reset(const std::vector<Cell> &cells, unsigned int n_particles);

    void set_material(const Material &material)
    {
      bulk_modulus = material.bulk_modulus();
      shear_modulus = material.shear_modulus();
    }

    bool is_on() const
    {
      return !share_begin.empty();
    }

    void set_partition(const NodePartition &partition);

    /** Finds F_c and J_c at these positions (current ghosts). */
    void find(const NodalVector &position);

    /** J_I of n_lanes particles from @p first on, one of those that are not there. */
    Lanes ratio(const unsigned int first) const
    {
      return load_lanes(&ratio_of_particle[first]);
    }

    /** Gives n_lanes particles from @p first on, with the ratio @p old_ratio before the step, J_I
     * in the place of the dilatation of @p motion. */
    void share(unsigned int first, const Lanes &old_ratio, bool is_logarithmic,
               MotionIncrement<Lanes> &motion) const;

    /** Takes the mean stress out of @p stress of n_lanes particles from @p first on, which comes
     * times the present volume, adds what d gives, with the determinant @p own of F_I, and what
     * both and the differences of the cells give to P_c. */
    void collect(unsigned int first, const Lanes &own, Lanes (&stress)[6]);

    /** Adds the forces of P_c after collect(), and begins the sums anew. */
    void add_force(NodalVector &force);

    /** G [M/(L T^2)]. */
    double modulus_of_own() const
    {
      return shear_modulus;
    }

    /** Adds what the terms of the J_I of @p particle, and the differences of its cells, add to the
     * equations of its row, at the positions of the last find(). */
    void add_tangent(unsigned int particle, const typename RowStiffness<dim, 1>::RatioTerms &terms,
                     CellEquations &equations) const;

    /** Of the differences of cells and the own determinants, of the particles of this rank, at
     * the last find() and collect() [M L^2/T^2]. */
    double energy() const;

    /** @name The linear answer to velocities at the positions of the last find() */
    ///@{
    /** Finds the rates of J_c. */
    void find_rates(const NodalVector &velocity);
    /** Gives n_lanes particles the rate of ln J_I in the place of the trace of @p gradient. Returns
     * the rate of ln d. */
    Lanes share_rate(unsigned int first, Matrix3<Lanes> &gradient) const;
    /** collect() of rates; @p stress comes times minus the present volume. */
    void collect_rates(unsigned int first, const Lanes &own, const Lanes &rate_of_own,
                       Lanes (&stress)[6]);
    /** Adds what they give, and begins the sums anew. */
    void add_force_of_rates(NodalVector &force);
    ///@}

  private:
    /** Σ V_cI y_c / V_I. */
    Lanes mean(const dealii::AlignedVector<double> &of_cell, unsigned int first) const;
    /** Adds V_cI times what n_lanes particles from @p first on have to P_c. */
    void add_pressures(unsigned int first, const Lanes &of_particles);
    /** Subtracts P_c cof(F_c) g_cJ from @p force, with @p of_cell(c) in P_c beside what particles
     * have added, which is emptied. */
    template <typename OfCell>
    void subtract_pressures(const OfCell &of_cell, NodalVector &force);

    Stencils cells;               ///< rows of g_cJ; its particles are the first nodes of cells
    std::vector<Node> cell_nodes; ///< by entry of a row
    dealii::AlignedVector<double> cofactor; ///< of F_c, three columns of node_stride a cell
    dealii::AlignedVector<double> jacobian; ///< J_c
    dealii::AlignedVector<double> rate;     ///< of J_c
    dealii::AlignedVector<double> pressure; ///< P_c
    std::vector<double> cell_volume;        ///< Σ_I V_cI over the particles of this rank
    dealii::AlignedVector<double> ratio_of_particle; ///< J_I

    std::vector<unsigned int> share_begin; ///< by particle, of what follows
    std::vector<unsigned int> share_cell;
    std::vector<double> share_volume;         ///< V_cI
    std::vector<double> volume;               ///< V_I
    dealii::AlignedVector<double> own_energy; ///< of each particle, at the last collect()
    double bulk_modulus = 0, shear_modulus = 0;
  };
} // namespace tombolo
