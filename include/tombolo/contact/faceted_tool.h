#pragma once

#include <deal.II/base/parameter_handler.h>

#include <tombolo/base/parameters.h>
#include <tombolo/contact/contact_surface.h>
#include <tombolo/contact/rigid_mesh.h>
#include <tombolo/contact/rigid_motion.h>

#include <string>

namespace tombolo
{
  /** A rigid tool whose surface stands in a file: triangles in three dimensions, a closed polygon
   * in two. It moves by a RigidMotion. The file has the tool's own coordinates, to which points are
   * taken, so that what finds the nearest facet never moves. */
  template <int dim>
  class FacetedTool : public ContactSurface<dim>
  {
  public:
    static void declare_parameters(dealii::ParameterHandler &handler);

    explicit FacetedTool(const Section &section);

    /** Throws InputError where the file cannot be read or bounds no body. */
    void load(MPI_Comm communicator) override;
    std::string description() const override;
    std::vector<std::string> remarks() const override;
    std::size_t memory_consumption() const override;

    void find_gaps(const NodalVector &position, const std::vector<unsigned int> &nodes, double time,
                   std::vector<double> &gap) const override;
    dealii::Tensor<1, dim> normal(const dealii::Tensor<1, dim> &point, double time) const override;
    dealii::Tensor<1, dim> motion(const dealii::Tensor<1, dim> &point, double from,
                                  double to) const override;
    dealii::Tensor<1, dim> reference_point(double time) const override;
    RigidTranslation<dim> &translation() override;

  private:
    FacetList<dim> read(MPI_Comm communicator) const;

    Section section;
    std::string file;
    double scale;
    double edge_radius;
    RigidMotion<dim> rigid_motion;
    RigidMesh<dim> body;
  };
} // namespace tombolo
