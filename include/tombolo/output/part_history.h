// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/output/output.h>

namespace tombolo
{
  /**
   * Energies of the parts: `parts.csv`, with a row every n steps of, for each part, its mass,
   * momentum and kinetic energy, and all the energies that its formulation accounts for. Rows are
   * in the file after each output. On request, by `Further outputs`.
   *
   * Momentum and kinetic energy are Σ m v̂ and Σ ½ m v̂² at t_{n-1/2} with the part's own mass at its
   * nodes, unscaled: a node that two parts share counts in both with the share that each has of
   * it.
   */
  template <int dim>
  class PartHistory : public Output<dim>
  {
  public:
    explicit PartHistory(const Section &section);

    static void declare_parameters(dealii::ParameterHandler &handler);

    /** Throws InputError in scenes of heat alone. */
    void check(const OutputView<dim> &view) override;
    void start(const OutputView<dim> &view, const OutputDirectory &directory,
               const UnitLabels &unit_labels) override;
    void after_step(const OutputView<dim> &view) override;
    void write(const OutputView<dim> &view, TimeTable &statistics) override;
    void serialize(StateArchive &archive) override;
    void finish(Json &results) override;

  private:
    void add_row(const OutputView<dim> &view);

    Section section;
    unsigned int steps_between;
    TimeTable table{"parts.csv", TimeTable::Rows::in_file};
  };
} // namespace tombolo
