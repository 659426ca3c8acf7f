// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/coupling/bridge.h>
#include <tombolo/model/part.h>
#include <tombolo/state/nodal_vector.h>

#include <vector>

namespace tombolo
{
  /**
   * The loop over the parts of a model for an operator of any kind (internal force, elastic
   * stiffness, conduction), and the one place that knows what the trace bridge does to it: elements
   * see the field of the particles at shared nodes, and what they give there goes to the particles
   * by Φᵀ. What parts give to dependent nodes goes to those on which these depend.
   */
  template <int dim>
  class Assembly
  {
  public:
    explicit Assembly(const std::vector<Part<dim>> &parts) : parts(parts) {}

    /**
     * @p result := Σ over parts of what @p of_part(part, field, result) adds at local nodes, with
     * ghosts collected, and of what @p result has already, where it @p has_begun. @p field has
     * current ghosts; what a part is handed as field is what it sees. Collective.
     */
    template <typename Operator>
    void assemble(Bridge &bridge, const NodalVector &field, NodalVector &result,
                  const Operator &of_part, const bool has_begun = false)
    {
      const bool is_trace = bridge.is_trace();
      if (!has_begun)
        result.set_zero();
      if (is_trace)
      {
        if (of_elements.partition() != result.partition())
          of_elements.reinit_like(result);
        of_elements.set_zero();
      }
      const NodalVector &seen_by_elements = bridge.element_velocity(field);
      for (const Part<dim> &part : parts)
      {
        const bool sees_trace = is_trace && part.particles == nullptr;
        of_part(part, sees_trace ? seen_by_elements : field, sees_trace ? of_elements : result);
      }
      result.collect();
      if (is_trace)
        bridge.collect_element_force(of_elements, result);
    }

  private:
    const std::vector<Part<dim>> &parts;
    NodalVector of_elements; // with the trace bridge only
  };
} // namespace tombolo
