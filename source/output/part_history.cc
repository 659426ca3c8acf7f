// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/part_history.h>

#include <tombolo/base/input/declarations.h>
#include <tombolo/base/ordered_sum.h>

#include <array>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** Mass, momentum and kinetic energy of a part. Collective. */
    template <int dim>
    std::array<double, 5> motion_of(const OutputView<dim> &view, const OutputPart<dim> &part)
    {
      const NodePartition &partition = *view.state->partition();
      const NodalVector mass = part.nodal_mass();
      std::array<double, 5> sums{};
      for (unsigned int node = 0; node < partition.n_owned(); ++node)
      {
        const double of_part = *mass.node(node);
        if (of_part == 0.)
          continue;
        sums[0] += of_part;
        // With lumped rows v̂ has other masses than the cells, together as much.
        const double m = of_part * view.unsmoothed_share(node);
        const double *const v = view.state->unsmoothed_velocity.node(node);
        for (unsigned int d = 0; d < 3; ++d)
        {
          sums[1 + d] += m * v[d];
          sums[4] += 0.5 * m * v[d] * v[d];
        }
      }
      return ordered_sum(sums, partition.communicator());
    }
  } // namespace

  template <int dim>
  void PartHistory<dim>::declare_parameters(ParameterHandler &handler)
  {
    Declarations(handler).whole_number("Steps between rows", 10, 1,
                                       "parts.csv has a row every so many steps.");
  }

  template <int dim>
  PartHistory<dim>::PartHistory(const Section &section)
      : section(section), steps_between(section.get_unsigned("Steps between rows"))
  {}

  template <int dim>
  void PartHistory<dim>::check(const OutputView<dim> &view)
  {
    if (!view.has_mechanics)
      section.parent().fail("Further outputs", "the scene has no mechanics, so that its parts have "
                                               "no energies: remove \"part history\".");
  }

  template <int dim>
  void PartHistory<dim>::start(const OutputView<dim> &view, const OutputDirectory &directory,
                               const UnitLabels &unit_labels)
  {
    add_row(view);
    table.open(directory, unit_labels);
  }

  template <int dim>
  void PartHistory<dim>::serialize(StateArchive &archive)
  {
    table.serialize(archive);
  }

  template <int dim>
  void PartHistory<dim>::after_step(const OutputView<dim> &view)
  {
    if (!view.has_row(steps_between))
      return;
    add_row(view);
    table.write_row();
  }

  template <int dim>
  void PartHistory<dim>::add_row(const OutputView<dim> &view)
  {
    const std::string energy = "M L^2/T^2";
    table.begin_row(view.time, view.step);
    for (const OutputPart<dim> &part : view.parts)
    {
      const std::array<double, 5> motion = motion_of(view, part);
      table.add(part.name + " mass", "M", motion[0]);
      for (unsigned int d = 0; d < dim; ++d)
        table.add(part.name + " momentum " + "xyz"[d], "M L/T", motion[1 + d]);
      table.add(part.name + " kinetic energy", energy, motion[4]);
      EnergyAccounts energies = part.formulation->energies();
      energies.sum_over_ranks(view.state->partition()->communicator());
      for (const EnergyAccounts::Account &account : energies.accounts())
        table.add(part.name + " " + account.name, energy, account.value);
    }
  }

  template <int dim>
  void PartHistory<dim>::write(const OutputView<dim> & /*view*/, TimeTable & /*statistics*/)
  {
    table.flush();
  }

  template <int dim>
  void PartHistory<dim>::finish(Json & /*results*/)
  {
    table.flush();
  }

  template class PartHistory<2>;
  template class PartHistory<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Output, PartHistory, "part history",
                                  "Mass, momentum and energies of each part (parts.csv).")
} // namespace tombolo
