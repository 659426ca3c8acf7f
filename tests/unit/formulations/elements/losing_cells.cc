// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1
#include <tombolo/formulations/elements/losing_cells.h>

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace tombolo
{
  namespace testing
  {
    namespace
    {
      TEST(LostCells, keep_what_cells_dissipate_and_no_account_that_particles_have_alone)
      {
        EnergyAccounts all_accounts;
        all_accounts.add("elastic energy", EnergyKind::stored, 1.);
        all_accounts.add("plastic dissipation", EnergyKind::dissipated, 2.);
        all_accounts.add("viscous dissipation", EnergyKind::artificial, 3.);
        all_accounts.add("failure dissipation", EnergyKind::dissipated, 4.);
        all_accounts.add("self-contact damping", EnergyKind::dissipated, 5.);
        LostCells cells;
        cells.keep_dissipated(all_accounts);
        std::vector<std::string> names;
        double sum = 0;
        for (const EnergyAccounts::Account &account : cells.dissipated().accounts())
        {
          names.push_back(account.name);
          sum += account.value;
        }
        EXPECT_EQ(names, (std::vector<std::string>{"plastic dissipation", "viscous dissipation"}));
        EXPECT_EQ(sum, 5.);
      }
    } // namespace
  }   // namespace testing
} // namespace tombolo
