// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/spring_contact.h>

namespace tombolo
{
  /**
   * Contact by penalty springs: each candidate node behind the surface has a spring of ContactLaw,
   * with its mass m̂ and the stable time step Δt, not the one taken, so that the safety factor does
   * not change the stiffness. Against a surface with a mass m_t, m̂ / (1 + M/m_t) replaces m̂, with
   * the mass M of all nodes in contact: then the frequency of the springs is that of contact with a
   * surface of prescribed motion. Against a part it is m̂ / (1 + R), see PartSurface, which gets the
   * reactions.
   */
  template <int dim>
  class PenaltyContact : public SpringContact<dim>
  {
  public:
    /** As that of SurfaceContact. Throws InputError. Collective. */
    PenaltyContact(const Section &section, const Mesh<dim> &mesh, const Nodes<dim> &nodes,
                   const NodalState &state, const std::vector<bool> &can_be_exposed, bool has_heat,
                   const std::vector<double> &volume = {}, MasterPart<dim> master = {});

    void add_forces(const NodalState &state, const Clock &clock, NodalVector &loads,
                    std::vector<unsigned int> &loaded_nodes,
                    const NodalHeat &nodal_heat = {}) override;

    void find_stiffness(const NodalState &state, const Clock &clock,
                        std::vector<ContactStiffness<dim>> &result) override;

  private:
    using typename SurfaceContact<dim>::NodeHistory;

    /** What a node in contact sees of the surface. */
    struct Below
    {
      dealii::Tensor<1, dim> normal, motion; ///< motion over the last step [L]
      double mass_ratio;                     ///< of its mass to that of its spring
    };

    /** The mass of the nodes behind the surface, of this rank. */
    double mass_behind(const NodalState &state) const;
    /** Finds the places of nodes in contact with a part. Collective. */
    void find_places(const NodalState &state);
    Below below(std::size_t candidate, const dealii::Tensor<1, dim> &x, const Clock &clock,
                double mass_ratio) const;
    std::vector<double> depths_at(const NodalVector &position, const Clock &clock) override;
  };
} // namespace tombolo
