// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/model/model.h>
#include <tombolo/study/waves/bloch_operator.h>

#include <functional>
#include <vector>

namespace tombolo
{
  /** The operators of small motion for fields that vary as exp(i k_y y) along the interface. The
   * unknowns of a column are the two components of the displacement or velocity of its nodes. */
  struct ReducedOperators
  {
    BlochOperator smoothing; ///< S
    BlochOperator stiffness; ///< M⁻¹ K, and the trace bridge's field on both sides of K [1/T^2]
    BlochOperator viscosity; ///< M⁻¹ C of artificial viscosity, alike [1/T]
    BlochOperator interpolation;   ///< the adjoint of S, as chosen
    BlochOperator short_wave_part; ///< T = I - ΦS of the lattice filter
    BlochOperator update;          ///< A = interpolation · stiffness · smoothing [1/T^2]
    BlochOperator damping;         ///< interpolation · viscosity · smoothing [1/T]
  };

  /**
   * The linear update of small motion across a plane interface, found by applying the operators of
   * a scene to unit vectors: the bridge's smoothing, its adjoint and short wave part, the stiffness
   * of each formulation and the nodal mass, as SpectralEstimator does. The scene is a strip: a
   * lattice of columns, the interface at x = 0, high enough that the row in the middle sees neither
   * of the edges, and wide enough that the outermost probed columns see neither the ends nor the
   * interface. Both are checked on every probe.
   */
  class LinearizedOperators
  {
  public:
    /** How many cells a strip needs. */
    struct StripSize
    {
      unsigned int columns_per_side;
      unsigned int rows;
    };

    /** @p neighbour_reach is the number of columns over which particles are neighbours; 1 for
     * dilations below 2. */
    static StripSize strip_size(unsigned int neighbour_reach);

    /** Probes @p scene, which must be on one rank. */
    LinearizedOperators(const Model<2> &model, unsigned int neighbour_reach);

    /** Bloch's reduction to wave number @p wave_number along the interface [1/L]. */
    ReducedOperators reduce(double wave_number) const;

    /** m̂ of a node of a column [M]. */
    double mass(const int column) const
    {
      return masses[static_cast<std::size_t>(std::clamp(column, -n_probed, n_probed) + n_columns) *
                    3];
    }

    /** m of a node of a column [M], in the direction of @p component. */
    double nodal_mass(const int column, const unsigned int component) const
    {
      return masses[static_cast<std::size_t>(std::clamp(column, -n_probed, n_probed) + n_columns) *
                        3 +
                    1 + component];
    }

    /** Distance of the columns of a side [L]. */
    double spacing(ChainSide side) const;

  private:
    /** The responses of one operator to unit vectors in the row in the middle. */
    struct Probe
    {
      int reach = 0;
      std::vector<double> values; // [source][component][column offset][row offset][component]
    };

    using Operator = std::function<void(const NodalVector &, NodalVector &)>;

    void find_lattice(const Model<2> &model);

    unsigned int node(const int column, const unsigned int row) const
    {
      return nodes[static_cast<std::size_t>(column + n_columns) * y_coordinates.size() + row];
    }

    Probe probe(const NodalVector &like, const Operator &apply) const;
    void check_far_columns(const Probe &probe) const;
    double value(const Probe &probe, int source, unsigned int of, int column, int row,
                 unsigned int on) const;
    BlochOperator reduce(const Probe &probe, double wave_number) const;

    int reach;           // of one operator, in columns
    int n_probed;        // source columns -n_probed ... n_probed
    int n_columns;       // -n_columns ... n_columns
    unsigned int middle; // row
    std::vector<double> x_coordinates, y_coordinates;
    std::vector<unsigned int> nodes; // [column][row]
    std::vector<double> masses;      // of columns: m̂, m of component 0, m of component 1
    Probe smoothing, stiffness, viscosity, interpolation, short_wave_part;
  };
} // namespace tombolo
