// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/mpi.h>

#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/model.h>
#include <tombolo/state/records.h>
#include <tombolo/state/state_archive.h>

#include <functional>
#include <string>
#include <utility>

namespace tombolo
{
  /** Where nodes were the @p interval before, within the last motion [T]; without the smoothing of
   * its velocity. Collective. */
  inline NodalVector earlier_position(const NodalState &state, const double interval)
  {
    NodalVector result(state.partition());
    result.copy_from(state.unsmoothed_velocity);
    result.distribute();
    const auto n = std::size_t(state.partition()->n_local()) * node_stride;
    for (std::size_t i = 0; i < n; ++i)
      result.data()[i] = state.position.data()[i] - interval * result.data()[i];
    return result;
  }

  /**
   * For an energy that depends on the mesh, such as that of springs at points of faces. Where cells
   * are divided in the run, it changes by @p energy on the new mesh minus that
   * on the old one, at the positions in the middle of the last motion, up to which the forces of
   * the old mesh act. The account `refinement loss` receives the difference; without it the
   * difference is an error of the balance.
   *
   * @p share is what this rank has of the energy [M L^2/T^2], which @p records have already.
   * @p energy returns that at the positions, and receives the age of these [T]; on the new mesh it
   * is called before Process::model_changed(). Collective.
   */
  template <int dim>
  void follow_divisions(Records &records, const std::string &name, double &share,
                        const Model<dim> &model,
                        std::function<double(const NodalVector &position, double ago)> energy)
  {
    records.archived(
        [name, &share, &model, energy = std::move(energy)](auto &archive)
        {
          if (archive.division() == nullptr)
            return;
          const double ago = 0.5 * archive.division()->clock.previous_step;
          const double on_this_mesh =
              ordered_sum(energy(earlier_position(model.state, ago), ago), model.communicator);
          double on_old_mesh = on_this_mesh;
          archive(name, on_old_mesh);
          if (dealii::Utilities::MPI::this_mpi_process(model.communicator) == 0)
            share += on_this_mesh - on_old_mesh;
        });
  }
} // namespace tombolo
