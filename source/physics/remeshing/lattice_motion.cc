// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/lattice_motion.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/contact/nodal_geometry.h>
#include <tombolo/remesh/cell_simplices.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <iterator>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  LatticeMotion<dim>::LatticeMotion(const RefillSettings &settings)
      : settings(settings), displacement(settings.template motion<dim>())
  {}

  template <int dim>
  Tensor<1, dim> LatticeMotion<dim>::at(const Point<dim> &place, const double time) const
  {
    Tensor<1, dim> result;
    for (unsigned int d = 0; displacement && d < dim; ++d)
      result[d] = displacement->value(place, time, d);
    return result;
  }

  template <int dim>
  Tensor<1, dim> LatticeMotion<dim>::way(const Point<dim> &place, const double time) const
  {
    return at(place, time) - at(place, time_of_last);
  }

  template <int dim>
  double LatticeMotion<dim>::largest_way(const SmoothedCell<dim> &cell, const double time) const
  {
    double result = 0;
    for (const Point<dim> &corner : cell.corners)
      result = std::max(result, way(corner, time).norm());
    return result;
  }

  template <int dim>
  template <typename Way>
  NodalVector LatticeMotion<dim>::move(const NodalVector &initial, const NodalVector &from,
                                       const Way &way) const
  {
    NodalVector result = from.copy();
    result.fill(
        [&](const unsigned int i, double *const place)
        {
          const Tensor<1, dim> of_node = way(Point<dim>(vector_of<dim>(initial.node(i))));
          for (unsigned int d = 0; d < dim && is_on(); ++d)
            place[d] += of_node[d];
        });
    return result;
  }

  template <int dim>
  NodalVector LatticeMotion<dim>::places(const NodalVector &initial, const double time) const
  {
    return move(initial, initial, [&](const Point<dim> &place) { return at(place, time); });
  }

  template <int dim>
  std::vector<typename SubCells<dim>::Corners>
  LatticeMotion<dim>::corners(const std::vector<SmoothedCell<dim>> &cells, const double time,
                              const MPI_Comm communicator) const
  {
    std::vector<typename SubCells<dim>::Corners> result;
    std::string problem;
    for (const SmoothedCell<dim> &cell : cells)
    {
      result.push_back(cell.corners);
      if (!is_on())
        continue;
      for (Point<dim> &corner : result.back())
        corner += at(corner, time);
      const auto volumes = CellSimplices<dim>::volumes(result.back());
      if (problem.empty() && !(*std::min_element(volumes.begin(), volumes.end()) > 0.))
      {
        std::ostringstream text;
        text << "at t = " << time << " it turns a cell of the mesh over, which is around ("
             << cell.centre() << ") at the start.";
        problem = text.str();
      }
    }
    for (const std::string &of_rank : texts_of_ranks(communicator, problem))
      if (!of_rank.empty())
        settings.refuse_motion(of_rank);
    return result;
  }

  template <int dim>
  double LatticeMotion<dim>::largest_way(const std::vector<SmoothedCell<dim>> &cells,
                                         const double time, const MPI_Comm communicator) const
  {
    double result = 0;
    if (!is_on())
      return result;
    for (const SmoothedCell<dim> &cell : cells)
      result = std::max(result, largest_way(cell, time));
    return Utilities::MPI::max(result, communicator);
  }

  template <int dim>
  void LatticeMotion<dim>::add_moved_cells(const std::vector<SmoothedCell<dim>> &cells,
                                           const double time, const MPI_Comm communicator,
                                           std::vector<unsigned int> &distorted) const
  {
    constexpr double far = 0.1; // of the size of a cell
    if (!is_on())
      return;
    bool is_far = !distorted.empty();
    std::vector<unsigned int> moved, all;
    for (unsigned int c = 0; c < cells.size(); ++c)
    {
      const auto &corners = cells[c].corners;
      const double of_cell = largest_way(cells[c], time);
      is_far = is_far || of_cell > far * corners[0].distance(corners[1]);
      if (of_cell > 0.)
        moved.push_back(c);
    }
    if (Utilities::MPI::max(is_far ? 1 : 0, communicator) == 0)
      return;
    std::set_union(distorted.begin(), distorted.end(), moved.begin(), moved.end(),
                   std::back_inserter(all));
    distorted = std::move(all);
  }

  template <int dim>
  NodalVector LatticeMotion<dim>::follow(const NodalVector &initial, const NodalVector &position,
                                         const double time) const
  {
    return move(initial, position, [&](const Point<dim> &place) { return way(place, time); });
  }

  template class LatticeMotion<2>;
  template class LatticeMotion<3>;
} // namespace tombolo
