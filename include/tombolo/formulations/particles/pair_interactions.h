// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/stencils.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/simd/node_lanes.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/formulations/particles/particle_formulation.h>
#include <tombolo/materials/temperature_table.h>

#include <deal.II/base/aligned_vector.h>

#include <algorithm>
#include <cmath>
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

    Lanes operator()(const Lanes &distance) const
    {
      return interpolate_lanes(values.data(), distance * intervals_per_length, n_intervals);
    }

  private:
    static constexpr std::size_t n_intervals = 2048;

    double intervals_per_length = 0.;
    std::vector<double> values = std::vector<double>(n_intervals + 2, 0.);
  };

  /** The pairs of particles of one part: the neighbours of rows, whatever the rows do with them,
   * and the kernel gradient over the distance. It points to data of others. */
  struct PairRows
  {
    const Stencils *shape;
    /** The entry of the particle itself in each row. Particles of this rank with smaller numbers
     * stand before it, those with larger numbers and ghosts behind. */
    const std::size_t *own_entry;
    std::size_t n_nodes; ///< local ones, with ghosts and images
    /** By local node, node_stride each: V⁰ as it acts on others, and the present V of particles
     * with a row, else zero. On planes of symmetry V is of the part in the body. */
    const double *volumes;
    const double *initial_volume; ///< V⁰ of each row, as V
    const RadialTable *slope;     ///< |dW/dr| over the distance

    /** V_i and V_i/V⁰_i of a row. */
    double volume(const unsigned int row) const
    {
      return volumes[std::size_t(shape->particle_node[row]) * node_stride + 1];
    }
    double volume_ratio(const unsigned int row) const
    {
      return volume(row) / initial_volume[row];
    }
  };

  /**
   * n_lanes pairs of the particle i of a row with particles j behind it, at the present positions.
   * Each pair of two particles of this rank stands in the rows of both, and is treated once: the
   * interaction is the sum of a half from either row. A ghost has its row on another rank, so that
   * its half is zero here, and a rank needs only position and size of particles of another one.
   */
  template <int dim>
  struct RowPairs
  {
    /** Those of @p n neighbours, whose particle @p particle is at @p own. Lanes beyond are pairs of
     * the particle with itself, without weight. */
    TOMBOLO_ALWAYS_INLINE RowPairs(const PairRows &rows, const unsigned int *neighbour,
                                   const unsigned int n, const unsigned int particle,
                                   const Lanes (&own)[dim], const double *position)
        : n(n), node(neighbour)
    {
      if (n < n_lanes)
      {
        for (unsigned int lane = 0; lane < n_lanes; ++lane)
          last[lane] = lane < n ? neighbour[lane] : particle;
        node = last;
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
      const Lanes inverse = reciprocal_root(squared);
      distance = squared * inverse;
      Lanes slope = (*rows.slope)(distance)*inverse;
      where(!is_pair, slope) = 0.;
      const double *const own_volumes = rows.volumes + std::size_t(particle) * node_stride;
      Lanes other[2];
      gather_nodes(rows.volumes, node, other);
      volumes = other[0] * own_volumes[1];
      row_slope = slope * volumes;
      other_slope = slope * other[1] * own_volumes[0];
      volumes += other[1] * own_volumes[0];
    }
    RowPairs(const RowPairs &) = delete;
    RowPairs &operator=(const RowPairs &) = delete;

    /** Σ_d a_d (x_j - x_i)_d */
    Lanes along_offset(const Lanes (&a)[dim]) const
    {
      Lanes sum = a[0] * offset[0];
      for (unsigned int d = 1; d < dim; ++d)
        sum += a[d] * offset[d];
      return sum;
    }

    unsigned int n; ///< pairs among the lanes
    const unsigned int *node;
    unsigned int last[n_lanes];
    Lanes offset[dim]; ///< x_j - x_i
    Lanes squared;     ///< its square; 1 for a particle with itself
    Lanes distance;    ///< |x_j - x_i|
    /** V_i V⁰_j |dW/dr|/r: V⁰_i |∇φ_j| of row i over r. Zero for a particle with itself. */
    Lanes row_slope;
    Lanes other_slope; ///< the same of row j
    Lanes volumes;     ///< V_i V⁰_j + V_j V⁰_i, also of a particle with itself
  };

  /** A nodal value of one particle in all lanes. */
  template <int dim>
  TOMBOLO_ALWAYS_INLINE void spread_node(const double *field, const unsigned int local,
                                         Lanes (&components)[dim])
  {
    for (unsigned int d = 0; d < dim; ++d)
      components[d] = field[static_cast<std::size_t>(local) * NodeLanes::size() + d];
  }

  /** Calls @p use with the pairs of a row that stand behind its particle, n_lanes at a time. */
  template <int dim, typename Use>
  TOMBOLO_ALWAYS_INLINE void for_pairs_of_row(const PairRows &rows, const unsigned int row,
                                              const double *position, const Use &use)
  {
    const unsigned int particle = rows.shape->particle_node[row];
    Lanes own[dim];
    spread_node(position, particle, own);
    const std::size_t end = rows.shape->row_start[row + 1];
    for (std::size_t entry = rows.own_entry[row] + 1; entry < end; entry += n_lanes)
      use(RowPairs<dim>(rows, rows.shape->neighbour.data() + entry,
                        static_cast<unsigned int>(std::min<std::size_t>(n_lanes, end - entry)),
                        particle, own, position));
  }

  /** The viscosity of all pairs of a part for small changes of the velocity: C = Σ e eᵀ, where a
   * vector e of each pair multiplies differences of velocities. */
  template <int dim>
  class PairDampers
  {
  public:
    /** Adds @p factor C @p direction. */
    void apply(const double *direction, double factor, double *force) const;

  private:
    template <int>
    friend class PairTerms;

    std::vector<unsigned int> particle;     // of each row
    std::vector<std::size_t> start;         // of rows, whole Lanes each
    std::vector<unsigned int> node;         // the other of each pair; that of the row without one
    dealii::AlignedVector<double> way[dim]; // e
  };

  /**
   * The interactions of pairs of particles with radial kernels beyond their stresses
   * (doc/pair_terms.md), each off unless chosen. With x_ij = x_i - x_j, v_ij = v_i - v_j, the
   * smoothing length h, the speed c of P waves and ∇φ_j = (m_j/ρ_i) ∇_iW_ij at the present
   * distance, whatever the gradients of the rows are corrected to, row i adds
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
   * velocity with which positions are moved in addition; velocities do not include it. Its weights
   * are symmetric, so that it keeps the centre of mass and the angular momentum.
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

    /** Adds the forces of the viscosity and of the artificial stress, where they are on, and unless
     * @p power is null the power that the viscosity dissipates, which is not negative, by local
     * node. @p points have the stresses of the rows. */
    void add_forces(const PairRows &rows, const MaterialPoints &points, const double *position,
                    const double *velocity, double *viscous_force, double *power,
                    double *stress_force) const;

    /** Sets C of @p dampers: -C v is the viscous force of small velocity changes of all pairs. */
    void linearize_viscosity(const PairRows &rows, const double *position, const double *velocity,
                             PairDampers<dim> &dampers) const;

    /** Adds the momenta ½ ε m_i m_j W/ρ_i (v_j - v_i) that XSPH exchanges. */
    void add_exchanged_momentum(const PairRows &rows, const double *position,
                                const double *velocity, double *momentum) const;

  private:
    /** ε V_i/V⁰_i σ_i⁺ of the rows, for their pairs. Returns whether there is tension. */
    bool find_tensile_parts(const PairRows &rows, const MaterialPoints &points) const;

    double linear = 0., quadratic = 0.;
    double stress_factor = 0., stress_exponent = 0.;
    double xsph_factor = 0.;

    double smoothing_length = 0., wave_speed = 0.;
    double inertia_ratio = 1.; // inertial over true density
    RadialTable stress_weight; // (W/W(dp))^n
    RadialTable kernel_value;  // W
    /** By local node: xx, yy, xy in the plane; xx, yy, zz and yz, zx, xy in space. A buffer. */
    mutable dealii::AlignedVector<double> tensile[dim - 1];
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
   * pass from j to i: with the row of j the usual 4 k_i k_j/(k_i + k_j). What i receives j loses,
   * so that heat is conserved to round-off; the operator is symmetric, not negative, and has no
   * other null mode than a constant. `paper` takes c = 1, and conducts too little by what a kernel
   * sum misses on a lattice; `corrected` takes c_i = dim / Σ_j |x_ij| |∇φ_j|, the inverse of that
   * factor, at most that of an undisturbed cubic lattice: at surfaces the sum is smaller since
   * neighbours are absent, which must not count.
   */
  template <int dim>
  class PairConduction
  {
  public:
    /** None: heat is conducted by the gradients of the rows. */
    PairConduction() = default;
    explicit PairConduction(const Entries &e)
    {
      const std::string name =
          e.choice("Conduction", "corrected", "corrected|paper|gradients",
                   "How heat passes between particles: in pairs as in SPH, `corrected` by what the "
                   "sum over a lattice misses, or as in the `paper`, which conducts too little by "
                   "some percent at every spacing; or by the `gradients` of the rows, which do not "
                   "see temperatures that alternate from particle to particle. Pairs need a kernel "
                   "in the current configuration; others take `gradients` unless it is set.");
      const bool is_current = e.given("Configuration") == "current";
      if (e.declares() || name == "gradients" || (!is_current && !e.is_set("Conduction")))
        return;
      e.refuse(!is_current, "Conduction",
               "the distances of pairs do not fit the gradients of a kernel that keeps its "
               "reference; allowed is `gradients`, or `Configuration = current`.");
      method = name == "paper" ? Method::paper : Method::corrected;
    }
    bool is_on() const
    {
      return method != Method::gradients;
    }

    /** @p slope is |dW/dr| over the distance, of the normalized kernel, zero beyond @p radius; @p
     * spacing is that of the lattice. */
    void initialize(const std::function<double(double)> &slope, const double radius,
                    const double spacing)
    {
      largest_factor = method == Method::corrected ? 1. / lattice_sum(slope, radius, spacing) : 1.;
    }

    /** The largest c_i. */
    double lattice_factor() const
    {
      return largest_factor;
    }

    /** Local numbers i, j of a pair, and its conductance by rows of this rank [M L^2/(T^3 K)]. */
    using Visitor = std::function<void(unsigned int, unsigned int, double)>;

    /** Calls @p visit for every pair, with conductivities at the temperatures @p
     * conductivity_temperature (slot 0): for matrices, not for steps. */
    void for_each_pair(const PairRows &rows, const TemperatureTable &conductivity,
                       const double *position, const double *conductivity_temperature,
                       const Visitor &visit) const
    {
      visit_pairs(rows, conductivity, position, conductivity_temperature,
                  [&](const unsigned int i, const RowPairs<dim> &pairs, const Lanes &conductance)
                  {
                    for (unsigned int lane = 0; lane < pairs.n; ++lane)
                      if (conductance[lane] > 0.)
                        visit(i, pairs.node[lane], conductance[lane]);
                  });
    }

    /** Adds the heat per unit time to slot 0 of @p heat_rate; nodal arrays have node_stride doubles
     * a node and current ghosts, and heat is added at ghosts, too. */
    void add_conduction(const PairRows &rows, const TemperatureTable &conductivity,
                        const double *position, const double *conductivity_temperature,
                        const double *temperature, double *heat_rate) const
    {
      visit_pairs(rows, conductivity, position, conductivity_temperature,
                  [&](const unsigned int i, const RowPairs<dim> &pairs, const Lanes &conductance)
                  {
                    Lanes heat[1];
                    gather_nodes(temperature, pairs.node, heat);
                    heat[0] = conductance * (temperature[std::size_t(i) * node_stride] - heat[0]);
                    add_to_nodes(heat, pairs.node, pairs.n, heat_rate);
                    heat_rate[std::size_t(i) * node_stride] -= reduce(heat[0]);
                  });
    }

    /** Calls @p use with each row and its Σ_j c_i |∇φ_j|/|x_ij| [1/L^2]. With the diffusivity D,
     * 1/(2 D) over the largest sum bounds the stable explicit step. */
    void for_each_decay(const PairRows &rows, const double *position,
                        const std::function<void(unsigned int, double)> &use) const
    {
      find_factors(rows, position);
      for (unsigned int row = 0; row < rows.shape->n_particles(); ++row)
      {
        const double *const own =
            &nodal_buffer[std::size_t(rows.shape->particle_node[row]) * node_stride];
        use(row, own[0] / rows.volume_ratio(row) * own[1]);
      }
    }

  private:
    /** Σ_j V |x_j| |W'(x_j)| / dim of a cubic lattice of this spacing. */
    static double lattice_sum(const std::function<double(double)> &slope, const double radius,
                              const double spacing)
    {
      const int n = static_cast<int>(std::ceil(radius / spacing));
      const int n_in_depth = dim == 3 ? n : 0;
      double sum = 0;
      for (int i = -n; i <= n; ++i)
        for (int j = -n; j <= n; ++j)
          for (int k = -n_in_depth; k <= n_in_depth; ++k)
          {
            const double distance = spacing * std::sqrt(double(i * i + j * j + k * k));
            if (distance > 0. && distance < radius)
              sum += distance * slope(distance);
          }
      return sum * std::pow(spacing, dim) / dim;
    }

    enum class Method
    {
      gradients,
      corrected,
      paper
    };

    /** Calls use(particle, pairs, conductances). */
    template <typename Use>
    void visit_pairs(const PairRows &rows, const TemperatureTable &conductivity,
                     const double *position, const double *conductivity_temperature,
                     const Use &use) const
    {
      if (conductivity.largest() == 0.)
        return;
      find_factors(rows, position);
      for (std::size_t slot = 0; slot < rows.n_nodes * node_stride; slot += node_stride)
        nodal_buffer[slot + 1] = conductivity.is_constant()
                                     ? conductivity.largest()
                                     : conductivity.value(conductivity_temperature[slot]);
      const Stencils &shape = *rows.shape;
      Lanes other[2];
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        const double *const own =
            &nodal_buffer[std::size_t(shape.particle_node[row]) * node_stride];
        for_pairs_of_row<dim>(rows, row, position,
                              [&](const RowPairs<dim> &pairs) TOMBOLO_INLINE_LAMBDA
                              {
                                gather_nodes(nodal_buffer.data(), pairs.node, other);
                                const Lanes sum = own[1] + other[1];
                                Lanes conductance =
                                    2. * own[1] * other[1] *
                                    (own[0] * pairs.row_slope + other[0] * pairs.other_slope) / sum;
                                where(!(sum > 0.), conductance) = 0.;
                                use(shape.particle_node[row], pairs, conductance);
                              });
      }
    }

    /** Sets nodal_buffer of the rows to c_i V_i/V⁰_i and Σ_j |∇φ_j|/|x_ij|. */
    void find_factors(const PairRows &rows, const double *position) const
    {
      // Sums of the rows: of the squared distances, and of one, times V⁰ of the row.
      nodal_buffer.resize_fast(rows.n_nodes * node_stride);
      nodal_buffer.fill(0.);
      const Stencils &shape = *rows.shape;
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        Lanes squares = 0., sum = 0., other_sums[2];
        for_pairs_of_row<dim>(rows, row, position,
                              [&](const RowPairs<dim> &pairs) TOMBOLO_INLINE_LAMBDA
                              {
                                squares += pairs.row_slope * pairs.squared;
                                sum += pairs.row_slope;
                                other_sums[0] = pairs.other_slope * pairs.squared;
                                other_sums[1] = pairs.other_slope;
                                add_to_nodes(other_sums, pairs.node, pairs.n, nodal_buffer.data());
                              });
        double *const own = &nodal_buffer[std::size_t(shape.particle_node[row]) * node_stride];
        own[0] += reduce(squares);
        own[1] += reduce(sum);
      }
      for (unsigned int row = 0; row < shape.n_particles(); ++row)
      {
        double *const own = &nodal_buffer[std::size_t(shape.particle_node[row]) * node_stride];
        const double moment = own[0] / rows.initial_volume[row];
        own[0] = rows.volume_ratio(row) * (method == Method::paper         ? 1.
                                           : moment * largest_factor > dim ? dim / moment
                                                                           : largest_factor);
        own[1] /= rows.initial_volume[row];
      }
    }

    Method method = Method::gradients;
    double largest_factor = 1.;
    mutable dealii::AlignedVector<double> nodal_buffer; // node_stride each: a buffer
  };

  /** Particle formulations whose particles also act on each other in pairs, beside their rows. */
  template <int dim>
  class PairInteractions
  {
  public:
    virtual ~PairInteractions() = default;

    virtual const PairTerms<dim> &pair_terms() const = 0;

    /** The pairs, with present volumes; valid until partition, rows or points change. */
    virtual PairRows pair_rows() const = 0;

    /** Where heat is conducted between pairs, calls @p visit for the local numbers and conductances
     * of all of them, and returns true. Arguments as in Formulation::add_conduction(). */
    virtual bool visit_conductances(const NodalVector &position,
                                    const NodalVector &conductivity_temperature,
                                    const typename PairConduction<dim>::Visitor &visit) const = 0;
  };
} // namespace tombolo
