// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/pairing.h>

#include <algorithm>
#include <cmath>
#include <limits>

namespace tombolo
{
  namespace
  {
    /** Faces whose normals have a larger cosine do not face each other. */
    constexpr double largest_cosine = -0.3;
  } // namespace

  /** The mortar: with the shape functions N of both sides at the same points of their common part,
   *
   * @verbatim
   *   w^s_IJ = ∫ N^s_I N^s_J dA,   w^m_IL = ∫ N^s_I N^m_L dA
   * @endverbatim
   *
   * where slave and master face each other and their distance along the normal of the slave is at
   * most reach() times the thickness of the thinner of the cells behind the faces: the bodies can
   * be pressed into each other, and in a layer of one cell the far side is one thickness away. */
  template <int dim>
  class MortarPairing : public Pairing<dim>
  {
  public:
    void find(const PairedFace<dim> &slave, const std::vector<PairedFace<dim>> &masters,
              std::vector<FacePair<dim>> &pairs) const override
    {
      Tensor<1, dim> normal = slave.area;
      normal /= normal.norm();
      for (const PairedFace<dim> &master : masters)
      {
        if (master.area * normal > largest_cosine * master.area.norm())
          continue;
        FacePair<dim> pair(slave, master);
        pair.set_normal(normal);
        if (integrate(slave.corners, master.corners,
                      this->reach() * std::min(slave.thickness, master.thickness), pair))
          pairs.push_back(pair);
      }
    }

  private:
    /** Returns whether there is a common part within the @p distance. */
    bool integrate(const FaceCorners<dim> &slave, const FaceCorners<dim> &master,
                   const double distance, FacePair<dim> &pair) const
    {
      constexpr unsigned int n_corners = FacePair<dim>::n_corners;
      const Tensor<1, dim> &normal = pair.normals[0];
      Tensor<1, dim> middle;
      for (const auto &corner : slave)
        middle += corner / n_corners;
      double nearest = std::numeric_limits<double>::max(), farthest = -nearest, warp = 0;
      for (const auto &corner : master)
      {
        nearest = std::min(nearest, (corner - middle) * normal);
        farthest = std::max(farthest, (corner - middle) * normal);
      }
      for (const auto &corner : slave)
        warp = std::max(warp, std::abs((corner - middle) * normal));
      if (nearest > distance + warp || farthest < -distance - warp)
        return false;
      find_overlap(slave, master, overlap);
      bool is_empty = true;
      for (const OverlapPoint<dim> &point : overlap)
      {
        Tensor<1, dim> gap;
        for (unsigned int k = 0; k < n_corners; ++k)
          gap += point.of_master[k] * (master[k] - slave[0]) -
                 point.of_slave[k] * (slave[k] - slave[0]);
        if (!(std::abs(gap * normal) <= distance))
          continue;
        is_empty = false;
        for (unsigned int i = 0; i < n_corners; ++i)
          for (unsigned int j = 0; j < n_corners; ++j)
          {
            pair.of_slave[i][j] += point.weight * point.of_slave[i] * point.of_slave[j];
            pair.of_master[i][j] += point.weight * point.of_slave[i] * point.of_master[j];
          }
      }
      return !is_empty;
    }

    mutable std::vector<OverlapPoint<dim>> overlap; ///< a buffer
  };

  /** The same of the start, near by. */
  template <int dim>
  class TiedPairing : public MortarPairing<dim>
  {
  public:
    bool is_tied() const override
    {
      return true;
    }
    double reach() const override
    {
      return 0.1;
    }
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Pairing, MortarPairing, "touching",
                                  "faces that press each other, by a mortar")
  TOMBOLO_REGISTER_FOR_DIMENSIONS(Pairing, TiedPairing, "tied",
                                  "faces that are one where they meet at the start, by a mortar")
} // namespace tombolo
