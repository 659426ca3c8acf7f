// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surface_contact.h>

#include <vector>

namespace tombolo
{
  /**
   * Contact by penalty springs: each candidate node behind the surface has a spring of ContactLaw,
   * with its mass m̂ and the stable time step Δt, not the one taken, so that the safety factor does
   * not change the stiffness. Against a surface with a mass m_t, m̂ / (1 + M/m_t) replaces m̂, with
   * the mass M of all nodes in contact: then the frequency of the springs is that of contact with a
   * surface of prescribed motion.
   */
  template <int dim>
  class PenaltyContact : public SurfaceContact<dim>
  {
  public:
    /** As that of SurfaceContact. Throws InputError. Collective. */
    PenaltyContact(const Section &section, const Mesh<dim> &mesh, const Nodes<dim> &nodes,
                   const NodalState &state, const std::vector<bool> &can_be_exposed, bool has_heat,
                   const std::vector<double> &volume = {});

    void add_forces(const NodalState &state, const Clock &clock, NodalVector &loads,
                    std::vector<unsigned int> &loaded_nodes,
                    const NodalHeat &nodal_heat = {}) override;

    void begin_trial(const NodalState &state, const Clock &clock) override;
    void restart_trial() override;
    void find_stiffness(const NodalState &state, const Clock &clock,
                        std::vector<ContactStiffness<dim>> &result) override;

    /** That of ContactLaw. A node between two surfaces that press against each other is neglected.
     */
    double stable_fraction() const override;

  private:
    using typename SurfaceContact<dim>::NodeHistory;
    using typename SurfaceContact<dim>::NodeSums;

    NodeSums node_sums() const override;
    void serialize_nodes(StateArchive &archive) override;
    void continue_nodes(StateArchive &archive) override;

    /** The force on a candidate behind the surface after its @p motion relative to the surface. */
    void press(std::size_t candidate, const dealii::Tensor<1, dim> &motion,
               const dealii::Tensor<1, dim> &normal, double mass, const Clock &clock,
               const NodalHeat &nodal_heat);
    /** Ends the contact of a candidate that is in front of the surface or @p has_eroded. */
    void release(std::size_t candidate, const dealii::Tensor<1, dim> &motion,
                 const dealii::Tensor<1, dim> &normal, bool has_eroded);
    /** The ratio of m̂ to the mass in springs and dampers. Collective where the surface has a mass.
     */
    double mass_ratio(const NodalState &state) const;

    std::vector<ContactSpring<dim>> springs, committed_springs; ///< of each candidate
  };
} // namespace tombolo
