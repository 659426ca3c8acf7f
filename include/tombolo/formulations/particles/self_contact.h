// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/base/energy_accounts.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/particles/fragment_friction.h>
#include <tombolo/state/material_points.h>
#include <tombolo/state/nodal_vector.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace tombolo
{
  class Records;

  /** Fragments of a part in contact. */
  struct FragmentCounts
  {
    unsigned long n_fragments = 0; ///< bodies that no chain of bonds connects, as last looked for
    unsigned long n_touching = 0;  ///< particles that others push
  };

  /** The particles of a part on this rank, as self-contact knows them; in the order of rows. */
  struct ContactParticles
  {
    std::vector<dealii::types::global_dof_index> nodes; ///< ascending
    std::vector<std::uint64_t> ids;                     ///< persistent identifiers
    std::vector<double> volumes;                        ///< initial ones [L^dim]
    std::vector<double> masses;                         ///< inertia: m̂, scaled as it is [M]
    /** Volume and mass in the whole body over these: 1 without planes of symmetry. */
    std::vector<double> copies;
  };

  /**
   * Contact between the fragments of one part: bodies that no chain of bonds connects, debris
   * without bonds among them. Each particle is a sphere (a disc) of the radius ½ V^(1/dim) of its
   * initial volume. Where those of two particles of different fragments overlap by δ, a spring and
   * a damper push both apart along the line between them,
   *
   *   f = k δ + b ⟨δ̇⟩,  k = s μ (c/h)²,  b = 2 ζ √(k μ),  μ = m̂_I m̂_J / (m̂_I + m̂_J),
   *
   * with the speed c of longitudinal waves and the smallest spacing h of the particles of the part,
   * and with ⟨δ̇⟩ the speed of approach. There is no adhesion; friction and conduction are those of
   * FragmentFriction. Both ends compute the same force from the same numbers, so that momentum is
   * kept to round-off. Two particles that
   * overlap when they come apart, or when cells make one of them, get smaller spheres, so that
   * fragments begin to touch without a force. Two nodes of elements are left to the elements.
   *
   * At planes of symmetry particles also meet the images of others and their own ones, unless a
   * chain of bonds connects both in the whole body. A particle on a plane has the sphere and the
   * mass that it has in the whole body, and gets its share of the force.
   *
   * What damping takes is the work of the normal forces, by the mean of those at both ends of each
   * step, less what their springs store.
   */
  template <int dim>
  class SelfContact
  {
  public:
    /** Null where the section of the formulation does not want it. Throws InputError. */
    static std::unique_ptr<SelfContact> create(const Entries &e);

    /** Particles meet these images. Before variables(). */
    void set_images(const std::shared_ptr<const Images> &images)
    {
      images_of_part = images;
      neighbourhoods.set_images(images);
    }

    /** What points must hold. */
    std::vector<FieldDescription> variables() const;

    /** Before anything else, and whenever there are more particles. @p wave_rate is c/h, the same
     * each time. Collective. */
    void set_particles(ContactParticles particles, double wave_rate, MPI_Comm communicator);

    /** Returns how many fragments the whole body has. Where cells become particles of the part, or
     * there are several, pairs are looked for from the first step on, otherwise from the first
     * broken bond on. @p partition as in find_fragments(). Collective. */
    unsigned long set_start(bool grows, const Stencils &shape, const NodePartition &partition);

    /** Before each force, with current ghosts of @p position: looks for pairs anew where that is
     * due. @p has_broken_bonds is that of all ranks. Returns whether the partition can lack what
     * is required on any rank. Collective. */
    bool update(const NodalVector &position, bool has_broken_bonds);

    /** Rows have lost neighbours or have other ones, or elements have gone: fragments and pairs are
     * to be found again. */
    void forget_fragments()
    {
      pairs_are_current = false;
    }

    /** Nodes whose values this rank must see. */
    const std::vector<dealii::types::global_dof_index> &required_nodes() const
    {
      return is_searched ? neighbourhoods.global_nodes() : particles.nodes;
    }

    /** Adds the images of nodes whose values this rank must see. */
    template <typename List>
    void add_image_nodes(List &nodes) const
    {
      if (is_searched)
        nodes.insert(nodes.end(), neighbourhoods.images().begin(), neighbourhoods.images().end());
    }

    /** Translates node numbers to those of a partition that has what is required. */
    void set_partition(const NodePartition &partition)
    {
      pairs_are_current = false;
      if (is_searched)
        neighbourhoods.set_partition(partition, candidates);
    }

    /** Adds the forces on this rank's particles to @p loads, forces at positions, and their nodes
     * to @p loaded_nodes; with friction, loads of other nodes, ghosts among them, as well. @p
     * element_mass is that of elements at owned nodes. @p points keep forces and fragments.
     * Collective. */
    void add_forces(const MechanicalInput &input, const NodalVector &element_mass,
                    const Stencils &shape, MaterialPoints &points, NodalVector &loads,
                    std::vector<unsigned int> &loaded_nodes, const FragmentHeat &heat);

    /** The share of @p stable_step, the limit without contact, that springs and dampers leave: to a
     * particle of a body with five others on its free side, or to debris among twelve. */
    double stable_fraction(double stable_step) const;

    /** What springs store, and what has been taken by damping, by spheres that shrink and by the
     * steps, and by friction: this rank's shares. */
    void account(EnergyAccounts &accounts) const;

    /** As last looked for, over this rank; each fragment is counted where its label is. */
    FragmentCounts counts() const
    {
      return {n_fragments, n_touching};
    }

    /** Whether fragments rub or conduct. */
    bool rubs() const
    {
      return friction != nullptr;
    }

    /** Beside points. */
    void list(Records &records);

  private:
    explicit SelfContact(const Entries &e);

    /** Finds fragments and the pairs of different ones. Collective. */
    void find_pairs(const NodalVector &position, const NodalVector &element_mass,
                    const Stencils &shape, MaterialPoints &points);
    /** How many tags a node has. */
    unsigned int n_tags() const;
    double present_radius(const unsigned int i, const double shrinkage) const
    {
      return 0.5 * std::pow(particles.volumes[i], 1. / dim) * (1. - shrinkage);
    }
    /** Which particles of this rank touch another fragment. */
    void find_touching(const NodalVector &position);
    /** Makes spheres of pairs that were none before as small as it takes for no overlap.
     * Collective. */
    void shrink_spheres(const NodalVector &position, MaterialPoints &points);

    double stiffness, damping;
    MPI_Comm communicator = MPI_COMM_NULL;
    std::shared_ptr<const Images> images_of_part = Images::none();
    ContactParticles particles;
    std::vector<double> shares; // in the piece of the body, of particles of the whole one
    bool is_apart_at_start = false;
    double frequency = 0; // √(k/μ) [1/T]
    double stored = 0, dissipated = 0;

    // Candidates, found with a skin; rows have no shape functions.
    std::vector<double> supports, present_position; // node_stride a particle
    Neighbourhoods<dim> neighbourhoods;
    Stencils candidates;
    bool is_searched = false;
    std::vector<bool> has_grown; // by particle, since pairs were found last

    // Pairs of different fragments among them, by particle.
    bool pairs_are_current = false;
    FragmentPairs pairs;
    // The fragment, and whether it is a node of elements; now, and when last found.
    NodalVector tags, former_tags;
    NodalVector spheres; // radius, mass, area
    unsigned long n_fragments = 0, n_touching = 0;
    std::unique_ptr<FragmentFriction<dim>> friction; // null: fragments neither rub nor conduct
    std::vector<bool> is_touching;                   // particles, in this step; with friction alone
  };
} // namespace tombolo
