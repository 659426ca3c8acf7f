// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/contact/face_overlap.h>
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
      FaceOverlap<dim> overlap(slave.corners);
      const Heights heights(slave.corners, normal);
      for (const PairedFace<dim> &master : masters)
      {
        if (master.area * normal > largest_cosine * master.area.norm())
          continue;
        FacePair<dim> pair(slave, master);
        pair.set_normal(normal);
        if (integrate(heights, master.corners,
                      this->reach() * std::min(slave.thickness, master.thickness), overlap, pair))
          pairs.push_back(pair);
      }
    }

  private:
    static constexpr unsigned int n_corners = FacePair<dim>::n_corners;

    /** Of corners along the normal of the slave face, relative to its first corner. */
    struct Heights
    {
      Heights(const FaceCorners<dim> &slave, const Tensor<1, dim> &normal)
          : place(slave[0]), normal(normal)
      {
        for (unsigned int k = 0; k < n_corners; ++k)
        {
          of_slave[k] = (slave[k] - place) * normal;
          middle += of_slave[k] / n_corners;
        }
        for (const double height : of_slave)
          warp = std::max(warp, std::abs(height - middle));
      }

      Tensor<1, dim> place, normal;
      double of_slave[n_corners];
      double middle = 0, warp = 0;
    };

    /** Returns whether there is a common part within the @p distance. */
    bool integrate(const Heights &heights, const FaceCorners<dim> &master, const double distance,
                   FaceOverlap<dim> &overlap, FacePair<dim> &pair) const
    {
      double of_master[n_corners];
      for (unsigned int k = 0; k < n_corners; ++k)
        of_master[k] = (master[k] - heights.place) * heights.normal;
      const auto [nearest, farthest] = std::minmax_element(of_master, of_master + n_corners);
      if (*nearest - heights.middle > distance + heights.warp ||
          *farthest - heights.middle < -distance - heights.warp)
        return false;
      overlap.find(master);
      bool is_empty = true;
      Lanes to_slave[n_corners][n_corners], to_master[n_corners][n_corners];
      for (unsigned int i = 0; i < n_corners; ++i)
        for (unsigned int j = 0; j < n_corners; ++j)
          to_slave[i][j] = to_master[i][j] = 0.;
      for (unsigned int q = 0; q < overlap.n_points(); q += n_lanes)
      {
        Lanes slave_shape[n_corners], master_shape[n_corners], gap = 0.;
        for (unsigned int k = 0; k < n_corners; ++k)
        {
          slave_shape[k] = load_lanes(overlap.of_slave(k) + q);
          master_shape[k] = load_lanes(overlap.of_master(k) + q);
          gap += master_shape[k] * of_master[k] - slave_shape[k] * heights.of_slave[k];
        }
        Lanes weight = load_lanes(overlap.weights() + q);
        where(!(abs(gap) <= distance), weight) = 0.;
        is_empty = is_empty && !any_of(weight > 0.);
        for (unsigned int i = 0; i < n_corners; ++i)
        {
          const Lanes weighted = weight * slave_shape[i];
          for (unsigned int j = i; j < n_corners; ++j)
            to_slave[i][j] += weighted * slave_shape[j];
          for (unsigned int j = 0; j < n_corners; ++j)
            to_master[i][j] += weighted * master_shape[j];
        }
      }
      for (unsigned int i = 0; i < n_corners && !is_empty; ++i)
        for (unsigned int j = 0; j < n_corners; ++j)
        {
          pair.of_slave[i][j] = j < i ? pair.of_slave[j][i] : reduce(to_slave[i][j]);
          pair.of_master[i][j] = reduce(to_master[i][j]);
        }
      return !is_empty;
    }
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
