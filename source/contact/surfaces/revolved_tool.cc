// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/declarations.h>
#include <tombolo/contact/direction_across.h>
#include <tombolo/contact/read_vector.h>
#include <tombolo/contact/surfaces/revolved_tool.h>

#include <deal.II/base/numbers.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace tombolo
{
  using namespace dealii;

  template <int dim, typename Outline>
  void RevolvedTool<dim, Outline>::declare_parameters(ParameterHandler &handler)
  {
    Outline::declare_parameters(handler);
    Declarations(handler).text("Axis", dim == 2 ? "0, 1" : "0, 0, 1", "",
                               "The direction from the tool's origin into the tool, at t = 0.");
    RigidMotion<dim>::declare_parameters(handler);
  }

  template <int dim, typename Outline>
  RevolvedTool<dim, Outline>::RevolvedTool(const Section &section)
      : RigidTool<dim>(section, read_direction<dim>(section, "Axis")),
        axis(read_direction<dim>(section, "Axis"))
  {
    const auto corners = Outline::corners(section);
    const double edge_radius = Outline::edge_radius(section);
    try
    {
      profile = RigidProfile(corners, edge_radius);
    }
    catch (const std::invalid_argument &error)
    {
      section.fail("", std::string("the tool has no outline: ") + error.what() + ".");
    }
  }

  template <int dim, typename Outline>
  Tensor<1, dim> RevolvedTool<dim, Outline>::axis_at(const double time) const
  {
    return dim == 2 ? this->rigid_motion.turned(axis, this->rigid_motion.angle(time)) : axis;
  }

  template <int dim, typename Outline>
  void RevolvedTool<dim, Outline>::evaluate_gaps(const NodalVector &position,
                                                 const std::vector<unsigned int> &nodes,
                                                 const double time, std::vector<double> &gap) const
  {
    gap.resize(nodes.size());
    const Tensor<1, dim> origin = this->rigid_motion.origin(time), along = axis_at(time);
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
      const RigidProfile::Place place = {std::sqrt(std::max(square - z * z, 0.)), z};
      const double at_least = profile.distance_from_box(place);
      gap[k] = at_least > reach ? at_least : profile.nearest(place).gap;
    }
  }

  template <int dim, typename Outline>
  Tensor<1, dim> RevolvedTool<dim, Outline>::normal(const Tensor<1, dim> &point,
                                                    const double time) const
  {
    const Tensor<1, dim> along = axis_at(time),
                         from_origin = point - this->rigid_motion.origin(time);
    const double z = from_origin * along;
    const Tensor<1, dim> across = from_origin - z * along;
    const double r = across.norm();
    const RigidProfile::Place normal = profile.nearest({r, z}).normal;
    Tensor<1, dim> result = normal.z * along;
    // On the axis, to round-off, all directions across are alike, and only the one along is left,
    // if there is one.
    if (r > 1e-10 * from_origin.norm())
      result += (normal.r / r) * across;
    else if (!(std::abs(normal.z) > 1e-8))
      result = direction_across(along);
    return result / result.norm();
  }

  template <int dim, typename Outline>
  FacetList<dim> RevolvedTool<dim, Outline>::picture(const double time, const Tensor<1, dim> &,
                                                     const Tensor<1, dim> &) const
  {
    const Tensor<1, dim> origin = this->rigid_motion.origin(time), along = axis_at(time);
    const std::vector<RigidProfile::Place> outline =
        profile.outline(numbers::PI / (dim == 2 ? 180 : 18));
    FacetList<dim> result;
    if constexpr (dim == 2)
    {
      const Tensor<1, 2> across({along[1], -along[0]});
      const auto add = [&](const RigidProfile::Place &place, const double side)
      { result.vertices.push_back(origin + place.z * along + side * place.r * across); };
      for (const RigidProfile::Place &place : outline)
        add(place, 1.);
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
      const double start = this->rigid_motion.angle(time);
      for (const RigidProfile::Place &place : outline)
        for (unsigned int k = 0; k < n; ++k)
        {
          const double angle = start + 2 * numbers::PI * k / n;
          result.vertices.push_back(origin + place.z * along +
                                    place.r * (std::cos(angle) * first + std::sin(angle) * second));
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

  double EdgedOutline::edge_radius(const Section &section)
  {
    return section.get_double("Edge radius");
  }

  void EdgedOutline::declare_edge_radius(ParameterHandler &handler)
  {
    Declarations section(handler);
    section.non_negative("Edge radius", 0., "L",
                         "Convex edges are rounded with it. The force on a node that slides "
                         "over an edge is continuous as long as the node is less deep than "
                         "this.");
  }

  namespace
  {
    void declare_length(ParameterHandler &handler, const std::string &entry,
                        const std::string &documentation)
    {
      Declarations(handler).number(entry, mandatory, "L", documentation);
    }

    /** The tangent of half of an angle between the sides of a cone. */
    double slope(const Section &section, const std::string &entry)
    {
      const double degrees = section.get_double(entry);
      if (!(degrees > 0. && degrees < 180.))
        section.fail(entry, "allowed is an angle between 0 and 180 degrees.");
      return std::tan(0.5 * degrees * numbers::PI / 180.);
    }
  } // namespace

  void DrillOutline::declare_parameters(ParameterHandler &handler)
  {
    Declarations section(handler);
    declare_length(handler, "Diameter", "Of the cylinder.");
    section.number("Cone angle", mandatory, "degrees", "Between opposite sides of the cone.");
    section.non_negative("Centre height", 0., "L",
                         "Of the small cone at the tip; 0: there is none.");
    section.number("Centre angle", 90., "degrees", "Between opposite sides of the small cone.");
    declare_length(handler, "Length", "From the tip to the end of the cylinder.");
    declare_edge_radius(handler);
  }

  std::vector<RigidProfile::Place> DrillOutline::corners(const Section &section)
  {
    const double radius = 0.5 * section.get_positive("Diameter");
    const double length = section.get_positive("Length");
    const double centre_height = section.get_double("Centre height");
    std::vector<RigidProfile::Place> corners = {{0., 0.}};
    const double centre_radius =
        centre_height > 0. ? centre_height * slope(section, "Centre angle") : 0.;
    if (!(centre_radius < radius))
      section.fail("Centre height", "the small cone would be wider than the drill.");
    if (centre_height > 0.)
      corners.push_back({centre_radius, centre_height});
    const double end_of_cone =
        centre_height + (radius - centre_radius) / slope(section, "Cone angle");
    if (!(length > end_of_cone))
      section.fail("Length", "the cone ends " + std::to_string(end_of_cone) +
                                 " above the tip: allowed is a larger number.");
    corners.push_back({radius, end_of_cone});
    corners.push_back({radius, length});
    corners.push_back({0., length});
    return corners;
  }

  void PinOutline::declare_parameters(ParameterHandler &handler)
  {
    declare_length(handler, "Pin diameter", "Of the pin.");
    declare_length(handler, "Pin length", "From the end of the pin to the shoulder.");
    declare_length(handler, "Shoulder diameter", "Larger than that of the pin.");
    declare_length(handler, "Shoulder length", "From the shoulder to the other end of the tool.");
    declare_edge_radius(handler);
  }

  std::vector<RigidProfile::Place> PinOutline::corners(const Section &section)
  {
    const double pin = 0.5 * section.get_positive("Pin diameter");
    const double shoulder = 0.5 * section.get_positive("Shoulder diameter");
    const double pin_length = section.get_positive("Pin length");
    const double end = pin_length + section.get_positive("Shoulder length");
    if (!(shoulder > pin))
      section.fail("Shoulder diameter", "allowed is a number above the diameter of the pin.");
    return {{0., 0.},        {pin, 0.}, {pin, pin_length}, {shoulder, pin_length},
            {shoulder, end}, {0., end}};
  }

  void SphereOutline::declare_parameters(ParameterHandler &handler)
  {
    declare_length(handler, "Radius", "Of the sphere.");
  }

  std::vector<RigidProfile::Place> SphereOutline::corners(const Section &section)
  {
    const double radius = section.get_positive("Radius");
    return {{0., -radius}, {radius, -radius}, {radius, radius}, {0., radius}};
  }

  double SphereOutline::edge_radius(const Section &section)
  {
    return section.get_positive("Radius");
  }

  void ProfileOutline::declare_parameters(ParameterHandler &handler)
  {
    Declarations section(handler);
    section.text(
        "Corners", mandatory, "L",
        "Pairs `r, z` separated by `;`: the distance from the axis and the place along it, from "
        "the axis around the tool and back to it, with the tool to the left.");
    declare_edge_radius(handler);
  }

  std::vector<RigidProfile::Place> ProfileOutline::corners(const Section &section)
  {
    std::vector<RigidProfile::Place> corners;
    for (const std::string &text : Utilities::split_string_list(section.get("Corners"), ';'))
    {
      std::vector<double> numbers;
      try
      {
        numbers = Utilities::string_to_double(Utilities::split_string_list(text, ','));
      }
      catch (const ExceptionBase &)
      {
        numbers.clear();
      }
      if (numbers.size() != 2)
        section.fail("Corners", "\"" + text + "\" is not a pair of numbers `r, z`.");
      corners.push_back({numbers[0], numbers[1]});
    }
    return corners;
  }

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
