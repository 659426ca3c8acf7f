// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/surface_contact.h>
#include <tombolo/model/model.h>
#include <tombolo/state/nodal_vector.h>
#include <tombolo/state/records.h>

#include <memory>
#include <vector>

namespace tombolo
{
  /**
   * The friction over the temperature of contacts in a scene whose particles share out the heat of
   * nodes (SpreadFriction). The coefficients of the receivers are implicit in the thermal step:
   * those of the temperatures that they will have at its end if what the last one brought by the
   * coefficient 1 comes again,
   *
   * @verbatim
   *   m_j = μ(T_j),   H_j(T_j) = H_j + m_j Σ_i G_ij q_i / μ_i
   * @endverbatim
   *
   * where T_j is that of the node or of the field there, whichever is hotter: sharpened and affine
   * smoothings are hotter between nodes than these are.
   *
   * Where nodes hang, heat is shared out as that of other sources, and friction sees the field at
   * the node.
   */
  template <int dim>
  class HeatedFriction
  {
  public:
    using Contacts = std::vector<std::unique_ptr<SurfaceContact<dim>>>;

    /** Of those of @p contacts that have a friction over the temperature, where something is
     * smoothed: of none elsewhere. They must outlive this. Lists what it keeps in @p records. */
    HeatedFriction(const Contacts &contacts, const Model<dim> &model, Records &records);

    /** Before forces of contacts: finds coefficients where a thermal step has ended. Collective. */
    void update(const Model<dim> &model);

    /** The model has changed, other than its rows alone. */
    void forget_coefficients();

    /** At the end of a thermal step: nodes get the heat of friction, which waits no longer.
     * Collective. */
    void give_heat(const Model<dim> &model);

  private:
    struct Member
    {
      const SurfaceContact<dim> *contact;
      SpreadFriction *friction;
      bool is_current = false; ///< whether its coefficients are those of its weights
    };

    /** Collective. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition);
    /** Takes friction from receivers whose heat raises the field where that is beyond the end of
     * friction. Collective. */
    void limit_weights(const Model<dim> &model, const Member &member);
    /** Σ_j G_ij m_j at nodes that can touch. Collective. */
    void find_coefficients(const Model<dim> &model, const Member &member, NodalVector &result);
    void give_heat(const Model<dim> &model, const Member &member);

    std::vector<Member> members;
    unsigned long revision_of_rows = 0; // of the coefficients
    // Buffers.
    NodalVector smoothed, field, loads, heat, adjoint, unit_heat;
    std::vector<double> kept, hottest, explicit_weights;
    std::vector<unsigned int> heated;
  };
} // namespace tombolo
