// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/output/history.h>
#include <tombolo/state/body_point.h>

#include <deal.II/base/point.h>

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * Histories at nodes: `probes.csv`, whose rows have time, step, and for each probe position,
   * displacement and velocity (of half a step before) and, in scenes with heat, temperature of its
   * node.
   *
   * `Locations` lists places, to which the nearest node at the start is taken:
   * `tip: 10, 0.6, 0.6; 5, 0.6, 0.6`, where one without a name is called "probe" and its number in
   * the list. Of nodes at the same distance the one with the smallest persistent id is taken, so
   * the choice does not depend on the number of ranks. `Nodes` lists persistent ids, and all nodes
   * on `Boundary` and where `Where` holds are taken: these are called "node" and their persistent
   * id at the start, and those of a region stand in its order. `Mesh nodes` lists numbers of the
   * mesh file; these are called "mesh node" and their number there.
   */
  template <int dim>
  class Probes : public History<dim>
  {
  public:
    explicit Probes(const Entries &e);

    /** Throws InputError where a location is far from every node, or a node is not there. */
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

    void add(const Probe &probe);
    /** The numbers that an entry lists. Throws InputError. */
    std::vector<std::uint64_t> read_numbers(const std::string &entry,
                                            const std::string &list) const;
    /** The persistent ids of `Mesh nodes`. Throws InputError. Collective. */
    std::vector<std::uint64_t> mesh_nodes(const OutputView<dim> &view) const;
    /** Persistent ids and initial positions of the nodes that are given by number and region.
     * Throws InputError. Collective. */
    std::vector<std::pair<std::uint64_t, dealii::Point<dim>>>
    choose_nodes(const OutputView<dim> &view) const;
    /** What one of these is called. */
    std::string name_of_chosen(std::size_t index) const;
    /** The nodes next to the locations, at the start of the run; afterwards they stay the same ones
     * where cells are divided. Throws InputError. Collective. */
    void begin(const OutputView<dim> &view) override;
    void add_columns(const OutputView<dim> &view) override;
    void check_columns(const OutputDirectory &directory, const UnitLabels &unit_labels) override;

    std::vector<Probe> probes; ///< those of locations first
    std::size_t n_locations = 0;
    std::vector<std::uint64_t> numbers;      ///< of the entry `Nodes`
    std::vector<std::uint64_t> mesh_numbers; ///< of the entry `Mesh nodes`
    std::optional<Predicate<dim>> where;     ///< of the region
    std::string boundary;                    ///< likewise
    std::string wanted_choice, choice;       ///< what was asked for, and what is chosen
    std::vector<std::uint64_t> chosen;       ///< of the nodes by number and region, at the start
    std::vector<double> places; ///< initial coordinates of the nodes, one after the other
  };
} // namespace tombolo
