// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/on_ranks.h>
#include <tombolo/contact/surfaces/facet_list.h>
#include <tombolo/mesh/extent.h>
#include <tombolo/mesh/nodes.h>
#include <tombolo/state/nodal_vector.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/tensor.h>
#include <deal.II/base/types.h>
#include <deal.II/numerics/rtree.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <mpi.h>
#include <numeric>
#include <utility>
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

  /** The box around the corners of a face, @p by wider on all sides. */
  template <int dim>
  dealii::BoundingBox<dim> box_around(const FaceCorners<dim> &corners, const double by)
  {
    dealii::Tensor<1, dim> low = corners[0], high = low;
    for (const auto &corner : corners)
      widen_box(low, high, corner);
    dealii::BoundingBox<dim> result({dealii::Point<dim>(low), dealii::Point<dim>(high)});
    result.extend(by);
    return result;
  }

  template <int dim>
  bool have_common_points(const dealii::BoundingBox<dim> &one,
                          const dealii::BoundingBox<dim> &other)
  {
    // A bound by itself is a call of the library.
    const auto &[low, high] = one.get_boundary_points();
    const auto &[other_low, other_high] = other.get_boundary_points();
    for (unsigned int d = 0; d < dim; ++d)
      if (low[d] > other_high[d] || other_low[d] > high[d])
        return false;
    return true;
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

    ContactFaces(const Nodes<dim> &nodes, const Selector &selects, const IsGone &is_gone = {})
    {
      const auto is_exposed = [&](const Cell &cell, const unsigned int f)
      {
        return is_gone && !cell->at_boundary(f) && cell->neighbor(f)->is_active() &&
               is_gone(cell->neighbor(f));
      };
      const auto is_of_side = [&](const Cell &cell, const unsigned int f)
      {
        return !(is_gone && is_gone(cell)) &&
               (nodes.is_outer_face(cell, f) || is_exposed(cell, f)) && selects(cell, f);
      };
      const auto add = [&](const Cell &cell, const unsigned int f, const auto &face_nodes,
                           const auto &face_points)
      {
        Face face;
        FaceCorners<dim> corners;
        std::copy_n(face_nodes.begin(), n_corners, face.global_nodes.begin());
        std::copy_n(face_points.begin(), n_corners, corners.begin());
        const dealii::Tensor<1, dim> area = area_vector<dim>(corners);
        face.orientation = area * (cell->face(f)->center() - cell->center()) > 0. ? 1. : -1.;
        face.thickness = cell->measure() / area.norm();
        all.push_back(face);
      };
      nodes.for_each_face(is_of_side, add);
    }

    /** Translates node numbers to those of @p partition. Collective. */
    void set_partition(const std::shared_ptr<const NodePartition> &partition)
    {
      positive.reinit(partition, Quantity::scalars);
      negative.reinit(partition, Quantity::scalars);
      for (Face &face : all)
        for (unsigned int k = 0; k < n_corners; ++k)
          face.nodes[k] = partition->local_index(face.global_nodes[k]);
      owned = owned_marked_nodes(partition,
                                 [&](const auto &mark)
                                 {
                                   for (const Face &face : all)
                                     std::for_each(face.nodes.begin(), face.nodes.end(), mark);
                                 });
    }

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
    void find_areas(const NodalVector &position, std::vector<double> &area)
    {
      for (const unsigned int node : owned)
      {
        std::fill_n(positive.node(node), node_stride, 0.);
        std::fill_n(negative.node(node), node_stride, 0.);
      }
      for (const Face &face : all)
      {
        const dealii::Tensor<1, dim> share =
            face.orientation / n_corners * area_vector<dim>(corners(face, position));
        for (const unsigned int node : face.nodes)
          for (unsigned int d = 0; d < dim; ++d)
            (share[d] > 0. ? positive : negative).node(node)[d] += std::abs(share[d]);
      }
      positive.add_to_owners();
      negative.add_to_owners();
      area.clear();
      for (const unsigned int node : owned)
      {
        double square = 0;
        for (unsigned int d = 0; d < dim; ++d)
          square += std::pow(std::max(positive.node(node)[d], negative.node(node)[d]), 2);
        area.push_back(std::sqrt(square));
      }
    }

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

    /** A pair: local number of the slave face, index of the master face among masters(). */
    struct Pair
    {
      unsigned int slave, master;
    };

    /** Data of a master face on this rank, beside the values of its corners. */
    struct Master
    {
      std::array<dealii::types::global_dof_index, n_corners> nodes; ///< global numbers
      double orientation, thickness;
    };

    explicit FaceExchange(const MPI_Comm communicator)
        : communicator(communicator),
          n_sent(dealii::Utilities::MPI::n_mpi_processes(communicator), 0), n_received(n_sent)
    {}

    /** Finds the pairs whose boxes are closer than @p reach times the thickness of the slave face
     * and @p margin [L], in these positions (ghosts current), without common nodes. Collective. */
    void find_pairs(const ContactFaces<dim> &slaves, const ContactFaces<dim> &masters,
                    const NodalVector &position, const double reach, const double margin)
    {
      select_sent_faces(slaves, masters, position, reach, margin);
      receive_masters(masters);
      std::vector<double> to_send, values;
      for (const unsigned int f : sent)
        for (const auto &corner : masters.corners(masters.faces()[f], position))
          to_send.insert(to_send.end(), corner.begin_raw(), corner.end_raw());
      send(n_corners * dim, to_send, values);
      std::vector<dealii::BoundingBox<dim>> boxes;
      for (std::size_t m = 0; m < received.size(); ++m)
      {
        FaceCorners<dim> corners;
        for (unsigned int k = 0; k < n_corners; ++k)
          corners[k] = vector_of<dim>(&values[(m * n_corners + k) * dim]);
        boxes.push_back(box_around<dim>(corners, 0.));
      }
      const auto tree = pack_rtree_of_indices(boxes);
      found.clear();
      std::vector<std::size_t> hits;
      for (unsigned int s = 0; s < slaves.faces().size(); ++s)
      {
        const auto &face = slaves.faces()[s];
        hits.clear();
        tree.query(boost::geometry::index::intersects(box_around<dim>(
                       slaves.corners(face, position), reach * face.thickness + margin)),
                   std::back_inserter(hits));
        std::sort(hits.begin(), hits.end());
        for (const std::size_t m : hits)
        {
          const auto &nodes = received[m].nodes;
          const bool has_common_node =
              std::any_of(face.global_nodes.begin(), face.global_nodes.end(),
                          [&](const dealii::types::global_dof_index node)
                          { return std::find(nodes.begin(), nodes.end(), node) != nodes.end(); });
          if (!has_common_node)
            found.push_back({s, static_cast<unsigned int>(m)});
        }
      }
      drop_unused();
    }

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

    /** Sends @p n_values for each of sent_faces() to masters(). Collective. */
    void send(const unsigned int n_values, const std::vector<double> &at_sent,
              std::vector<double> &at_masters) const
    {
      exchange_items(n_values, n_sent, n_received, at_sent, at_masters, communicator);
    }

    /** Sends @p n_values for each of masters() back to sent_faces(). Collective. */
    void send_back(const unsigned int n_values, const std::vector<double> &at_masters,
                   std::vector<double> &at_sent) const
    {
      exchange_items(n_values, n_received, n_sent, at_masters, at_sent, communicator);
    }

  private:
    /** The exchange of a number of doubles per item between all ranks. Collective. */
    static void exchange_items(const unsigned int n_values, const std::vector<int> &n_to,
                               const std::vector<int> &n_from, const std::vector<double> &to_send,
                               std::vector<double> &to_receive, const MPI_Comm communicator)
    {
      const auto values_of = [&](std::vector<int> counts)
      {
        for (int &count : counts)
          count *= static_cast<int>(n_values);
        return counts;
      };
      const auto offsets_of = [](std::vector<int> counts)
      {
        std::exclusive_scan(counts.begin(), counts.end(), counts.begin(), 0);
        return counts;
      };
      const std::vector<int> send_counts = values_of(n_to), receive_counts = values_of(n_from);
      const std::vector<int> send_offsets = offsets_of(send_counts),
                             receive_offsets = offsets_of(receive_counts);
      to_receive.resize(static_cast<std::size_t>(receive_offsets.back() + receive_counts.back()));
      const int error = MPI_Alltoallv(to_send.data(), send_counts.data(), send_offsets.data(),
                                      MPI_DOUBLE, to_receive.data(), receive_counts.data(),
                                      receive_offsets.data(), MPI_DOUBLE, communicator);
      AssertThrowMPI(error);
    }

    void select_sent_faces(const ContactFaces<dim> &slaves, const ContactFaces<dim> &masters,
                           const NodalVector &position, const double reach, const double margin)
    {
      Extent<dim> around; // the slave faces of this rank
      for (const auto &face : slaves.faces())
      {
        const dealii::BoundingBox<dim> box =
            box_around<dim>(slaves.corners(face, position), reach * face.thickness + margin);
        around.add(box.get_boundary_points().first);
        around.add(box.get_boundary_points().second);
      }
      const auto rank_boxes = from_all_ranks(std::vector<Extent<dim>>{around}, communicator);
      std::vector<dealii::BoundingBox<dim>> boxes;
      for (const auto &face : masters.faces())
        boxes.push_back(box_around<dim>(masters.corners(face, position), 0.));
      sent.clear();
      for (std::size_t rank = 0; rank < rank_boxes.size(); ++rank)
      {
        const std::size_t before = sent.size();
        for (std::size_t f = 0; f < boxes.size(); ++f)
        {
          bool meets = true;
          for (unsigned int d = 0; d < dim; ++d)
            meets = meets && boxes[f].lower_bound(d) <= rank_boxes[rank].highest[d] &&
                    boxes[f].upper_bound(d) >= rank_boxes[rank].lowest[d];
          if (meets)
            sent.push_back(static_cast<unsigned int>(f));
        }
        n_sent[rank] = static_cast<int>(sent.size() - before);
      }
      const int error =
          MPI_Alltoall(n_sent.data(), 1, MPI_INT, n_received.data(), 1, MPI_INT, communicator);
      AssertThrowMPI(error);
    }

    void receive_masters(const ContactFaces<dim> &masters)
    {
      // Numbers of nodes are exact as doubles up to 2^53.
      std::vector<double> to_send, values;
      for (const unsigned int f : sent)
      {
        const auto &face = masters.faces()[f];
        for (const auto node : face.global_nodes)
          to_send.push_back(static_cast<double>(node));
        to_send.insert(to_send.end(), {face.orientation, face.thickness});
      }
      constexpr unsigned int n_values = n_corners + 2;
      send(n_values, to_send, values);
      received.clear();
      for (std::size_t i = 0; i < values.size(); i += n_values)
      {
        Master master{{}, values[i + n_corners], values[i + n_corners + 1]};
        for (unsigned int k = 0; k < n_corners; ++k)
          master.nodes[k] = static_cast<dealii::types::global_dof_index>(values[i + k]);
        received.push_back(master);
      }
    }

    void drop_unused()
    {
      std::vector<double> is_used(received.size(), 0.), sent_is_used;
      for (const Pair &pair : found)
        is_used[pair.master] = 1.;
      send_back(1, is_used, sent_is_used);
      const auto drop = [](const std::vector<double> &used, std::vector<int> &counts, auto &items)
      {
        std::size_t from = 0, to = 0;
        for (int &count : counts)
        {
          const std::size_t end = from + static_cast<std::size_t>(count), begin = to;
          for (; from < end; ++from)
            if (used[from] > 0.)
              items[to++] = items[from];
          count = static_cast<int>(to - begin);
        }
        items.resize(to);
      };
      std::vector<unsigned int> number(received.size());
      unsigned int n_used = 0;
      for (std::size_t m = 0; m < received.size(); ++m)
        number[m] = is_used[m] > 0. ? n_used++ : 0;
      for (Pair &pair : found)
        pair.master = number[pair.master];
      drop(sent_is_used, n_sent, sent);
      drop(is_used, n_received, received);
    }

    MPI_Comm communicator;
    std::vector<int> n_sent, n_received; ///< faces to and from each rank
    std::vector<unsigned int> sent;
    std::vector<Master> received;
    std::vector<Pair> found;
  };

  extern template class FaceExchange<2>;
  extern template class FaceExchange<3>;
} // namespace tombolo
