// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/condition_accounts.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/output/history.h>
#include <tombolo/physics/mechanics/loads.h>

namespace tombolo
{

  template <int dim>
  void add_condition_columns(const std::vector<ConditionBalance> &conditions,
                             BalanceHistory<dim> &row)
  {
    for (const ConditionBalance &now : conditions)
    {
      row.begin_item(now);
      row.add_impulses();
      row.add("work", "M L^2/T^2", now.work);
      if (now.prescribes_motion)
        row.add("mean displacement", "L", now.displacement);
      row.summarize("work", now.work);
    }
  }

  template void add_condition_columns(const std::vector<ConditionBalance> &, BalanceHistory<2> &);
  template void add_condition_columns(const std::vector<ConditionBalance> &, BalanceHistory<3> &);

  namespace
  {
    /** `conditions.csv` (doc/conditions.md). */
    const HistoryRegistration condition_registration(
        {condition_history, "conditions.csv",
         "Forces, moments, impulses and works of mechanical conditions, displacements of those "
         "that "
         "prescribe motion (conditions.csv); in every scene that has such.",
         false, true, "conditions"},
        3, "conditions of mechanics",
        [](const Section &output)
        {
          const Parameters &parameters = output.all();
          for (const std::string &name : section_names(parameters, "Conditions"))
          {
            std::string type;
            parameters.attempt([&]
                               { type = parameters.section("Condition: " + name).get("Type"); });
            for (const char *const known : {"traction", "pressure", "body force", "gravity",
                                            "velocity", "displacement", "clamp"})
              if (type == known)
                return true;
          }
          return false;
        });
  } // namespace

  TOMBOLO_REGISTER_PROCESS(Loads, process_order::loads)
} // namespace tombolo
