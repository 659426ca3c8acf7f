// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/energy_accounts.h>
#include <tombolo/formulations/elements/converting_cells.h>

#include <vector>

namespace tombolo
{
  class StateArchive;

  /** Which of the cells of a part on this rank are none of it any more, removed or become
   * particles, and what was dissipated in them. */
  class LostCells
  {
  public:
    /** Whether a cell, by its number, is no cell of the part any more. */
    bool is_lost(const unsigned int cell) const
    {
      return !lost.empty() && lost[cell];
    }

    /** Whether it became particles. */
    bool is_converted(const unsigned int cell) const
    {
      return cell < converted.size() && converted[cell];
    }

    unsigned int n_converted() const;

    /** is_lost() of all cells; empty before the first. */
    const std::vector<bool> &flags() const
    {
      return lost;
    }

    /** Notes of a part of @p n_cells that @p cells are removed. */
    void remove(const std::vector<unsigned int> &cells, unsigned int n_cells);

    /** ... and that they become particles. */
    void convert(const std::vector<unsigned int> &cells, unsigned int n_cells);

    /** Keeps what is not stored of the energies that went with cells, but for what failure
     * dissipated. */
    void keep_dissipated(const EnergyAccounts &of_cells);

    const EnergyAccounts &dissipated() const
    {
      return dissipated_in_lost;
    }

    /** Writes to a checkpoint, or reads from it. Returns whether cells were read that are lost.
     * Collective. */
    bool serialize(unsigned int n_cells, bool has_heat, StateArchive &archive);

  private:
    std::vector<bool> lost;      // by cell; empty before the first
    std::vector<bool> converted; // those of them that became particles; likewise
    EnergyAccounts dissipated_in_lost;
  };

  /** What all parts have whose cells can become particles: when they do, and which are lost. */
  template <int dim>
  class LosingCells : public ConvertingCells<dim>
  {
  public:
    LosingCells() = default;
    explicit LosingCells(const Section &section) : criterion(section) {}

    const ConversionCriterion &conversion() const override
    {
      return criterion;
    }

    void keep_dissipated(const EnergyAccounts &lost) override
    {
      lost_cells.keep_dissipated(lost);
    }

    unsigned int n_converted_cells() const override
    {
      return lost_cells.n_converted();
    }

  protected:
    ConversionCriterion criterion; ///< of conversion
    LostCells lost_cells;
  };
} // namespace tombolo
