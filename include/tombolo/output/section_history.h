// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/output/output.h>

#include <vector>

namespace tombolo
{
  /**
   * What passes through sections of the bodies: `sections.csv`, with a row every n steps of, for
   * each section in the order of `Sections`, the mean force and the mean moment since the row
   * before and the impulse since the start. Impulses are those until t_{n-1/2}, as the momenta of
   * `statistics.csv`. Rows are in the file after each output. Part of every scene that has
   * sections.
   */
  template <int dim>
  class SectionHistory : public Output<dim>
  {
  public:
    explicit SectionHistory(const Section &section);

    static void declare_parameters(dealii::ParameterHandler &handler);

    void start(const OutputView<dim> &view, const OutputDirectory &directory,
               const UnitLabels &unit_labels) override;
    void after_step(const OutputView<dim> &view) override;
    void write(const OutputView<dim> &view, TimeTable &statistics) override;
    void serialize(StateArchive &archive) override;
    void finish(Json &results) override;

  private:
    void add_row(const OutputView<dim> &view, const std::vector<SectionBalance> &now);

    unsigned int steps_between;
    std::vector<SectionBalance> last; ///< at the last row
    std::vector<SectionBalance> at_output;
    TimeTable table{"sections.csv", TimeTable::Rows::in_file};
  };
} // namespace tombolo
