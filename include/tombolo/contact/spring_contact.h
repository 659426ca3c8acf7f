// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surface_contact.h>

#include <vector>

namespace tombolo
{
  /** Contact by penalty springs: each candidate node has a spring of ContactLaw, whether its depth
   * is that of the node or a mean over its faces. */
  template <int dim>
  class SpringContact : public SurfaceContact<dim>
  {
  public:
    /** As that of SurfaceContact. Throws InputError. Collective. */
    explicit SpringContact(ContactScene<dim> &scene);

    /** That of ContactLaw. A node between two surfaces that press against each other is neglected.
     */
    double stable_fraction() const override
    {
      return this->settings.law.stable_fraction();
    }

    /** Springs in contact are deeper by as much as their nodes are. */
    void place_nodes(const NodalState &state, const NodalVector &before,
                     const Clock &clock) override;

  protected:
    using typename SurfaceContact<dim>::NodeHistory;

    /** What a step does to a candidate in contact. */
    struct Press
    {
      double depth;                          ///< δ [L]
      dealii::Tensor<1, dim> motion, normal; ///< relative to the surface, out of it
      double mass;
      double share = 1.; ///< of the node's area that is pressed
    };

    /** Moves the spring of a candidate, with friction and heat. */
    void press(std::size_t candidate, const Press &press, const Clock &clock,
               const NodalHeat &nodal_heat);
    /** Ends the contact of a candidate after its @p approach. */
    void release(const std::size_t candidate, const double approach, const bool has_eroded,
                 const NodalHeat &nodal_heat)
    {
      this->add_friction_heat(
          candidate,
          ContactLaw::release(approach, has_eroded, springs[candidate], this->totals.damping),
          nodal_heat);
    }

    /** The ratio of m̂ to the mass in springs and dampers, for the @p mass of all nodes in contact
     * on this rank. Collective where the surface has a mass. */
    double mass_ratio(const double mass) const
    {
      const double tool_mass = this->surface->translation().mass();
      return tool_mass == 0. ? 1. : 1. + ordered_sum(mass, this->communicator) / tool_mass;
    }

    /** How deep candidates are at these positions, negative where they are outside. Collective. */
    virtual std::vector<double> depths_at(const NodalVector &position, const Clock &clock) = 0;

    void add_node_sums(ContactBalance &shares) const override;

    std::vector<ContactSpring<dim>> springs; ///< of each candidate

  private:
    /** Of all closed springs of all ranks; very large where there is none. Collective. */
    double mean_stiffness() const;

    /** Of a mesh that was divided: springs of new nodes are as stiff as those around them, those of
     * all nodes are shared out by their masses, and they are as deep as nodes were. Collective. */
    void close_springs(const NodalState &state, StateArchive &archive);
  };
} // namespace tombolo
