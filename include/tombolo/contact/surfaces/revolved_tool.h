// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/contact/surfaces/rigid_profile.h>
#include <tombolo/contact/surfaces/rigid_tool.h>

#include <vector>

namespace tombolo
{
  /**
   * A rigid tool whose outline is a RigidProfile: a body of revolution about its axis in three
   * dimensions, the section through its axis in two. Coordinates of the profile are the distance
   * from the axis and the place along it, from the tool's origin on; a tool of revolution that
   * spins touches the same places, but drags along what it touches.
   *
   * @tparam Outline is derived from ToolOutline, with a constructor from Entries.
   */
  template <int dim, typename Outline>
  class RevolvedTool : public RigidTool<dim>
  {
  public:
    explicit RevolvedTool(const Entries &e);

    void evaluate_gaps(const NodalVector &position, const std::vector<unsigned int> &nodes,
                       double time, std::vector<double> &gap) const override;
    void set_reach(const double distance) override
    {
      reach = distance;
    }
    dealii::Tensor<1, dim> normal(const dealii::Tensor<1, dim> &point, double time) const override;
    FacetList<dim> picture(double time, const dealii::Tensor<1, dim> &low,
                           const dealii::Tensor<1, dim> &high) const override;

  private:
    dealii::Tensor<1, dim> axis_at(double time) const;

    dealii::Tensor<1, dim> axis;
    RigidProfile profile;
    double reach = 0;
  };

  /** The corners of a profile, and the radius by which its edges are rounded [L]. */
  struct ToolOutline
  {
    std::vector<RigidProfile::Place> corners;
    double edge_radius = 0;

  protected:
    void read_edge_radius(const Entries &e);
  };

  /** A friction drill: a small cone in the centre, a cone up to the full diameter, a cylinder; the
   * origin is the tip. */
  struct DrillOutline : ToolOutline
  {
    explicit DrillOutline(const Entries &e);
  };

  /** A pin below a shoulder, as for friction stir welding; the origin is the middle of the pin's
   * end. */
  struct PinOutline : ToolOutline
  {
    explicit PinOutline(const Entries &e);
  };

  /** A sphere (a disc in two dimensions) around the origin. */
  struct SphereOutline : ToolOutline
  {
    explicit SphereOutline(const Entries &e);
  };

  /** Any profile, by its corners. */
  struct ProfileOutline : ToolOutline
  {
    explicit ProfileOutline(const Entries &e);
  };
} // namespace tombolo
