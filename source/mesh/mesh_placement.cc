// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/mesh_placement.h>

#include <deal.II/base/numbers.h>
#include <deal.II/physics/transformations.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace tombolo
{
  template <int dim>
  MeshPlacement<dim>::MeshPlacement(const Entries &e)
  {
    const std::string origin = dim == 2 ? "0, 0" : "0, 0, 0";
    const double degrees =
        e.number("Rotation", "0", any_number(), "",
                 dim == 2 ? "The angle by which the mesh is turned about `Rotation point`, before "
                            "it is shifted. Units: degrees"
                          : "The angle by which the mesh is turned about `Rotation axis`, before "
                            "it is shifted. Units: degrees");
    Tensor<1, 3> axis({0., 0., 1.});
    if (dim == 3)
    {
      const std::vector<double> direction =
          e.numbers("Rotation axis", "0, 0, 1", dim, "",
                    "The direction of the axis of the rotation; its length is of no importance.");
      std::copy_n(direction.begin(), dim, axis.begin_raw());
      e.refuse(!std::isfinite(axis.norm()) || axis.norm() == 0., "Rotation axis",
               "The direction must be finite and not zero.");
    }
    const std::vector<double> point =
        e.numbers("Rotation point", origin, dim, "L",
                  dim == 2 ? "The point that the rotation leaves where it is."
                           : "A point that the axis of the rotation passes through.");
    const std::vector<double> displacement =
        e.numbers("Shift", origin, dim, "L", "By what the mesh is displaced, all of it.");
    if (e.declares())
      return;
    std::copy_n(point.begin(), dim, centre.begin_raw());
    std::copy_n(displacement.begin(), dim, shift.begin_raw());
    is_turned = degrees != 0.;
    const Tensor<2, 3> matrix = Physics::Transformations::Rotations::rotation_matrix_3d(
        axis / axis.norm(), degrees * numbers::PI / 180.);
    for (unsigned int i = 0; i < dim; ++i)
      for (unsigned int j = 0; j < dim; ++j)
      {
        // Quarters of a turn are exact.
        const double nearest = std::round(matrix[i][j]);
        rotation[i][j] = std::abs(matrix[i][j] - nearest) < 1e-15 ? nearest : matrix[i][j];
      }
  }

  template <int dim>
  Point<dim> MeshPlacement<dim>::operator()(const Point<dim> &place) const
  {
    return (is_turned ? centre + rotation * (place - centre) : place) + shift;
  }

  template class MeshPlacement<2>;
  template class MeshPlacement<3>;
} // namespace tombolo
