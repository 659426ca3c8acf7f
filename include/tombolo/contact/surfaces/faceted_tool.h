// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/contact/surfaces/rigid_mesh.h>
#include <tombolo/contact/surfaces/rigid_tool.h>

#include <string>

namespace tombolo
{
  /** A rigid tool whose surface stands in a file: triangles in three dimensions, a closed polygon
   * in two. The file has the tool's own coordinates, to which points are
   * taken, so that what finds the nearest facet never moves. */
  template <int dim>
  class FacetedTool : public RigidTool<dim>
  {
  public:
    explicit FacetedTool(const Entries &e);

    /** Throws InputError where the file cannot be read or bounds no body. */
    void load(MPI_Comm communicator) override;
    std::string description() const override;
    std::vector<std::string> remarks() const override;

    void evaluate_gaps(const NodalVector &position, const std::vector<unsigned int> &nodes,
                       double time, std::vector<double> &gap) const override;
    void set_reach(const double distance) override
    {
      body.set_reach(distance);
    }
    dealii::Tensor<1, dim> normal(const dealii::Tensor<1, dim> &point, double time) const override;
    FacetList<dim> picture(double time, const dealii::Tensor<1, dim> &low,
                           const dealii::Tensor<1, dim> &high) const override;

  private:
    FacetList<dim> read(MPI_Comm communicator) const;

    Section section;
    std::string file;
    double scale;
    double edge_radius;
    RigidMesh<dim> body;
  };
} // namespace tombolo
