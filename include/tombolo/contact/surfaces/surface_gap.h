// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surfaces/facet_tree.h>

#include <deal.II/base/tensor.h>

#include <functional>
#include <optional>
#include <vector>

namespace tombolo
{
  /** The surface next to a point, and the place on it that is nearest. */
  template <int dim>
  struct SurfaceGap : FacetTree<dim>::Nearest
  {
    double gap; ///< negative behind it [L]
    dealii::Tensor<1, dim> normal;
    unsigned int facet;
  };

  /** The sides of a surface that the outward area of a node faces. */
  template <int dim>
  struct FacedSides
  {
    /** How far beyond the edge of these sides a node belongs to them as within, over the size of
     * the cell there. */
    static constexpr double across_edge = 0.01;

    /** That to the plane of the nearest side, which goes on beyond its edge, and from across_edge
     * on falls off slowly: so the gap is continuous. */
    SurfaceGap<dim> gap;
    double behind;  ///< the depth behind the plane of the nearest side [L]
    double outside; ///< the distance from the side, within this plane [L]
    double size;    ///< of the cell at the nearest side [L]

    static bool are_of(const dealii::Tensor<1, dim> &area, const dealii::Tensor<1, dim> &normal);
  };

  /** A closed surface with the tree of its facets. */
  template <int dim>
  class SearchedSurface : public ClosedSurface<dim>
  {
  public:
    SearchedSurface() = default;

    explicit SearchedSurface(const ClosedSurface<dim> &surface)
        : ClosedSurface<dim>(surface), tree(*this)
    {}

    /** The signed distance of a point from the place that is nearest to it, and the normal there;
     * @p hint as in FacetTree. */
    SurfaceGap<dim> gap(const dealii::Tensor<1, dim> &point, unsigned int hint = 0) const;

    /** How far a point is outside of the box around the surface; negative inside [L]. */
    double distance_to_box(const dealii::Tensor<1, dim> &point) const;

    /** Nothing where there are no such sides. @p size_of: the size of the cell behind a facet. */
    std::optional<FacedSides<dim>>
    faced_sides(const dealii::Tensor<1, dim> &point, const dealii::Tensor<1, dim> &area,
                const std::function<double(unsigned int facet)> &size_of) const;

    /** See FacetTree. */
    std::optional<dealii::Tensor<1, dim>> find_crossing() const
    {
      return tree.find_crossing(*this);
    }

    /** See ClosedSurface. */
    void move_vertices(const std::vector<dealii::Tensor<1, dim>> &places)
    {
      ClosedSurface<dim>::move_vertices(places);
      tree.refit(*this);
    }

  private:
    FacetTree<dim> tree;
  };
} // namespace tombolo
