// SPDX-License-Identifier: LGPL-2.1-or-later
// ranks: 1 2 3
#include <tombolo/physics/remeshing/cell_filling.h>

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

namespace
{
  using namespace tombolo;
  using namespace dealii;

  /** Cubes of size one in a row-wise lattice, of which every rank has some. */
  template <int dim>
  class Lattice
  {
  public:
    using Filling = CellFilling<dim>;
    using Motion = std::function<Point<dim>(const Point<dim> &)>;
    static constexpr unsigned int n_corners = Filling::n_corners;

    explicit Lattice(const unsigned int n) : n(n)
    {
      const unsigned int rank = Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
      const unsigned int n_ranks = Utilities::MPI::n_mpi_processes(MPI_COMM_WORLD);
      const auto n_cells = static_cast<unsigned int>(std::lround(std::pow(n, dim)));
      for (unsigned int c = 0; c < n_cells; ++c)
        if (c * n_ranks / n_cells == rank)
        {
          Point<dim> low;
          for (unsigned int d = 0, rest = c; d < dim; ++d, rest /= n)
            low[d] = rest % n;
          middle.push_back(low);
          ids.emplace_back();
          mesh.emplace_back();
          for (unsigned int k = 0; k < n_corners; ++k)
          {
            std::uint64_t id = 0;
            for (unsigned int d = dim; d-- > 0;)
            {
              mesh.back()[k][d] = low[d] + ((k >> d) & 1u);
              id = id * (n + 1) + static_cast<std::uint64_t>(mesh.back()[k][d]);
            }
            ids.back()[k] = id;
          }
          for (unsigned int d = 0; d < dim; ++d)
            middle.back()[d] += 0.5;
        }
    }

    /** Void cells after the full ones have moved to other positions. */
    std::vector<bool> after(const std::vector<bool> &is_void, const Motion &motion) const
    {
      Filling filling(ids, MPI_COMM_WORLD);
      std::vector<typename Filling::Corners> present = mesh;
      for (auto &corners : present)
        for (Point<dim> &corner : corners)
          corner = motion(corner);
      const std::vector<bool> all(is_void.size(), true);
      filling.measure(is_void, present, all, mesh, all);
      return filling.choose(is_void, all, all);
    }

    std::vector<bool> where(const std::function<bool(const Point<dim> &)> &is_void) const
    {
      std::vector<bool> result;
      for (const Point<dim> &x : middle)
        result.push_back(is_void(x));
      return result;
    }

    unsigned int n;
    std::vector<Point<dim>> middle;
    std::vector<typename Filling::Ids> ids;
    std::vector<typename Filling::Corners> mesh;
  };

  template <int dim>
  void expect_follows_motion()
  {
    const Lattice<dim> lattice(6);
    const auto half = [](const Point<dim> &x) { return x[dim - 1] > 3.; };
    // The bottom stays, and the top of the lower half goes this way.
    const auto up = [](const double way)
    {
      return [way](Point<dim> x)
      {
        x[dim - 1] *= 1. + way / 3.;
        return x;
      };
    };
    const std::vector<bool> start = lattice.where(half);
    EXPECT_EQ(lattice.after(start, up(0.)), start);
    EXPECT_EQ(lattice.after(start, up(0.5)), start); // within the hysteresis, which keeps cells
    EXPECT_EQ(lattice.after(start, up(-0.5)), start);
    EXPECT_EQ(lattice.after(start, up(0.7)),
              lattice.where([](const Point<dim> &x) { return x[dim - 1] > 4.; }));
    EXPECT_EQ(lattice.after(start, up(-0.7)),
              lattice.where([](const Point<dim> &x) { return x[dim - 1] > 2.; }));
  }

  TEST(CellFilling, follows_the_motion_of_the_body)
  {
    expect_follows_motion<2>();
    expect_follows_motion<3>();
  }

  template <int dim>
  void expect_joins_diagonals()
  {
    // Two cubes of cells that touch at an edge or a corner alone, or two holes that do.
    const Lattice<dim> lattice(6);
    for (const unsigned int n_apart : {2u, dim == 3 ? 3u : 2u})
    {
      const auto in_cubes = [&](const Point<dim> &x)
      {
        bool first = true, second = true;
        for (unsigned int d = 0; d < dim; ++d)
        {
          first = first && x[d] > 1. && x[d] < 3.;
          second = second && (d < n_apart ? x[d] > 3. && x[d] < 5. : x[d] > 1. && x[d] < 3.);
        }
        return first || second;
      };
      for (const bool are_holes : {false, true})
      {
        const auto start =
            lattice.where([&](const Point<dim> &x) { return in_cubes(x) == are_holes; });
        const auto still = lattice.after(start, [](const Point<dim> &x) { return x; });
        // Around the node between them, full and void cells are joined by faces.
        std::vector<double> around(std::size_t(1) << dim, 0.);
        for (std::size_t c = 0; c < lattice.middle.size(); ++c)
        {
          std::size_t corner = 0;
          bool is_next = true;
          for (unsigned int d = 0; d < dim; ++d)
          {
            is_next = is_next && std::abs(lattice.middle[c][d] - 3.) < 1.;
            corner += lattice.middle[c][d] > 3. ? std::size_t(1) << d : 0u;
          }
          if (is_next && !still[c])
            around[corner] = 1.;
        }
        Utilities::MPI::sum(around, MPI_COMM_WORLD, around);
        for (const double flag : {0., 1.})
        {
          std::vector<std::size_t> reached;
          for (std::size_t k = 0; k < around.size() && reached.empty(); ++k)
            if (around[k] == flag)
              reached.push_back(k);
          for (std::size_t next = 0; next < reached.size(); ++next)
            for (unsigned int d = 0; d < dim; ++d)
            {
              const std::size_t other = reached[next] ^ (std::size_t(1) << d);
              if (around[other] == flag &&
                  std::find(reached.begin(), reached.end(), other) == reached.end())
                reached.push_back(other);
            }
          EXPECT_EQ(reached.size(),
                    static_cast<std::size_t>(std::count(around.begin(), around.end(), flag)))
              << n_apart << are_holes << flag;
        }
      }
    }
  }

  TEST(CellFilling, joins_or_parts_cells_that_touch_at_edges_and_corners)
  {
    expect_joins_diagonals<2>();
    expect_joins_diagonals<3>();
  }
} // namespace
