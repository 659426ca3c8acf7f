// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/remesh/cell_simplices.h>

#include <deal.II/base/mpi.h>

#include <array>
#include <cstdint>
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
    CellFilling(std::vector<Ids> ids, MPI_Comm communicator);

    /** Finds how much of the cells with the corners @p mesh, of those that are @p wanted, is in the
     * full cells with the corners @p present, of those that are @p near: by the share of 64
     * places. Cells that are not wanted count as they are. Collective. */
    void measure(const std::vector<bool> &is_void, const std::vector<Corners> &present,
                 const std::vector<bool> &near, const std::vector<Corners> &mesh,
                 const std::vector<bool> &wanted);

    /** The shares of cells that measure() finds, of wanted ones; zero of others. Collective. */
    std::vector<double> shares_in(const std::vector<bool> &is_void,
                                  const std::vector<Corners> &present,
                                  const std::vector<bool> &near, const std::vector<Corners> &mesh,
                                  const std::vector<bool> &wanted) const;

    /** Whether there was a measure() yet. */
    bool is_measured() const
    {
      return !shares.empty();
    }

    /** The share of a cell of this rank. */
    double share(const std::size_t cell) const
    {
      return shares[cell];
    }

    /** Lets a cell count as if the body had nothing of it. */
    void discard(const std::size_t cell)
    {
      shares[cell] = 0.;
    }

    /** Which cells are void then. Only those that @p may_change become full or void; all cells
     * around their corners must be @p near. The same on all ranks. Collective. */
    std::vector<bool> choose(const std::vector<bool> &is_void, const std::vector<bool> &near,
                             const std::vector<bool> &may_change) const;

  private:
    std::vector<Ids> corner_ids;
    MPI_Comm communicator;
    std::vector<double> shares;
  };
} // namespace tombolo
