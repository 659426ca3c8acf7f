// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/coupling/bridge.h>

#include <tombolo/base/exceptions.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <string>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  void Bridge::sum_nodal_mass()
  {
    // m = W 1 (eqs 11, 48).
    const auto &partition = work.partition();
    const unsigned int n_owned = partition->n_owned();
    momentum_is_current = false;
    for (unsigned int i = 0; i < partition->n_local(); ++i)
      std::fill_n(work.node(i), node_stride, 1.);
    mass_by_component.set_zero();
    add_own_momentum(work, mass_by_component);
    for (const ParticlePart &part : parts)
      if (part.is_smoothed)
        NodalSmoothing::scatter(*part.shape, part.smoothed_mass.data(), work.data(),
                                mass_by_component.data());
    mass_by_component.add_to_owners();
    // Of nodes that erosion left without mass: there is no momentum to divide by it.
    for (unsigned int i = 0; i < n_owned; ++i)
      if (*total_mass.node(i) == 0.)
        std::fill_n(mass_by_component.node(i), node_stride, 1.);
    mass_by_component.update_ghosts();
  }

  bool Bridge::has_mass_above(const double share) const
  {
    const auto &partition = mass_by_component.partition();
    bool all_above = true;
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      for (unsigned int c = 0; c < node_stride; ++c)
        all_above = all_above && mass_by_component.node(i)[c] > share * *total_mass.node(i);
    return Utilities::MPI::min(all_above ? 1 : 0, partition->communicator()) == 1;
  }

  bool Bridge::remove_negative_values()
  {
    const auto &partition = mass_by_component.partition();
    NodalVector is_light;
    is_light.reinit(partition, 1);
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
    {
      const double *const mass = mass_by_component.node(i);
      if (!(*std::min_element(mass, mass + node_stride) >
            smallest_mass_share * *total_mass.node(i)))
        *is_light.node(i) = 1.;
    }
    is_light.update_ghosts();
    bool has_changed = false;
    for (ParticlePart &part : parts)
      for (unsigned int row = 0; part.is_smoothed && row < part.shape->n_particles(); ++row)
      {
        const Stencils::Row of_row = part.shape->row(row);
        bool takes_mass = false;
        for (unsigned int k = 0; k < of_row.size; ++k)
          takes_mass =
              takes_mass || (of_row.value[k] < 0. && *is_light.node(of_row.neighbour[k]) > 0.);
        if (!takes_mass)
          continue;
        part.shape->remove_negative_values(row);
        has_changed = true;
      }
    return Utilities::MPI::max(has_changed ? 1 : 0, partition->communicator()) == 1;
  }

  void Bridge::update_nodal_mass()
  {
    sum_nodal_mass();
    if (has_mass_above(smallest_mass_share))
      return;
    // A scaled row can leave too little to another node; each time there are fewer that can.
    while (has_started && settings.is_active && remove_negative_values())
    {
      rows_have_changed = true;
      sum_nodal_mass();
      if (has_mass_above(smallest_mass_share))
        return;
    }
    if (!has_mass_above(0.))
      throw RunError(
          std::string("The smoothed mass of a particle is not positive: its neighbours are too few "
                      "or too one-sided for the kernel. A larger dilation helps") +
          (trace && settings.affine ? "; with elements much heavier than the particles, the bridge "
                                      "`paper` or another smoothing than `affine`."
                                    : "."));
  }

  bool Bridge::take_change_of_rows()
  {
    return std::exchange(rows_have_changed, false);
  }
} // namespace tombolo
