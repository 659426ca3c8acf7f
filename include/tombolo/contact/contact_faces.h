// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/tensor.h>
#include <deal.II/base/types.h>

#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_vector.h>

#include <array>
#include <functional>
#include <memory>
#include <mpi.h>
#include <vector>

namespace tombolo
{
  /** Corners of a face of a cell of degree 1, in lexicographic order. */
  template <int dim>
  using FaceCorners = std::array<dealii::Tensor<1, dim>, (1u << (dim - 1))>;

  /** The area of a face with its direction, ∫ n dA [L^(dim-1)]: that of the product of the
   * tangents, as FaceShapes::normal() has it. */
  template <int dim>
  dealii::Tensor<1, dim> area_vector(const FaceCorners<dim> &face)
  {
    if constexpr (dim == 2)
      return dealii::cross_product_2d(face[1] - face[0]);
    else
      return 0.5 * dealii::cross_product_3d(face[3] - face[0], face[2] - face[1]);
  }

  /**
   * The faces of one side of a contact between bodies: outer faces (Nodes::is_outer_face) of cells
   * of degree 1, and those below cells that are gone, each on the rank that owns its cell. Nodes
   * are numbered locally.
   */
  template <int dim>
  class ContactFaces
  {
  public:
    static constexpr unsigned int n_corners = 1u << (dim - 1);
    using Cell = typename Nodes<dim>::Cell;

    struct Face
    {
      std::array<dealii::types::global_dof_index, n_corners> global_nodes;
      std::array<unsigned int, n_corners> nodes; ///< local
      double orientation;                        ///< 1 where area_vector() is out of the body
      double thickness;                          ///< initial volume of the cell over the area [L]
    };

    using Selector = std::function<bool(const Cell &, unsigned int face)>;
    using IsGone = std::function<bool(const Cell &)>; ///< of owned and ghost cells

    /** Takes the faces that @p selects. */
    ContactFaces(const Nodes<dim> &nodes, const Selector &selects, const IsGone &is_gone = {});

    /** Translates node numbers to those of @p partition. Collective. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition);

    const std::vector<Face> &faces() const
    {
      return all;
    }

    /** The owned nodes on faces of any rank, ascending. */
    const std::vector<unsigned int> &owned_nodes() const
    {
      return owned;
    }

    FaceCorners<dim> corners(const Face &face, const NodalVector &position) const
    {
      FaceCorners<dim> result;
      for (unsigned int k = 0; k < n_corners; ++k)
        for (unsigned int d = 0; d < dim; ++d)
          result[k][d] = position.node(face.nodes[k])[d];
      return result;
    }

    /** Finds what the faces have at each owned node [L^(dim-1)] in these positions (ghosts
     * current): the norm of the sums of ∫ N |n_d| dA over d, with n_d of one sign. It is at least
     * the area of the faces that a contact can press at the same time. Collective. */
    void find_areas(const NodalVector &position, std::vector<double> &area);

  private:
    std::vector<Face> all;
    std::vector<unsigned int> owned;
    NodalVector positive, negative; // buffers of find_areas()
  };

  /**
   * The pairs of a slave face of this rank and a master face of any rank that can touch, and the
   * exchange between their ranks. Candidates are found by boxes: ranks receive the master faces in
   * the box around their slave faces, sort them into a tree of boxes, and keep those that are in
   * the inflated box of one of their faces. Until nodes have moved by half of the margin the pairs
   * stay, and a step exchanges values at the corners of these faces alone. Every rank takes part in
   * every exchange, also one without faces.
   */
  template <int dim>
  class FaceExchange
  {
  public:
    static constexpr unsigned int n_corners = ContactFaces<dim>::n_corners;

    /** A pair of faces: local number of the slave face, index of the master face among masters().
     */
    struct Pair
    {
      unsigned int slave, master;
    };

    /** What this rank knows of a master face beside the values of its corners. */
    struct Master
    {
      std::array<dealii::types::global_dof_index, n_corners> nodes; ///< global numbers
      double orientation, thickness;
    };

    explicit FaceExchange(MPI_Comm communicator);

    /** Finds the pairs whose boxes are closer than @p reach times the thickness of the slave face
     * and
     * @p margin [L], in these positions (ghosts current). Faces with a common node are no pair.
     * Collective. */
    void find_pairs(const ContactFaces<dim> &slaves, const ContactFaces<dim> &masters,
                    const NodalVector &position, double reach, double margin);

    /** By slave face, then by rank and number of the master face. */
    const std::vector<Pair> &pairs() const
    {
      return found;
    }

    const std::vector<Master> &masters() const
    {
      return received;
    }

    /** The master faces of this rank that others read, with repetitions: local numbers. */
    const std::vector<unsigned int> &sent_faces() const
    {
      return sent;
    }

    /** Takes @p n_values for each of sent_faces() to those of masters(). Collective. */
    void send(unsigned int n_values, const std::vector<double> &at_sent,
              std::vector<double> &at_masters) const;

    /** Takes @p n_values for each of masters() back to sent_faces(). Collective. */
    void send_back(unsigned int n_values, const std::vector<double> &at_masters,
                   std::vector<double> &at_sent) const;

  private:
    void select_sent_faces(const ContactFaces<dim> &slaves, const ContactFaces<dim> &masters,
                           const NodalVector &position, double reach, double margin);
    void receive_masters(const ContactFaces<dim> &masters);
    /** Drops what no pair needs, on both sides. */
    void drop_unused();

    MPI_Comm communicator;
    std::vector<int> n_sent, n_received; ///< faces to and from each rank
    std::vector<unsigned int> sent;
    std::vector<Master> received;
    std::vector<Pair> found;
  };
} // namespace tombolo
