// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/output/history.h>

#include <array>
#include <memory>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * The dimensions of a specimen that stands with its foot on a plane, as in an impact test
   * (Pan et al. 2019, Sec. 4.1.3): `specimen.csv`, `results` of the summary, and the screen.
   *
   * Surfaces are chosen once, in the initial mesh, and followed by the current positions of the
   * corners of their faces, which are nodes of elements or particles. Means over the circumference
   * are integrals over the angle about the axis, so that a half or a quarter between symmetry
   * planes has those of the whole. A row of specimen.csv comes every so many steps and at each
   * output; averages over time are those of the rows.
   */
  class SpecimenShape : public History<3>
  {
  public:
    /** What is measured at one time. NaN where there is nothing to measure. */
    struct Dimensions
    {
      double length = 0;                ///< extent of foot, side and rear along the axis
      double foot_diameter = 0;         ///< mean over the edge between foot and side
      double largest_foot_diameter = 0; ///< twice the largest radius on that edge
      double largest_diameter = 0;      ///< twice the largest radius of foot, side and rear
      double bulge_diameter = 0;        ///< mean where side and plane at the bulge height meet
    };

    explicit SpecimenShape(const Entries &e);

    /** Throws InputError where a surface has no face or foot and side have no edge in common. */
    void check(const OutputView<3> &view) override;

    void write(const OutputView<3> &view, TimeTable &statistics) override;
    void finish(Json &results) override;
    std::string report() const override;

    /** Measures the present positions. Collective; the same on all ranks. */
    Dimensions measure(const OutputView<3> &view) const;

    /** The mean of |computed - test| / test over length, foot and bulge diameter, Eq. (42). */
    double mean_error(const Dimensions &dimensions) const;

  private:
    using GlobalNode = dealii::types::global_dof_index;

    void select_surfaces(const OutputView<3> &view);
    void find_local_nodes(const OutputView<3> &view);
    bool is_sampled(const OutputView<3> &view) const
    {
      return has_present && step_of_present == view.step;
    }

    bool has_row(const OutputView<3> &view) const override;
    void add_columns(const OutputView<3> &view) override;
    void end_row(const OutputView<3> &view) override;
    std::string text_of(const Dimensions &dimensions) const;

    unsigned int axis;
    std::array<double, 3> point_on_axis;
    double average_from; ///< negative: no averages
    double bulge_height; ///< above the lowest point of the foot [L]
    std::array<double, 3> test_dimensions;
    bool has_test = false;

    // Of owned cells, global and, for one partition at a time, local: nodes of foot, side and rear;
    // pairs of nodes for the edges between foot and side; four for each face of the side, around.
    std::vector<GlobalNode> surface_nodes, edge_nodes, side_nodes;
    std::vector<unsigned int> local_surface, local_edges, local_sides;
    std::shared_ptr<const NodePartition> partition;

    Dimensions measured; ///< of the row that is being written
    Dimensions present;
    double time_of_present = 0;
    std::uint64_t step_of_present = 0;
    bool has_present = false;
    Dimensions time_integral; ///< of the samples since `average_from`, by the trapezoidal rule
    double averaged_time = 0;
    bool is_averaging = false;
    bool is_finished = false;
  };
} // namespace tombolo
