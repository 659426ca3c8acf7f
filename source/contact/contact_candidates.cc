// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/contact/contact_candidates.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/mesh/boundary_names.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <optional>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    Point<dim> initial_point(const NodalState &state, const unsigned int node)
    {
      Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = state.initial_position.node(node)[d];
      return result;
    }

    /** Marks owned nodes on outer faces: of these ids, or of any if there are none. */
    template <int dim>
    void mark_surface_nodes(const Nodes<dim> &nodes, const NodePartition &partition,
                            const std::set<types::boundary_id> &boundaries, std::vector<bool> &mark)
    {
      std::vector<types::global_dof_index> cell_nodes;
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
      {
        if (cell->is_artificial() || !cell->at_boundary())
          continue;
        nodes.cell_nodes(cell, cell_nodes);
        for (const unsigned int f : cell->face_indices())
        {
          if (!nodes.is_outer_face(cell, f) ||
              (!boundaries.empty() && boundaries.count(cell->face(f)->boundary_id()) == 0))
            continue;
          for (const unsigned int k : nodes.face_places(f))
            if (nodes.owned().is_element(cell_nodes[k]))
              mark[partition.local_index(cell_nodes[k])] = true;
        }
      }
    }
  } // namespace

  void declare_contact_candidates(const Entries &e)
  {
    e.text("Boundary", "", "",
           "Names of the boundaries whose nodes can touch, separated by commas; empty for the "
           "nodes of the whole surface, all particles, and all nodes of elements that erode.");
    e.text("Where", "", "", "A predicate of the initial position that nodes must fulfil to touch.");
  }

  template <int dim>
  void validate_contact_candidates(const Section &section)
  {
    if (!section.get("Where").empty())
      Predicate<dim> where(section, "Where");
    section.get("Boundary");
  }

  template <int dim>
  std::set<types::boundary_id> contact_boundaries(const Section &section, const Mesh<dim> &mesh)
  {
    if (section.get("Boundary").empty())
      return {};
    return boundary_ids(mesh, section, "Boundary");
  }

  template <int dim>
  std::vector<unsigned int>
  find_contact_candidates(const Section &section, const std::set<types::boundary_id> &boundaries,
                          const Nodes<dim> &nodes, const NodalState &state,
                          const std::vector<bool> &can_be_exposed)
  {
    const NodePartition &partition = *state.partition();
    std::vector<bool> is_candidate(partition.n_owned(), false);
    if (section.get("Boundary").empty())
      is_candidate = can_be_exposed;
    mark_surface_nodes(nodes, partition, boundaries, is_candidate);

    std::optional<Predicate<dim>> where;
    if (!section.get("Where").empty())
      where.emplace(section, "Where");
    std::vector<unsigned int> candidates;
    std::string failure;
    try
    {
      for (unsigned int i = 0; i < partition.n_owned(); ++i)
        if (is_candidate[i] && (!where || (*where)(initial_point<dim>(state, i))))
          candidates.push_back(i);
    }
    catch (const InputError &error)
    {
      failure = error.what();
    }
    throw_on_all_ranks<InputError>(failure, nodes.communicator());
    if (Utilities::MPI::sum(candidates.size(), nodes.communicator()) == 0)
      section.fail(where ? "Where" : "Boundary",
                   "no node can touch; the contact would do nothing.");
    return candidates;
  }

  template <int dim>
  void refuse_penetration(const Section &section, const Nodes<dim> &nodes, const NodalState &state,
                          const std::vector<unsigned int> &candidates,
                          const std::vector<double> &gap)
  {
    double extent = 0;
    for (unsigned int i = 0; i < state.partition()->n_owned(); ++i)
      extent = std::max(extent, initial_point<dim>(state, i).norm());
    extent = Utilities::MPI::max(extent, nodes.communicator());
    std::string failure;
    double deepest = 0;
    for (std::size_t k = 0; k < candidates.size(); ++k)
      if (gap[k]<deepest && * state.mass.node(candidates[k])> 0.)
      {
        deepest = gap[k];
        if (gap[k] > -1e-9 * extent)
          continue;
        const double *const x = state.initial_position.node(candidates[k]);
        std::ostringstream message;
        message << section.describe("")
                << ": the surface starts inside the body: the node with the number "
                << nodes.persistent_ids()[candidates[k]] << " at (" << x[0];
        for (unsigned int d = 1; d < dim; ++d)
          message << ", " << x[d];
        message << ") is " << -gap[k] << " behind it. Move the surface or the body."
                << " The normal of a plane points to the side where bodies may be.";
        failure = message.str();
      }
    // Of all ranks, the one with the deepest node reports it.
    const double of_all = Utilities::MPI::min(deepest, nodes.communicator());
    if (deepest > of_all)
      failure.clear();
    throw_on_all_ranks<InputError>(failure, nodes.communicator());
  }

  template <int dim>
  void refuse_motion_out_of_mirrors(const Section &section, const Images &images,
                                    ContactSurface<dim> &surface)
  {
    for (unsigned int d = 0; d < dim; ++d)
      if (images.are_opposite_along(d) && surface.translation().moves_along(d))
        section.subsection(section.get("Surface"))
            .fail("Directions", "a body with a mass would move out of a " + Images::words(true) +
                                    "; allowed are directions without " + "xyz"[d] + ".");
  }

  template void validate_contact_candidates<2>(const Section &);
  template <int dim>
  void push_out(const ContactSurface<dim> &surface, const std::vector<unsigned int> &candidates,
                const std::vector<double> &was, const std::vector<double> &gap, const double time,
                const NodalVector &slides, const NodalVector &from, NodalVector &position,
                NodalVector &is_bound)
  {
    constexpr double clearance = 1e-6, largest_slope = 0.3;
    for (std::size_t k = 0; k < candidates.size(); ++k)
    {
      if (!(was[k] < 0. || gap[k] < 0.) || !(*slides.node(candidates[k]) > 0.))
        continue;
      *is_bound.node(candidates[k]) = 1.;
      double *const x = position.node(candidates[k]);
      // Beyond the surface by some of its way: on it, round-off would decide whether a node
      // touches.
      double excess = -(1. + clearance) * gap[k];
      if (was[k] < 0.)
      {
        // Faces are chords of a round surface, and beside the last node that touches they go away
        // from it: what touched it touches it still.
        const double along = (vector_of<dim>(x) - vector_of<dim>(from.node(candidates[k]))).norm();
        const bool may_leave = *slides.node(candidates[k]) < 1.;
        excess = may_leave && gap[k] - was[k] > largest_slope * along ? 0. : was[k] - gap[k];
      }
      const Tensor<1, dim> way = excess * surface.normal(vector_of<dim>(x), time);
      for (unsigned int d = 0; d < dim; ++d)
        x[d] += way[d];
    }
  }

  template void push_out(const ContactSurface<2> &, const std::vector<unsigned int> &,
                         const std::vector<double> &, const std::vector<double> &, double,
                         const NodalVector &, const NodalVector &, NodalVector &, NodalVector &);
  template void push_out(const ContactSurface<3> &, const std::vector<unsigned int> &,
                         const std::vector<double> &, const std::vector<double> &, double,
                         const NodalVector &, const NodalVector &, NodalVector &, NodalVector &);
  template std::set<types::boundary_id> contact_boundaries(const Section &, const Mesh<2> &);
  template std::vector<unsigned int> find_contact_candidates(const Section &,
                                                             const std::set<types::boundary_id> &,
                                                             const Nodes<2> &, const NodalState &,
                                                             const std::vector<bool> &);
  template void refuse_penetration(const Section &, const Nodes<2> &, const NodalState &,
                                   const std::vector<unsigned int> &, const std::vector<double> &);
  template void validate_contact_candidates<3>(const Section &);
  template std::set<types::boundary_id> contact_boundaries(const Section &, const Mesh<3> &);
  template std::vector<unsigned int> find_contact_candidates(const Section &,
                                                             const std::set<types::boundary_id> &,
                                                             const Nodes<3> &, const NodalState &,
                                                             const std::vector<bool> &);
  template void refuse_penetration(const Section &, const Nodes<3> &, const NodalState &,
                                   const std::vector<unsigned int> &, const std::vector<double> &);
  template void refuse_motion_out_of_mirrors(const Section &, const Images &, ContactSurface<2> &);
  template void refuse_motion_out_of_mirrors(const Section &, const Images &, ContactSurface<3> &);
} // namespace tombolo
