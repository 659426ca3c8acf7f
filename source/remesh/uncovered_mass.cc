// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/remesh/uncovered_mass.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/throw_on_all_ranks.h>

#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    template <int dim>
    std::string without_taker(const RemapCell<dim> &cell)
    {
      Point<dim> centre;
      for (const Point<dim> &corner : cell.before)
        centre += corner / static_cast<double>(cell.before.size());
      std::ostringstream text;
      text << "A refill finds no cell to put the mass of the cell around (" << centre << ") into.";
      return text.str();
    }
  } // namespace

  template <int dim>
  void give_to_neighbours(const CellOverlap<dim> &overlap,
                          const std::shared_ptr<const NodePartition> &partition,
                          const unsigned int n_components, std::vector<double> &mass,
                          std::vector<double> &values)
  {
    constexpr unsigned int n_sub_cells = CellOverlap<dim>::n_sub_cells;
    const std::vector<RemapCell<dim>> &cells = overlap.cells;
    const auto takes = [&](const std::size_t i)
    {
      return !overlap.is_uncovered[i] && mass[i] > 0. &&
             overlap.is_source(static_cast<unsigned int>(i / n_sub_cells));
    };
    NodalVector of_takers, of_givers;
    of_takers.reinit(partition, Quantity::scalar);
    for (std::size_t i = 0; i < mass.size(); ++i)
      if (takes(i))
        for (const unsigned int node : cells[i / n_sub_cells].nodes)
          *of_takers.node(node) += mass[i];
    of_takers.sum_over_ranks();
    std::string failure;
    // What a giver gives to a node, as a share of its own.
    std::vector<double> share(mass.size(), 0.);
    for (std::size_t i = 0; i < mass.size(); ++i)
    {
      if (!overlap.is_uncovered[i])
        continue;
      double n_nodes = 0;
      for (const unsigned int node : cells[i / n_sub_cells].nodes)
        n_nodes += *of_takers.node(node) > 0. ? 1. : 0.;
      if (n_nodes > 0.)
        share[i] = 1. / n_nodes;
      else if (failure.empty())
        failure = without_taker(cells[i / n_sub_cells]);
    }
    throw_on_all_ranks<RunError>(failure, overlap.communicator);

    // The first one is the mass itself.
    std::vector<double> taken(mass.size() * (1 + n_components), 0.);
    for (unsigned int f = 0; f <= n_components; ++f)
    {
      const auto content = [&](const std::size_t i)
      { return mass[i] * (f == 0 ? 1. : values[i * n_components + f - 1]); };
      of_givers.reinit(partition, Quantity::scalar);
      for (std::size_t i = 0; i < mass.size(); ++i)
        if (overlap.is_uncovered[i])
          for (const unsigned int node : cells[i / n_sub_cells].nodes)
            if (*of_takers.node(node) > 0.)
              *of_givers.node(node) += share[i] * content(i);
      of_givers.sum_over_ranks();
      for (std::size_t i = 0; i < mass.size(); ++i)
        if (takes(i))
          for (const unsigned int node : cells[i / n_sub_cells].nodes)
            taken[i * (1 + n_components) + f] +=
                mass[i] / *of_takers.node(node) * *of_givers.node(node);
    }
    for (std::size_t i = 0; i < mass.size(); ++i)
    {
      const double *const of_others = taken.data() + i * (1 + n_components);
      if (overlap.is_uncovered[i])
        mass[i] = 0.;
      else if (of_others[0] > 0.)
      {
        for (unsigned int f = 0; f < n_components; ++f)
        {
          double &value = values[i * n_components + f];
          value = (mass[i] * value + of_others[1 + f]) / (mass[i] + of_others[0]);
        }
        mass[i] += of_others[0];
      }
    }
  }

  template void give_to_neighbours(const CellOverlap<2> &,
                                   const std::shared_ptr<const NodePartition> &, unsigned int,
                                   std::vector<double> &, std::vector<double> &);
  template void give_to_neighbours(const CellOverlap<3> &,
                                   const std::shared_ptr<const NodePartition> &, unsigned int,
                                   std::vector<double> &, std::vector<double> &);
} // namespace tombolo
