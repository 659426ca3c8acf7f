// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/contact_faces.h>
#include <tombolo/contact/spring_contact.h>
#include <tombolo/mesh/face_shapes.h>

#include <memory>
#include <vector>

namespace tombolo
{
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
   * Faces are those of cells of degree 1 on the boundary of the mesh.
   */
  template <int dim>
  class FaceContact : public SpringContact<dim>
  {
  public:
    /** As that of SurfaceContact. Throws InputError. Collective. */
    FaceContact(const Section &section, const Mesh<dim> &mesh, const Nodes<dim> &nodes,
                const NodalState &state, bool has_heat, const std::vector<double> &volume = {});

    void set_partition(const std::shared_ptr<const NodePartition> &partition) override;

    void add_forces(const NodalState &state, const Clock &clock, NodalVector &loads,
                    std::vector<unsigned int> &loaded_nodes,
                    const NodalHeat &nodal_heat = {}) override;

    void keep_outside(const Clock &clock, const NodalVector &slides, const NodalVector &from,
                      NodalVector &position, NodalVector &is_bound) override;
    void place_nodes(const NodalState &state, const NodalVector &before,
                     const Clock &clock) override;
    void forget_motion(const NodalState &state) override;
    void find_stiffness(const NodalState &state, const Clock &clock,
                        std::vector<ContactStiffness<dim>> &result) override;

  private:
    using typename SurfaceContact<dim>::NodeHistory;
    using typename SurfaceContact<dim>::NodeSums;

    /** A quadrature point behind the surface. */
    struct Point
    {
      unsigned int face, q;
      double weight;  ///< area [L^(dim-1)]
      double depth;   ///< <-g> [L]
      double rubbing; ///< weight of motion and friction: the area, in static steps times the depth
      dealii::Tensor<1, dim> normal, motion;
    };

    /** Slots of the sums at nodes. */
    enum Sum : unsigned int
    {
      area,    ///< A_I
      depth,   ///< ∫ N_I <-g> dA
      pressed, ///< ∫ N_I dA over the points behind the surface, by the weights of rubbing
      squares  ///< ∫ N_I <-g>² dA
    };

    /** Finds the points behind the surface at t_n, and A_I. */
    void find_points(const NodalVector &position, const Clock &clock);
    /** Sums over points at nodes. Collective. */
    void gather();
    /** Both. Collective. */
    void sum_points(const NodalVector &position, const Clock &clock);
    std::vector<double> depths_at(const NodalVector &position, const Clock &clock) override;
    /** Normal and tangential force per area of a candidate. Returns whether it has any. */
    bool advance_node(std::size_t k, double mass, const Clock &clock, const NodalHeat &nodal_heat);
    /** Forces of the points on nodes. Collective. */
    void scatter();
    /** Points share out what nodes have of their own depth. */
    bool is_static() const
    {
      return this->touch_distance > 0.;
    }
    /** How the pressure at a point changes with its depth, turns with the surface, and takes
     * friction with it. */
    void add_pressure(const Point &point, const NodalState &state, double time,
                      std::vector<ContactStiffness<dim>> &result) const;
    NodeSums node_sums() const override;
    /** The mass of the nodes in contact, of this rank. */
    double mass_in_contact(const NodalState &state) const;

    ContactFaces<dim> faces;
    FaceShapes<dim> shapes;
    std::vector<Point> points;
    NodalVector sums, normals, motions; ///< at nodes
    NodalVector pressures;              ///< per area, at nodes; in static steps per area and depth
    NodalVector tangentials;            ///< per weight of rubbing, at nodes
    NodalVector forces, last_position;
  };
} // namespace tombolo
