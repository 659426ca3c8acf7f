// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/output/history.h>
#include <tombolo/state/body_point.h>

#include <string>
#include <vector>

namespace tombolo
{
  /**
   * Histories at nodes: `probes.csv`, whose rows have time, step, and for each probe position,
   * displacement and velocity (of half a step before) and, in scenes with heat, temperature of the
   * node that was nearest to its location at the start.
   *
   * `Locations` lists them: `tip: 10, 0.6, 0.6; 5, 0.6, 0.6`, where one without a name is called
   * "probe" and its number in the list. Of nodes at the same distance the one
   * with the smallest persistent id is taken, so the choice does not depend on the number of ranks.
   */
  template <int dim>
  class Probes : public History<dim>
  {
  public:
    explicit Probes(const Entries &e);

    /** Throws InputError where a location is far from every node. */
    void check(const OutputView<dim> &view) override;

    /** Persistent ids of the nodes that were chosen, in the order of columns. */
    std::vector<std::uint64_t> nodes() const;

  private:
    struct Probe
    {
      std::string name;
      dealii::Point<dim> location;
      BodyPoint<dim> node;
    };

    void read_location(const std::string &text);
    /** The nodes next to the locations, at the start of the run; afterwards they stay the same ones
     * where cells are divided. Throws InputError. Collective. */
    void find_nodes(const OutputView<dim> &view);
    void begin(const OutputView<dim> &view) override;
    void add_columns(const OutputView<dim> &view) override;
    void check_columns(const OutputDirectory &directory, const UnitLabels &unit_labels) override;

    std::vector<Probe> probes;
    std::vector<double> places; ///< initial coordinates of the nodes, one after the other
  };
} // namespace tombolo
