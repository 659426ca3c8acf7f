// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/model/model.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  bool Model<dim>::erodes() const
  {
    return std::any_of(parts.begin(), parts.end(),
                       [](const Part<dim> &part) { return part.eroding != nullptr; });
  }

  template <int dim>
  unsigned long Model<dim>::n_removed_cells() const
  {
    unsigned long count = 0;
    for (const Part<dim> &part : parts)
      if (part.eroding != nullptr)
        count += part.eroding->n_removed_cells();
    return Utilities::MPI::sum(count, communicator);
  }

  template <int dim>
  void Model<dim>::remove_faces_of_removed_cells()
  {
    std::vector<std::vector<types::global_dof_index>> cells;
    for (const Part<dim> &part : parts)
      if (part.eroding != nullptr)
        part.eroding->add_nodes_of_removed_cells(cells);
    conditions->remove_faces(cells);
    conditions->set_partition(*partition);
    if (heat)
      heat->conditions.remove_faces(cells); // their partition is set with the masses
  }

  template <int dim>
  void Model<dim>::find_massless_nodes()
  {
    massless_nodes.clear();
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
      if (*state.mass.node(i) == 0.)
        massless_nodes.push_back(i);
  }

  template <int dim>
  bool Model<dim>::find_failed_cells()
  {
    unsigned int n_failed = 0;
    for (const Part<dim> &part : parts)
      if (part.eroding != nullptr)
        n_failed += part.eroding->find_failed_cells(state.position);
    if (Utilities::MPI::sum(n_failed, communicator) == 0)
      return false;
    bridge->smooth_velocity(state);
    return true;
  }

  template <int dim>
  void Model<dim>::remove_failed_cells(const Clock &clock, ErosionLoss &loss)
  {
    const NodalVector &element_velocity = bridge->element_velocity(state.velocity);
    double pending_heat = 0;
    for (const Part<dim> &part : parts)
    {
      if (part.eroding == nullptr)
        continue;
      const RemovedCells removed =
          part.eroding->remove_failed_cells(state.position, element_velocity, clock.previous_step);
      loss.n_cells += removed.n_cells;
      loss.energy += removed.energy;
      pending_heat += removed.pending_heat;
    }

    NodalVector old_mass;
    old_mass.reinit(partition, 1);
    old_mass.copy_from(state.mass);
    NodalVector old_true_mass;
    if (scaling)
    {
      old_true_mass.reinit(partition, 1);
      old_true_mass.copy_from(true_mass);
    }
    remove_faces_of_removed_cells();
    set_masses();
    for (const Part<dim> &part : parts)
      if (part.particles != nullptr)
        part.particles->forget_fragments();

    std::vector<unsigned int> lighter;
    for (unsigned int i = 0; i < partition->n_owned(); ++i)
    {
      const double mass = *old_mass.node(i) - *state.mass.node(i);
      if (mass == 0.)
        continue;
      lighter.push_back(i);
      loss.mass += scaling ? *old_true_mass.node(i) - *true_mass.node(i) : mass;
      const double *const x = state.position.node(i);
      double *const v = state.unsmoothed_velocity.node(i);
      for (unsigned int d = 0; d < 3; ++d)
      {
        const unsigned int e = (d + 1) % 3, f = (d + 2) % 3;
        loss.momentum[d] += mass * v[d];
        loss.angular_momentum[d] += mass * (x[e] * v[f] - x[f] * v[e]);
        loss.energy += 0.5 * mass * v[d] * v[d];
      }
      if (*state.mass.node(i) > 0.)
        continue;
      // Stays where it is for the rest of the run.
      for (NodalVector *vector : {&state.unsmoothed_velocity, &state.velocity, &state.acceleration})
        std::fill_n(vector->node(i), node_stride, 0.);
    }
    state.unsmoothed_velocity.update_ghosts();
    if (heat)
      heat->lose_heat(lighter, pending_heat);
    has_eroded = true;
  }

  template bool Model<2>::erodes() const;
  template bool Model<3>::erodes() const;
  template unsigned long Model<2>::n_removed_cells() const;
  template unsigned long Model<3>::n_removed_cells() const;
  template void Model<2>::remove_faces_of_removed_cells();
  template void Model<3>::remove_faces_of_removed_cells();
  template void Model<2>::find_massless_nodes();
  template void Model<3>::find_massless_nodes();
  template bool Model<2>::find_failed_cells();
  template bool Model<3>::find_failed_cells();
  template void Model<2>::remove_failed_cells(const Clock &, ErosionLoss &);
  template void Model<3>::remove_failed_cells(const Clock &, ErosionLoss &);
} // namespace tombolo
