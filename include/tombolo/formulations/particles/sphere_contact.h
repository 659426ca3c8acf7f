// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/formulations/particles/fragment_friction.h>
#include <tombolo/formulations/particles/sphere_pairs.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/tensor.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * Contact between particles of different bodies (SpherePairs). Each is a sphere (a disc) of the
   * radius ½ V^(1/dim) of its initial volume. Where those of two particles overlap by δ, a spring
   * and a damper push both apart along the line between them,
   *
   *   f = k δ + b ⟨δ̇⟩,  k = μ ω²,  b = 2 ζ √(k μ),  μ = m̂_I m̂_J / (m̂_I + m̂_J),
   *
   * with ω = √s c/h of the part (the speed c of longitudinal waves, the smallest spacing h of its
   * particles), the smaller one of two parts, the damping ζ of the part, of two the mean, and the
   * speed of approach ⟨δ̇⟩. There is no adhesion; friction and conduction are those of
   * FragmentFriction. Both ends compute the same force from the same numbers, so that momentum is
   * kept to round-off. Two particles that overlap initially, when they come apart, or when cells
   * make one of them, get smaller spheres, so that bodies begin to touch without a force.
   *
   * A particle on a plane of symmetry has the sphere and the mass that it has in the whole body,
   * and gets its share of the force.
   *
   * What damping takes is the work of the normal forces, by the mean of those at both ends of each
   * step, less what their springs store. Each end books its half with its part.
   */
  template <int dim>
  class SphereContact
  {
  public:
    /** Between these @p parts of a mesh, which must outlive this. Collective. */
    SphereContact(std::vector<typename SpherePairs<dim>::Part> parts, const Nodes<dim> &nodes,
                  const Bodies<dim> &bodies);

    /** Elements have gone: fragments and pairs are to be found again. */
    void forget_pairs()
    {
      pairing.forget();
    }

    /** Adds the forces on this rank's particles to @p loads, forces at positions, and their nodes
     * to @p loaded_nodes; with friction, loads of other nodes, ghosts among them, as well. @p
     * element_mass is that of elements at owned nodes. Points keep forces and fragments.
     * Collective. */
    void add_forces(const MechanicalInput &input, const NodalVector &element_mass,
                    NodalVector &loads, std::vector<unsigned int> &loaded_nodes,
                    const FragmentHeat &heat);

    /** The share of @p stable_step, the limit without contact, that springs and dampers leave. */
    double stable_fraction(double stable_step) const;

    /** The sums over the parts, of this rank. */
    FragmentCounts counts() const;

    /** Whether any particles rub or conduct. */
    bool rubs() const
    {
      return friction != nullptr;
    }

  private:
    using Columns = typename SelfContact<dim>::Columns;

    /** Of two parts. */
    struct PairLaw
    {
      double frequency, damping;
    };

    /** What the ends of a pair know of each other. */
    struct Motion
    {
      const NodalVector *position, *velocity;
    };

    /** Sums of a step, by part. */
    struct Sums
    {
      double elastic = 0, work = 0;
      unsigned long n_touching = 0;
    };

    double shrinkage(unsigned int row) const;
    /** Makes spheres of pairs that were none before as small as it takes for no overlap.
     * Collective. */
    void shrink_spheres(const NodalVector &position);
    /** With the ghosts of pairs. Collective. */
    Motion motion_of_ends(const MechanicalInput &input);
    void begin_friction(const MechanicalInput &input, const NodalVector &position,
                        const FragmentHeat &heat);
    /** The normal force on the particle of a row in the whole body; that of friction is added to
     * @p along. */
    dealii::Tensor<1, dim> force_on(unsigned int row, const Motion &of_ends, double time_step,
                                    const FragmentHeat &heat, double &elastic,
                                    dealii::Tensor<1, dim> &along);
    /** The force and the position of now take the place of those of the step before. Adds the
     * work in between. */
    void replace_force(unsigned int row, const dealii::Tensor<1, dim> &force,
                       const double *position, double &work);

    SpherePairs<dim> pairing;
    std::vector<PairLaw> laws;                       // of all pairs of parts
    std::vector<Columns> columns;                    // by part, in this step
    NodalVector spheres;                             // radius, mass, area, law
    NodalVector positions, velocities;               // where ranks or images see others
    std::unique_ptr<FragmentFriction<dim>> friction; // null: nothing rubs or conducts
  };
} // namespace tombolo
