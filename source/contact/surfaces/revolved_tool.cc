// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/read_vector.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/contact/surfaces/rigid_profile.h>
#include <tombolo/contact/surfaces/rigid_tool.h>

#include <deal.II/base/numbers.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

namespace tombolo
{
  namespace
  {
    /** The tangent of half of an angle between the sides of a cone. */
    double slope(const Entries &e, const std::string &entry, const double degrees)
    {
      if (e.declares())
        return 1.;
      e.refuse(!(degrees > 0. && degrees < 180.), entry,
               "allowed is an angle between 0 and 180 degrees.");
      return std::tan(0.5 * degrees * numbers::PI / 180.);
    }
  } // namespace

  /** The corners of a profile, and the radius by which its edges are rounded [L]. */
  struct ToolOutline
  {
    std::vector<RigidProfile::Point> corners;
    double edge_radius = 0;

  protected:
    void read_edge_radius(const Entries &e)
    {
      edge_radius =
          e.number("Edge radius", "0", at_least(0.), "L",
                   "Convex edges are rounded with it. The force on a node that slides over "
                   "an edge is continuous as long as the node is less deep than this.");
    }
  };

  /** A friction drill: a small cone, a cone up to the full diameter, a cylinder; from the tip. */
  struct DrillOutline : ToolOutline
  {
    explicit DrillOutline(const Entries &e)
    {
      const double radius =
          0.5 * e.number("Diameter", mandatory, positive(), "L", "Of the cylinder.");
      const double cone = slope(e, "Cone angle",
                                e.number("Cone angle", mandatory, any_number(), "degrees",
                                         "Between opposite sides of the cone."));
      const double centre_height = e.number("Centre height", "0", at_least(0.), "L",
                                            "Of the small cone at the tip; 0: there is none.");
      double centre_radius = 0.;
      if (e.when(centre_height > 0.))
        centre_radius =
            centre_height * slope(e, "Centre angle",
                                  e.number("Centre angle", "90", any_number(), "degrees",
                                           "Between opposite sides of the small cone."));
      e.refuse(!(centre_radius < radius), "Centre height",
               "the small cone would be wider than the drill.");
      const double length = e.number("Length", mandatory, positive(), "L",
                                     "From the tip to the end of the cylinder.");
      const double end_of_cone = centre_height + (radius - centre_radius) / cone;
      e.refuse(!(length > end_of_cone), "Length",
               "the cone ends " + std::to_string(end_of_cone) +
                   " above the tip: allowed is a larger number.");
      corners = {{0., 0.}};
      if (centre_height > 0.)
        corners.push_back({centre_radius, centre_height});
      corners.push_back({radius, end_of_cone});
      corners.push_back({radius, length});
      corners.push_back({0., length});
      read_edge_radius(e);
    }
  };

  /** A pin below a shoulder, for friction stir welding; from the middle of the pin's end. */
  struct PinOutline : ToolOutline
  {
    explicit PinOutline(const Entries &e)
    {
      const double pin = 0.5 * e.number("Pin diameter", mandatory, positive(), "L", "Of the pin.");
      const double pin_length = e.number("Pin length", mandatory, positive(), "L",
                                         "From the end of the pin to the shoulder.");
      const double shoulder = 0.5 * e.number("Shoulder diameter", mandatory, positive(), "L",
                                             "Larger than that of the pin.");
      const double end = pin_length + e.number("Shoulder length", mandatory, positive(), "L",
                                               "From the shoulder to the other end of the tool.");
      e.refuse(!(shoulder > pin), "Shoulder diameter",
               "allowed is a number above the diameter of the pin.");
      corners = {{0., 0.},        {pin, 0.}, {pin, pin_length}, {shoulder, pin_length},
                 {shoulder, end}, {0., end}};
      read_edge_radius(e);
    }
  };

  /** A sphere (a disc in two dimensions) around the origin. */
  struct SphereOutline : ToolOutline
  {
    explicit SphereOutline(const Entries &e)
    {
      const double radius = edge_radius =
          e.number("Radius", mandatory, positive(), "L", "Of the sphere.");
      corners = {{0., -radius}, {radius, -radius}, {radius, radius}, {0., radius}};
    }
  };

  /** Any profile, by its corners. */
  struct ProfileOutline : ToolOutline
  {
    explicit ProfileOutline(const Entries &e)
    {
      for (const std::string &text : Utilities::split_string_list(
               e.text(
                   "Corners", mandatory, "L",
                   "Pairs `r, z` separated by `;`: the distance from the axis and the place along "
                   "it, from the axis around the tool and back to it, with the tool to the left."),
               ';'))
      {
        const std::vector<std::string> numbers = Utilities::split_string_list(text, ',');
        RigidProfile::Point corner{};
        if (numbers.size() != 2 || !is_number(numbers[0], corner.r) ||
            !is_number(numbers[1], corner.z))
          e.section().fail("Corners", "\"" + text + "\" is not a pair of numbers `r, z`.");
        corners.push_back(corner);
      }
      read_edge_radius(e);
    }
  };

  /**
   * A rigid tool whose outline is a RigidProfile: a body of revolution about its axis in three
   * dimensions, the section through its axis in two. Coordinates of the profile are the distance
   * from the axis and the position along it, from the tool's origin on; a tool of revolution that
   * spins touches the same points, but drags along what it touches.
   *
   * @tparam Outline is derived from ToolOutline, with a constructor from Entries.
   */
  template <int dim, typename Outline>
  class RevolvedTool : public RigidTool<dim>
  {
  public:
    explicit RevolvedTool(const Entries &e)
    {
      const Outline outline(e);
      axis = e.read("Axis", dim == 2 ? "0, 1" : "0, 0, 1", "",
                    "The direction from the tool's origin into the tool, at t = 0.",
                    &read_direction<dim>);
      this->read_motion(e, axis);
      if (e.declares())
        return;
      e.refuse(dim == 3 && this->has_constant_angle(), "Angle",
               "a constant does not turn a tool of revolution: allowed is a function of t such as "
               "`2*pi*50*t`");
      try
      {
        profile = RigidProfile(outline.corners, outline.edge_radius);
      }
      catch (const std::invalid_argument &error)
      {
        e.refuse(true, "", std::string("the tool has no outline: ") + error.what() + ".");
      }
    }

    void evaluate_gaps(const NodalVector &position, const std::vector<unsigned int> &nodes,
                       const double time, std::vector<double> &gap) const override
    {
      gap.resize(nodes.size());
      // The angle at which motion() fails where only some ranks have nodes that touch.
      this->angle(time);
      const Tensor<1, dim> origin = this->origin(time), along = axis_at(time);
      for (std::size_t k = 0; k < nodes.size(); ++k)
      {
        const double *const x = position.node(nodes[k]);
        double z = 0, square = 0;
        for (unsigned int d = 0; d < dim; ++d)
        {
          const double y = x[d] - origin[d];
          z += along[d] * y;
          square += y * y;
        }
        const RigidProfile::Point point = {std::sqrt(std::max(square - z * z, 0.)), z};
        const double at_least = profile.distance_from_box(point);
        gap[k] = at_least > reach ? at_least : profile.nearest(point).gap;
      }
    }

    void set_reach(const double distance) override
    {
      reach = distance;
    }
    Tensor<1, dim> normal(const Tensor<1, dim> &point, const double time) const override
    {
      const Tensor<1, dim> along = axis_at(time), from_origin = point - this->origin(time);
      const double z = from_origin * along;
      const Tensor<1, dim> across = from_origin - z * along;
      const double r = across.norm();
      const RigidProfile::Point normal = profile.nearest({r, z}).normal;
      Tensor<1, dim> result = normal.z * along;
      // On the axis, to round-off, all directions across are alike, and only the one along is left,
      // if there is one.
      if (r > 1e-10 * from_origin.norm())
        result += (normal.r / r) * across;
      else if (!(std::abs(normal.z) > 1e-8))
        result = direction_across(along);
      return result / result.norm();
    }

    FacetList<dim> picture(const double time, const Tensor<1, dim> &,
                           const Tensor<1, dim> &) const override
    {
      const Tensor<1, dim> origin = this->origin(time), along = axis_at(time);
      const std::vector<RigidProfile::Point> outline =
          profile.outline(numbers::PI / (dim == 2 ? 180 : 18));
      FacetList<dim> result;
      if constexpr (dim == 2)
      {
        const Tensor<1, 2> across({along[1], -along[0]});
        const auto add = [&](const RigidProfile::Point &point, const double side)
        { result.vertices.push_back(origin + point.z * along + side * point.r * across); };
        for (const RigidProfile::Point &point : outline)
          add(point, 1.);
        for (std::size_t i = outline.size() - 2; i > 0; --i)
          add(outline[i], -1.);
        const auto n = static_cast<unsigned int>(result.vertices.size());
        for (unsigned int i = 0; i < n; ++i)
          result.facets.push_back({{i, (i + 1) % n}});
      }
      else
      {
        constexpr unsigned int n = 48;
        const Tensor<1, 3> first = direction_across(along), second = cross_product_3d(along, first);
        const double start = this->angle(time);
        for (const RigidProfile::Point &point : outline)
          for (unsigned int k = 0; k < n; ++k)
          {
            const double angle = start + 2 * numbers::PI * k / n;
            result.vertices.push_back(origin + point.z * along +
                                      point.r *
                                          (std::cos(angle) * first + std::sin(angle) * second));
          }
        for (unsigned int i = 0; i + 1 < outline.size(); ++i)
          for (unsigned int k = 0; k < n; ++k)
          {
            const unsigned int a = i * n + k, b = i * n + (k + 1) % n;
            if (outline[i].r > 0.)
              result.facets.push_back({{a, b, b + n}});
            if (outline[i + 1].r > 0.)
              result.facets.push_back({{a, b + n, a + n}});
          }
      }
      return result;
    }

  private:
    Tensor<1, dim> axis_at(const double time) const
    {
      return dim == 2 ? this->turned(axis, this->angle(time)) : axis;
    }

    Tensor<1, dim> axis;
    RigidProfile profile;
    double reach = 0;
  };

  template <int dim>
  using Drill = RevolvedTool<dim, DrillOutline>;

  template <int dim>
  using Pin = RevolvedTool<dim, PinOutline>;

  template <int dim>
  using Sphere = RevolvedTool<dim, SphereOutline>;

  template <int dim>
  using Profile = RevolvedTool<dim, ProfileOutline>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      ContactSurface, Drill, "drill",
      "a friction drill: cone and cylinder, moved by functions of time or by "
      "forces")
  TOMBOLO_REGISTER_FOR_DIMENSIONS(ContactSurface, Pin, "pin and shoulder",
                                  "a pin below a shoulder, moved by functions of time or by forces")
  TOMBOLO_REGISTER_FOR_DIMENSIONS(ContactSurface, Sphere, "sphere",
                                  "a sphere, moved by functions of time or by forces")
  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      ContactSurface, Profile, "profile",
      "a body of revolution (in two dimensions a symmetric one) by "
      "the corners of its outline, moved by functions of time or by forces")
} // namespace tombolo
