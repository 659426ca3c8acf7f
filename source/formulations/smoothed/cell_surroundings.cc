// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/formulations/smoothed/cell_surroundings.h>

#include <deal.II/numerics/rtree.h>

#include <algorithm>
#include <iterator>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  CellSurroundings<dim>::CellSurroundings(const PartSetup<dim> &setup, const double dilation)
      : cells(smoothed_cells_of(setup)), cloud(setup, dilation, cells), shared_facets(cells),
        first(1, 0)
  {
    const std::vector<BoundingBox<dim>> boxes = cloud.boxes();
    const auto tree = pack_rtree_of_indices(boxes);
    std::vector<std::size_t> found;
    for (const SmoothedCell<dim> &cell : cells)
    {
      found.clear();
      tree.query(boost::geometry::index::intersects(cell.box()), std::back_inserter(found));
      std::sort(found.begin(), found.end());
      reaching.insert(reaching.end(), found.begin(), found.end());
      first.push_back(reaching.size());
    }
  }

  template <int dim>
  void CellSurroundings<dim>::find_neighbours(const std::size_t cell,
                                              std::vector<std::size_t> &result) const
  {
    const double body =
        cloud.body.empty() ? 0. : cloud.body[cloud.place_of(cells[cell].nodes.front())];
    result.clear();
    for (std::size_t k = first[cell]; k < first[cell + 1]; ++k)
    {
      const std::size_t i = reaching[k];
      if ((cloud.is_void.empty() || !cloud.is_void[i]) &&
          (cloud.body.empty() || cloud.body[i] == body))
        result.push_back(i);
    }
  }

  template <int dim>
  std::vector<bool> CellSurroundings<dim>::reaches_cells() const
  {
    std::vector<bool> result(cloud.node.size(), false);
    for (const unsigned int i : reaching)
      result[i] = true;
    return result;
  }

  template class CellSurroundings<2>;
  template class CellSurroundings<3>;
} // namespace tombolo
