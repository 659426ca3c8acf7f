// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/elements/losing_cells.h>

#include <tombolo/state/state_archive.h>

#include <algorithm>
#include <array>
#include <string_view>
#include <utility>

namespace tombolo
{
  namespace
  {
    /** What is dissipated in cells that are lost; particles that cells become have further
     * accounts. */
    constexpr std::array<std::pair<std::string_view, EnergyKind>, 3> kept = {
        {{"plastic dissipation", EnergyKind::dissipated},
         {"viscous dissipation", EnergyKind::artificial},
         {"thermal work", EnergyKind::external}}};
  } // namespace

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
      if (std::any_of(kept.begin(), kept.end(),
                      [&](const auto &of_cell) { return of_cell.first == account.name; }))
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
    std::array<double, kept.size()> values;
    for (std::size_t k = 0; k < kept.size(); ++k)
      values[k] = dissipated_in_lost[std::string(kept[k].first)];
    archive.sums("dissipated in removed cells", {&values[0], &values[1], &values[2]});
    if (!archive.is_reading())
      return false;
    dissipated_in_lost = EnergyAccounts();
    for (std::size_t k = 0; k < kept.size(); ++k)
      if (has_heat || kept[k].second != EnergyKind::external)
        dissipated_in_lost.add(std::string(kept[k].first), kept[k].second, values[k]);
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
