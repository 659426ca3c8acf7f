// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/contact/face_overlap.h>
#include <tombolo/contact/pairing.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tombolo
{
  namespace
  {
    using PlanePoint = std::array<double, 2>;
    using PlaneQuadrilateral = std::array<PlanePoint, 4>;

    /** The rule of degree 4 (Dunavant, Int. J. Numer. Meth. Eng. 21, 1985): weight and barycentric
     * coordinate, which two corners have, of three points each. Products of two bilinear functions
     * have this degree where faces are parallelograms: then weights do not jump where faces slide
     * over each other and the polygon has another corner. */
    constexpr std::array<std::pair<double, double>, 2> rule_of_triangles{
        {{0.22338158967801146570, 0.44594849091596488632},
         {0.10995174365532186764, 0.09157621350977074346}}};

    /** Overlaps below this share of the slave face are none. */
    constexpr double nothing = 1e-12;

    PlanePoint difference(const PlanePoint &a, const PlanePoint &b)
    {
      return {{a[0] - b[0], a[1] - b[1]}};
    }

    double cross(const PlanePoint &a, const PlanePoint &b)
    {
      return a[0] * b[1] - a[1] * b[0];
    }

    template <unsigned int max_corners>
    struct Polygon
    {
      std::array<PlanePoint, max_corners> corners;
      unsigned int size = 0;

      void add(const PlanePoint &corner)
      {
        if (size < max_corners)
          corners[size++] = corner;
      }

      double double_area() const
      {
        double sum = 0;
        for (unsigned int k = 1; k + 1 < size; ++k)
          sum += cross(difference(corners[k], corners[0]), difference(corners[k + 1], corners[0]));
        return sum;
      }

      /** The centre of the area: corners that fall on each other, as where a corner is clipped at
       * an edge of its own, do not move it. */
      PlanePoint centre() const
      {
        PlanePoint sum{};
        double area = 0;
        for (unsigned int k = 1; k + 1 < size; ++k)
        {
          const PlanePoint one = difference(corners[k], corners[0]),
                           other = difference(corners[k + 1], corners[0]);
          const double part = cross(one, other);
          area += part;
          for (unsigned int a = 0; a < 2; ++a)
            sum[a] += part / 3. * (one[a] + other[a]);
        }
        return {{corners[0][0] + sum[0] / area, corners[0][1] + sum[1] / area}};
      }

      /** The number of the corner farthest from the centre. */
      unsigned int farthest() const
      {
        const PlanePoint middle = centre();
        unsigned int result = 0;
        double largest = 0;
        for (unsigned int k = 0; k < size; ++k)
        {
          const PlanePoint offset = difference(corners[k], middle);
          const double squared = offset[0] * offset[0] + offset[1] * offset[1];
          if (squared > largest)
          {
            largest = squared;
            result = k;
          }
        }
        return result;
      }

      /** The part to the left of the line from @p begin to @p end. */
      Polygon clipped(const PlanePoint &begin, const PlanePoint &end) const
      {
        Polygon result;
        const PlanePoint along = difference(end, begin);
        std::array<double, max_corners> left;
        for (unsigned int k = 0; k < size; ++k)
          left[k] = cross(along, difference(corners[k], begin));
        for (unsigned int k = 0; k < size; ++k)
        {
          const unsigned int next = k + 1 < size ? k + 1 : 0;
          if (left[k] >= 0.)
            result.add(corners[k]);
          if ((left[k] >= 0.) != (left[next] >= 0.))
          {
            const double share = left[k] / (left[k] - left[next]);
            const PlanePoint edge = difference(corners[next], corners[k]);
            result.add({{corners[k][0] + share * edge[0], corners[k][1] + share * edge[1]}});
          }
        }
        return result;
      }
    };

    /** The corners of a quadrilateral counter-clockwise. */
    template <unsigned int max_corners>
    Polygon<max_corners> polygon_of(const PlaneQuadrilateral &face)
    {
      Polygon<max_corners> result;
      for (const unsigned int k : {0u, 1u, 3u, 2u})
        result.add(face[k]);
      if (result.double_area() < 0.)
        std::swap(result.corners[1], result.corners[3]);
      return result;
    }

    bool are_apart(const PlaneQuadrilateral &one, const PlaneQuadrilateral &other)
    {
      for (unsigned int a = 0; a < 2; ++a)
      {
        const auto [low, high] = std::minmax({one[0][a], one[1][a], one[2][a], one[3][a]});
        const auto [other_low, other_high] =
            std::minmax({other[0][a], other[1][a], other[2][a], other[3][a]});
        if (low > other_high || other_low > high)
          return true;
      }
      return false;
    }

    /** The shape functions of a quadrilateral at points of the plane, by Newton's method. */
    void find_shapes(const PlaneQuadrilateral &face, const Lanes &x, const Lanes &y,
                     Lanes (&shape)[4])
    {
      const PlanePoint along = difference(face[1], face[0]), up = difference(face[2], face[0]);
      const PlanePoint twist = difference(difference(face[3], face[2]), along);
      Lanes xi = 0.5, eta = 0.5;
      constexpr unsigned int most_iterations = 20;
      for (unsigned int i = 0; i < most_iterations; ++i)
      {
        const Lanes product = xi * eta;
        const Lanes rest[2] = {x - face[0][0] - xi * along[0] - eta * up[0] - product * twist[0],
                               y - face[0][1] - xi * along[1] - eta * up[1] - product * twist[1]};
        const Lanes by_xi[2] = {along[0] + eta * twist[0], along[1] + eta * twist[1]};
        const Lanes by_eta[2] = {up[0] + xi * twist[0], up[1] + xi * twist[1]};
        const Lanes determinant = by_xi[0] * by_eta[1] - by_xi[1] * by_eta[0];
        Lanes inverse = 1. / determinant;
        where(determinant == 0., inverse) = 0.;
        const Lanes change_xi = (rest[0] * by_eta[1] - rest[1] * by_eta[0]) * inverse;
        const Lanes change_eta = (by_xi[0] * rest[1] - by_xi[1] * rest[0]) * inverse;
        xi += change_xi;
        eta += change_eta;
        // The product of the changes times the twist is all that is left: what follows from it.
        const Lanes next = abs(twist[0] * by_eta[1] - twist[1] * by_eta[0]) +
                           abs(by_xi[0] * twist[1] - by_xi[1] * twist[0]);
        if (all_of(abs(change_xi * change_eta * inverse) * next < 1e-14))
          break;
      }
      shape[0] = (1. - xi) * (1. - eta);
      shape[1] = xi * (1. - eta);
      shape[2] = (1. - xi) * eta;
      shape[3] = xi * eta;
    }
  } // namespace

  template <>
  FaceOverlap<3>::FaceOverlap(const FaceCorners<3> &face)
  {
    const Tensor<1, 3> normal = area_vector<3>(face);
    for (const auto &corner : face)
      origin += 0.25 * corner;
    axes[0] = face[1] - face[0] + face[3] - face[2];
    axes[0] -= (axes[0] * normal) / normal.norm_square() * normal;
    axes[0] /= axes[0].norm();
    axes[1] = cross_product_3d(normal / normal.norm(), axes[0]);
    slave = on_plane(face);
  }

  template <>
  FaceOverlap<2>::FaceOverlap(const FaceCorners<2> &face) : origin(face[0])
  {
    axes[0] = face[1] - face[0];
    axes[0] /= axes[0].norm();
    slave = on_plane(face);
  }

  template <>
  void FaceOverlap<3>::find_points(const PlaneFace &master)
  {
    if (are_apart(slave, master))
      return;
    const Polygon<max_corners> frame = polygon_of<max_corners>(slave);
    Polygon<max_corners> common = polygon_of<max_corners>(master);
    for (unsigned int k = 0; k < 4 && common.size > 2; ++k)
      common = common.clipped(frame.corners[k], frame.corners[(k + 1) % 4]);
    if (common.size < 3 || common.double_area() < nothing * frame.double_area())
      return;
    // From a corner that geometry chooses, since only for parallelograms the rule is exact.
    std::rotate(common.corners.begin(), common.corners.begin() + common.farthest(),
                common.corners.begin() + common.size);
    double x[max_points], y[max_points];
    for (unsigned int k = 1; k + 1 < common.size; ++k)
    {
      const PlanePoint *const corners[3] = {&common.corners[0], &common.corners[k],
                                            &common.corners[k + 1]};
      const double area =
          0.5 * cross(difference(*corners[1], *corners[0]), difference(*corners[2], *corners[0]));
      if (!(area > 0.))
        continue;
      const auto sum = [&](const unsigned int a)
      { return (*corners[0])[a] + (*corners[1])[a] + (*corners[2])[a]; };
      const double sum_x = sum(0), sum_y = sum(1);
      for (const auto &[share, coordinate] : rule_of_triangles)
        for (const PlanePoint *const corner : corners)
        {
          weight[n] = share * area;
          x[n] = coordinate * sum_x + (1. - 3. * coordinate) * (*corner)[0];
          y[n] = coordinate * sum_y + (1. - 3. * coordinate) * (*corner)[1];
          ++n;
        }
    }
    for (unsigned int q = n; q < padded_to_lanes(n); ++q)
    {
      weight[q] = 0.;
      x[q] = x[0];
      y[q] = y[0];
    }
    Lanes shape[4];
    for (unsigned int q = 0; q < n; q += n_lanes)
    {
      find_shapes(slave, load_lanes(x + q), load_lanes(y + q), shape);
      for (unsigned int k = 0; k < n_corners; ++k)
        store_lanes(shape[k], slave_shape[k] + q);
      find_shapes(master, load_lanes(x + q), load_lanes(y + q), shape);
      for (unsigned int k = 0; k < n_corners; ++k)
        store_lanes(shape[k], master_shape[k] + q);
    }
  }

  template <>
  void FaceOverlap<2>::find_points(const PlaneFace &master)
  {
    const double length = slave[1][0], begin = master[0][0], end = master[1][0];
    const double low = std::max(0., std::min(begin, end));
    const double high = std::min(length, std::max(begin, end));
    if (high - low < nothing * length)
      return;
    const double half_width = 0.5 / std::sqrt(3.); // of the Gauss points, in the unit interval
    for (unsigned int q = 0; q < max_points; ++q)
    {
      const double fraction = q == 0 ? 0.5 - half_width : 0.5 + half_width;
      const double s = low + fraction * (high - low);
      weight[q] = q < 2 ? 0.5 * (high - low) : 0.;
      slave_shape[1][q] = s / length;
      master_shape[1][q] = (s - begin) / (end - begin);
      slave_shape[0][q] = 1. - slave_shape[1][q];
      master_shape[0][q] = 1. - master_shape[1][q];
    }
    n = 2;
  }

  template <int dim>
  void FaceOverlap<dim>::find(const FaceCorners<dim> &master)
  {
    n = 0;
    find_points(on_plane(master));
  }

  template class FaceOverlap<2>;
  template class FaceOverlap<3>;

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
        const double distance = this->reach() * std::min(slave.thickness, master.thickness);
        double master_heights[n_corners];
        if (!heights.find(master.corners, distance, master_heights))
          continue;
        overlap.find(master.corners);
        if (overlap.n_points() == 0)
          continue;
        pairs.emplace_back(slave, master);
        pairs.back().set_normal(normal);
        if (!integrate(heights, master_heights, distance, overlap, pairs.back()))
          pairs.pop_back();
      }
    }

  private:
    static constexpr unsigned int n_corners = FacePair<dim>::n_corners;

    /** Of corners along the normal of the slave face, relative to its first corner. */
    struct Heights
    {
      Heights(const FaceCorners<dim> &slave, const Tensor<1, dim> &normal)
          : origin(slave[0]), normal(normal)
      {
        for (unsigned int k = 0; k < n_corners; ++k)
        {
          slave_heights[k] = (slave[k] - origin) * normal;
          middle += slave_heights[k] / n_corners;
        }
        for (const double height : slave_heights)
          warp = std::max(warp, std::abs(height - middle));
      }

      /** Those of the corners of a master. Returns whether it can be within the @p distance. */
      bool find(const FaceCorners<dim> &master, const double distance,
                double (&master_heights)[n_corners]) const
      {
        for (unsigned int k = 0; k < n_corners; ++k)
          master_heights[k] = (master[k] - origin) * normal;
        const auto [nearest, farthest] =
            std::minmax_element(master_heights, master_heights + n_corners);
        return !(*nearest - middle > distance + warp || *farthest - middle < -distance - warp);
      }

      Tensor<1, dim> origin, normal;
      double slave_heights[n_corners];
      double middle = 0, warp = 0;
    };

    /** Returns whether there is a common part within the @p distance. */
    static bool integrate(const Heights &heights, const double (&master_heights)[n_corners],
                          const double distance, const FaceOverlap<dim> &overlap,
                          FacePair<dim> &pair)
    {
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
          gap += master_shape[k] * master_heights[k] - slave_shape[k] * heights.slave_heights[k];
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
