// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/approximation/neighbourhoods.h>
#include <tombolo/formulations/particles/particle_formulation.h>
#include <tombolo/formulations/particles/self_contact.h>
#include <tombolo/mesh/bodies.h>
#include <tombolo/state/nodal_vector.h>

#include <cstdint>
#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * The pairs of particles that can touch: of different fragments of one part, which no chain of
   * bonds connects, debris without bonds among them, or of bodies of different parts that no common
   * node joins; two nodes of elements are none. At planes of symmetry particles also meet the
   * images of others and their own ones, unless a chain of bonds, or between parts a node on the
   * plane, connects both in the whole body. Each node is one particle, with all the volume and mass
   * that it has of these parts.
   *
   * Candidates are found with a skin among all particles of the parts concerned, and kept until
   * something has moved by half a diameter (the mean of the largest ones of its part and of all)
   * relative to anything else: meant for particles that are not too different in size. They are
   * local nodes of a partition of their own, which has no other ghosts.
   */
  template <int dim>
  class SpherePairs
  {
  public:
    using Columns = typename SelfContact<dim>::Columns;

    /** A part whose particles touch others. */
    struct Part
    {
      SelfContact<dim> *contact;
      ParticleFormulation<dim> *particles;
      bool acts = false; ///< whether its particles can be in pairs
      // As last seen.
      unsigned long particles_revision = 0, rows_revision = 0;
    };

    /** The particles of this rank, by row. */
    struct Spheres
    {
      std::vector<dealii::types::global_dof_index> nodes;
      std::vector<double> volumes, masses; ///< in the whole body
      std::vector<unsigned int> laws;      ///< of its parts the number of that with the smallest ω
      std::vector<std::uint64_t> parts;    ///< a bit each
    };

    /** Of these @p parts of a mesh, which must outlive this. Collective. */
    SpherePairs(std::vector<Part> parts, const Nodes<dim> &nodes, const Bodies<dim> &bodies);

    const std::vector<Part> &parts() const
    {
      return all_parts;
    }

    /** Whether bodies of different parts can meet. */
    bool are_between_parts() const
    {
      return is_between_parts;
    }

    /** Fragments and pairs are to be found again. */
    void forget()
    {
      are_current = false;
    }

    /** Looks for candidates anew where that is due. Returns whether there can be any. Collective.
     */
    bool find_candidates(const NodalVector &position);

    /** Whether pairs are those of the candidates, the rows and the elements. */
    bool is_current() const
    {
      return are_current;
    }

    /** Finds fragments and the pairs of different bodies among the candidates; @p position has the
     * ghosts of the stencils, @p element_mass is that of elements at owned nodes. Columns keep the
     * fragments. Collective. */
    void find_pairs(const NodalVector &position, const NodalVector &element_mass,
                    const std::vector<Columns> &columns);

    /** Whether both ends of a pair were one before as well, with the volumes that they have now. */
    bool were_pair(unsigned int own, unsigned int other, unsigned int mirrors) const;

    const TouchingRows &rows() const
    {
      return all_rows;
    }
    const Spheres &spheres() const
    {
      return all_spheres;
    }
    const FragmentPairs &pairs() const
    {
      return all_pairs;
    }
    /** Has the local nodes of pairs. */
    const std::shared_ptr<const NodePartition> &partition() const
    {
      return own_partition;
    }
    /** Whether it has ghosts or images on any rank. */
    bool has_ghosts() const
    {
      return sees_ghosts;
    }

  private:
    void collect_rows();
    void add_row(dealii::types::global_dof_index node);
    /** The reach of each particle: half the largest diameters of its part and of all. Collective.
     */
    void find_supports();
    /** Gives all rows of one particle the same state. Returns which particles were there, and have
     * not grown, since pairs were found last. */
    std::vector<bool> unite_rows(const std::vector<Columns> &columns);
    void find_tags(unsigned int part, const NodalVector &position, const NodalVector &element_mass,
                   const Columns &of_part);
    void set_owners(const std::vector<bool> &were_known, const NodalVector &element_mass);
    bool are_apart(const std::vector<NodalVector> &of_parts, unsigned int own, unsigned int other,
                   unsigned int mirrors) const;

    std::vector<Part> all_parts;
    const Nodes<dim> *nodes;
    const Bodies<dim> *bodies;
    PlanesOfBodies planes;
    bool is_between_parts = false;
    TouchingRows all_rows;
    Spheres all_spheres;

    // Rows of candidates have no shape functions.
    std::vector<double> supports, present_position; // node_stride a particle
    Neighbourhoods<dim> neighbourhoods;
    Stencils candidates;
    std::shared_ptr<const NodePartition> own_partition;
    bool sees_ghosts = false;

    bool are_current = false;
    FragmentPairs all_pairs;
    // By part: the fragment, and whether it is a node of elements; now, and when last found.
    std::vector<NodalVector> tags, former_tags;
    NodalVector owners; // of several parts: see OwnerTag
  };
} // namespace tombolo
