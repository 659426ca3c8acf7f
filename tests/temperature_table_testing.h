// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/parameters.h>
#include <tombolo/materials/temperature_table.h>

#include <string>

namespace tombolo
{
  namespace testing
  {
    /** A table as the entry `Heat/Conductivity` of a file has it. */
    inline TemperatureTable read_table(const std::string &text)
    {
      Parameters parameters(MPI_COMM_SELF);
      parameters.read_text("subsection Heat\nset Conductivity = " + text + "\nend\n", "test.prm");
      parameters.handler().enter_subsection("Heat");
      Parameters::declare_mandatory(parameters.handler(), "Conductivity",
                                    dealii::Patterns::Anything(), "");
      parameters.handler().leave_subsection();
      parameters.assign();
      return TemperatureTable(parameters.section("Heat"), "Conductivity");
    }
  } // namespace testing
} // namespace tombolo
