#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <tombolo/base/parameters.h>
#include <tombolo/mesh/mesh_source.h>

#include <array>
#include <string>
#include <vector>

namespace tombolo
{
  /** A stretch of an axis that is divided into equal cells. */
  struct BoxSegment
  {
    unsigned int n_cells = 0;
    double begin = 0;
    double end = 0;
  };

  /**
   * A box of hexahedra (quadrilaterals), each axis divided into one or several segments of equal
   * cells. The mesh is refined from the coarsest box whose cells the counts allow: if all counts
   * are multiples of 2^k, k times. Boundaries are called "x min", "x max", "y min", and so on.
   * With disorder, nodes are displaced at random, by numbers that depend on the place in the
   * lattice only, and the mesh is not refined, since only coarse vertices keep their places when
   * cells move between ranks.
   */
  template <int dim>
  class Box : public MeshSource<dim>
  {
  public:
    static void declare_parameters(dealii::ParameterHandler &handler);

    /** Throws InputError where an entry makes no box. */
    explicit Box(const Section &section);

    void create(Mesh<dim> &mesh) const override;

    /** How often the coarse box is refined. */
    unsigned int n_refinements() const;

  private:
    /** Parses one axis of `Cells`, for example "25 to 5 | 75 to 10". */
    std::vector<BoxSegment> parse_axis(const std::string &text, unsigned int axis, double begin,
                                       double end) const;
    void check_counts() const;
    void read_disorder();
    void read_rotation();

    /** The coordinates of the coarse vertices along each axis. */
    std::array<std::vector<double>, dim> coarse_coordinates() const;

    /** Displaces the vertices, lexicographic on the lattice of these coordinates. */
    void displace(const std::array<std::vector<double>, dim> &coordinates,
                  std::vector<dealii::Point<dim>> &vertices) const;

    Section section;
    std::array<std::vector<BoxSegment>, dim> segments;
    unsigned int refinements = 0;
    double disorder = 0;
    unsigned int seed = 0;
    bool surface_nodes_slide = false;
    dealii::Tensor<2, dim> rotation;
  };
} // namespace tombolo
