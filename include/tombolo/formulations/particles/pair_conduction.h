// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/particles/row_pairs.h>
#include <tombolo/materials/temperature_table.h>

#include <functional>

namespace tombolo
{
  /**
   * Conduction between pairs of particles with radial kernels (Cleary and Monaghan 1999; Jubelgas
   * 2007; doc/pair_terms.md): row i, with ∇φ_j = (m_j/ρ_i) ∇_iW_ij at the present distance, lets
   * the heat per unit time
   *
   * @verbatim
   *   c_i V_i 2 k_i k_j/(k_i + k_j) |∇φ_j|/|x_ij| (T_j - T_i)
   * @endverbatim
   *
   * pass from j to i: with the row of j the usual 4 k_i k_j/(k_i + k_j). What i gets j gives, so
   * that heat is conserved to round-off; the operator is symmetric, not negative, and has no other
   * null mode than a constant. `paper` takes c = 1, and conducts too little by what a kernel sum
   * misses on a lattice; `corrected` takes c_i = dim / Σ_j |x_ij| |∇φ_j|, the inverse of that
   * factor, at most that of an undisturbed cubic lattice: at surfaces the sum is smaller since
   * neighbours are absent, which must not count.
   */
  template <int dim>
  class PairConduction
  {
  public:
    /** None: heat is conducted by the gradients of the rows. */
    PairConduction() = default;
    /** Reads the section of a formulation. */
    explicit PairConduction(const Entries &e);
    bool is_on() const
    {
      return method != Method::gradients;
    }

    /** @p slope is |dW/dr| over the distance, of the normalized kernel, zero beyond @p radius; @p
     * spacing is that of the lattice. */
    void initialize(const std::function<double(double)> &slope, double radius, double spacing);

    /** The largest c_i. */
    double lattice_factor() const
    {
      return largest_factor;
    }

    /** The local numbers i, j of a pair of a row, and the conductance K that the row gives it
     * [M L^2/(T^3 K)]. */
    using Visitor = std::function<void(unsigned int, unsigned int, double)>;

    /** Calls @p visit for every pair, with conductivities at the
     * temperatures @p of_conductivity (slot 0 of node_stride a node): for matrices, not for steps.
     */
    void for_each_pair(const PairRows &rows, const TemperatureTable &conductivity,
                       const double *position, const double *of_conductivity,
                       const Visitor &visit) const;

    /** Adds the heat per unit time to slot 0 of @p heat_rate; nodal arrays have node_stride doubles
     * a node and current ghosts, and heat goes to ghosts too. */
    void add_conduction(const PairRows &rows, const TemperatureTable &conductivity,
                        const double *position, const double *of_conductivity,
                        const double *temperature, double *heat_rate) const;

    /** Σ_j c_i |∇φ_j|/|x_ij| of a row [1/L^2]. With the diffusivity D, 1/(2 D) over the largest sum
     * bounds the stable explicit step. */
    double decay(const PairRows &rows, unsigned int row, const double *position) const;

  private:
    enum class Method
    {
      gradients,
      corrected,
      paper
    };

    template <typename AnyVisitor>
    void visit_pairs(const PairRows &rows, const TemperatureTable &conductivity,
                     const double *position, const double *of_conductivity,
                     const AnyVisitor &visit) const;

    /** c_i. */
    double factor(const PairRows &rows, unsigned int row, const double *position) const;

    Method method = Method::gradients;
    double largest_factor = 1.;
  };
} // namespace tombolo
