// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/energy_ledger.h>
#include <tombolo/physics/remeshing/part_refill.h>
#include <tombolo/remesh/nodal_projection.h>
#include <tombolo/remesh/point_remap.h>
#include <tombolo/remesh/simplex_overlaps.h>

#include <deal.II/base/mpi.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <memory>
#include <string>

/** Microseconds per cell of refills of a disordered block of smoothed cells whose inner nodes all
 * move, so that all cells do, with velocities and heat: a whole refill, and what it consists of. */
namespace tombolo
{
  namespace
  {
    using namespace dealii;

    constexpr double disorder = 0.2; // of the size of a cell
    using Cells = std::vector<RemapCell<3>>;

    class Block
    {
    public:
      explicit Block(const bool slides = false, const unsigned int n_along_axis = 16)
          : parameters(MPI_COMM_SELF), n_along_axis(n_along_axis), slides(slides)
      {
        const std::string n = std::to_string(n_along_axis);
        parameters.read_text(
            "set Dimension = 3\nset Materials = m\nset Parts = a\nsubsection "
            "Mesh\nset Type = box\n"
            "subsection box\nset Upper corner = " +
                n + ", " + n + ", " + n + "\nset Cells = " + n + ", " + n + ", " + n +
                "\nend\nend\nsubsection Material: m\nset Model = j2 plasticity\n"
                "subsection j2 plasticity\nset Density = 1\nset Young's modulus = 1\n"
                "set Poisson's ratio = 0.3\nset Taylor-Quinney coefficient = 0.9\n"
                "set Flow stress = linear hardening\nsubsection linear hardening\n"
                "set Yield stress = 0.002\nset Hardening modulus = 0\nend\nend\n"
                "subsection Heat\nset Specific heat capacity = 1\nset Conductivity = 1\n"
                "set Initial temperature = 0\nend\nend\n"
                "subsection Part: a\nset Cells = all\nset Material = m\n"
                "set Formulation = smoothed cells\nsubsection smoothed cells\n"
                "set Refill stretch = 1.0001\nset Refill surface = " +
                (slides ? "sliding" : "held") + "\nend\nend\n",
            "benchmark.prm");
        declare_model<3>(parameters);
        parameters.handler().declare_entry("End time", "1", Patterns::Double());
        parameters.assign();
        model = std::make_unique<Model<3>>(parameters, MPI_COMM_SELF);
        cells = dynamic_cast<SmoothedCells<3> *>(model->parts[0].formulation.get());
        refill = std::make_unique<PartRefill<3>>(*model, 0, *cells, 1.);
        ThermalState &thermal = model->heat->state;
        for (unsigned int i = 0; i < model->state.partition()->n_owned(); ++i)
        {
          for (unsigned int d = 0; d < 3; ++d)
            model->state.unsmoothed_velocity.node(i)[d] = std::sin(0.3 * i + d);
          for (NodalVector *const temperature :
               {&thermal.unsmoothed_temperature, &thermal.next_unsmoothed_temperature,
                &thermal.present_temperature})
            *temperature->node(i) = 2. + std::sin(0.2 * i);
        }
        model->state.unsmoothed_velocity.update_ghosts();
        disturb();
      }

      /** Moves the inner nodes about, as material that has been deformed, and those of sides that
       * slide along them. */
      void disturb()
      {
        NodalVector &position = model->state.position;
        const auto &lattice = model->state.initial_position;
        for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
        {
          const auto is_inside = [&](const unsigned int d)
          { return lattice.node(i)[d] > 0.5 && lattice.node(i)[d] < n_along_axis - 0.5; };
          const unsigned int n_fixed = !is_inside(0) + !is_inside(1) + !is_inside(2);
          for (unsigned int d = 0; d < 3 && n_fixed <= (slides ? 1 : 0); ++d)
            if (is_inside(d))
              position.node(i)[d] = lattice.node(i)[d] + disorder * std::sin(12.9898 * ++count);
        }
        position.update_ghosts();
      }

      /** The cells before and after a refill. */
      Cells moved_cells()
      {
        NodalVector after(model->state.partition());
        after.copy_from(model->state.position);
        disturb();
        Cells result;
        for (unsigned int c = 0; c < cells->n_cells(); ++c)
        {
          RemapCell<3> cell;
          const auto nodes = cells->nodes_of_cell(c);
          for (unsigned int k = 0; k < nodes.size(); ++k)
          {
            cell.nodes[k] = model->state.partition()->local_index(nodes[k]);
            for (unsigned int d = 0; d < 3; ++d)
            {
              cell.before[k][d] = model->state.position.node(cell.nodes[k])[d];
              cell.after[k][d] = after.node(cell.nodes[k])[d];
            }
          }
          const auto volumes = CellSimplices<3>::volumes(cell.before);
          std::copy(volumes.begin(), volumes.end(), cell.mass.begin());
          result.push_back(cell);
        }
        return result;
      }

      /** The masses of nodes that the integrals over these cells have. */
      NodalVector nodal_mass(const Cells &before) const
      {
        NodalVector result(model->state.partition(), Quantity::scalar);
        for (const RemapCell<3> &cell : before)
        {
          const auto corner_masses = masses_of_corners<3>(cell.before, cell.mass.data());
          for (unsigned int k = 0; k < corner_masses.size(); ++k)
            *result.node(cell.nodes[k]) += corner_masses[k];
        }
        return result;
      }

      Parameters parameters;
      unsigned int n_along_axis;
      bool slides;
      EnergyLedger ledger;
      std::unique_ptr<Model<3>> model;
      SmoothedCells<3> *cells;
      std::unique_ptr<PartRefill<3>> refill;
      Clock clock;
      unsigned int count = 0;
    };

    void set_time_per_cell(benchmark::State &state, const Cells &cells)
    {
      state.counters["us/cell"] = benchmark::Counter(static_cast<double>(cells.size()) * 1e-6,
                                                     benchmark::Counter::kIsIterationInvariantRate |
                                                         benchmark::Counter::kInvert);
    }

    void whole_refill(benchmark::State &state, const bool slides, const unsigned int n_along_axis)
    {
      Block block(slides, n_along_axis);
      const Cells cells = block.moved_cells();
      for (auto _ : state)
      {
        state.PauseTiming();
        block.disturb();
        state.ResumeTiming();
        if (!block.refill->refill(*block.model, block.clock) ||
            block.refill->moved_nodes().size() <
                (n_along_axis - 1) * (n_along_axis - 1) * (n_along_axis - 1))
          state.SkipWithError("Nodes stayed.");
      }
      set_time_per_cell(state, cells);
    }

    void find_distorted(benchmark::State &state)
    {
      Block block;
      const Cells cells = block.moved_cells();
      for (auto _ : state)
        benchmark::DoNotOptimize(block.cells->distorted_cells(block.model->state.position));
      set_time_per_cell(state, cells);
    }

    void new_rows(benchmark::State &state)
    {
      Block block;
      const Cells cells = block.moved_cells();
      for (auto _ : state)
        block.cells->renew_reference(block.model->state.position);
      set_time_per_cell(state, cells);
    }

    void overlap(benchmark::State &state, const bool is_cut)
    {
      Block block;
      Cells cells = block.moved_cells();
      for (RemapCell<3> &cell : cells)
        cell.is_cut = is_cut;
      const NodalVector &field = block.model->state.unsmoothed_velocity;
      for (auto _ : state)
        benchmark::DoNotOptimize(CellOverlap<3>(cells, {&field, &field}, MPI_COMM_SELF).has_motion);
      set_time_per_cell(state, cells);
    }

    void points(benchmark::State &state)
    {
      Block block;
      const Cells cells = block.moved_cells();
      const CellOverlap<3> overlap(cells, {}, MPI_COMM_SELF);
      PointValues values;
      values.n_components = block.cells->point_state().n_components();
      values.stress = 0;
      for (const RemapCell<3> &cell : cells)
        values.mass.insert(values.mass.end(), cell.mass.begin(), cell.mass.end());
      for (std::size_t i = 0; i < values.mass.size() * values.n_components; ++i)
        values.values.push_back(std::sin(0.1 * static_cast<double>(i)));
      for (auto _ : state)
      {
        PointValues remapped = values;
        remap_points(overlap, block.model->state.partition(), remapped);
      }
      set_time_per_cell(state, cells);
    }

    void projection(benchmark::State &state)
    {
      Block block;
      const Cells cells = block.moved_cells();
      NodalVector &field = block.model->state.unsmoothed_velocity;
      const NodalVector mass = block.nodal_mass(cells);
      const CellOverlap<3> overlap(cells, {&field}, MPI_COMM_SELF);
      for (auto _ : state)
      {
        NodalVector projected(field.partition());
        projected.copy_from(field);
        project_nodal_field(overlap, 0, mass, mass, projected);
      }
      set_time_per_cell(state, cells);
    }

    /** Pairs of tetrahedra, cut as polyhedra or into pieces that are tetrahedra. */
    void pairs(benchmark::State &state, const bool as_polyhedra)
    {
      constexpr unsigned int n_pairs = 32; // as many as one new tetrahedron has
      constexpr std::uint8_t vertices[8] = {0, 1, 2, 3, 0, 0, 0, 0};
      double points[n_pairs][4][16] = {};
      for (unsigned int i = 0; i < n_pairs; ++i)
        for (unsigned int k = 0; k < 4; ++k)
        {
          points[i][0][k] = 1.;
          for (unsigned int j = 1; j < 4; ++j)
          {
            points[i][j][k] = 0.3 + 0.9 * std::sin(12.9898 * (i + 1) * (k + 1) + 78.233 * j);
            points[i][0][k] -= points[i][j][k];
          }
        }
      SimplexOverlaps<3> overlaps;
      OverlapMoments<3> moments;
      for (auto _ : state)
        if (as_polyhedra)
        {
          overlaps.clear();
          for (const auto &old : points)
            overlaps.add(old, vertices);
          overlaps.clip();
          for (const unsigned int number : overlaps.left())
          {
            overlaps.find_moments(number, moments);
            benchmark::DoNotOptimize(moments);
          }
        }
        else
          for (const auto &old : points)
          {
            SimplexOverlap::Piece<3> piece;
            for (unsigned int k = 0; k < 4; ++k)
              for (unsigned int j = 0; j < 4; ++j)
                piece[k].in_new[j] = old[j][k];
            moments = {};
            SimplexOverlap::clip<3>(piece, 0, [&](const auto &part) { moments.add(part); });
            benchmark::DoNotOptimize(moments);
          }
      state.counters["ns/pair"] =
          benchmark::Counter(n_pairs * 1e-9, benchmark::Counter::kIsIterationInvariantRate |
                                                 benchmark::Counter::kInvert);
    }

    void add(const std::string &label, const std::function<void(benchmark::State &)> &measure)
    {
      benchmark::RegisterBenchmark(label.c_str(), measure)->Unit(benchmark::kMillisecond);
    }
  } // namespace
} // namespace tombolo

int main(int argc, char **argv)
{
  using namespace tombolo;
  dealii::Utilities::MPI::MPI_InitFinalize mpi(argc, argv, 1);
  for (const unsigned int n_along_axis : {16, 31})
    for (const bool slides : {false, true})
      add(std::string("whole_refill_of_") + std::to_string(n_along_axis) + "_along_an_axis" +
              (slides ? "_with_sliding_surface" : ""),
          [=](benchmark::State &state) { whole_refill(state, slides, n_along_axis); });
  add("look_for_distorted_cells", find_distorted);
  add("new_rows", new_rows);
  add("overlap", [](benchmark::State &state) { overlap(state, false); });
  add("overlap_with_moving_surface", [](benchmark::State &state) { overlap(state, true); });
  add("pairs_by_pieces", [](benchmark::State &state) { pairs(state, false); });
  add("pairs_as_polyhedra", [](benchmark::State &state) { pairs(state, true); });
  add("points", points);
  add("projection_of_one_field", projection);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::ClearRegisteredBenchmarks();
  return 0;
}
