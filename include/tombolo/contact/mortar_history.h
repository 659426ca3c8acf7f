// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/contact/contact_law.h>

#include <vector>

namespace tombolo
{
  class StateArchive;

  /** What a slave node of a contact between bodies keeps from step to step. The normal is out of
   * the master. */
  template <int dim>
  struct MortarHistory
  {
    ContactSpring<dim> spring; ///< per area
    dealii::Tensor<1, dim> traction, normal;
    double gap = 0;
    double area = 0; ///< A_I; zero where no master is near
    /** The overlap that has no force, or for tied surfaces the distance that they keep [L]. */
    double offset = 0;
    bool is_bonded = false;

    /** Writes those of these owned nodes to a checkpoint or reads them. Collective. */
    static void serialize(StateArchive &archive, const std::vector<unsigned int> &nodes,
                          std::vector<MortarHistory> &histories);
  };
} // namespace tombolo
