// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/mortar_start.h>

#include <tombolo/base/throw_on_all_ranks.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/contact/place_text.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <limits>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void refuse_overlap(const Section &section, const std::vector<MortarNode<dim>> &kept,
                      const ContactFaces<dim> &slaves, const ContactFaces<dim> &masters,
                      const Nodes<dim> &nodes, const NodalVector &position,
                      const MPI_Comm communicator)
  {
    constexpr double round_off = 1e-9; // of the extent
    double extent = 0, deepest = 0;
    for (const auto *const side : {&slaves, &masters})
      for (const unsigned int node : side->owned_nodes())
        extent = std::max(extent, vector_of<dim>(position.node(node)).norm());
    extent = Utilities::MPI::max(extent, communicator);
    std::string failure;
    for (std::size_t k = 0; k < kept.size(); ++k)
      if (kept[k].offset > std::max(deepest, round_off * extent))
      {
        deepest = kept[k].offset;
        const unsigned int node = slaves.owned_nodes()[k];
        std::ostringstream message;
        message << section.describe("") << ": the bodies overlap at the start: the slave is "
                << deepest << " deep in the master around the node with the number "
                << nodes.persistent_ids()[node] << " at "
                << place_text(vector_of<dim>(position.node(node)))
                << ". Move a body, or set `Initial overlap = resolve`.";
        failure = message.str();
      }
    if (deepest < Utilities::MPI::max(deepest, communicator))
      failure.clear();
    throw_on_all_ranks<InputError>(failure, communicator);
  }

  template <int dim>
  void refuse_distance(const Section &section, const ContactFaces<dim> &slaves,
                       const ContactFaces<dim> &masters, const NodalVector &position,
                       const MPI_Comm communicator)
  {
    std::vector<double> places;
    for (const unsigned int node : masters.owned_nodes())
      for (unsigned int d = 0; d < dim; ++d)
        places.push_back(position.node(node)[d]);
    double least = std::numeric_limits<double>::max();
    std::string where;
    for (const std::vector<double> &of_rank : Utilities::MPI::all_gather(communicator, places))
      for (std::size_t i = 0; i < of_rank.size(); i += dim)
        for (const unsigned int node : slaves.owned_nodes())
        {
          const double *const x = position.node(node);
          const double distance = (vector_of<dim>(x) - vector_of<dim>(of_rank.data() + i)).norm();
          if (distance < least)
          {
            least = distance;
            where = place_text(vector_of<dim>(x));
          }
        }
    const double least_of_all = Utilities::MPI::min(least, communicator);
    std::ostringstream message;
    message << section.describe("Type") << ": the tied bodies are apart: the nearest nodes, at "
            << where << ", are " << least
            << " from each other, or their faces do not face each other; allowed is 10 % of the "
               "thickness of the thinner cells.";
    throw_on_all_ranks<InputError>(least > least_of_all ? "" : message.str(), communicator);
    section.fail("Type", "the tied bodies are apart.");
  }

  template void refuse_overlap(const Section &, const std::vector<MortarNode<2>> &,
                               const ContactFaces<2> &, const ContactFaces<2> &, const Nodes<2> &,
                               const NodalVector &, MPI_Comm);
  template void refuse_distance(const Section &, const ContactFaces<2> &, const ContactFaces<2> &,
                                const NodalVector &, MPI_Comm);
  template void refuse_overlap(const Section &, const std::vector<MortarNode<3>> &,
                               const ContactFaces<3> &, const ContactFaces<3> &, const Nodes<3> &,
                               const NodalVector &, MPI_Comm);
  template void refuse_distance(const Section &, const ContactFaces<3> &, const ContactFaces<3> &,
                                const NodalVector &, MPI_Comm);
} // namespace tombolo
