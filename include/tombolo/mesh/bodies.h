// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/mesh/images.h>
#include <tombolo/mesh/nodes.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/types.h>
#include <deal.II/lac/la_parallel_vector.h>

#include <map>

namespace tombolo
{
  /**
   * The bodies of a mesh: sets of cells that common nodes join, whatever their parts are. Known for
   * the relevant nodes of this rank.
   */
  template <int dim>
  class Bodies
  {
  public:
    /** Collective. */
    explicit Bodies(const Nodes<dim> &nodes);

    /** Over all ranks. */
    unsigned int n_bodies() const
    {
      return count;
    }

    /** The body of a relevant node (global number), by the smallest number of its nodes. */
    dealii::types::global_dof_index body_of(const dealii::types::global_dof_index node) const
    {
      return static_cast<dealii::types::global_dof_index>(smallest[node]);
    }

  private:
    dealii::LinearAlgebra::distributed::Vector<double> smallest; // node of the body
    unsigned int count;
  };

  /** Which bodies of a mesh have nodes on which planes of symmetry. There a body is one with its
   * image; the image of a body that stays off a plane is another body. Known for all bodies. */
  class PlanesOfBodies
  {
  public:
    /** Of a body without planes. */
    PlanesOfBodies() = default;

    /** Collective. */
    template <int dim>
    PlanesOfBodies(const Bodies<dim> &bodies, const Images &images, MPI_Comm communicator);

    /** Whether a body is one with its image in these @p mirrors, as bits; 0: it is that itself. */
    bool joins(const dealii::types::global_dof_index body, const unsigned int mirrors) const
    {
      if (mirrors == 0)
        return true;
      const auto found = mirrors_of_body.find(body);
      return found != mirrors_of_body.end() && (mirrors & ~found->second) == 0;
    }

  private:
    std::map<dealii::types::global_dof_index, unsigned int> mirrors_of_body; // as bits
  };

  extern template class Bodies<2>;
  extern template class Bodies<3>;
} // namespace tombolo
