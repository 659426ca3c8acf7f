// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/exceptions.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/formulations/elements/cell_part.h>
#include <tombolo/formulations/elements/rigid_cells.h>
#include <tombolo/formulations/formulation.h>
#include <tombolo/formulations/step_cost.h>

#include <deal.II/base/geometry_info.h>
#include <deal.II/base/mpi.h>
#include <deal.II/base/quadrature_lib.h>
#include <deal.II/base/utilities.h>

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

namespace tombolo
{
  namespace
  {
    /** Calls @p use with position and volume of each point of integration of the cells of this
     * rank, multilinear images of the reference cell: exact for polynomials of degree two. */
    template <int dim, typename Use>
    void for_volumes(const CellBatches<dim> &cells, const unsigned int degree, const Use &use)
    {
      const QGauss<dim> quadrature(3);
      constexpr unsigned int n_corners = GeometryInfo<dim>::vertices_per_cell;
      for (unsigned int cell = 0; cell < cells.n_cells(); ++cell)
      {
        const double *const positions = cells.initial_positions(cell / n_lanes);
        std::array<Tensor<1, dim>, n_corners> corners;
        for (unsigned int corner = 0; corner < n_corners; ++corner)
          for (unsigned int d = 0; d < dim; ++d)
            corners[corner][d] =
                positions[(node_of_corner<dim>(degree, corner) * dim + d) * n_lanes +
                          cell % n_lanes];
        for (unsigned int q = 0; q < quadrature.size(); ++q)
        {
          Tensor<1, 3> position;
          Tensor<2, dim> jacobian;
          for (unsigned int corner = 0; corner < n_corners; ++corner)
          {
            const double value =
                GeometryInfo<dim>::d_linear_shape_function(quadrature.point(q), corner);
            for (unsigned int d = 0; d < dim; ++d)
              position[d] += value * corners[corner][d];
            jacobian += outer_product(
                corners[corner],
                GeometryInfo<dim>::d_linear_shape_function_gradient(quadrature.point(q), corner));
          }
          use(position, determinant(jacobian), quadrature.weight(q));
        }
      }
    }

    /** Collective. */
    template <int dim>
    MassMoments moments_of(const CellBatches<dim> &cells, const unsigned int degree,
                           const double density, const MPI_Comm communicator)
    {
      MassMoments result;
      result.smallest_jacobian = 1e300;
      std::array<double, 4> first{};
      for_volumes<dim>(cells, degree,
                       [&](const Tensor<1, 3> &position, const double jacobian, const double weight)
                       {
                         const double mass = density * jacobian * weight;
                         result.smallest_jacobian = std::min(result.smallest_jacobian, jacobian);
                         first[3] += mass;
                         for (unsigned int d = 0; d < 3; ++d)
                           first[d] += mass * position[d];
                       });
      result.smallest_jacobian = Utilities::MPI::min(result.smallest_jacobian, communicator);
      first = ordered_sum(first, communicator);
      result.mass = first[3];
      for (unsigned int d = 0; d < 3; ++d)
        result.centre[d] = first[d] / first[3];

      std::array<double, 6> second{};
      for_volumes<dim>(cells, degree,
                       [&](const Tensor<1, 3> &position, const double jacobian, const double weight)
                       {
                         const Tensor<1, 3> r = position - result.centre;
                         const double mass = density * jacobian * weight;
                         for (unsigned int a = 0, k = 0; a < 3; ++a)
                           for (unsigned int b = a; b < 3; ++b, ++k)
                             second[k] += mass * r[a] * r[b];
                       });
      second = ordered_sum(second, communicator);
      for (unsigned int a = 0, k = 0; a < 3; ++a)
        for (unsigned int b = a; b < 3; ++b, ++k)
          result.second[a][b] = result.second[b][a] = second[k];
      return result;
    }
  } // namespace

  /** What CellPoints and ConductionElement need of a cell without stress. */
  template <int dim, unsigned int p>
  struct RigidCell
  {
    static constexpr unsigned int degree = p;
    static constexpr unsigned int n_nodes =
        static_cast<unsigned int>(dealii::Utilities::pow(p + 1, dim));
    static constexpr unsigned int n_points = 1;
    static constexpr MassLumping lumping =
        p == 1 ? MassLumping::row_sum : MassLumping::gauss_lobatto;
  };

  /**
   * A part of cells that conduct heat and have mass, and no stress: its nodes move as one rigid
   * body (doc/rigid_bodies.md). There are no material points, internal forces or limits of the
   * mechanical step. Mass and capacity are lumped to the nodes as by other elements of the degree.
   */
  template <int dim, unsigned int p>
  class RigidFormulation : public CellPart<dim, CellPoints<dim, RigidCell<dim, p>>>,
                           public RigidCells<dim>
  {
  public:
    unsigned int degree() const override
    {
      return p;
    }

    MiddleNodes middle_nodes() const override
    {
      return MiddleNodes::means;
    }

    StepCost step_cost(const Material & /*material*/, const double /*box_ratio*/) const override
    {
      return StepCosts::cell_cost(dim, p, 0.);
    }

    void initialize(const PartSetup<dim> &setup) override
    {
      part_points.initialize(setup.material, setup.heat, false);
      cell_points.set_cells(setup, p, RigidCell<dim, p>::lumping, false);
      moments = moments_of(cell_points.cells(), p, setup.material->density(), setup.communicator);
      cell_points.cells().release_initial_positions();
      if (!(moments.smallest_jacobian > 0.))
        throw InputError("The part \"" + setup.name +
                         "\" cannot be made of this mesh: a cell is turned inside out.");
    }

    const MassMoments &mass_moments() const override
    {
      return moments;
    }

    void add_internal_force(const MechanicalInput & /*input*/, NodalVector & /*force*/) override {}
    void apply_elastic_stiffness(const NodalVector & /*position*/, const NodalVector & /*velocity*/,
                                 const double /*time_step*/, NodalVector & /*force*/) const override
    {}
    void courant_limits(const NodalVector & /*position*/,
                        std::vector<double> &time_steps) const override
    {
      time_steps.assign(this->n_cells(), StepLimit().time_step);
    }
    void add_extra_mass(const std::vector<double> & /*inertia*/,
                        NodalVector & /*mass*/) const override
    {}
    EnergyAccounts energies() const override
    {
      return {};
    }

    void add_conduction(const NodalVector &position, const NodalVector &conductivity_temperature,
                        const NodalVector &temperature, NodalVector &heat_rate) const override
    {
      add_conduction_of_cells(cell_points, *part_points.heat(), position, conductivity_temperature,
                              temperature, heat_rate);
    }

  private:
    using Base = CellPart<dim, CellPoints<dim, RigidCell<dim, p>>>;
    using Base::cell_points, Base::part_points;

    MassMoments moments;
  };

  namespace
  {
    void declare_rigid_parameters(ParameterHandler &handler)
    {
      handler.declare_entry(
          "Degree", "1", Patterns::Integer(1, 3),
          "Polynomial degree of the temperature and of the nodes. All parts of a scene need nodes "
          "of the same degree.");
    }

    template <int dim>
    std::unique_ptr<Formulation<dim>> create_rigid(const Section &section)
    {
      switch (section.get_unsigned("Degree"))
      {
      case 1:
        return std::make_unique<RigidFormulation<dim, 1>>();
      case 2:
        return std::make_unique<RigidFormulation<dim, 2>>();
      default:
        return std::make_unique<RigidFormulation<dim, 3>>();
      }
    }

    template <int dim>
    bool add_rigid_to_registry()
    {
      Registry<Formulation<dim>>::instance().add(
          "rigid", {"moves as one rigid body, by functions of time or by forces; conducts heat",
                    &declare_rigid_parameters, &create_rigid<dim>});
      return true;
    }

    const bool rigid_is_registered = add_rigid_to_registry<2>() && add_rigid_to_registry<3>();
  } // namespace
} // namespace tombolo
