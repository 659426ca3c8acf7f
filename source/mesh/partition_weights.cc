// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/mesh/partition_weights.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  namespace
  {
    template <int dim>
    double box_ratio(const typename dealii::Triangulation<dim>::cell_iterator &cell)
    {
      return cell->bounding_box().volume() / cell->measure();
    }
  } // namespace

  template <int dim>
  void balance(Mesh<dim> &mesh, const PartCells<dim> &part_cells,
               const std::vector<std::function<double(double)>> &work_of_part)
  {
    using Triangulation = dealii::Triangulation<dim>;
    const auto connection = mesh.triangulation.signals.weight.connect(
        [&](const typename Triangulation::cell_iterator &cell,
            const typename Triangulation::CellStatus)
        {
          const double work = work_of_part[part_cells.part_of(cell)](box_ratio<dim>(cell));
          Assert(work > 0 && std::isfinite(work), dealii::ExcMessage("Work must be positive."));
          // p4est adds whole numbers in 64 bits: a tenth of a cost unit is its resolution.
          constexpr double weight_per_unit = 10., largest_weight = 1e9;
          return static_cast<unsigned int>(std::clamp(weight_per_unit * work, 1., largest_weight));
        });
    mesh.triangulation.repartition();
    connection.disconnect();
  }

  template void balance(Mesh<2> &, const PartCells<2> &,
                        const std::vector<std::function<double(double)>> &);
  template void balance(Mesh<3> &, const PartCells<3> &,
                        const std::vector<std::function<double(double)>> &);
} // namespace tombolo
