// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/output/output.h>

#include <deal.II/grid/grid_generator.h>

#include <algorithm>
#include <array>
#include <memory>
#include <set>
#include <string>
#include <vector>

/** A scene of elements and particles without physics, whose fields are known functions of the
 * initial position X, so that what is written can be checked: x = 1.1 X, v = (X, 2, Y), v̂ = 3 v, a
 * reaction (0, X, 0), and at material points stress component c = (c + 1) X,
 * J = 1 + X/100. */
namespace mock
{
  using namespace tombolo;

  inline double stress(const double x, const unsigned int component)
  {
    return (component + 1) * x;
  }

  inline void fill(MaterialPoints &points, const std::vector<double> &x, const std::string &own)
  {
    points.reinit(static_cast<unsigned int>(x.size()),
                  {{"common variable", "1", FieldLocation::material_point, 1, true},
                   {own, "M/T^2", FieldLocation::material_point, 1, true},
                   {"memory", "1", FieldLocation::material_point, 1, true, 8., true}});
    for (unsigned int i = 0; i < x.size(); ++i)
    {
      for (unsigned int c = 0; c < 6; ++c)
        points.component(MaterialPoints::stress, c)[i] = stress(x[i], c);
      points.component(MaterialPoints::volume, 0)[i] = 0.5;
      points.component(MaterialPoints::volume_ratio, 0)[i] = 1 + x[i] / 100;
      points.component(MaterialPoints::n_standard_fields, 0)[i] = x[i] * x[i];
      points.component(MaterialPoints::n_standard_fields + 1, 0)[i] = 7;
    }
  }

  /** What no output requests. */
  template <int dim, typename Base>
  class Inert : public Base
  {
  public:
    unsigned int degree() const override
    {
      return 0;
    }
    void initialize(const PartSetup<dim> &) override {}
    dealii::IndexSet required_nodes() const override
    {
      return {};
    }
    void set_partition(const NodePartition &) override {}
    void add_mass(NodalVector &) const override {}
    void add_internal_force(const MechanicalInput &, NodalVector &) override {}
    void apply_elastic_stiffness(const NodalVector &, const NodalVector &, double,
                                 NodalVector &) const override
    {}
    EnergyAccounts energies() const override
    {
      return {};
    }
    void point_positions(const NodalVector &, std::vector<dealii::Point<dim>> &) const override {}
    const std::vector<dealii::Point<dim>> &initial_point_positions() const override
    {
      return positions;
    }
    std::vector<dealii::Point<dim>> positions;

    std::vector<double> x_of_points() const
    {
      std::vector<double> result;
      for (const auto &position : positions)
        result.push_back(position[0]);
      return result;
    }
  };

  /** Cells of degree 1 with a point between the centre and each corner; of higher degree with a
   * point at each node, the last node first. */
  template <int dim>
  class Elements : public Inert<dim, Formulation<dim>>
  {
  public:
    Elements(const Nodes<dim> &nodes, const PartCells<dim> &part_cells, const unsigned int part)
        : points_per_cell(dealii::Utilities::fixed_power<dim>(nodes.degree() + 1))
    {
      std::vector<dealii::Point<dim>> corners;
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
        if (cell->is_locally_owned() && part_cells.part_of(cell) == part)
        {
          nodes.cell_points(cell, corners);
          std::reverse(corners.begin(), corners.end());
          for (const auto &corner : corners)
            this->positions.push_back(
                nodes.degree() > 1 ? corner : corner + 0.5 * (cell->center() - corner));
          ++cells;
        }
      fill(this->points(), this->x_of_points(), "element variable");
    }
    unsigned int n_cells() const override
    {
      return cells;
    }
    unsigned int n_points_per_cell() const override
    {
      return points_per_cell;
    }

  private:
    unsigned int cells = 0, points_per_cell;
  };

  template <int dim>
  class Particles : public Inert<dim, ParticleFormulation<dim>>
  {
  public:
    Particles(const Nodes<dim> &nodes, const PartCells<dim> &part_cells, const unsigned int part,
              const NodalState &state)
    {
      const NodePartition &partition = *state.partition();
      std::set<unsigned int> own;
      std::vector<dealii::types::global_dof_index> cell_nodes;
      for (const auto &cell : nodes.dof_handler().active_cell_iterators())
        if (!cell->is_artificial() && part_cells.part_of(cell) == part)
        {
          nodes.cell_nodes(cell, cell_nodes);
          for (const auto node : cell_nodes)
            if (partition.owned().is_element(node))
              own.insert(partition.local_index(node));
        }
      for (const unsigned int node : own)
      {
        shape.particle_node.push_back(node);
        shape.mass.push_back(0.25);
        dealii::Point<dim> point;
        for (unsigned int d = 0; d < dim; ++d)
          point[d] = state.initial_position.node(node)[d];
        this->positions.push_back(point);
      }
      shape.row_start.assign(own.size() + 1, 0);
      shape.coefficient_start.assign(own.size(), 0);
      fill(this->points(), this->x_of_points(), "particle variable");
    }
    unsigned int n_cells() const override
    {
      return 0;
    }
    unsigned int n_points_per_cell() const override
    {
      return 1;
    }
    const ParticleSet<dim> &particle_set() const override
    {
      return set;
    }
    const Stencils &stencils() const override
    {
      return shape;
    }
    Stencils &stencils() override
    {
      return shape;
    }
    SmoothingSettings smoothing() const override
    {
      return {};
    }
    double smallest_spacing() const override
    {
      return 0;
    }
    NeighbourCounts neighbour_counts() const override
    {
      return {};
    }
    dealii::Tensor<2, dim> deformation(unsigned int, const NodalVector &) const override
    {
      return 1.1 * dealii::Tensor<2, dim>(dealii::unit_symmetric_tensor<dim>());
    }
    dealii::Point<dim> support(const unsigned int i) const override
    {
      dealii::Point<dim> result = 0.1 * this->positions[i];
      result[dim - 1] = 5;
      return result;
    }

  private:
    ParticleSet<dim> set;
    Stencils shape;
  };

  /** A box of 4 x 2 (x 2) cells in [0, 4] x [0, 2] (x [0, 2]). */
  template <int dim>
  struct Model
  {
    /** Particles are the cells whose lower corner is at least at @p first_x and, if @p one_cell,
     * only the one in the corner. */
    Model(const unsigned int degree, const double first_x, const bool one_cell)
        : mesh(MPI_COMM_WORLD), parameters(MPI_COMM_WORLD)
    {
      std::vector<unsigned int> n_cells(dim, 2u);
      n_cells[0] = 4;
      dealii::Point<dim> lower, upper;
      for (unsigned int d = 0; d < dim; ++d)
        upper[d] = n_cells[d];
      dealii::GridGenerator::subdivided_hyper_rectangle(mesh.triangulation, n_cells, lower, upper);
      for (const auto &cell : mesh.triangulation.cell_iterators_on_level(0))
      {
        bool is_particle = cell->center()[0] > first_x;
        for (unsigned int d = 1; d < dim; ++d)
          is_particle = is_particle && (!one_cell || cell->center()[d] < 1);
        cell->set_material_id(is_particle ? 1 : 0);
      }

      parameters.read_text("subsection Part: <left> & \"right\"\n set Cells = material 0\nend\n"
                           "subsection Part: particles\n set Cells = material 1\nend\n",
                           "mock.prm");
      std::vector<Section> sections;
      for (const char *name : {"Part: <left> & \"right\"", "Part: particles"})
      {
        parameters.handler().enter_subsection(name);
        parameters.handler().declare_entry("Cells", "all");
        parameters.handler().leave_subsection();
      }
      parameters.assign();
      for (const char *name : {"Part: <left> & \"right\"", "Part: particles"})
        sections.push_back(parameters.section(name));
      part_cells = std::make_unique<PartCells<dim>>(sections, mesh);
      nodes = std::make_unique<Nodes<dim>>(mesh, degree);
      set_state();
      elements = std::make_unique<Elements<dim>>(*nodes, *part_cells, 0);
      particles = std::make_unique<Particles<dim>>(*nodes, *part_cells, 1, state);
    }

    void set_state()
    {
      const auto partition =
          std::make_shared<const NodePartition>(nodes->owned(), nodes->relevant(), MPI_COMM_WORLD);
      state.reinit(partition);
      std::vector<dealii::types::global_dof_index> cell_nodes;
      std::vector<dealii::Point<dim>> points;
      for (const auto &cell : nodes->dof_handler().active_cell_iterators())
        if (cell->is_locally_owned() || cell->is_ghost())
        {
          nodes->cell_nodes(cell, cell_nodes);
          nodes->cell_points(cell, points);
          for (std::size_t i = 0; i < points.size(); ++i)
            if (partition->has(cell_nodes[i]))
            {
              const unsigned int node = partition->local_index(cell_nodes[i]);
              const double velocity[3] = {points[i][0], 2., points[i][1]};
              for (unsigned int d = 0; d < 3; ++d)
              {
                const double x = d < dim ? points[i][d] : 0.;
                state.initial_position.node(node)[d] = x;
                state.position.node(node)[d] = 1.1 * x;
                state.velocity.node(node)[d] = velocity[d];
                state.unsmoothed_velocity.node(node)[d] = 3 * velocity[d];
              }
            }
        }
    }

    OutputView<dim> view(const double time, const std::uint64_t step) const
    {
      OutputView<dim> result;
      result.time = time;
      result.step = step;
      result.mesh = &mesh;
      result.nodes = nodes.get();
      result.part_cells = part_cells.get();
      result.state = &state;
      result.parts = {{"<left> & \"right\"", elements.get(), nullptr, nullptr, {}},
                      {"particles", particles.get(), particles.get(), &particles->stencils(), {}}};
      result.reaction = [this](const unsigned int node) {
        return std::array<double, 3>{{0., state.initial_position.node(node)[0], 0.}};
      };
      result.exact_stress = [](const dealii::Point<dim> &point, double)
      {
        dealii::SymmetricTensor<2, 3> exact;
        exact[0][0] = stress(point[0], 0);
        exact[1][1] = stress(point[0], 1);
        exact[2][2] = stress(point[0], 2);
        exact[1][2] = stress(point[0], 3);
        exact[0][2] = stress(point[0], 4);
        exact[0][1] = stress(point[0], 5);
        return exact;
      };
      return result;
    }

    Mesh<dim> mesh;
    Parameters parameters;
    std::unique_ptr<PartCells<dim>> part_cells;
    std::unique_ptr<Nodes<dim>> nodes;
    NodalState state;
    std::unique_ptr<Elements<dim>> elements;
    std::unique_ptr<Particles<dim>> particles;
  };

  /** The outputs that the text of section Output requests. */
  template <int dim>
  struct OutputsOf
  {
    explicit OutputsOf(const std::string &text) : parameters(MPI_COMM_WORLD)
    {
      parameters.read_text("subsection Output\n" + text + "end\n", "output.prm");
      parameters.handler().enter_subsection("Output");
      declare_outputs<dim>(parameters.handler());
      parameters.handler().leave_subsection();
      parameters.assign();
      outputs = create_outputs<dim>(parameters.section("Output"));
    }

    Parameters parameters;
    std::vector<std::unique_ptr<Output<dim>>> outputs;
  };
} // namespace mock
