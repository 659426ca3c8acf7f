// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/pairing.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tombolo
{
  /**
   * Balls around the corners of slave faces against master faces: each ball touches the nearest
   * point of any of these, on a face, an edge or a corner, along the line to its centre, with its
   * share of the area of the slave face across that line. doc/add_a_process.md has what it shows.
   */
  template <int dim>
  class Balls : public Pairing<dim>
  {
  public:
    explicit Balls(const Entries &e)
        : ball_radius(e.number("Radius", mandatory, positive(), "L", "Of the balls around nodes."))
    {}

    double radius() const override
    {
      return ball_radius;
    }

    void find(const PairedFace<dim> &slave, const std::vector<PairedFace<dim>> &masters,
              std::vector<FacePair<dim>> &pairs) const override
    {
      std::array<Foot, n_corners> feet; // of the balls, and below which master
      std::array<const PairedFace<dim> *, n_corners> below{};
      for (unsigned int i = 0; i < n_corners; ++i)
        for (const PairedFace<dim> &master : masters)
          if (const Foot foot = foot_on(master, slave.corners[i]);
              std::abs(foot.distance) < ball_radius + this->reach() * master.thickness &&
              (below[i] == nullptr || foot.is_nearer_than(feet[i])))
          {
            feet[i] = foot;
            below[i] = &master;
          }
      for (const PairedFace<dim> &master : masters)
      {
        FacePair<dim> pair(slave, master);
        bool touches = false;
        for (unsigned int i = 0; i < n_corners; ++i)
        {
          // What is turned away from the point does not touch.
          const double area = -(slave.area * feet[i].normal) / n_corners;
          if (below[i] != &master || !(area > 0.))
            continue;
          touches = true;
          pair.normals[i] = -feet[i].normal;
          pair.of_slave[i][i] = area;
          for (unsigned int k = 0; k < n_corners; ++k)
            pair.of_master[i][k] = area * feet[i].shares[k];
        }
        if (touches)
          pairs.push_back(pair);
      }
    }

  private:
    using Vector = dealii::Tensor<1, dim>;
    static constexpr unsigned int n_corners = FacePair<dim>::n_corners;

    /** The point of a face that is nearest to a centre. */
    struct Foot
    {
      std::array<double, n_corners> shares; ///< N of the corners of the face
      Vector normal;                        ///< out of the master
      double distance = 0;                  ///< along it, negative behind the face

      /** At an edge that both faces have, the one in front of which the centre is. */
      bool is_nearer_than(const Foot &other) const
      {
        const double excess = std::abs(distance) - std::abs(other.distance);
        return std::abs(excess) < 1e-9 * std::abs(distance) ? distance > other.distance
                                                            : excess < 0.;
      }
    };

    static Vector position_at(const FaceCorners<dim> &corners,
                              const std::array<double, n_corners> &shares)
    {
      Vector result;
      for (unsigned int k = 0; k < n_corners; ++k)
        result += shares[k] * corners[k];
      return result;
    }

    static Foot foot_on(const PairedFace<dim> &face, const Vector &centre)
    {
      // The nearest point in one direction after the other, each a line: on plane faces whose
      // edges are at right angles this ends at once.
      constexpr unsigned int most_turns = 50;
      std::array<double, dim - 1> at;
      at.fill(0.5);
      Foot foot;
      for (unsigned int turn = 0; turn < most_turns; ++turn)
      {
        double moved = 0;
        for (unsigned int d = 0; d + 1 < dim; ++d)
        {
          std::array<Vector, 2> ends;
          for (const unsigned int end : {0u, 1u})
          {
            auto there = at;
            there[d] = end;
            ends[end] = position_at(face.corners, shares_at(there));
          }
          const Vector line = ends[1] - ends[0];
          const double now = std::clamp((centre - ends[0]) * line / line.norm_square(), 0., 1.);
          moved = std::max(moved, std::abs(now - at[d]));
          at[d] = now;
        }
        if (moved < 1e-14)
          break;
      }
      foot.shares = shares_at(at);
      const Vector way = centre - position_at(face.corners, foot.shares);
      const Vector normal = face.area / face.area.norm();
      const bool is_behind = way * normal <= 1e-12 * way.norm();
      foot.distance = is_behind ? -way.norm() : way.norm();
      foot.normal = is_behind ? normal : way / way.norm();
      return foot;
    }

    static std::array<double, n_corners> shares_at(const std::array<double, dim - 1> &at)
    {
      std::array<double, n_corners> result;
      for (unsigned int k = 0; k < n_corners; ++k)
      {
        result[k] = 1.;
        for (unsigned int d = 0; d + 1 < dim; ++d)
          result[k] *= ((k >> d) & 1u) != 0 ? at[d] : 1. - at[d];
      }
      return result;
    }

    double ball_radius;
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Pairing, Balls, "balls", "balls around nodes that press faces")
} // namespace tombolo
