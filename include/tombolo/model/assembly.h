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
   * stiffness, conduction), with the trace bridge: elements are evaluated with the
   * field of the particles at shared nodes, and what they add there goes to the particles
   * by Φᵀ. What parts add to dependent nodes goes to those on which these depend.
   */
  template <int dim>
  class Assembly
  {
  public:
    explicit Assembly(const std::vector<Part<dim>> &parts) : parts(parts) {}

    /**
     * @p result := Σ over parts of what @p part_operator(part, field, result) adds at local nodes,
     * with ghosts collected, and of what @p result has already, where it @p has_begun. @p field has
     * current ghosts; each part uses the field that is passed to it. Collective.
     */
    template <typename Operator>
    void assemble(Bridge &bridge, const NodalVector &field, NodalVector &result,
                  const Operator &part_operator, const bool has_begun = false)
    {
      const bool is_trace = bridge.is_trace();
      if (!has_begun)
        result.set_zero();
      if (is_trace)
      {
        element_result.fit_to(result.partition(), result.quantity());
        element_result.set_zero();
      }
      const NodalVector &element_field = bridge.element_velocity(field);
      for (const Part<dim> &part : parts)
      {
        const bool uses_trace = is_trace && part.particles == nullptr;
        part_operator(part, uses_trace ? element_field : field,
                      uses_trace ? element_result : result);
      }
      result.collect();
      if (is_trace)
        bridge.collect_element_force(element_result, result);
    }

  private:
    const std::vector<Part<dim>> &parts;
    NodalVector element_result; // with the trace bridge only
  };
} // namespace tombolo
