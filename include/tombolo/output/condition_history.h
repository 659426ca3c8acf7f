// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/output/output.h>

#include <deal.II/base/tensor.h>

#include <string>
#include <vector>

namespace tombolo
{
  /**
   * What holds, drives and loads the bodies: `conditions.csv`, with a row every n steps of, for
   * each mechanical condition, the mean force and the mean moment on the bodies since the row
   * before, the impulse and the work since the start; of those that prescribe motion also the mean
   * displacement of their nodes. Those come first, then loads, each in the order of
   * `Conditions`. Moments are about the entry `Moments about`. Impulses are those until t_{n-1/2},
   * as the momenta of `statistics.csv`. Rows are in the file after each output. Part of every scene
   * that has mechanical conditions.
   */
  template <int dim>
  class ConditionHistory : public Output<dim>
  {
  public:
    /** Throws InputError. */
    explicit ConditionHistory(const Section &section);

    static void declare_parameters(dealii::ParameterHandler &handler);

    void start(const OutputView<dim> &view, const OutputDirectory &directory,
               const UnitLabels &unit_labels) override;
    void after_step(const OutputView<dim> &view) override;
    void write(const OutputView<dim> &view, TimeTable &statistics) override;
    void serialize(StateArchive &archive) override;
    void finish(Json &results) override;

  private:
    /** With the moments about `Moments about`. Collective. */
    std::vector<ConditionBalance> balances(const OutputView<dim> &view) const;
    void add_row(const OutputView<dim> &view, const std::vector<ConditionBalance> &now);
    void add_columns(const ConditionBalance &now, const ConditionBalance &before);

    unsigned int steps_between;
    dealii::Tensor<1, dim> reference_point; ///< of moments [L]
    std::vector<ConditionBalance> last;     ///< at the last row
    std::vector<ConditionBalance> at_output;
    TimeTable table{"conditions.csv", TimeTable::Rows::in_file};
  };
} // namespace tombolo
