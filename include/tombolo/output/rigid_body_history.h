// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/output/output.h>

#include <vector>

namespace tombolo
{
  /**
   * Where rigid parts are, how they move and what drives them: `rigid_bodies.csv`, with a row every
   * n steps of, for each of them, position and velocity of its reference point, rotation and spin,
   * momentum, angular momentum about the centre of mass, the mean force and the mean moment about
   * the reference point since the row before of what holds and drives the prescribed components,
   * the work of it and of given forces since the start, and kinetic energies. Rows are in the file
   * after each output. Part of every scene that has rigid parts.
   */
  template <int dim>
  class RigidBodyHistory : public Output<dim>
  {
  public:
    explicit RigidBodyHistory(const Section &section);

    static void declare_parameters(dealii::ParameterHandler &handler);

    void start(const OutputView<dim> &view, const OutputDirectory &directory,
               const UnitLabels &unit_labels) override;
    void after_step(const OutputView<dim> &view) override;
    void write(const OutputView<dim> &view, TimeTable &statistics) override;
    void serialize(StateArchive &archive) override;
    void finish(Json &results) override;

  private:
    void add_row(const OutputView<dim> &view, const std::vector<RigidBodyBalance> &now);

    unsigned int steps_between;
    double time_of_row = 0;             ///< until which impulses of the last row go
    std::vector<RigidBodyBalance> last; ///< of each body, at the last row
    TimeTable table{"rigid_bodies.csv", TimeTable::Rows::in_file};
  };
} // namespace tombolo
