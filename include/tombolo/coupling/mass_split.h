// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/smoothing_settings.h>
#include <tombolo/approximation/stencils.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/aligned_vector.h>

#include <cstdint>
#include <memory>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * The masses of the nodes, split by component into a part that is the node's own and parts that
   * particles smooth, of which a Bridge makes its operators: m = W 1 (eqs 11, 21, 48).
   *
   * Where rows are lumped (Stencils::is_lumped) S still divides by W 1, but m is the lumped mass,
   * which the nodal forces accelerate, and m̂ = Sᵀ m: then a constant acceleration of all nodes is
   * one of all v̂, and momentum and energy are those of every S. m̂ is that of S without prescribed
   * components, so that it is one number a node.
   */
  class MassSplit
  {
  public:
    struct ParticlePart
    {
      Stencils *shape;
      bool is_smoothed = true;
      dealii::AlignedVector<double> smoothed_mass;     ///< by component, node_stride per row [M]
      dealii::AlignedVector<double> smoothed_fraction; ///< of m̂, node_stride per row
      dealii::AlignedVector<double> row_mass; ///< where nothing is prescribed; if has_lumped_rows
      std::vector<unsigned int> element_rows; ///< rows of nodes shared with elements

      TOMBOLO_ALWAYS_INLINE NodeLanes fraction_of_row(const std::size_t row) const
      {
        return load_node(smoothed_fraction.data() + row * node_stride);
      }
    };

    /** The masses that are split; for heat, capacities. */
    struct Masses
    {
      const std::vector<Stencils *> &particle_parts;
      const NodalVector &element_mass; ///< of elements at nodes, scalar, owned values
      /** A bit per component for each owned node, or empty. */
      const std::vector<std::uint8_t> &constrained;
      const std::vector<double> &weights; ///< factors of the masses of the parts; empty: one
      /** Further factors of single particles, by part and row; empty, also those of a part: one. */
      const std::vector<std::vector<double>> &row_weights;

      /** m̂ of a row [M]. */
      double mass_of_row(std::size_t part, unsigned int row) const;
    };

    /** Without @p smoothing all mass is own. Of capacities @p is_of_motion is false: they stay in
     * their layers (Stencils::accelerated_share), as sources of heat do. Collective. */
    MassSplit(const SmoothingSettings &smoothing, bool is_trace, bool is_of_motion = true);

    /** See Bridge::set_smoothed_parts(). */
    void set_smoothed_parts(const std::vector<bool> &are_smoothed)
    {
      parts.resize(are_smoothed.size());
      for (std::size_t p = 0; p < parts.size(); ++p)
        parts[p].is_smoothed = are_smoothed[p];
    }

    /** Splits @p masses anew; nodal_mass is not found yet. Collective. */
    void reinit(const std::shared_ptr<const NodePartition> &partition, const Masses &masses);

    /** Finds nodal_mass, after shape functions changed their values or lost neighbours too. Where
     * nodes have too little (SmoothingSettings::smallest_mass_share), rows change, but for those of
     * the first time. Returns whether it is positive at all nodes. Collective. */
    bool update_nodal_mass();

    /** Whether rows lost negative values since the last call. */
    bool extract_change_of_rows()
    {
      return std::exchange(rows_have_changed, false);
    }

    /** m̂ of the nodes, scalar [M]. */
    const NodalVector &unsmoothed_mass() const
    {
      return has_lumped_rows ? adjoint_mass : total_mass;
    }
    /** The mass that body forces act on, scalar [M]: m before its smoothing, if that spreads loads,
     * too. */
    const NodalVector &loaded_mass() const
    {
      return has_lumped_rows ? body_mass : total_mass;
    }
    /** The largest lumped mass over m̂; 1 without lumped rows. */
    double largest_mass_ratio() const
    {
      return has_lumped_rows ? largest_ratio : 1.;
    }
    /** W 1 by component, with current ghosts [M]. */
    const NodalVector &row_sums() const
    {
      return has_lumped_rows ? sums_of_rows : nodal_mass;
    }
    /** m a / (W 1) of a nodal field a, the field itself without lumped rows. @p field has current
     * ghosts, and so has the result, which is valid until the next call. */
    const NodalVector &field_over_row_sums(const NodalVector &field);
    /** Scales I - ΦS of a field so that it is symmetric with the masses m̂, too, and not above one:
     * then taking it away keeps the linear momentum. Updates ghosts. */
    void make_symmetric(NodalVector &short_wave_part) const;
    /** ½ v·m v of a nodal field with scalar masses. Collective. */
    static double kinetic_energy(const NodalVector &mass, const NodalVector &velocity);

    /** Of each owned node: whether its mass is its own in all components, so that smoothing leaves
     * its velocity, and no plane of symmetry changes it. */
    std::vector<bool> move_alone() const;

    TOMBOLO_ALWAYS_INLINE NodeLanes own_mass_of(const std::size_t k) const
    {
      return load_node(own_mass.data() + k * node_stride);
    }

    TOMBOLO_ALWAYS_INLINE NodeLanes own_fraction_of(const std::size_t k) const
    {
      return load_node(own_fraction.data() + k * node_stride);
    }

    /** Adds the own part of W @p velocity at owned nodes. */
    void add_own_momentum(const NodalVector &velocity, NodalVector &result) const;

    /** @p result = the own fraction of @p field at owned nodes, zero elsewhere. */
    void set_own_fraction(const NodalVector &field, NodalVector &result) const;

    std::vector<ParticlePart> parts;
    bool shared_by_particle_parts = false;      ///< a node has rows in two of them
    std::vector<unsigned int> n_particle_parts; ///< that smooth it, of each owned node
    std::vector<unsigned int> own_nodes;        ///< owned nodes with own mass in some component
    dealii::AlignedVector<double> own_mass;     ///< node_stride per own node [M]
    dealii::AlignedVector<double> own_fraction; ///< of m̂, node_stride per own node
    NodalVector total_mass;                     ///< lumped; m̂ without lumped rows; scalar [M]
    NodalVector nodal_mass;                     ///< m by component [M]
    bool has_lumped_rows = false;

  private:
    void sum_total_mass(const std::shared_ptr<const NodePartition> &partition,
                        const Masses &masses);
    /** Splits the masses of the rows; subtracts what is smoothed from @p own. */
    void split_rows(const Masses &masses, std::vector<double> &own);
    void collect_own_nodes(std::vector<double> &own);
    /** Sets the fractions of components across planes of symmetry at nodes on them to zero: nothing
     * moves there, also by round-off, which a step and its repetition after a checkpoint would not
     * have alike. */
    void clear_fractions_on_planes();
    void sum_nodal_mass();
    /** W 1, or with @p as_accelerated m, without prescribed components where not @p constrained,
     * into @p result at owned nodes. Collective. */
    void sum_rows(bool constrained, bool as_accelerated, NodalVector &result);
    double accelerated_share(const ParticlePart &part, const unsigned int row) const
    {
      return is_of_motion && part.shape->is_lumped ? part.shape->accelerated_share[row] : 1.;
    }
    /** m and m̂ where rows are lumped. Collective. */
    void find_lumped_masses();
    /** Whether m is above @p share of m̂ at all nodes of all ranks. Collective. */
    bool has_mass_above(double share) const;
    /** In rows with a negative φ of a node with too little mass. Returns whether there was any on
     * any rank. Collective. */
    bool remove_negative_values();

    bool is_smoothed;
    double smallest_mass_share;
    bool is_trace;
    bool is_of_motion;
    bool has_started = false; // nodal_mass was found once
    bool rows_have_changed = false;
    NodalVector ones;
    NodalVector free_own_mass; // without prescribed components [M]
    NodalVector sums_of_rows, ratio_of_masses, adjoint_mass, body_mass,
        scaled;                // if has_lumped_rows
    double largest_ratio = 1.; // of the lumped mass to m̂
  };
} // namespace tombolo
