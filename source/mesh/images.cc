// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/images.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using namespace dealii;

  const std::shared_ptr<const Images> &Images::none()
  {
    static const auto result = std::make_shared<const Images>();
    return result;
  }

  Images::Map Images::map(const unsigned int mirrors) const
  {
    Map result;
    for (unsigned int m = 0; m < all.size(); ++m)
      if ((mirrors >> m) & 1u)
      {
        result.sign[all[m].axis] = -1.;
        result.offset[all[m].axis] = 2. * all[m].coordinate;
      }
    return result;
  }

  std::vector<unsigned int> Images::combinations() const
  {
    std::vector<unsigned int> result;
    for (unsigned int mirrors = 1; mirrors < (1u << all.size()); ++mirrors)
    {
      unsigned int n_mirrors[3] = {0, 0, 0};
      bool is_single = true;
      for (unsigned int m = 0; m < all.size(); ++m)
        if ((mirrors >> m) & 1u)
          is_single = is_single && ++n_mirrors[all[m].axis] == 1;
      if (is_single)
        result.push_back(mirrors);
    }
    return result;
  }

  unsigned int Images::near(const double *const x, const double *const reach,
                            const double share) const
  {
    unsigned int result = 0;
    for (unsigned int m = 0; m < all.size(); ++m)
      if (std::abs(x[all[m].axis] - all[m].coordinate) < reach[all[m].axis] * share)
        result |= 1u << m;
    return result;
  }

  template <int dim>
  unsigned int Images::at(const Point<dim> &x, const double tolerance) const
  {
    unsigned int result = 0;
    for (unsigned int m = 0; m < all.size(); ++m)
      if (std::abs(x[all[m].axis] - all[m].coordinate) <= tolerance)
        result |= 1u << m;
    return result;
  }

  unsigned int Images::n_own_images(const types::global_dof_index node) const
  {
    unsigned int result = 1;
    for (const Mirror &mirror : all)
      if (std::binary_search(mirror.own_images.begin(), mirror.own_images.end(), node))
        result *= 2;
    return result;
  }

  bool Images::are_opposite_along(const unsigned int axis) const
  {
    return std::any_of(all.begin(), all.end(),
                       [&](const Mirror &mirror) { return mirror.axis == axis; });
  }

  bool Images::are_opposite_about(const unsigned int axis) const
  {
    return std::any_of(all.begin(), all.end(),
                       [&](const Mirror &mirror) { return mirror.axis != axis; });
  }

  template unsigned int Images::at(const Point<2> &, double) const;
  template unsigned int Images::at(const Point<3> &, double) const;
} // namespace tombolo
