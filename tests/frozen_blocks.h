// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include "frozen_body.h"

namespace tombolo
{
  namespace testing
  {
    inline Block particles(const std::string &dilation, const std::string &smoothing,
                           const double poisson)
    {
      Block block;
      block.options = "set Dilation = " + dilation + "\nset Smoothing = " + smoothing;
      block.poisson = poisson;
      return block;
    }

    inline Block elements(const std::string &name, const std::string &options, const double poisson,
                          const std::vector<unsigned int> &cells = {6, 5, 5})
    {
      Block block;
      block.formulation = name;
      block.options = options;
      block.poisson = poisson;
      block.cells = cells;
      return block;
    }

    inline Block coupled(const std::string &smoothing, const std::string &bridge,
                         const double poisson,
                         const std::string &element = "fully integrated hexahedron")
    {
      Block block = particles("1.8", smoothing, poisson);
      block.formulation = "coupled";
      block.bridge = bridge;
      block.element = element;
      return block;
    }

    inline constexpr const char *clamped = "set Conditions = c\nsubsection Condition: c\nset Type "
                                           "= clamp\nset Where = x < 1e-9\nend\n";

    inline Block with(Block block, const std::string &conditions, const std::string &mesh_options,
                      const std::vector<unsigned int> &cells)
    {
      block.conditions = conditions;
      block.mesh_options = mesh_options;
      block.cells = cells;
      return block;
    }
  } // namespace testing
} // namespace tombolo
