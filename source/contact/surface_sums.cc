// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/surface_sums.h>

#include <tombolo/base/ordered_sum.h>

#include <deal.II/base/mpi.h>

#include <algorithm>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  ContactBalance SurfaceSums<dim>::balance(const ContactBalance &shares,
                                           const RigidTranslation<dim> &translation,
                                           const MPI_Comm communicator) const
  {
    std::vector<double> sums = {shares.elastic,           shares.friction,  shares.damping,   work,
                                shares.n_nodes,           translation_work, shares.conducted, area,
                                shares.friction_of_bodies};
    const std::size_t first_vector = sums.size();
    for (unsigned int d = 0; d < dim; ++d)
    {
      sums.push_back(force[d]);
      sums.push_back(impulse[d]);
    }
    for (unsigned int c = 0; c < 3; ++c)
      sums.push_back(angular_impulse[c]);
    sums = ordered_sum(sums, communicator);
    ContactBalance result;
    result.elastic = sums[0];
    result.friction = sums[1];
    result.damping = sums[2];
    result.work = sums[3];
    result.n_nodes = sums[4];
    result.conducted = sums[6];
    result.area = sums[7];
    result.friction_of_bodies = sums[8];
    for (unsigned int d = 0; d < dim; ++d)
    {
      result.force[d] = sums[first_vector + 2 * d];
      result.impulse[d] = sums[first_vector + 1 + 2 * d];
    }
    std::copy_n(sums.end() - 3, 3, result.angular_impulse.begin());
    result.penetration = Utilities::MPI::max(shares.penetration, communicator);

    result.external_work =
        translation.has_mass() ? result.work - sums[5] + translation.work_of_force() : result.work;
    result.tool_kinetic = translation.kinetic_energy();
    for (unsigned int d = 0; d < dim; ++d)
    {
      result.position[d] = position[d];
      if (translation.has_mass())
      {
        result.velocity[d] = translation.velocity()[d];
        result.tool_momentum[d] = translation.mass() * result.velocity[d];
      }
    }
    return result;
  }

  template struct SurfaceSums<2>;
  template struct SurfaceSums<3>;
} // namespace tombolo
