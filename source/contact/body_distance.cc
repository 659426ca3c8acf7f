// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/body_distance.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/format.h>
#include <tombolo/contact/nodal_geometry.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <limits>
#include <sstream>
#include <string>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  void refuse_overlap(const Section &section, const Nodes<dim> &nodes, const NodalState &state,
                      const std::vector<unsigned int> &slave_nodes,
                      const std::vector<double> &depths)
  {
    constexpr double round_off = 1e-9; // of the extent
    const MPI_Comm communicator = nodes.communicator();
    double extent = 0, deepest = 0;
    for (const unsigned int node : slave_nodes)
      extent = std::max(extent, vector_of<dim>(state.initial_position.node(node)).norm());
    extent = Utilities::MPI::max(extent, communicator);
    std::string failure;
    for (std::size_t k = 0; k < depths.size(); ++k)
      if (depths[k] > std::max(deepest, round_off * extent))
      {
        deepest = depths[k];
        const unsigned int node = slave_nodes[k];
        std::ostringstream message;
        message << section.describe("") << ": the bodies overlap at the start: the slave is "
                << deepest << " deep in the master around the node with the number "
                << nodes.persistent_ids()[node] << " at "
                << place_text(vector_of<dim>(state.initial_position.node(node)))
                << ". Move a body, or set `Initial overlap = resolve`.";
        failure = message.str();
      }
    if (deepest < Utilities::MPI::max(deepest, communicator))
      failure.clear();
    throw_on_all_ranks<InputError>(failure, communicator);
  }

  template <int dim>
  void refuse_distance(const Section &section, const NodalState &state,
                       const std::vector<unsigned int> &slave_nodes,
                       const std::vector<unsigned int> &master_nodes, const MPI_Comm communicator)
  {
    std::vector<double> places;
    for (const unsigned int node : master_nodes)
      for (unsigned int d = 0; d < dim; ++d)
        places.push_back(state.initial_position.node(node)[d]);
    double least = std::numeric_limits<double>::max();
    std::string where;
    for (const std::vector<double> &of_rank : Utilities::MPI::all_gather(communicator, places))
      for (std::size_t i = 0; i < of_rank.size(); i += dim)
        for (const unsigned int node : slave_nodes)
        {
          const double *const x = state.initial_position.node(node);
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

  template <int dim>
  std::string describe_tie(const NodalVector &position,
                           const std::vector<unsigned int> &slave_nodes,
                           const std::vector<double> &areas, const MPI_Comm communicator)
  {
    unsigned long n_tied = 0;
    std::vector<double> first; // of the free ones
    for (std::size_t k = 0; k < slave_nodes.size(); ++k)
    {
      const double *const x = position.node(slave_nodes[k]);
      if (areas[k] > 0.)
        ++n_tied;
      else if (const std::vector<double> place(x, x + dim); first.empty() || place < first)
        first = place;
    }
    for (const std::vector<double> &of_rank : Utilities::MPI::all_gather(communicator, first))
      if (!of_rank.empty() && (first.empty() || of_rank < first))
        first = of_rank;
    n_tied = Utilities::MPI::sum(n_tied, communicator);
    const unsigned long n_nodes = Utilities::MPI::sum(slave_nodes.size(), communicator);
    const std::string text =
        std::to_string(n_tied) + " of " + std::to_string(n_nodes) + " slave nodes are tied";
    return first.empty() ? text
                         : text + ", " + std::to_string(n_nodes - n_tied) +
                               " not, where no master is near: the first at " +
                               place_text(vector_of<dim>(first.data()));
  }

  template void refuse_overlap(const Section &, const Nodes<2> &, const NodalState &,
                               const std::vector<unsigned int> &, const std::vector<double> &);
  template void refuse_overlap(const Section &, const Nodes<3> &, const NodalState &,
                               const std::vector<unsigned int> &, const std::vector<double> &);
  template void refuse_distance<2>(const Section &, const NodalState &,
                                   const std::vector<unsigned int> &,
                                   const std::vector<unsigned int> &, MPI_Comm);
  template void refuse_distance<3>(const Section &, const NodalState &,
                                   const std::vector<unsigned int> &,
                                   const std::vector<unsigned int> &, MPI_Comm);
  template std::string describe_tie<2>(const NodalVector &, const std::vector<unsigned int> &,
                                       const std::vector<double> &, MPI_Comm);
  template std::string describe_tie<3>(const NodalVector &, const std::vector<unsigned int> &,
                                       const std::vector<double> &, MPI_Comm);
} // namespace tombolo
