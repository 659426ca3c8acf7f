// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/types.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <ostream>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace tombolo
{
  /** The image of a node in some of the mirrors of Images, one after the other (their order does
   * not matter): bit m of @p mirrors is that of mirror m. */
  struct ImageNode
  {
    dealii::types::global_dof_index source;
    unsigned int mirrors;

    bool operator<(const ImageNode &other) const
    {
      return std::tie(source, mirrors) < std::tie(other.source, other.mirrors);
    }
    bool operator==(const ImageNode &other) const
    {
      return source == other.source && mirrors == other.mirrors;
    }
  };

  /** A node that is no unknown: in any field it has the mean of others, with these weights, which
   * sum to one. */
  struct DependentNode
  {
    dealii::types::global_dof_index node;
    std::vector<std::pair<dealii::types::global_dof_index, double>> weights;
  };

  /** What a mesh represents besides itself: its images in mirrors, which are planes normal to
   * coordinate axes with the body on one side. An axis can have two of them: a slab between them
   * represents a body without end. */
  struct Images
  {
    struct Mirror
    {
      unsigned int axis;
      double coordinate; ///< [L]
      /** Owned nodes that are their own images; global numbers, ascending. */
      std::vector<dealii::types::global_dof_index> own_images;
    };

    /** The image of x is sign * x + offset, by component. */
    struct Map
    {
      double sign[4] = {1., 1., 1., 1.};
      double offset[4] = {0., 0., 0., 0.};
    };

    /** Of a mesh that is the whole body. */
    static const std::shared_ptr<const Images> &none()
    {
      static const auto result = std::make_shared<const Images>();
      return result;
    }

    bool empty() const
    {
      return all.empty();
    }

    /** The map of a bit field of mirrors. */
    Map map(const unsigned int mirrors) const
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

    /** The bit fields of all images that a node can have: those with at most one mirror an axis. */
    std::vector<unsigned int> combinations() const
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

    /** The mirrors, as bits, nearer to @p x than @p share of the component of @p reach. */
    unsigned int near(const double *const x, const double *const reach, const double share) const
    {
      unsigned int result = 0;
      for (unsigned int m = 0; m < all.size(); ++m)
        if (std::abs(x[all[m].axis] - all[m].coordinate) < reach[all[m].axis] * share)
          result |= 1u << m;
      return result;
    }

    /** The mirrors, as bits, on which a point lies. */
    template <int dim>
    unsigned int at(const dealii::Point<dim> &x, const double tolerance) const
    {
      unsigned int result = 0;
      for (unsigned int m = 0; m < all.size(); ++m)
        if (std::abs(x[all[m].axis] - all[m].coordinate) <= tolerance)
          result |= 1u << m;
      return result;
    }

    /** How many of its images an owned node is: 2 to the number of its mirrors. */
    unsigned int n_own_images(const dealii::types::global_dof_index node) const
    {
      unsigned int result = 1;
      for (const Mirror &mirror : all)
        if (std::binary_search(mirror.own_images.begin(), mirror.own_images.end(), node))
          result *= 2;
      return result;
    }

    /** Whether images move the other way along an axis: the body as a whole does not move there. */
    bool are_opposite_along(const unsigned int axis) const
    {
      return std::any_of(all.begin(), all.end(),
                         [&](const Mirror &mirror) { return mirror.axis == axis; });
    }

    /** Whether images turn the other way about an axis: the body does not turn about it. */
    bool are_opposite_about(const unsigned int axis) const
    {
      return std::any_of(all.begin(), all.end(),
                         [&](const Mirror &mirror) { return mirror.axis != axis; });
    }

    /** What mirrors are for users, and where they are. */
    static std::string words(bool is_one);
    void describe(std::ostream &text) const;

    std::vector<Mirror> all;
  };
} // namespace tombolo
