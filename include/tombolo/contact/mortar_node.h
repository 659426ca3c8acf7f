// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>

#include <tombolo/contact/contact_law.h>

#include <string>
#include <vector>

namespace tombolo
{
  class StateArchive;

  /** What a slave node keeps from step to step. The normal is out of the master. */
  template <int dim>
  struct MortarNode
  {
    ContactSpring<dim> spring; ///< per area
    dealii::Tensor<1, dim> traction, normal;
    double gap = 0;
    double area = 0; ///< A_I; zero where no master is near
    /** The overlap that has no force, or for tied surfaces the distance that they keep [L]. */
    double offset = 0;
    bool is_bonded = false;
  };

  /** Writes to a checkpoint, or reads from it, what these owned nodes keep. Collective. */
  template <int dim>
  void serialize_mortar_nodes(const std::vector<unsigned int> &owned_nodes,
                              std::vector<MortarNode<dim>> &kept, StateArchive &archive);

  /** The same for areas, of which there may be none yet. Collective. */
  void serialize_areas(const std::string &name, const std::vector<unsigned int> &owned_nodes,
                       std::vector<double> &areas, StateArchive &archive);
} // namespace tombolo
