// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/simulation/rotation.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace
  {
    template <int dim>
    Tensor<1, 3> in_space(const double *const vector)
    {
      Tensor<1, 3> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = vector[d];
      return result;
    }
  } // namespace

  template <int dim>
  double speed_of_rim(const Model<dim> &model)
  {
    const MPI_Comm communicator = model.communicator;
    const NodalVector &positions = model.state.position,
                      &velocities = model.state.unsmoothed_velocity;
    const unsigned int n_nodes = model.state.partition()->n_owned();
    const auto mass = [&](const unsigned int i) { return *model.state.mass.node(i); };

    double total = 0;
    Tensor<1, 3> centre, mean;
    for (unsigned int i = 0; i < n_nodes; ++i)
    {
      total += mass(i);
      centre += mass(i) * in_space<dim>(positions.node(i));
      mean += mass(i) * in_space<dim>(velocities.node(i));
    }
    total = Utilities::MPI::sum(total, communicator);
    centre = Utilities::MPI::sum(centre, communicator) / total;
    mean = Utilities::MPI::sum(mean, communicator) / total;

    double energy = 0;
    Tensor<1, 3> momentum;
    for (unsigned int i = 0; i < n_nodes; ++i)
    {
      const Tensor<1, 3> velocity = in_space<dim>(velocities.node(i)) - mean;
      energy += 0.5 * mass(i) * velocity.norm_square();
      momentum += mass(i) * cross_product_3d(in_space<dim>(positions.node(i)) - centre, velocity);
    }
    energy = Utilities::MPI::sum(energy, communicator);
    momentum = Utilities::MPI::sum(momentum, communicator);
    if (!(momentum.norm() > 0.))
      return 0.;

    const Tensor<1, 3> axis = momentum / momentum.norm();
    double inertia = 0, radius = 0;
    for (unsigned int i = 0; i < n_nodes; ++i)
    {
      const double distance =
          cross_product_3d(axis, in_space<dim>(positions.node(i)) - centre).norm();
      inertia += mass(i) * distance * distance;
      radius = std::max(radius, distance);
    }
    inertia = Utilities::MPI::sum(inertia, communicator);
    radius = Utilities::MPI::max(radius, communicator);
    const bool spins = 0.5 * momentum.norm_square() / inertia > 0.5 * energy;
    return spins ? momentum.norm() / inertia * radius : 0.;
  }

  template double speed_of_rim(const Model<2> &);
  template double speed_of_rim(const Model<3> &);
} // namespace tombolo
