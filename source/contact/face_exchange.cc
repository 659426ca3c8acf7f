// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/face_exchange.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/mpi.h>
#include <deal.II/numerics/rtree.h>

#include <algorithm>
#include <iterator>
#include <limits>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    BoundingBox<dim> box_around(const FaceCorners<dim> &corners, const double by)
    {
      std::pair<Point<dim>, Point<dim>> ends;
      for (unsigned int d = 0; d < dim; ++d)
      {
        ends.first[d] = ends.second[d] = corners[0][d];
        for (const auto &corner : corners)
        {
          ends.first[d] = std::min(ends.first[d], corner[d]);
          ends.second[d] = std::max(ends.second[d], corner[d]);
        }
        ends.first[d] -= by;
        ends.second[d] += by;
      }
      return BoundingBox<dim>(ends);
    }

    /** The exchange of a number of doubles per item between all ranks. Collective. */
    void exchange_items(const unsigned int n_values, const std::vector<int> &n_to,
                        const std::vector<int> &n_from, const std::vector<double> &to_send,
                        std::vector<double> &to_receive, const MPI_Comm communicator)
    {
      const std::size_t n_ranks = n_to.size();
      std::vector<int> send_counts(n_ranks), send_offsets(n_ranks), receive_counts(n_ranks),
          receive_offsets(n_ranks);
      int send_total = 0, receive_total = 0;
      for (std::size_t r = 0; r < n_ranks; ++r)
      {
        send_counts[r] = n_to[r] * static_cast<int>(n_values);
        receive_counts[r] = n_from[r] * static_cast<int>(n_values);
        send_offsets[r] = send_total;
        receive_offsets[r] = receive_total;
        send_total += send_counts[r];
        receive_total += receive_counts[r];
      }
      to_receive.resize(static_cast<std::size_t>(receive_total));
      const int error = MPI_Alltoallv(to_send.data(), send_counts.data(), send_offsets.data(),
                                      MPI_DOUBLE, to_receive.data(), receive_counts.data(),
                                      receive_offsets.data(), MPI_DOUBLE, communicator);
      AssertThrowMPI(error);
    }
  } // namespace

  template <int dim>
  FaceExchange<dim>::FaceExchange(const MPI_Comm communicator)
      : communicator(communicator), n_sent(Utilities::MPI::n_mpi_processes(communicator), 0),
        n_received(n_sent)
  {}

  template <int dim>
  void FaceExchange<dim>::select_sent_faces(const ContactFaces<dim> &slaves,
                                            const ContactFaces<dim> &masters,
                                            const NodalVector &position, const double reach,
                                            const double margin)
  {
    // The box around the slave faces of each rank, low and high corner; turned round without faces.
    constexpr double far = std::numeric_limits<double>::max();
    std::vector<double> around(2 * dim, far);
    std::fill_n(around.begin() + dim, dim, -far);
    for (const auto &face : slaves.faces())
    {
      const BoundingBox<dim> box =
          box_around<dim>(slaves.corners(face, position), reach * face.thickness + margin);
      for (unsigned int d = 0; d < dim; ++d)
      {
        around[d] = std::min(around[d], box.lower_bound(d));
        around[dim + d] = std::max(around[dim + d], box.upper_bound(d));
      }
    }
    const auto of_ranks = Utilities::MPI::all_gather(communicator, around);
    std::vector<BoundingBox<dim>> boxes;
    for (const auto &face : masters.faces())
      boxes.push_back(box_around<dim>(masters.corners(face, position), 0.));
    sent.clear();
    for (std::size_t rank = 0; rank < of_ranks.size(); ++rank)
    {
      const std::size_t before = sent.size();
      for (std::size_t f = 0; f < boxes.size(); ++f)
      {
        bool meets = true;
        for (unsigned int d = 0; d < dim; ++d)
          meets = meets && boxes[f].lower_bound(d) <= of_ranks[rank][dim + d] &&
                  boxes[f].upper_bound(d) >= of_ranks[rank][d];
        if (meets)
          sent.push_back(static_cast<unsigned int>(f));
      }
      n_sent[rank] = static_cast<int>(sent.size() - before);
    }
    const int error =
        MPI_Alltoall(n_sent.data(), 1, MPI_INT, n_received.data(), 1, MPI_INT, communicator);
    AssertThrowMPI(error);
  }

  template <int dim>
  void FaceExchange<dim>::receive_masters(const ContactFaces<dim> &masters)
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
        master.nodes[k] = static_cast<types::global_dof_index>(values[i + k]);
      received.push_back(master);
    }
  }

  template <int dim>
  void FaceExchange<dim>::find_pairs(const ContactFaces<dim> &slaves,
                                     const ContactFaces<dim> &masters, const NodalVector &position,
                                     const double reach, const double margin)
  {
    select_sent_faces(slaves, masters, position, reach, margin);
    receive_masters(masters);
    std::vector<double> to_send, values;
    for (const unsigned int f : sent)
      for (const auto &corner : masters.corners(masters.faces()[f], position))
        for (unsigned int d = 0; d < dim; ++d)
          to_send.push_back(corner[d]);
    send(n_corners * dim, to_send, values);
    std::vector<BoundingBox<dim>> boxes;
    for (std::size_t m = 0; m < received.size(); ++m)
    {
      FaceCorners<dim> corners;
      for (unsigned int k = 0; k < n_corners; ++k)
        for (unsigned int d = 0; d < dim; ++d)
          corners[k][d] = values[(m * n_corners + k) * dim + d];
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
                        [&](const types::global_dof_index node)
                        { return std::find(nodes.begin(), nodes.end(), node) != nodes.end(); });
        if (!has_common_node)
          found.push_back({s, static_cast<unsigned int>(m)});
      }
    }
    drop_unused();
  }

  template <int dim>
  void FaceExchange<dim>::drop_unused()
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

  template <int dim>
  void FaceExchange<dim>::send(const unsigned int n_values, const std::vector<double> &at_sent,
                               std::vector<double> &at_masters) const
  {
    exchange_items(n_values, n_sent, n_received, at_sent, at_masters, communicator);
  }

  template <int dim>
  void FaceExchange<dim>::send_back(const unsigned int n_values,
                                    const std::vector<double> &at_masters,
                                    std::vector<double> &at_sent) const
  {
    exchange_items(n_values, n_received, n_sent, at_masters, at_sent, communicator);
  }

  template class FaceExchange<2>;
  template class FaceExchange<3>;
} // namespace tombolo
