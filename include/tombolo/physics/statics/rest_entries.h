// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/model/part.h>

#include <string>
#include <vector>

namespace tombolo
{
  /** Throws the InputError that an entry is not allowed where steps are those of bodies at rest
   * (`Time integration`): @p reason is the first half of a sentence, "it resists velocities", and
   * @p allowed the end of it. */
  template <int dim>
  void refuse_at_rest(const Section &section, const std::string &entry, const std::string &reason,
                      const std::string &allowed);

  /** The same for an entry of formulations that switches something on, where a part has it. */
  template <int dim>
  void refuse_switch_at_rest(const Parameters &parameters, const std::vector<Part<dim>> &parts,
                             const std::string &entry, const std::string &reason);
} // namespace tombolo
