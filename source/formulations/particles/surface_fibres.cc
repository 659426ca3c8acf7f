// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/particles/surface_fibres.h>

#include <tombolo/base/on_ranks.h>

#include <algorithm>
#include <tuple>

namespace tombolo
{
  namespace
  {
    using Node = types::global_dof_index;
    /** From a node to the next one inside. */
    struct Step
    {
      Node from, to;

      bool operator<(const Step &other) const
      {
        return std::tie(from, to) < std::tie(other.from, other.to);
      }
      bool operator==(const Step &other) const
      {
        return from == other.from && to == other.to;
      }
    };

    /** A step, and the node that follows it. */
    struct Continuation
    {
      Node from, to, next;

      bool operator<(const Continuation &other) const
      {
        return std::tie(from, to, next) < std::tie(other.from, other.to, other.next);
      }
    };

    template <int dim>
    class FibreSearch
    {
    public:
      using Cell = typename Nodes<dim>::Cell;

      explicit FibreSearch(const PartSetup<dim> &setup) : setup(setup), nodes(*setup.nodes) {}

      std::vector<SurfaceFibre> find()
      {
        for_own_cells([this](const Cell &cell) { begin_at(cell); });
        for (unsigned int n = 2; n < SurfaceFibre::most_nodes; ++n)
          lengthen(n);
        std::vector<SurfaceFibre> result;
        for (SurfaceFibre &fibre : fibres)
          if (fibre.n_nodes >= SurfaceFibre::least_nodes)
          {
            if (fibre.n_nodes < SurfaceFibre::most_nodes)
              fibre.n_nodes = SurfaceFibre::least_nodes;
            result.push_back(fibre);
          }
        return result;
      }

    private:
      template <typename Use>
      void for_own_cells(const Use &use)
      {
        for (const auto &cell : nodes.dof_handler().active_cell_iterators())
          if (cell->is_locally_owned() && setup.part_cells->part_of(cell) == setup.index)
            use(cell);
      }

      /** Begins the fibres at the outer faces of @p cell. */
      void begin_at(const Cell &cell)
      {
        nodes.cell_nodes(cell, of_cell);
        nodes.cell_points(cell, points);
        for (const unsigned int face : cell->face_indices())
          if (nodes.is_outer_face(cell, face))
            for (const unsigned int place : nodes.face_places(face))
            {
              const unsigned int next = place ^ (1u << (face / 2));
              SurfaceFibre fibre{};
              fibre.node[0] = of_cell[place];
              fibre.node[1] = of_cell[next];
              fibre.n_nodes = 2;
              fibre.volume = cell->measure() / (1u << dim);
              fibre.length = points[place].distance(points[next]);
              fibres.push_back(fibre);
            }
      }

      /** Gives the fibres that have n nodes the next one. */
      void lengthen(const unsigned int n)
      {
        std::vector<Step> steps;
        for (const SurfaceFibre &fibre : fibres)
          if (fibre.n_nodes == n)
            steps.push_back({fibre.node[n - 2], fibre.node[n - 1]});
        // The cell that a step is an edge of may be one of another rank.
        steps = of_all_ranks(steps, setup.communicator);
        std::sort(steps.begin(), steps.end());
        steps.erase(std::unique(steps.begin(), steps.end()), steps.end());
        std::vector<Continuation> found = of_all_ranks(continuations(steps), setup.communicator);
        std::sort(found.begin(), found.end());
        for (SurfaceFibre &fibre : fibres)
        {
          if (fibre.n_nodes != n)
            continue;
          const auto place = find_in(found, {fibre.node[n - 2], fibre.node[n - 1]});
          if (place == found.end())
            continue;
          fibre.node[n] = place->next;
          ++fibre.n_nodes;
        }
      }

      static std::vector<Continuation>::const_iterator find_in(const std::vector<Continuation> &all,
                                                               const Step &step)
      {
        const auto place =
            std::lower_bound(all.begin(), all.end(), Continuation{step.from, step.to, 0});
        return place != all.end() && place->from == step.from && place->to == step.to ? place
                                                                                      : all.end();
      }

      /** Of those of @p steps, which are in order, that are edges of cells of this rank. */
      std::vector<Continuation> continuations(const std::vector<Step> &steps)
      {
        std::vector<Continuation> result;
        if (steps.empty())
          return result;
        for_own_cells(
            [&](const Cell &cell)
            {
              nodes.cell_nodes(cell, of_cell);
              for (unsigned int place = 0; place < of_cell.size(); ++place)
              {
                const auto first =
                    std::lower_bound(steps.begin(), steps.end(), Step{of_cell[place], 0});
                if (first == steps.end() || first->from != of_cell[place])
                  continue;
                for (unsigned int d = 0; d < dim; ++d)
                  if (const Step step{of_cell[place], of_cell[place ^ (1u << d)]};
                      std::binary_search(first, steps.end(), step))
                    add_next(cell, 2 * d + ((place >> d) & 1u ? 0 : 1), step, result);
              }
            });
        return result;
      }

      /** Adds the node that follows @p step, an edge of @p cell that ends at @p face. */
      void add_next(const Cell &cell, const unsigned int face, const Step &step,
                    std::vector<Continuation> &result)
      {
        if (cell->at_boundary(face) || cell->face(face)->has_children() ||
            cell->neighbor_is_coarser(face) ||
            setup.part_cells->part_beyond(cell, face) != setup.index)
          return;
        const Cell beyond(&nodes.dof_handler().get_triangulation(), cell->neighbor(face)->level(),
                          cell->neighbor(face)->index(), &nodes.dof_handler());
        nodes.cell_nodes(beyond, of_neighbour);
        const unsigned int across = cell->neighbor_of_neighbor(face) / 2;
        const auto place = static_cast<unsigned int>(
            std::find(of_neighbour.begin(), of_neighbour.end(), step.to) - of_neighbour.begin());
        result.push_back({step.from, step.to, of_neighbour[place ^ (1u << across)]});
      }

      const PartSetup<dim> &setup;
      const Nodes<dim> &nodes;
      std::vector<SurfaceFibre> fibres;
      std::vector<Node> of_cell, of_neighbour; // buffers
      std::vector<Point<dim>> points;
    };
  } // namespace

  template <int dim>
  std::vector<SurfaceFibre> find_surface_fibres(const PartSetup<dim> &setup)
  {
    return FibreSearch<dim>(setup).find();
  }

  template std::vector<SurfaceFibre> find_surface_fibres<2>(const PartSetup<2> &);
  template std::vector<SurfaceFibre> find_surface_fibres<3>(const PartSetup<3> &);
} // namespace tombolo
