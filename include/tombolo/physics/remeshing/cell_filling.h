// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/on_ranks.h>
#include <tombolo/remesh/cell_overlap.h>

#include <deal.II/base/bounding_box.h>
#include <deal.II/base/mpi.h>
#include <deal.II/numerics/rtree.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <utility>
#include <vector>

namespace tombolo
{
  /**
   * Which cells of a mesh are full of a body whose cells have moved: those of which the body has at
   * least half, with a hysteresis of a tenth. Cells that touch at an edge or a corner alone, full
   * ones and void ones, are joined or parted, so that the surface of the body is one sheet at every
   * node.
   */
  template <int dim>
  class CellFilling
  {
  public:
    static constexpr unsigned int n_corners = SubCells<dim>::n_corners;
    using Corners = typename SubCells<dim>::Corners;
    using Ids = std::array<std::uint64_t, n_corners>;

    /** @p ids: of the corners of the cells of this rank, the same on all ranks. */
    CellFilling(std::vector<Ids> ids, const MPI_Comm communicator)
        : corner_ids(std::move(ids)), communicator(communicator)
    {}

    /** Finds how much of the cells with the corners @p mesh, of those that are @p wanted, is in the
     * full cells with the corners @p present, of those that are @p near: by the share of 64 points.
     * Other cells count as full or void as they are. Collective. */
    void measure(const std::vector<bool> &is_void, const std::vector<Corners> &present,
                 const std::vector<bool> &near, const std::vector<Corners> &mesh,
                 const std::vector<bool> &wanted)
    {
      shares = shares_in(is_void, present, near, mesh, wanted);
      for (std::size_t c = 0; c < is_void.size(); ++c)
        if (!wanted[c])
          shares[c] = is_void[c] ? 0. : 1.;
    }

    /** The shares of cells that measure() finds, of wanted ones; zero of others. Collective. */
    std::vector<double> shares_in(const std::vector<bool> &is_void,
                                  const std::vector<Corners> &present,
                                  const std::vector<bool> &near, const std::vector<Corners> &mesh,
                                  const std::vector<bool> &wanted) const
    {
      std::vector<Corners> full;
      for (std::size_t c = 0; c < present.size(); ++c)
        if (!is_void[c] && near[c])
          full.push_back(present[c]);
      const FullBody body(full, communicator);
      std::vector<double> result(is_void.size(), 0.);
      for (std::size_t c = 0; c < is_void.size(); ++c)
        if (wanted[c])
          result[c] = share_in(body, mesh[c]);
      return result;
    }

    /** Whether measure() was called. */
    bool is_measured() const
    {
      return !shares.empty();
    }

    /** The share of a cell of this rank. */
    double share(const std::size_t cell) const
    {
      return shares[cell];
    }

    /** Sets the share of a cell to zero. */
    void discard(const std::size_t cell)
    {
      shares[cell] = 0.;
    }

    /** Which cells are void then. Only those that @p may_change become full or void; all cells
     * around their corners must be @p near. The same on all ranks. Collective. */
    std::vector<bool> choose(const std::vector<bool> &is_void, const std::vector<bool> &near,
                             const std::vector<bool> &may_change) const
    {
      constexpr double filled_from = 0.6, emptied_below = 0.4; // shares
      std::vector<KnownCell> own, cells;
      for (std::size_t c = 0; c < is_void.size(); ++c)
        if (near[c])
          own.push_back(
              {corner_ids[c], shares[c],
               may_change[c] ? shares[c] < (is_void[c] ? filled_from : emptied_below) : is_void[c],
               may_change[c]});
      std::size_t first_of_rank = 0;
      const auto rank_cells = items_by_rank(own, communicator);
      for (unsigned int rank = 0; rank < rank_cells.size(); ++rank)
      {
        if (rank == dealii::Utilities::MPI::this_mpi_process(communicator))
          first_of_rank = cells.size();
        cells.insert(cells.end(), rank_cells[rank].begin(), rank_cells[rank].end());
      }
      Sheets(cells).correct();
      std::vector<bool> result = is_void;
      for (std::size_t c = 0, next = first_of_rank; c < is_void.size(); ++c)
        if (near[c])
          result[c] = cells[next++].is_void;
      return result;
    }

  private:
    /** Checks whether points are in one of the full cells of all ranks. */
    class FullBody
    {
    public:
      /** Collective. */
      FullBody(const std::vector<Corners> &own_cells, const MPI_Comm communicator)
      {
        for (const auto &one_rank : items_by_rank(own_cells, communicator))
          for (const Corners &corners : one_rank)
            add(corners);
        tree.emplace(dealii::pack_rtree_of_indices(boxes));
      }

      bool contains(const dealii::Point<dim> &point) const
      {
        std::vector<std::size_t> found;
        tree->query(boost::geometry::index::intersects(point), std::back_inserter(found));
        return std::any_of(found.begin(), found.end(),
                           [&](const std::size_t cell) { return is_inside(cell, point); });
      }

    private:
      void add(const Corners &corners)
      {
        boxes.emplace_back(std::vector<dealii::Point<dim>>(corners.begin(), corners.end()));
        for (const auto &simplex : CellSimplices<dim>::all())
        {
          const auto vertices = CellSimplices<dim>::vertices(simplex, corners);
          coordinates.emplace_back();
          if (CellSimplices<dim>::volume(vertices) > 0.)
            coordinates.back().emplace(vertices);
        }
      }

      bool is_inside(const std::size_t cell, const dealii::Point<dim> &point) const
      {
        constexpr double tolerance = 1e-12;
        const std::size_t n = CellSimplices<dim>::all().size();
        for (std::size_t s = cell * n; s < (cell + 1) * n; ++s)
        {
          if (!coordinates[s])
            continue;
          double values[dim + 1];
          coordinates[s]->evaluate(point, values);
          if (*std::min_element(values, values + dim + 1) > -tolerance)
            return true;
        }
        return false;
      }

      std::vector<dealii::BoundingBox<dim>> boxes;
      std::vector<std::optional<BarycentricCoordinates<dim>>> coordinates; // of simplices, by cell
      std::optional<decltype(dealii::pack_rtree_of_indices(boxes))> tree;
    };

    static double share_in(const FullBody &body, const Corners &corners)
    {
      constexpr unsigned int n_along = dim == 2 ? 8 : 4,
                             n = dim == 2 ? n_along * n_along : n_along * n_along * n_along;
      unsigned int n_inside = 0;
      for (unsigned int i = 0; i < n; ++i)
      {
        const unsigned int steps[3] = {i % n_along, i / n_along % n_along, i / n_along / n_along};
        dealii::Point<dim> in_cell, point;
        for (unsigned int d = 0; d < dim; ++d)
          in_cell[d] = (steps[d] + 0.5) / n_along;
        for (unsigned int k = 0; k < corners.size(); ++k)
          point += dealii::GeometryInfo<dim>::d_linear_shape_function(in_cell, k) * corners[k];
        n_inside += body.contains(point) ? 1 : 0;
      }
      return static_cast<double>(n_inside) / n;
    }

    /** The data of a cell that all ranks have. */
    struct KnownCell
    {
      Ids ids;
      double share;
      bool is_void, may_change;
    };

    /** Joins and parts cells around nodes. */
    class Sheets
    {
    public:
      explicit Sheets(std::vector<KnownCell> &cells) : cells(cells)
      {
        for (unsigned int c = 0; c < cells.size(); ++c)
          for (const std::uint64_t id : cells[c].ids)
            stars[id].push_back(c);
        // So that ties are decided alike for all distributions of cells over ranks.
        for (auto &[id, star] : stars)
          sort(star);
      }

      void correct()
      {
        constexpr unsigned int most_sweeps = 20;
        bool has_changed = true;
        for (unsigned int sweep = 0; sweep < most_sweeps && has_changed; ++sweep)
        {
          has_changed = false;
          // Cells are only emptied in the end, so that sweeps do not undo each other.
          const bool may_fill = 2 * sweep < most_sweeps;
          for (const auto &[id, star] : stars)
            if (std::any_of(star.begin(), star.end(),
                            [&](const unsigned int c) { return cells[c].may_change; }))
              has_changed = correct_node(star, may_fill) || has_changed;
        }
      }

    private:
      using Group = std::vector<unsigned int>;

      void sort(Group &group) const
      {
        std::sort(group.begin(), group.end(),
                  [this](const unsigned int a, const unsigned int b)
                  { return cells[a].ids < cells[b].ids; });
      }

      bool share_a_face(const unsigned int a, const unsigned int b) const
      {
        unsigned int n = 0;
        for (const std::uint64_t id : cells[a].ids)
          n += static_cast<unsigned int>(std::count(cells[b].ids.begin(), cells[b].ids.end(), id));
        return n == 1u << (dim - 1);
      }

      /** The void or the full cells around a node, those together that are joined by faces. */
      std::vector<Group> groups(const Group &star, const bool is_void) const
      {
        std::vector<Group> result;
        for (const unsigned int c : star)
        {
          if (cells[c].is_void != is_void)
            continue;
          Group joined{c};
          for (auto group = result.begin(); group != result.end();)
            if (std::any_of(group->begin(), group->end(),
                            [&](const unsigned int other) { return share_a_face(c, other); }))
            {
              joined.insert(joined.end(), group->begin(), group->end());
              group = result.erase(group);
            }
            else
              ++group;
          sort(joined);
          result.push_back(std::move(joined));
        }
        return result;
      }

      /** The error where these cells become full or void, in shares; nothing if one must stay. */
      std::optional<double> cost(const Group &group, const bool fills) const
      {
        if (std::any_of(group.begin(), group.end(),
                        [&](const unsigned int c)
                        { return !cells[c].may_change || (fills && !(cells[c].share > 0.)); }))
          return {};
        return error(group, fills);
      }

      double error(const Group &group, const bool fills) const
      {
        double result = 0;
        for (const unsigned int c : group)
          result += fills ? 1. - cells[c].share : cells[c].share;
        return result;
      }

      /** All cells of these groups except those of the most expensive one. */
      Group but_the_largest(const std::vector<Group> &all, const bool fills) const
      {
        const auto largest = std::max_element(all.begin(), all.end(),
                                              [&](const Group &a, const Group &b)
                                              { return error(a, fills) < error(b, fills); });
        Group result;
        for (auto group = all.begin(); group != all.end(); ++group)
          if (group != largest)
            result.insert(result.end(), group->begin(), group->end());
        return result;
      }

      bool correct_node(const Group &star, const bool may_fill)
      {
        const std::vector<Group> full = groups(star, false), empty = groups(star, true);
        const bool is_whole = star.size() >= (1u << dim); // not at the end of the mesh
        if (full.size() > 1)
        {
          Group all_void;
          for (const Group &group : empty)
            all_void.insert(all_void.end(), group.begin(), group.end());
          return apply_cheaper(but_the_largest(full, false), all_void, may_fill);
        }
        if (empty.size() < 2 || !is_whole)
          return false;
        // The full cell that parts the void ones with the least of the body.
        Group parting;
        for (const unsigned int c : full.empty() ? Group() : full.front())
          if (cells[c].may_change &&
              (parting.empty() || cells[c].share < cells[parting.front()].share))
            parting = {c};
        return apply_cheaper(parting, but_the_largest(empty, true), may_fill);
      }

      bool apply_cheaper(const Group &to_empty, const Group &to_fill, const bool may_fill)
      {
        const auto emptying_cost = to_empty.empty() ? std::nullopt : cost(to_empty, false);
        const auto filling_cost = to_fill.empty() || !may_fill ? std::nullopt : cost(to_fill, true);
        if (!emptying_cost && !filling_cost)
          return false;
        const bool fills = filling_cost && (!emptying_cost || *filling_cost <= *emptying_cost);
        for (const unsigned int c : fills ? to_fill : to_empty)
          cells[c].is_void = !fills;
        return true;
      }

      std::vector<KnownCell> &cells;
      std::map<std::uint64_t, Group> stars;
    };

    std::vector<Ids> corner_ids;
    MPI_Comm communicator;
    std::vector<double> shares;
  };

  extern template class CellFilling<2>;
  extern template class CellFilling<3>;
} // namespace tombolo
