// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/local_shortening.h>

#include <tombolo/approximation/row_deformation.h>
#include <tombolo/model/model.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <limits>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    /** Supports stay as they are where a particle loses neighbours; its gradients grow. */
    template <int dim>
    std::vector<double> times_of_rows(const Part<dim> &part, const NodalVector &position)
    {
      const Stencils &shape = part.particles->stencils();
      std::vector<double> result(shape.n_particles(), std::numeric_limits<double>::max());
      for (unsigned int i = 0; i < shape.n_particles(); ++i)
        if (!shape.is_undeformed(i))
          result[i] = 1. / (present_gradient<dim>(shape, i, position) *
                            part.material->longitudinal_wave_speed());
      return result;
    }

    template <int dim>
    std::vector<std::vector<double>> times_of(const Model<dim> &model)
    {
      std::vector<std::vector<double>> result(model.parts.size());
      for (std::size_t p = 0; p < result.size(); ++p)
        if (model.parts[p].particles != nullptr && model.stencils_change_for_good)
          result[p] = times_of_rows(model.parts[p], model.state.position);
        else
          model.parts[p].formulation->courant_limits(model.state.position, result[p]);
      return result;
    }
  } // namespace

  template <int dim>
  void LocalShortening<dim>::remember(const Model<dim> &model)
  {
    times = times_of(model);
  }

  template <int dim>
  bool LocalShortening<dim>::exceeds(const Model<dim> &model, const double fraction) const
  {
    const std::vector<std::vector<double>> present = times_of(model);
    double smallest = std::numeric_limits<double>::max();
    for (const std::vector<double> &of_part : present)
      for (const double time : of_part)
        smallest = std::min(smallest, time);
    smallest = Utilities::MPI::min(smallest, model.communicator);
    // What changed on one rank alone counts for all, so that their number changes nothing.
    std::vector<int> is_comparable(present.size(), 0);
    for (std::size_t p = 0; p < std::min(times.size(), present.size()); ++p)
      is_comparable[p] = times[p].size() == present[p].size() ? 1 : 0;
    Utilities::MPI::min(is_comparable, model.communicator, is_comparable);
    int result = 0;
    for (std::size_t p = 0; p < present.size(); ++p)
      for (std::size_t i = 0; is_comparable[p] == 1 && i < present[p].size(); ++i)
        if (present[p][i] < 2. * smallest && present[p][i] < (1. - fraction) * times[p][i])
          result = 1;
    return Utilities::MPI::max(result, model.communicator) == 1;
  }

  template <int dim>
  void LocalShortening<dim>::serialize(StateArchive &archive, const Model<dim> &model)
  {
    bool is_kept = !times.empty();
    archive("has lengths at estimate", is_kept);
    if (!is_kept)
      return;
    times.resize(model.parts.size());
    for (unsigned int p = 0; p < model.parts.size(); ++p)
    {
      const auto group = archive.group("lengths of part " + model.parts[p].name);
      const std::vector<std::uint64_t> ids = model.persistent_ids_of_points(p);
      // Cells that have come since are not known, as little as in the run that goes on.
      bool is_complete =
          Utilities::MPI::min(times[p].size() == ids.size() ? 1 : 0, model.communicator) == 1;
      archive("is complete", is_complete);
      if (!is_complete)
        continue;
      archive.set_rows(ids);
      archive.rows("length over wave speed", 1, times[p]);
    }
  }

  template class LocalShortening<2>;
  template class LocalShortening<3>;
} // namespace tombolo
