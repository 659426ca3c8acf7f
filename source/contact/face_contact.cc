// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/on_ranks.h>
#include <tombolo/contact/contact_faces.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/contact/surface_contact.h>
#include <tombolo/mesh/face_shapes.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <set>

namespace tombolo
{
  namespace
  {
    constexpr unsigned int points_per_direction = 3;

    template <int dim>
    typename ContactFaces<dim>::Selector selector_of(const ContactScene<dim> &scene)
    {
      const Section &section = scene.section;
      const Nodes<dim> &nodes = scene.nodes;
      if (nodes.degree() > 1)
        section.fail("Method", "elements have degree " + std::to_string(nodes.degree()) +
                                   ", and `surface` needs degree 1; allowed is penalty or "
                                   "kinematic.");
      if (!section.get("Where").empty())
        section.fail("Where", "with `Method = surface` faces touch; allowed is a `Boundary`.");
      return [boundaries = scene.boundaries()](const auto &cell, const unsigned int face)
      { return boundaries.empty() || boundaries.count(cell->face(face)->boundary_id()) > 0; };
    }
  } // namespace

  /**
   * Contact of the faces of a body with a rigid surface: quadrature points on current faces have
   * depths, and each node on them the weighted and normalized one,
   *
   * @verbatim
   *   δ_I = ∫ N_I <-g> dA / A_I,   A_I = ∫ N_I dA,   p(x) = Σ_I N_I(x) f_I / A_I  where g(x) < 0
   * @endverbatim
   *
   * with f_I of ContactLaw for the mass of the node. The pressure acts at the points behind the
   * surface along the normal there: the normal forces are the derivative of Σ_I ½ k_I δ_I² but for
   * the change of areas. So a face does not fall between two flanks of a tool, and the pressure of
   * a node does not depend on how much of its faces is beyond an edge. Friction follows ContactLaw
   * in the mean motion of the points behind the surface.
   *
   * In static steps the pressure at a point is that of its own depth,
   *
   * @verbatim
   *   p(x) = <-g(x)> Σ_I N_I(x) k_I / A_I
   * @endverbatim
   *
   * so that forces do not jump where a point of a pressed node comes into contact, and are in
   * proportion to how far a body is pressed: works by the mean of two forces are exact. The sum of
   * the pressure is that of the f_I. Points share out the friction of a node by their depths, and
   * so are motions weighted.
   *
   * Faces are those of cells of degree 1 on the boundary of the mesh, and below cells that are
   * gone.
   */
  template <int dim>
  class FaceContact : public SpringContact<dim>
  {
  public:
    /** As that of SurfaceContact. Throws InputError. Collective. */
    explicit FaceContact(ContactScene<dim> &scene)
        : SpringContact<dim>(scene), selects(selector_of(scene)), faces(scene.nodes, selects),
          shapes(1, points_per_direction)
    {
      set_partition(scene.state.partition());
      last_position.copy_from(scene.state.position);
      this->records.nodal("last position", dim, last_position);
      this->records.archived([this](const auto &) { former_faces.reset(); });
    }

    void renew_faces(const Nodes<dim> &nodes,
                     const typename ContactFaces<dim>::IsGone &is_gone) override
    {
      SurfaceContact<dim>::renew_faces(nodes, is_gone);
      if (!former_faces)
        former_faces = std::make_unique<ContactFaces<dim>>(std::move(faces));
      faces = ContactFaces<dim>(nodes, selects, is_gone);
    }

    void set_partition(const std::shared_ptr<const NodePartition> &partition) override
    {
      SurfaceContact<dim>::set_partition(partition);
      faces.set_partition(partition);
      if (former_faces)
        former_faces->set_partition(partition);
      sums.reinit(partition, Quantity::scalars);
      pressures.reinit(partition, Quantity::scalar);
      for (NodalVector *const vector : {&normals, &motions, &tangentials, &forces})
        vector->reinit(partition);
      if (last_position.partition() == nullptr)
        last_position.reinit(partition, Quantity::position);
      else if (last_position.partition() != partition)
        last_position.move_to(partition);
    }

    void add_forces(const NodalState &state, const Clock &clock, NodalVector &loads,
                    std::vector<unsigned int> &loaded_nodes, const NodalHeat &nodal_heat) override
    {
      if (!this->begin_forces(state, clock, nodal_heat))
        return;
      // Until now the former faces have pressed.
      if (former_faces)
        std::swap(faces, *former_faces);
      sum_points(state.position, clock);
      past_approaches.clear();
      for (const unsigned int node : this->candidates)
        past_approaches.push_back(
            sums.node(node)[area] > 0. ? motions.node(node)[approach] / sums.node(node)[area] : 0.);
      if (former_faces)
      {
        std::swap(faces, *former_faces);
        former_faces.reset();
        sum_points(state.position, clock);
      }
      double mass_in_contact = 0;
      for (const unsigned int node : this->candidates)
        if (sums.node(node)[pressed] > 0.)
          mass_in_contact += *state.mass.node(node);
      const double ratio = this->mass_ratio(mass_in_contact);
      for (std::size_t k = 0; k < this->candidates.size(); ++k)
        advance_node(k, *state.mass.node(this->candidates[k]) / ratio, clock, nodal_heat);
      scatter();
      for (std::size_t k = 0; k < this->candidates.size(); ++k)
      {
        const auto x = vector_of<dim>(state.position.node(this->candidates[k]));
        const auto force = vector_of<dim>(forces.node(this->candidates[k]));
        if (force.norm_square() > 0. || this->histories[k].force.norm_square() > 0.)
          this->set_force(k, x, force,
                          this->surface->motion(x, clock.time - clock.previous_step, clock.time),
                          true, loads, loaded_nodes);
        else
          this->histories[k] = {force, x};
      }
      last_position.copy_from(state.position);
      this->end_forces();
    }

    void keep_outside(const Clock &clock, const NodalVector &slides, const NodalVector &from,
                      NodalVector &position, NodalVector &is_bound) override
    {
      const std::vector<double> was = depths_at(from, clock);
      const std::vector<double> is = depths_at(position, clock);
      for (std::size_t k = 0; k < this->candidates.size(); ++k)
      {
        const unsigned int node = this->candidates[k];
        const auto normal = vector_of<dim>(normals.node(node));
        if (!(was[k] > 0. || is[k] > 0.) || !(*slides.node(node) > 0.))
          continue;
        *is_bound.node(node) = 1.;
        const double excess = is[k] - was[k];
        for (unsigned int d = 0; d < dim && excess > 0.; ++d)
          position.node(node)[d] += excess * normal[d] / normal.norm();
      }
    }

    void place_nodes(const NodalState &state, const NodalVector &before,
                     const Clock &clock) override
    {
      SpringContact<dim>::place_nodes(state, before, clock);
      last_position.fill(
          [&](const unsigned int i, double *const value)
          {
            for (unsigned int d = 0; d < dim; ++d)
              value[d] += state.position.node(i)[d] - before.node(i)[d];
          });
    }

    void reset_motion(const NodalState &state) override
    {
      SpringContact<dim>::reset_motion(state);
      former_faces.reset();
      last_position.copy_from(state.position);
    }

    void find_stiffness(const NodalState &state, const Clock &clock,
                        std::vector<ContactStiffness<dim>> &result) override
    {
      // Points that touch and have no depth resist where nothing else does.
      const bool is_pressed = any_of_all_ranks(
          points, [](const Point &point) { return point.depth > 0.; }, this->communicator);
      // Of nodes that touch: deeper points have more of the mean motion.
      const NodalVector mean_motion =
          nodal_field(state.partition(), Quantity::vector, this->candidates,
                      [&](const std::size_t k, double *const value)
                      {
                        const unsigned int node = this->candidates[k];
                        if (this->springs[k].is_closed())
                          for (unsigned int d = 0; d < dim; ++d)
                            value[d] = motions.node(node)[d] / sums.node(node)[pressed];
                      });
      ContactRows<dim> rows;
      for (const Point &point : points)
      {
        const auto &face = faces.faces()[point.face];
        const double pressing = point.depth > 0. || !is_pressed ? point.weight : 0.;
        for (unsigned int i = 0; i < shapes.n_nodes; ++i)
        {
          const Tensor<2, dim> shares =
              outer_product(vector_of<dim>(mean_motion.node(face.nodes[i])) - point.motion,
                            pressing * point.normal);
          for (unsigned int j = 0; j < shapes.n_nodes; ++j)
          {
            const double values = shapes.value(point.q, i) * shapes.value(point.q, j);
            rows.add(face.global_nodes[i], face.global_nodes[j], pressing * values * point.normal,
                     point.rubbing * values, {}, values * shares);
          }
        }
        add_pressure(point, pressing, state, clock.time, result);
      }
      rows.collect(*state.partition());
      // Zero across planes of symmetry, as what points add there.
      const NodalVector kept =
          nodal_field(state.partition(), Quantity::vector, this->candidates,
                      [](const std::size_t, double *const value) { std::fill_n(value, dim, 1.); });
      for (std::size_t k = 0; k < this->springs.size(); ++k)
      {
        const ContactSpring<dim> &spring = this->springs[k];
        if (!spring.is_closed())
          continue;
        ContactStiffness<dim> stiffness;
        stiffness.node = this->candidates[k];
        stiffness.direction = vector_of<dim>(normals.node(stiffness.node));
        stiffness.direction /= stiffness.direction.norm();
        const double *const node_sums = sums.node(stiffness.node);
        stiffness.entries = rows.row(state.partition()->global_index(stiffness.node));
        // So that the change of the depth is that of the force over its share of the node.
        for (auto &entry : stiffness.entries)
          entry.normal *= node_sums[pressed] / node_sums[area];
        add_spring(spring, 1. / (node_sums[pressed] * node_sums[pressed]), stiffness);
        // The points have the pressure, and the more of the friction the deeper they are.
        stiffness.normal = 0.;
        stiffness.slip += spring.stiffness * node_sums[area] / std::pow(node_sums[pressed], 3) *
                          spring.elastic_slip;
        stiffness.keep(kept.node(stiffness.node));
        result.push_back(std::move(stiffness));
      }
    }

  private:
    /** A quadrature point that is behind the surface, or was before the step. */
    struct Point
    {
      unsigned int face, q;
      double weight;  ///< area [L^(dim-1)]
      double depth;   ///< <-g> [L]
      double rubbing; ///< weight of motion and friction: the area, in static steps times the depth
      Tensor<1, dim> normal, motion;
      double approach = 0, past_approach = 0; ///< of a point that is, was behind the surface [L]
    };

    /** Slots of the sums at nodes. */
    enum Sum : unsigned int
    {
      area,    ///< A_I
      depth,   ///< ∫ N_I <-g> dA
      pressed, ///< ∫ N_I dA over the points behind the surface, by the weights of rubbing
      squares  ///< ∫ N_I <-g>² dA
    };
    /** The slot with the integrals of approaches: in normals of points that are behind it, in
     * motions of those that were, in static steps the area of those that touch. */
    static constexpr unsigned int approach = node_stride - 1;

    /** Finds the points behind the surface at t_n or before, and A_I. */
    void find_points(const NodalVector &position, const Clock &clock)
    {
      const double begin = clock.time - clock.previous_step;
      std::vector<Tensor<1, dim>> gap_points;
      std::vector<double> sizes, gaps;
      const auto find_gaps = [&]
      {
        std::vector<unsigned int> numbers(gap_points.size());
        std::iota(numbers.begin(), numbers.end(), 0u);
        this->surface->evaluate_gaps(positions_as_nodes<dim>(gap_points), numbers, clock.time,
                                     gaps);
      };
      // Faces that are farther from the surface than their size have no point behind it.
      for (const auto &face : faces.faces())
      {
        const FaceCorners<dim> corners = faces.corners(face, position);
        Tensor<1, dim> middle;
        for (const auto &corner : corners)
          middle += corner / double(corners.size());
        double size = 0;
        for (const auto &corner : corners)
          size = std::max(size, (corner - middle).norm());
        gap_points.push_back(middle);
        sizes.push_back(size);
      }
      find_gaps();
      points.clear();
      gap_points.clear();
      for (unsigned int f = 0; f < faces.faces().size(); ++f)
      {
        const FaceCorners<dim> corners = faces.corners(faces.faces()[f], position);
        for (unsigned int q = 0; q < shapes.weights.size(); ++q)
        {
          const double weight =
              shapes.weights[q] *
              shapes.normal(q, [&](const unsigned int k) { return corners[k]; }).norm();
          for (unsigned int k = 0; k < shapes.n_nodes; ++k)
            sums.node(faces.faces()[f].nodes[k])[area] += weight * shapes.value(q, k);
          if (gaps[f] > sizes[f])
            continue;
          Tensor<1, dim> x;
          for (unsigned int k = 0; k < shapes.n_nodes; ++k)
            x += shapes.value(q, k) * corners[k];
          points.push_back({f, q, weight, 0., weight, {}, {}});
          gap_points.push_back(x);
        }
      }
      find_gaps();
      std::size_t n_kept = 0;
      for (std::size_t p = 0; p < points.size(); ++p)
      {
        const bool is_behind = gaps[p] < this->touch_distance;
        if (!is_behind && is_static())
          continue;
        Point point = points[p];
        point.depth = std::max(0., -gaps[p]);
        if (is_static())
          point.rubbing *= point.depth + this->touch_distance;
        Tensor<1, dim> last_x;
        for (unsigned int k = 0; k < shapes.n_nodes; ++k)
          last_x += shapes.value(point.q, k) *
                    vector_of<dim>(last_position.node(faces.faces()[point.face].nodes[k]));
        point.motion =
            gap_points[p] - this->surface->motion(gap_points[p], begin, clock.time) - last_x;
        if (!is_behind && !(gaps[p] < point.motion.norm()))
          continue;
        point.normal = this->surface->normal(gap_points[p], clock.time);
        const double approach = -(point.motion * point.normal);
        if (is_behind)
          point.approach = approach;
        else
          point.rubbing = 0.;
        if (gaps[p] + approach < 0.)
          point.past_approach = -(point.motion * this->surface->normal(last_x, begin));
        points[n_kept++] = point;
      }
      points.resize(n_kept);
    }

    /** Sums over points at nodes. Collective. */
    void gather()
    {
      for (const Point &point : points)
        for (unsigned int k = 0; k < shapes.n_nodes; ++k)
        {
          const unsigned int node = faces.faces()[point.face].nodes[k];
          const double weight = point.weight * shapes.value(point.q, k);
          const double rubbing = point.rubbing * shapes.value(point.q, k);
          sums.node(node)[depth] += weight * point.depth;
          sums.node(node)[squares] += weight * point.depth * point.depth;
          sums.node(node)[pressed] += rubbing;
          for (unsigned int d = 0; d < dim; ++d)
          {
            normals.node(node)[d] += rubbing * point.normal[d];
            motions.node(node)[d] += rubbing * point.motion[d];
          }
          normals.node(node)[approach] += weight * point.approach;
          motions.node(node)[approach] += weight * (is_static() ? 1. : point.past_approach);
        }
      for (NodalVector *const vector : {&sums, &normals, &motions})
        vector->add_to_owners();
    }

    /** Both. Collective. */
    void sum_points(const NodalVector &position, const Clock &clock)
    {
      for (NodalVector *const vector : {&sums, &normals, &motions})
        for (const unsigned int node : this->candidates)
          std::fill_n(vector->node(node), node_stride, 0.);
      find_points(position, clock);
      gather();
    }

    std::vector<double> depths_at(const NodalVector &position, const Clock &clock) override
    {
      sum_points(position, clock);
      std::vector<double> result;
      for (const unsigned int node : this->candidates)
        result.push_back(sums.node(node)[area] > 0. ? sums.node(node)[depth] / sums.node(node)[area]
                                                    : 0.);
      return result;
    }

    /** Normal and tangential force per area of a candidate. */
    void advance_node(const std::size_t k, const double mass, const Clock &clock,
                      const NodalHeat &nodal_heat)
    {
      const unsigned int node = this->candidates[k];
      const ContactSpring<dim> &spring = this->springs[k];
      const double *const node_sums = sums.node(node);
      Tensor<1, dim> normal = vector_of<dim>(normals.node(node));
      *pressures.node(node) = 0.;
      std::fill_n(tangentials.node(node), node_stride, 0.);
      if (!(node_sums[pressed] > 0. && normal.norm() > 0.) || mass == 0.)
      {
        ContactMotion<dim> move(0., Tensor<1, dim>(), Tensor<1, dim>());
        move.past_approach = past_approaches[k];
        if (spring.is_closed())
          this->release(k, move, nodal_heat);
        return;
      }
      normal /= normal.norm();
      // In explicit steps over the whole area, as the depth: forces act on the pressed share of it.
      const double whole = is_static() ? node_sums[pressed] : node_sums[area];
      ContactMotion<dim> move(node_sums[depth] / node_sums[area],
                              vector_of<dim>(motions.node(node)) / whole, normal);
      move.approach = normals.node(node)[approach] / node_sums[area];
      move.past_approach = past_approaches[k];
      this->press(k, move, mass, is_static() ? motions.node(node)[approach] : node_sums[pressed],
                  node_sums[pressed] / whole, clock, nodal_heat);
      *pressures.node(node) =
          (is_static() ? spring.stiffness : spring.normal_force()) / node_sums[area];
      for (unsigned int d = 0; d < dim; ++d)
        tangentials.node(node)[d] = -spring.stiffness * spring.elastic_slip[d] / whole;
    }

    /** Forces of the points on nodes. Collective. */
    void scatter()
    {
      pressures.update_ghosts();
      tangentials.update_ghosts();
      const auto add = [&](const Point &point)
      {
        const auto &nodes = faces.faces()[point.face].nodes;
        const double pressing = is_static() ? point.weight * point.depth : point.rubbing;
        Tensor<1, dim> force;
        for (unsigned int k = 0; k < shapes.n_nodes; ++k)
          force += shapes.value(point.q, k) *
                   (pressing * *pressures.node(nodes[k]) * point.normal +
                    point.rubbing * vector_of<dim>(tangentials.node(nodes[k])));
        for (unsigned int k = 0; k < shapes.n_nodes; ++k)
          for (unsigned int d = 0; d < dim; ++d)
            forces.node(nodes[k])[d] += shapes.value(point.q, k) * force[d];
      };
      add_up({&forces}, [&] { std::for_each(points.begin(), points.end(), add); });
    }

    /** Points share out what nodes have of their own depth. */
    bool is_static() const
    {
      return this->touch_distance > 0.;
    }

    /** How the pressure at a point changes with its depth, turns with the surface, and changes
     * friction. @p pressing: the area with which the depth of the point counts. */
    void add_pressure(const Point &point, const double pressing, const NodalState &state,
                      const double time, std::vector<ContactStiffness<dim>> &result) const
    {
      const auto &face = faces.faces()[point.face];
      Tensor<1, dim> x;
      ContactStiffness<dim> stiffness;
      for (unsigned int k = 0; k < shapes.n_nodes; ++k)
      {
        const double value = shapes.value(point.q, k);
        stiffness.normal += pressing * value * *pressures.node(face.nodes[k]);
        stiffness.slip += pressing * value * vector_of<dim>(tangentials.node(face.nodes[k]));
        x += value * vector_of<dim>(state.position.node(face.nodes[k]));
        stiffness.entries.push_back({face.global_nodes[k], value * point.normal, value});
      }
      stiffness.along = curvature_stiffness(*this->surface, x, stiffness.normal * point.depth, time,
                                            this->way_along_surface());
      stiffness.node = face.nodes[0];
      result.push_back(std::move(stiffness));
    }

    void add_node_sums(ContactBalance &shares) const override
    {
      SpringContact<dim>::add_node_sums(shares);
      // In static steps the depths of the points of a node differ from its mean.
      for (std::size_t k = 0; k < this->springs.size() && is_static(); ++k)
      {
        const double *const node_sums = sums.node(this->candidates[k]);
        const double mean_depth = this->springs[k].depth;
        if (this->springs[k].is_closed() && node_sums[area] > 0.)
          shares.elastic += 0.5 * this->springs[k].stiffness *
                            (node_sums[squares] / node_sums[area] - mean_depth * mean_depth);
      }
    }

    typename ContactFaces<dim>::Selector selects;
    ContactFaces<dim> faces;
    std::unique_ptr<ContactFaces<dim>> former_faces; ///< those of t_{n-1}; null if it has the same
    std::vector<double> past_approaches;             ///< of candidates, of points on these [L]
    FaceShapes<dim> shapes;
    std::vector<Point> points;
    NodalVector sums, normals, motions; ///< at nodes
    NodalVector pressures;              ///< per area, at nodes; in static steps per area and depth
    NodalVector tangentials;            ///< per weight of rubbing, at nodes
    NodalVector forces, last_position;
  };

  template <int dim>
  std::unique_ptr<SurfaceContact<dim>> make_face_contact(ContactScene<dim> &scene)
  {
    return std::make_unique<FaceContact<dim>>(scene);
  }

  template std::unique_ptr<SurfaceContact<2>> make_face_contact(ContactScene<2> &);
  template std::unique_ptr<SurfaceContact<3>> make_face_contact(ContactScene<3> &);
} // namespace tombolo
