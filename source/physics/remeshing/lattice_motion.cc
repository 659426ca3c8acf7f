// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/remeshing/lattice_motion.h>

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
  NodalVector LatticeMotion<dim>::places(const NodalVector &initial, const double time) const
  {
    NodalVector result;
    result.reinit(initial.partition(), node_stride, initial.under_reflection());
    result.copy_from(initial);
    for (unsigned int i = 0; is_on() && i < initial.partition()->n_owned(); ++i)
    {
      const Tensor<1, dim> way = at(Point<dim>(vector_of<dim>(initial.node(i))), time);
      for (unsigned int d = 0; d < dim; ++d)
        result.node(i)[d] += way[d];
    }
    result.update_ghosts();
    return result;
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
    for (const std::string &of_rank : Utilities::MPI::all_gather(communicator, problem))
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
      for (const Point<dim> &corner : cell.corners)
        result = std::max(result, (at(corner, time) - at(corner, time_of_last)).norm());
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
      double way = 0;
      for (const Point<dim> &corner : corners)
        way = std::max(way, (at(corner, time) - at(corner, time_of_last)).norm());
      is_far = is_far || way > far * corners[0].distance(corners[1]);
      if (way > 0.)
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
    NodalVector result;
    result.reinit(position.partition(), node_stride, position.under_reflection());
    result.copy_from(position);
    for (unsigned int i = 0; is_on() && i < position.partition()->n_owned(); ++i)
    {
      const Point<dim> place(vector_of<dim>(initial.node(i)));
      const Tensor<1, dim> way = at(place, time) - at(place, time_of_last);
      for (unsigned int d = 0; d < dim; ++d)
        result.node(i)[d] += way[d];
    }
    result.update_ghosts();
    return result;
  }

  template class LatticeMotion<2>;
  template class LatticeMotion<3>;
} // namespace tombolo
