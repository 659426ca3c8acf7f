// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/read_vector.h>
#include <tombolo/contact/contact_surface.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/contact/surfaces/rigid_translation.h>

namespace tombolo
{
  /** A rigid plane (a line in two dimensions), at rest or moved by a RigidTranslation. */
  template <int dim>
  class Plane : public ContactSurface<dim>
  {
  public:
    explicit Plane(const Entries &e)
    {
      point = e.read("Point", mandatory, "L",
                     "A point of the plane, as numbers separated by commas.", &read_vector<dim>);
      unit_normal = e.read("Normal", mandatory, "",
                           "The direction from the plane to the side where bodies may be.",
                           &read_direction<dim>);
      rigid_translation = RigidTranslation<dim>(e);
    }

    void evaluate_gaps(const NodalVector &position, const std::vector<unsigned int> &nodes,
                       const double time, std::vector<double> &gap) const override
    {
      gap.resize(nodes.size());
      const double offset = unit_normal * (point + rigid_translation.displacement(time));
      for (std::size_t k = 0; k < nodes.size(); ++k)
      {
        const double *const x = position.node(nodes[k]);
        double distance = -offset;
        for (unsigned int d = 0; d < dim; ++d)
          distance += unit_normal[d] * x[d];
        gap[k] = distance;
      }
    }

    dealii::Tensor<1, dim> normal(const Tensor<1, dim> & /*point*/,
                                  const double /*time*/) const override
    {
      return unit_normal;
    }

    dealii::Tensor<1, dim> motion(const Tensor<1, dim> & /*point*/, const double from,
                                  const double to) const override
    {
      return rigid_translation.displacement(to) - rigid_translation.displacement(from);
    }

    dealii::Tensor<1, dim> reference_point(const double time) const override
    {
      return point + rigid_translation.displacement(time);
    }

    FacetList<dim> picture(const double time, const Tensor<1, dim> &low,
                           const Tensor<1, dim> &high) const override
    {
      const Tensor<1, dim> middle = 0.5 * (low + high), on_plane = reference_point(time);
      const Tensor<1, dim> centre = middle - ((middle - on_plane) * unit_normal) * unit_normal;
      const double half_width = 0.6 * (high - low).norm();
      FacetList<dim> result;
      if constexpr (dim == 2)
      {
        // The body, which is rigid, is to the left.
        const Tensor<1, 2> along({-unit_normal[1], unit_normal[0]});
        result.vertices = {centre - half_width * along, centre + half_width * along};
        result.facets = {{{0, 1}}};
      }
      else
      {
        const Tensor<1, 3> first = direction_across(unit_normal),
                           second = cross_product_3d(unit_normal, first);
        for (const double sign : {-1., 1.})
          for (const double other : {-1., 1.})
            result.vertices.push_back(centre + half_width * (sign * first + other * second));
        result.facets = {{{0, 2, 3}}, {{0, 3, 1}}};
      }
      return result;
    }

    RigidTranslation<dim> &translation() override
    {
      return rigid_translation;
    }

  private:
    dealii::Tensor<1, dim> point;
    dealii::Tensor<1, dim> unit_normal;
    RigidTranslation<dim> rigid_translation;
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(ContactSurface, Plane, "plane",
                                  "a rigid plane, at rest, moved by functions of time or by forces")
} // namespace tombolo
