// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/contact/contact_faces.h>
#include <tombolo/state/nodal_vector.h>

#include <mpi.h>

#include <array>
#include <vector>

namespace tombolo
{
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
