// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/particles/particle_formulation.h>
#include <tombolo/materials/temperature_table.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace tombolo
{
  /** A function of the distance that ends at a radius, as straight lines between equal intervals:
   * what pair terms need of a kernel beyond its gradient, without a call of the kernel per pair. */
  class RadialTable
  {
  public:
    /** Zero everywhere. */
    RadialTable() = default;

    /** Of the values of @p function at distances from 0 to @p radius; zero beyond. */
    RadialTable(const double radius, const std::function<double(double)> &function)
        : intervals_per_length(n_intervals / radius), values(n_intervals + 2, 0.)
    {
      for (std::size_t k = 0; k < n_intervals; ++k)
        values[k] = function(static_cast<double>(k) / intervals_per_length);
    }

    double operator()(const double distance) const
    {
      const double place = std::min(distance * intervals_per_length, double(n_intervals));
      const auto interval = static_cast<std::size_t>(place);
      const double fraction = place - static_cast<double>(interval);
      return values[interval] + fraction * (values[interval + 1] - values[interval]);
    }

    Lanes operator()(const Lanes &distance) const
    {
      alignas(64) double entries[n_lanes];
      store_lanes(distance, entries);
      for (double &entry : entries)
        entry = (*this)(entry);
      return load_lanes(entries);
    }

  private:
    static constexpr std::size_t n_intervals = 2048;

    double intervals_per_length = 0.;
    std::vector<double> values = std::vector<double>(n_intervals + 2, 0.);
  };

  /** The pairs of particles of one part: the neighbours of rows, whatever the rows do with them,
   * and what makes kernel gradients of distances. It points to data of others. */
  struct PairRows
  {
    const Stencils *shape;
    const double *node_volume; ///< V⁰ by local node as others see it, ghosts and images too
    const double
        *initial_volume;      ///< V⁰ of each row: on planes of symmetry, of its part in the body
    const double *volume;     ///< V of each row
    const RadialTable *slope; ///< |dW/dr| over the distance
  };

  /**
   * n_lanes pairs of the particle i of a row with its neighbours j, at the present positions. Each
   * pair of particles stands in the rows of both: what acts between them is the sum of a half from
   * either row, which goes to both ends with opposite signs, so that no rank needs more of the
   * particles of another than where they are and how large they were.
   */
  template <int dim>
  struct RowPairs
  {
    /** Those from neighbour @p first of @p row on, whose particle @p particle is at @p own. Lanes
     * beyond the end of the row are pairs of the particle with itself, without weight. */
    RowPairs(const PairRows &rows, const unsigned int row, const unsigned int first,
             const unsigned int particle, const Lanes (&own)[dim], const double *position)
        : n(std::min(n_lanes, rows.shape->row(row).size - first))
    {
      const unsigned int *const neighbour = rows.shape->row(row).neighbour + first;
      alignas(64) double volume[n_lanes];
      for (unsigned int lane = 0; lane < n_lanes; ++lane)
      {
        node[lane] = lane < n ? neighbour[lane] : particle;
        volume[lane] = rows.node_volume[node[lane]];
      }
      gather_nodes(position, node, offset);
      squared = 0.;
      for (unsigned int d = 0; d < dim; ++d)
      {
        offset[d] -= own[d];
        squared += offset[d] * offset[d];
      }
      const LaneMask is_pair = squared > 0.;
      where(!is_pair, squared) = 1.;
      distance = square_root(squared);
      of_row = rows.volume[row] / rows.initial_volume[row];
      other_volume = load_lanes(volume);
      where(!is_pair, other_volume) = 0.;
      weight = of_row * other_volume * (*rows.slope)(distance) / distance;
    }

    /** Σ_d a_d (x_j - x_i)_d */
    Lanes along_offset(const Lanes (&a)[dim]) const
    {
      Lanes sum = a[0] * offset[0];
      for (unsigned int d = 1; d < dim; ++d)
        sum += a[d] * offset[d];
      return sum;
    }

    unsigned int n; ///< pairs of the row among the lanes
    unsigned int node[n_lanes];
    Lanes offset[dim];  ///< x_j - x_i
    Lanes squared;      ///< its square; 1 for a particle with itself
    Lanes distance;     ///< its root
    double of_row;      ///< V_i/V⁰_i
    Lanes other_volume; ///< V⁰_j; 0 for a particle with itself
    /** m_j/ρ_i |dW/dr|/r, the size of ∇φ_j over the distance; 0 for a particle with itself. */
    Lanes weight;
  };

  /** A nodal value of one particle in all lanes. */
  template <int dim>
  TOMBOLO_ALWAYS_INLINE void spread_node(const double *field, const unsigned int local,
                                         Lanes (&components)[dim])
  {
    for (unsigned int d = 0; d < dim; ++d)
      components[d] = field[static_cast<std::size_t>(local) * NodeLanes::size() + d];
  }

  /** The sum of the lanes. */
  TOMBOLO_ALWAYS_INLINE double sum_of_lanes(const Lanes &value)
  {
    double sum = value[0];
    for (unsigned int lane = 1; lane < n_lanes; ++lane)
      sum += value[lane];
    return sum;
  }

  /** Calls @p use with all pairs of a row, n_lanes at a time. */
  template <int dim, typename Use>
  TOMBOLO_ALWAYS_INLINE void for_pairs_of_row(const PairRows &rows, const unsigned int row,
                                              const double *position, const Use &use)
  {
    const unsigned int particle = rows.shape->particle_node[row];
    const unsigned int n_neighbours = rows.shape->row(row).size;
    Lanes own[dim];
    spread_node(position, particle, own);
    for (unsigned int first = 0; first < n_neighbours; first += n_lanes)
      use(RowPairs<dim>(rows, row, first, particle, own, position));
  }

  /**
   * What acts between pairs of particles with radial kernels beyond their stresses
   * (doc/pair_terms.md), each off unless chosen. With x_ij = x_i - x_j, v_ij = v_i - v_j, the
   * smoothing length h, the speed c of P waves and ∇φ_j = (m_j/ρ_i) ∇_iW_ij at the present
   * distance, whatever the gradients of the rows are corrected to, row i gives
   *
   * @verbatim
   *   artificial viscosity  ½ m_i (-α c µ + β µ²) |∇φ_j| x_ij/|x_ij|
   *                         for v_ij·x_ij < 0, with µ = h v_ij·x_ij/(x_ij² + 0.01 h²)
   *   artificial stress     -ε V_i (W(x_ij)/W(dp))^n σ_i⁺ ∇φ_j, σ⁺ the tensile principal stresses
   *   XSPH                  ½ ε m_i m_j W(x_ij)/ρ_i (v_j - v_i)/m_i
   * @endverbatim
   *
   * to particle i and the opposite to j (XSPH: with m_j in place of the last m_i). The sum of both
   * rows are the usual terms, with the mean of 1/ρ_i and 1/ρ_j where those have the inverse of a
   * mean density. The viscosity acts along x_ij and conserves linear and angular momentum; the
   * artificial stress (Gray, Monaghan, Swift 2001) conserves linear momentum only. XSPH is a
   * velocity with which positions are moved in addition; velocities do not know it. Its weights are
   * symmetric, so that it keeps the centre of mass and the angular momentum.
   *
   * Nodal arrays are at the address of local node 0, node_stride doubles a node, with current
   * ghosts where they are read; forces are added at ghosts too.
   */
  template <int dim>
  class PairTerms
  {
  public:
    /** None. */
    PairTerms() = default;
    /** Reads the section of a formulation, where `Configuration` stands too. Throws InputError. */
    explicit PairTerms(const Entries &e);
    /** Lengths and moduli: @p kernel is W over the distance, normalized, for the smoothing length
     * h, zero beyond @p radius; @p spacing is dp. */
    void initialize(const Material &material, const std::function<double(double)> &kernel,
                    double radius, double smoothing_length, double spacing);

    bool has_viscosity() const
    {
      return linear > 0. || quadratic > 0.;
    }
    bool has_artificial_stress() const
    {
      return stress_factor > 0.;
    }
    bool has_xsph() const
    {
      return xsph_factor > 0.;
    }
    bool is_on() const
    {
      return has_viscosity() || has_artificial_stress() || has_xsph();
    }

    /** Adds the viscous forces of the rows, and to @p power by row what they take per
     * unit time, which is not negative. */
    void add_viscous_force(const PairRows &rows, const double *position, const double *velocity,
                           double *force, double *power) const;

    /** Adds @p factor C @p direction, where -C v is the force of small @p velocity differences of
     * all pairs, those that separate too. */
    void apply_viscosity(const PairRows &rows, const double *position, const double *velocity,
                         const double *direction, double factor, double *force) const;

    /** Adds the forces of the artificial stress. @p points have the stresses of the rows. */
    void add_artificial_stress(const PairRows &rows, const MaterialPoints &points,
                               const double *position, double *force) const;

    /** Adds the momenta ½ ε m_i m_j W/ρ_i (v_j - v_i) that XSPH exchanges. */
    void add_exchanged_momentum(const PairRows &rows, const double *position,
                                const double *velocity, double *momentum) const;

  private:
    double linear = 0., quadratic = 0.;
    double stress_factor = 0., stress_exponent = 0.;
    double xsph_factor = 0.;

    double smoothing_length = 0., wave_speed = 0.;
    double inertia_ratio = 1.; // inertial over true density
    RadialTable stress_weight; // (W/W(dp))^n
    RadialTable kernel_value;  // W
  };

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

  /** What particle formulations have whose particles act on each other in pairs, beside what their
   * rows do: with radial kernels. */
  template <int dim>
  class PairInteractions
  {
  public:
    virtual ~PairInteractions() = default;

    /** Forces and motion of pairs. */
    virtual const PairTerms<dim> &pair_terms() const = 0;

    /** The pairs, with the present volumes. Valid until the partition, the rows or the points of
     * the part change. */
    virtual PairRows pair_rows() const = 0;

    /** Where heat is conducted between pairs and not by the gradients of the rows, calls @p visit
     * for the local numbers and conductances of all pairs of the rows, and returns true. Arguments
     * as in Formulation::add_conduction(). */
    virtual bool visit_conductances(const NodalVector &position, const NodalVector &of_conductivity,
                                    const typename PairConduction<dim>::Visitor &visit) const = 0;
  };
} // namespace tombolo
