// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/losing_cells.h>

#include <tombolo/state/state_archive.h>

#include <algorithm>

namespace tombolo
{
  unsigned int LostCells::n_converted() const
  {
    return static_cast<unsigned int>(std::count(converted.begin(), converted.end(), true));
  }

  void LostCells::remove(const std::vector<unsigned int> &cells, const unsigned int n_cells)
  {
    lost.resize(n_cells, false);
    for (const unsigned int cell : cells)
      lost[cell] = true;
  }

  void LostCells::convert(const std::vector<unsigned int> &cells, const unsigned int n_cells)
  {
    lost.resize(n_cells, false);
    converted.resize(n_cells, false);
    for (const unsigned int cell : cells)
      lost[cell] = converted[cell] = true;
  }

  void LostCells::keep_dissipated(const EnergyAccounts &of_cells)
  {
    for (const EnergyAccounts::Account &account : of_cells.accounts())
      if (account.kind != EnergyKind::stored && account.name != "failure dissipation")
        dissipated_in_lost.add(account.name, account.kind, account.value);
  }

  bool LostCells::serialize(const unsigned int n_cells, const bool has_heat, StateArchive &archive)
  {
    constexpr double present = 0., eroded = 1., became_particles = 2.;
    std::vector<double> flags(n_cells, present);
    for (unsigned int cell = 0; cell < n_cells; ++cell)
      if (is_lost(cell))
        flags[cell] = is_converted(cell) ? became_particles : eroded;
    archive.rows("is removed", 1, flags);
    double plastic = dissipated_in_lost["plastic dissipation"],
           viscous = dissipated_in_lost["viscous dissipation"],
           thermal_work = dissipated_in_lost["thermal work"];
    archive.sums("dissipated in removed cells", {&plastic, &viscous, &thermal_work});
    if (!archive.is_reading())
      return false;
    dissipated_in_lost = EnergyAccounts();
    dissipated_in_lost.add("plastic dissipation", EnergyKind::dissipated, plastic);
    dissipated_in_lost.add("viscous dissipation", EnergyKind::artificial, viscous);
    if (has_heat)
      dissipated_in_lost.add("thermal work", EnergyKind::external, thermal_work);
    lost.clear();
    converted.clear();
    if (std::all_of(flags.begin(), flags.end(), [](const double flag) { return flag == present; }))
      return false;
    for (const double flag : flags)
    {
      lost.push_back(flag != present);
      converted.push_back(flag == became_particles);
    }
    return true;
  }
} // namespace tombolo
