// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/planes_of_bodies.h>

#include <tombolo/base/on_ranks.h>

#include <array>
#include <vector>

namespace tombolo
{
  template <int dim>
  PlanesOfBodies::PlanesOfBodies(const Bodies<dim> &bodies, const Images &images,
                                 const MPI_Comm communicator)
  {
    if (images.empty())
      return;
    std::map<types::global_dof_index, unsigned int> of_rank;
    for (unsigned int m = 0; m < images.all.size(); ++m)
      for (const types::global_dof_index node : images.all[m].own_images)
        of_rank[bodies.body_of(node)] |= 1u << m;
    std::vector<std::array<types::global_dof_index, 2>> sent;
    for (const auto &[body, mirrors] : of_rank)
      sent.push_back({{body, mirrors}});
    for (const auto &[body, mirrors] : of_all_ranks(sent, communicator))
      mirrors_of_body[body] |= static_cast<unsigned int>(mirrors);
  }

  template PlanesOfBodies::PlanesOfBodies(const Bodies<2> &, const Images &, MPI_Comm);
  template PlanesOfBodies::PlanesOfBodies(const Bodies<3> &, const Images &, MPI_Comm);
} // namespace tombolo
