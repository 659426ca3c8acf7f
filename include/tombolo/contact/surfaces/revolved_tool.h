// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/parameter_handler.h>

#include <tombolo/base/input/parameters.h>
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
   * @tparam Outline has static functions `declare_parameters(ParameterHandler &)` and
   * `corners(const Section &)`, which gives the corners of the profile or throws InputError, and
   * `edge_radius(const Section &)`.
   */
  template <int dim, typename Outline>
  class RevolvedTool : public RigidTool<dim>
  {
  public:
    static void declare_parameters(dealii::ParameterHandler &handler);

    explicit RevolvedTool(const Section &section);

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

  /** What outlines with edges have in common. */
  struct EdgedOutline
  {
    static double edge_radius(const Section &section);

  protected:
    static void declare_edge_radius(dealii::ParameterHandler &handler);
  };

  /** A friction drill: a small cone in the centre, a cone up to the full diameter, a cylinder; the
   * origin is the tip. */
  struct DrillOutline : EdgedOutline
  {
    static void declare_parameters(dealii::ParameterHandler &handler);
    static std::vector<RigidProfile::Place> corners(const Section &section);
  };

  /** A pin below a shoulder, as for friction stir welding; the origin is the middle of the pin's
   * end. */
  struct PinOutline : EdgedOutline
  {
    static void declare_parameters(dealii::ParameterHandler &handler);
    static std::vector<RigidProfile::Place> corners(const Section &section);
  };

  /** A sphere (a disc in two dimensions) around the origin. */
  struct SphereOutline
  {
    static void declare_parameters(dealii::ParameterHandler &handler);
    static std::vector<RigidProfile::Place> corners(const Section &section);
    static double edge_radius(const Section &section);
  };

  /** Any profile, by its corners. */
  struct ProfileOutline : EdgedOutline
  {
    static void declare_parameters(dealii::ParameterHandler &handler);
    static std::vector<RigidProfile::Place> corners(const Section &section);
  };
} // namespace tombolo
