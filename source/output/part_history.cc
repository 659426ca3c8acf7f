// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/history.h>

#include <tombolo/base/ordered_sum.h>

#include <array>

namespace tombolo
{
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
        const double part_mass = *mass.node(node);
        if (part_mass == 0.)
          continue;
        sums[0] += part_mass;
        // With lumped rows v̂ has other masses than the cells, together as much.
        const double m = part_mass * view.unsmoothed_share(node);
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

  /**
   * Energies of the parts: `parts.csv`, with the mass, momentum and kinetic energy of each part,
   * and all the energies that its formulation accounts for. On request, by `Further outputs`.
   *
   * Momentum and kinetic energy are Σ m v̂ and Σ ½ m v̂² at t_{n-1/2} with the part's own mass at
   * its nodes, unscaled: a node that two parts share counts in both with the share that each has of
   * it.
   */
  template <int dim>
  class PartHistory : public History<dim>
  {
  public:
    explicit PartHistory(const Entries &e) : History<dim>(e, "parts.csv") {}

    /** Throws InputError in scenes of heat alone. */
    void check(const OutputView<dim> &view) override
    {
      if (!view.has_mechanics)
        this->section.parent().fail("Further outputs",
                                    "the scene has no mechanics, so that its parts "
                                    "have no energies: remove \"part history\".");
      History<dim>::check(view);
    }

  private:
    void add_columns(const OutputView<dim> &view) override
    {
      const std::string energy = "M L^2/T^2";
      for (const OutputPart<dim> &part : view.parts)
      {
        const std::array<double, 5> motion = motion_of(view, part);
        this->table.add(part.name + " mass", "M", motion[0]);
        this->add_vector(part.name + " momentum", "M L/T", {{motion[1], motion[2], motion[3]}});
        this->table.add(part.name + " kinetic energy", energy, motion[4]);
        EnergyAccounts energies = part.formulation->energies();
        energies.sum_over_ranks(view.state->partition()->communicator());
        for (const EnergyAccounts::Account &account : energies.accounts())
          this->table.add(part.name + " " + account.name, energy, account.value);
      }
    }
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Output, PartHistory, "part history",
                                  "Mass, momentum and energies of each part (parts.csv).")
} // namespace tombolo
