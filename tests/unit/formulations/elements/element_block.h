// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_tools.h>

#include <tombolo/base/input/parameters.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/materials/material.h>

#include <cmath>
#include <functional>
#include <memory>
#include <sstream>
#include <string>
#include <vector>

/** One part of finite elements on a distorted block, for the tests and benchmarks of elements. */
namespace tombolo
{
  struct Vector3
  {
    Vector3(const double x = 0., const double y = 0., const double z = 0.) : components{x, y, z} {}
    double &operator[](const unsigned int d)
    {
      return components[d];
    }
    double operator[](const unsigned int d) const
    {
      return components[d];
    }
    double components[3];
  };
  using VectorFunction = std::function<Vector3(const Vector3 &)>;

  /** A formulation by its name, with the entries of its section as parameter file text. */
  struct ElementChoice
  {
    std::string name;
    std::string entries;
  };

  struct BlockSettings
  {
    double young = 200.;
    double poisson = 0.3;
    double density = 7.;
    unsigned int n_cells = 3; ///< along each axis
    double distortion = 0.2;  ///< of the vertices, in edge lengths
    double yield_stress = 0.; ///< zero: the material is elastic
    MPI_Comm communicator = MPI_COMM_WORLD;
  };

  template <int dim>
  class ElementBlock
  {
  public:
    explicit ElementBlock(const ElementChoice &choice, const BlockSettings &settings = {})
        : is_logarithmic(choice.entries.find("logarithmic") != std::string::npos),
          communicator(settings.communicator), mesh(settings.communicator)
    {
      Parameters parameters(communicator);
      const bool is_plastic = settings.yield_stress > 0.;
      const std::string model = is_plastic ? "j2 plasticity" : "elastic";
      parameters.read_text(
          "subsection formulation\nsubsection " + choice.name + "\n" + choice.entries +
              "\nend\nend\nsubsection material\nsubsection " + model + "\nset Density = " +
              number(settings.density) + "\nset Young's modulus = " + number(settings.young) +
              "\nset Poisson's ratio = " + number(settings.poisson) +
              (is_plastic ? "\nset Flow stress = linear hardening\nsubsection linear hardening\n"
                            "set Yield stress = " +
                                number(settings.yield_stress) + "\nend\n"
                          : "\n") +
              "end\nend\n",
          "block.prm");
      auto &registry = Registry<Formulation<dim>>::instance();
      parameters.handler().enter_subsection("formulation");
      registry.declare_all(parameters.handler());
      parameters.handler().leave_subsection();
      parameters.handler().enter_subsection("material");
      Registry<Material>::instance().declare_all(parameters.handler());
      parameters.handler().leave_subsection();
      parameters.assign();
      material =
          Registry<Material>::instance().create(model, parameters.section("material/" + model));
      formulation = registry.create(choice.name, parameters.section("formulation/" + choice.name));

      dealii::GridGenerator::subdivided_hyper_cube(mesh.triangulation, settings.n_cells, 0.,
                                                   settings.n_cells);
      // A function of the vertex, so that it is the same on all ranks.
      const double amplitude = settings.distortion;
      dealii::GridTools::transform(
          [&](const dealii::Point<dim> &vertex)
          {
            dealii::Point<dim> moved = vertex;
            const double z = dim == 3 ? vertex[dim - 1] : 0.3;
            for (unsigned int d = 0; d < dim; ++d)
              moved[d] += amplitude * std::sin(31. * (d + 1.) * vertex[0] + 17. * vertex[1] +
                                               (7. + 5. * d) * z + d);
            return moved;
          },
          mesh.triangulation);
      nodes = std::make_unique<Nodes<dim>>(mesh, formulation->degree());
      PartSetup<dim> setup;
      setup.name = "block";
      setup.nodes = nodes.get();
      setup.material = material;
      setup.communicator = communicator;
      formulation->initialize(setup);
      partition = std::make_shared<const NodePartition>(
          nodes->owned(), formulation->required_nodes(), communicator);
      formulation->set_partition(*partition);
      initial_position.reinit(partition);
      position.reinit(partition);
      velocity.reinit(partition);
      force.reinit(partition);
      std::vector<dealii::types::global_dof_index> cell_nodes;
      std::vector<dealii::Point<dim>> cell_points;
      for (const auto &cell : nodes->dof_handler().active_cell_iterators())
        if (cell->is_locally_owned())
        {
          nodes->cell_nodes(cell, cell_nodes);
          nodes->cell_points(cell, cell_points);
          for (unsigned int k = 0; k < cell_nodes.size(); ++k)
            for (unsigned int d = 0; d < dim; ++d)
              initial_position.node(partition->local_index(cell_nodes[k]))[d] = cell_points[k][d];
        }
      position.copy_from(initial_position);
    }

    static std::string number(const double value)
    {
      std::ostringstream text;
      text.precision(17);
      text << value;
      return text.str();
    }

    /** Sets a nodal vector at all local nodes to a function of the initial position. */
    void set(NodalVector &vector, const VectorFunction &function) const
    {
      for (unsigned int i = 0; i < partition->n_local(); ++i)
      {
        const double *const x = initial_position.node(i);
        const Vector3 value = function({x[0], x[1], x[2]});
        for (unsigned int d = 0; d < dim; ++d)
          vector.node(i)[d] = value[d];
      }
    }

    /** Computes the force of a step and collects it. */
    void compute_force(const double time_increment)
    {
      force.set_zero();
      formulation->add_internal_force({&position, &velocity, time_increment}, force);
      force.add_to_owners();
    }

    /** (K + 2/Δt C) v, collected. */
    NodalVector stiffness_action(const NodalVector &v, const double time_step = 1e-2) const
    {
      NodalVector result(partition);
      formulation->apply_elastic_stiffness(position, v, time_step, result);
      result.add_to_owners();
      return result;
    }

    /** Owned nodes that are not on the surface. */
    std::vector<unsigned int> interior_nodes() const
    {
      const dealii::IndexSet boundary =
          dealii::DoFTools::extract_boundary_dofs(nodes->dof_handler(), dealii::ComponentMask());
      std::vector<unsigned int> result;
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        if (!boundary.is_element(partition->global_index(i)))
          result.push_back(i);
      return result;
    }

    /** Largest absolute value of owned components, over all ranks. */
    double maximum(const NodalVector &vector) const
    {
      double value = 0;
      for (unsigned int i = 0; i < partition->n_owned(); ++i)
        for (unsigned int d = 0; d < dim; ++d)
          value = std::max(value, std::abs(vector.node(i)[d]));
      return dealii::Utilities::MPI::max(value, communicator);
    }

    /** Numbers in points() of all points of cells. */
    std::vector<unsigned int> point_numbers() const
    {
      std::vector<unsigned int> result;
      for (unsigned int cell = 0; cell < formulation->n_cells(); ++cell)
        for (unsigned int q = 0; q < formulation->n_points_per_cell(); ++q)
          result.push_back(formulation->point_of_cell(cell, q));
      return result;
    }

    double volume() const
    {
      double sum = 0;
      for (const unsigned int i : point_numbers())
        sum += formulation->points().component(MaterialPoints::volume, 0)[i];
      return dealii::Utilities::MPI::sum(sum, communicator);
    }

    const bool is_logarithmic; ///< the strain measure is given so
    MPI_Comm communicator;
    Mesh<dim> mesh;
    std::shared_ptr<const Material> material;
    std::unique_ptr<Formulation<dim>> formulation;
    std::unique_ptr<Nodes<dim>> nodes;
    std::shared_ptr<const NodePartition> partition;
    NodalVector initial_position, position, velocity, force;
  };

  /** All elements of the library. */
  inline std::vector<ElementChoice> all_elements()
  {
    return {{"hexahedron", ""},
            {"fully integrated hexahedron", ""},
            {"lagrange hexahedron", "set Degree = 1"},
            {"lagrange hexahedron", "set Degree = 2"},
            {"lagrange hexahedron", "set Degree = 3"}};
  }

  /** A smooth field that is not linear. */
  inline Vector3 wavy(const Vector3 &x)
  {
    return {std::sin(1.3 * x[0] + 0.7 * x[1] - 0.4 * x[2]),
            std::cos(0.9 * x[0] - 1.1 * x[1] + 0.6 * x[2]),
            std::sin(0.5 * x[0] * x[1] + 1.2 * x[2])};
  }
  inline Vector3 other_wavy(const Vector3 &x)
  {
    return {std::cos(0.3 * x[0] + 1.7 * x[1] + 0.8 * x[2]),
            std::sin(1.9 * x[0] + 0.1 * x[1] - 0.6 * x[2]),
            std::cos(0.5 * x[0] * x[2] - 0.2 * x[1])};
  }
} // namespace tombolo
