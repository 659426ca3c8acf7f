// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/section_history.h>

#include <tombolo/base/input/declarations.h>
#include <tombolo/output/balance_rows.h>

#include <nlohmann/json.hpp>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void SectionHistory<dim>::declare_parameters(ParameterHandler &handler)
  {
    Declarations(handler).whole_number("Steps between rows", 10, 1,
                                       "sections.csv has a row every so many steps.");
  }

  template <int dim>
  SectionHistory<dim>::SectionHistory(const Section &section)
      : steps_between(section.get_unsigned("Steps between rows"))
  {}

  template <int dim>
  void SectionHistory<dim>::start(const OutputView<dim> &view, const OutputDirectory &directory,
                                  const UnitLabels &unit_labels)
  {
    const std::vector<SectionBalance> now = view.section_balances();
    if (!table.is_continued())
    {
      last = now;
      for (SectionBalance &balance : last)
        balance.time_of_impulse = view.time;
    }
    for (std::size_t k = 0; k < std::min(now.size(), at_output.size()); ++k)
      at_output[k].name = now[k].name;
    add_row(view, now);
    table.open(directory, unit_labels);
  }

  template <int dim>
  void SectionHistory<dim>::serialize(StateArchive &archive)
  {
    table.serialize(archive);
    serialize_last_row(archive, "times of row", &SectionBalance::time_of_impulse, "sections", last);
    serialize_at_output(archive, {}, at_output);
  }

  template <int dim>
  void SectionHistory<dim>::after_step(const OutputView<dim> &view)
  {
    if (!view.has_row(steps_between))
      return;
    const std::vector<SectionBalance> now = view.section_balances();
    add_row(view, now);
    table.write_row();
    last = now;
  }

  template <int dim>
  void SectionHistory<dim>::add_row(const OutputView<dim> &view,
                                    const std::vector<SectionBalance> &now)
  {
    table.begin_row(view.time, view.step);
    for (std::size_t k = 0; k < now.size(); ++k)
      add_impulse_columns<dim>(now[k], k < last.size() ? last[k] : now[k], table);
  }

  template <int dim>
  void SectionHistory<dim>::write(const OutputView<dim> &view, TimeTable & /*statistics*/)
  {
    at_output = view.section_balances();
    table.flush();
  }

  template <int dim>
  void SectionHistory<dim>::finish(Json &results)
  {
    table.flush();
    for (const SectionBalance &balance : at_output)
    {
      Json impulse = Json::array();
      for (unsigned int d = 0; d < dim; ++d)
        impulse.push_back(balance.impulse[d]);
      results["sections"][balance.name]["impulse"] = impulse;
    }
  }

  template class SectionHistory<2>;
  template class SectionHistory<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Output, SectionHistory, "section history",
      "Forces, moments and impulses through sections and interfaces of parts (sections.csv); in "
      "every scene that has `Sections`.")
} // namespace tombolo
