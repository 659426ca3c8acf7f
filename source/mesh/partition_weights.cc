#include <tombolo/mesh/partition_weights.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  template <int dim>
  void balance(Mesh<dim> &mesh, const PartCells<dim> &part_cells,
               const std::vector<double> &work_of_part)
  {
    // Whole numbers with four digits: p4est adds them in 64 bits.
    const double largest = *std::max_element(work_of_part.begin(), work_of_part.end());
    std::vector<unsigned int> weights;
    for (const double work : work_of_part)
    {
      Assert(work > 0 && std::isfinite(work), dealii::ExcMessage("Work must be positive."));
      weights.push_back(std::max(1u, static_cast<unsigned int>(std::lround(1e4 * work / largest))));
    }

    using Triangulation = dealii::Triangulation<dim>;
    const auto connection = mesh.triangulation.signals.weight.connect(
        [&](const typename Triangulation::cell_iterator &cell,
            const typename Triangulation::CellStatus)
        { return weights[part_cells.part_of(cell)]; });
    mesh.triangulation.repartition();
    connection.disconnect();
  }

  template void balance(Mesh<2> &, const PartCells<2> &, const std::vector<double> &);
  template void balance(Mesh<3> &, const PartCells<3> &, const std::vector<double> &);
} // namespace tombolo
