// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/condition_history.h>

#include <tombolo/base/input/declarations.h>
#include <tombolo/base/moment.h>
#include <tombolo/contact/read_vector.h>
#include <tombolo/output/balance_rows.h>

#include <nlohmann/json.hpp>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    constexpr const char *axis_names[3] = {"x", "y", "z"};
  }

  template <int dim>
  void ConditionHistory<dim>::declare_parameters(ParameterHandler &handler)
  {
    Declarations section(handler);
    section.whole_number("Steps between rows", 10, 1,
                         "conditions.csv has a row every so many steps.");
    section.numbers("Moments about", dim == 2 ? "0, 0" : "0, 0, 0", dim, "L",
                    "The point that moments in conditions.csv are about; it does not move.");
  }

  template <int dim>
  ConditionHistory<dim>::ConditionHistory(const Section &section)
      : steps_between(section.get_unsigned("Steps between rows")),
        reference_point(read_vector<dim>(section, "Moments about"))
  {}

  template <int dim>
  std::vector<ConditionBalance> ConditionHistory<dim>::balances(const OutputView<dim> &view) const
  {
    std::vector<ConditionBalance> result;
    for (const auto &of_kind : view.condition_balances)
    {
      const std::vector<ConditionBalance> balances = of_kind();
      result.insert(result.end(), balances.begin(), balances.end());
    }
    double from_point[3] = {0, 0, 0};
    for (unsigned int d = 0; d < dim; ++d)
      from_point[d] = -reference_point[d];
    for (ConditionBalance &balance : result)
      add_moment(from_point, balance.impulse.data(), balance.angular_impulse);
    return result;
  }

  template <int dim>
  void ConditionHistory<dim>::start(const OutputView<dim> &view, const OutputDirectory &directory,
                                    const UnitLabels &unit_labels)
  {
    const std::vector<ConditionBalance> now = balances(view);
    if (!table.is_continued())
    {
      last = now;
      for (ConditionBalance &balance : last)
        balance.time_of_impulse = view.time;
    }
    for (std::size_t k = 0; k < std::min(now.size(), at_output.size()); ++k)
      at_output[k].name = now[k].name;
    add_row(view, now);
    table.open(directory, unit_labels);
  }

  template <int dim>
  void ConditionHistory<dim>::serialize(StateArchive &archive)
  {
    table.serialize(archive);
    serialize_last_row(archive, "times of row", &ConditionBalance::time_of_impulse, "conditions",
                       last);
    serialize_at_output(archive, {&ConditionBalance::work}, at_output);
  }

  template <int dim>
  void ConditionHistory<dim>::after_step(const OutputView<dim> &view)
  {
    if (!view.has_row(steps_between))
      return;
    const std::vector<ConditionBalance> now = balances(view);
    add_row(view, now);
    table.write_row();
    last = now;
  }

  template <int dim>
  void ConditionHistory<dim>::add_row(const OutputView<dim> &view,
                                      const std::vector<ConditionBalance> &now)
  {
    table.begin_row(view.time, view.step);
    for (std::size_t k = 0; k < now.size(); ++k)
      add_columns(now[k], k < last.size() ? last[k] : now[k]);
  }

  template <int dim>
  void ConditionHistory<dim>::add_columns(const ConditionBalance &now,
                                          const ConditionBalance &before)
  {
    add_impulse_columns<dim>(now, before, table);
    const auto add = [&](const std::string &what, const std::string &unit, const double value)
    { table.add(now.name + " " + what, unit, value); };
    add("work", "M L^2/T^2", now.work);
    if (!now.prescribes_motion)
      return;
    for (unsigned int d = 0; d < dim; ++d)
      add(std::string("mean displacement ") + axis_names[d], "L", now.displacement[d]);
  }

  template <int dim>
  void ConditionHistory<dim>::write(const OutputView<dim> &view, TimeTable & /*statistics*/)
  {
    at_output = balances(view);
    table.flush();
  }

  template <int dim>
  void ConditionHistory<dim>::finish(Json &results)
  {
    table.flush();
    for (const ConditionBalance &balance : at_output)
    {
      Json impulse = Json::array();
      for (unsigned int d = 0; d < dim; ++d)
        impulse.push_back(balance.impulse[d]);
      results["conditions"][balance.name]["impulse"] = impulse;
      results["conditions"][balance.name]["work"] = balance.work;
    }
  }

  template class ConditionHistory<2>;
  template class ConditionHistory<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(
      Output, ConditionHistory, "condition history",
      "Forces, moments, impulses and works of mechanical conditions, displacements of those that "
      "prescribe motion (conditions.csv); in every scene that has such.")
} // namespace tombolo
