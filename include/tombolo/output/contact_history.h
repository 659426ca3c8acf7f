// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/output/output.h>

#include <string>
#include <vector>

namespace tombolo
{
  /**
   * What surfaces and bodies do to each other: `contact.csv`, with a row every n steps of, for each
   * contact, the mean force on the bodies since the row before, the impulse since the start, the
   * mean torque about the surface's reference point since the row before, heat, stored energy, the
   * work of the surface's motion and its mean power since the row before, nodes in contact,
   * penetration, the position of the reference point; the velocity of a surface with a mass; in
   * scenes with heat what bodies and tool have got of it, conducted heat and the temperature of the
   * tool where there are, mean and largest temperature of the nodes in contact. Of a contact
   * between bodies the force is that on the slave, conducted heat is what has entered the slave,
   * and there is no surface. Rows are in the file after each output. Part of every scene that has
   * contacts.
   */
  template <int dim>
  class ContactHistory : public Output<dim>
  {
  public:
    explicit ContactHistory(const Section &section);

    static void declare_parameters(dealii::ParameterHandler &handler);

    void start(const OutputView<dim> &view, const OutputDirectory &directory,
               const UnitLabels &unit_labels) override;
    void after_step(const OutputView<dim> &view) override;
    void write(const OutputView<dim> &view, TimeTable &statistics) override;
    void serialize(StateArchive &archive) override;
    void finish(Json &results) override;

  private:
    /** Adds a row for the present state; @p now are the balances of contacts. */
    void add_row(const OutputView<dim> &view, const std::vector<ContactBalance> &now);
    void add_columns(const SurfaceContact<dim> &contact, const ContactBalance &now,
                     const ContactBalance &before, double elapsed, double elapsed_of_work);
    void add_columns(const MortarContact<dim> &contact, const ContactBalance &now,
                     const ContactBalance &before, double elapsed);
    void add_temperatures(const std::string &of, const std::array<double, 2> &mean_and_largest);

    unsigned int steps_between;
    double time_of_row = 0;  ///< until which impulses of the last row go
    double time_of_work = 0; ///< until which its works go
    std::vector<std::string> names;
    std::vector<ContactBalance> last;        ///< of each contact, at the last row
    std::vector<ContactBalance> at_output;   ///< of each contact, at the last output
    std::vector<double> largest_penetration; ///< of each contact, over the rows
    TimeTable table{"contact.csv", TimeTable::Rows::in_file};
  };
} // namespace tombolo
