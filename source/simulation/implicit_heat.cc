#include <tombolo/simulation/implicit_heat.h>

#include <tombolo/simulation/low_order_conduction.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>
#include <deal.II/lac/solver_cg.h>
#include <deal.II/lac/trilinos_precondition.h>
#include <deal.II/lac/trilinos_sparse_matrix.h>

#include <algorithm>
#include <cmath>
#include <sstream>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    using Vector = LinearAlgebra::distributed::Vector<double>;

    void to_nodes(const Vector &source, NodalVector &target)
    {
      for (unsigned int i = 0; i < target.partition()->n_owned(); ++i)
        *target.node(i) = source.local_element(i);
      target.update_ghosts();
    }
  } // namespace

  /** dH/dθ + w Δt Sᵀ K S. */
  template <int dim>
  class ImplicitHeat<dim>::Operator
  {
  public:
    Operator(ImplicitHeat &owner, Scene<dim> &scene, const double time, const double factor)
        : owner(owner), scene(scene), time(time), factor(factor)
    {}

    void vmult(Vector &result, const Vector &source) const
    {
      to_nodes(source, owner.direction);
      scene.heat->apply_conduction(scene.state.position, owner.field, time, owner.direction,
                                   owner.image);
      for (unsigned int i = 0; i < source.locally_owned_size(); ++i)
        result.local_element(i) =
            *owner.capacity.node(i) * source.local_element(i) + factor * *owner.image.node(i);
    }

  private:
    ImplicitHeat &owner;
    Scene<dim> &scene;
    double time, factor;
  };

  template <int dim>
  class ImplicitHeat<dim>::Preconditioner
  {
  public:
    Preconditioner(ImplicitHeat &owner, Scene<dim> &scene, const double time, const double factor)
        : factor(factor), owner(owner), scene(scene)
    {
      NodalVector diagonal;
      diagonal.reinit(owner.capacity.partition(), 1);
      scene.heat->add_film_diagonal(time, owner.field, diagonal);
      for (unsigned int i = 0; i < diagonal.partition()->n_owned(); ++i)
        *diagonal.node(i) = *owner.capacity.node(i) + factor * *diagonal.node(i);
      is_diagonal = true;
      for (const Part<dim> &part : scene.parts)
        is_diagonal = is_diagonal && part.heat->conductivity().largest() == 0.;
      inverse_diagonal.reinit(owner.capacity.partition(), 1);
      for (unsigned int i = 0; i < diagonal.partition()->n_owned(); ++i)
        *inverse_diagonal.node(i) = 1. / *diagonal.node(i);
      if (is_diagonal)
        return;
      assemble_low_order_conduction(scene, factor, diagonal, matrix);
      TrilinosWrappers::PreconditionAMG::AdditionalData data;
      data.elliptic = true;
      data.smoother_sweeps = 2;
      data.aggregation_threshold = 0.02;
      multigrid.initialize(matrix, data);
    }

    void vmult(Vector &result, const Vector &source) const
    {
      const unsigned int n_owned = source.locally_owned_size();
      if (is_diagonal)
      {
        for (unsigned int i = 0; i < n_owned; ++i)
          result.local_element(i) = *inverse_diagonal.node(i) * source.local_element(i);
        return;
      }
      multigrid.vmult(result, source);
      Bridge &bridge = scene.heat->bridge;
      if (bridge.has_particles() && bridge.smoothing().is_active)
      {
        for (unsigned int i = 0; i < n_owned; ++i)
          *owner.direction.node(i) = source.local_element(i) / *bridge.mass().node(i);
        owner.direction.update_ghosts();
        bridge.apply_short_wave_part(owner.direction, owner.image);
        for (unsigned int i = 0; i < n_owned; ++i)
          result.local_element(i) += *owner.image.node(i);
      }
      for (const unsigned int node : scene.heat->conditions.constrained_nodes())
        result.local_element(node) = source.local_element(node);
    }

    const double factor; ///< w Δt that it was made for

  private:
    ImplicitHeat &owner;
    Scene<dim> &scene;
    bool is_diagonal = false;
    NodalVector inverse_diagonal;
    TrilinosWrappers::SparseMatrix matrix;
    TrilinosWrappers::PreconditionAMG multigrid;
  };

  template <int dim>
  void ImplicitHeat<dim>::declare_parameters(ParameterHandler &handler)
  {
    Parameters::declare_mandatory(handler, "Step", Patterns::Double(),
                                  "The time step; steps are equal and at most so long that outputs "
                                  "are met. Units: T.");
    handler.declare_entry("Tolerance", "1e-10", Patterns::Double(1e-15, 1e-2),
                          "The residual of a step over that of its beginning.");
    handler.declare_entry("Max Newton iterations", "30", Patterns::Integer(1, 10000),
                          "A step that needs more stops the run.");
  }

  template <int dim>
  ImplicitHeat<dim>::ImplicitHeat(const Section &section, const double weight)
      : weight(weight), time_step(section.get_positive("Step")),
        tolerance(section.get_double("Tolerance")),
        max_newton_iterations(section.get_unsigned("Max Newton iterations"))
  {}

  template <int dim>
  ImplicitHeat<dim>::~ImplicitHeat() = default;

  template <int dim>
  double ImplicitHeat<dim>::allowed_step(Scene<dim> & /*scene*/, const double /*time*/)
  {
    return time_step;
  }

  template <int dim>
  unsigned int ImplicitHeat<dim>::solve(Scene<dim> &scene, const double time, const double factor,
                                        const Vector &right_hand_side, Vector &solution)
  {
    const bool is_linear = scene.heat->is_linear();
    const double reduction = is_linear ? 0.1 * tolerance : std::max(0.1 * tolerance, 1e-3);
    if (preconditioner == nullptr || std::abs(preconditioner->factor / factor - 1.) > 0.1)
    {
      preconditioner = std::make_unique<Preconditioner>(*this, scene, time, factor);
      iterations_when_built = 0;
    }
    const Operator matrix(*this, scene, time, factor);
    SolverControl control(2000, reduction * right_hand_side.l2_norm());
    SolverCG<Vector> solver(control);
    solution = 0.;
    try
    {
      solver.solve(matrix, solution, right_hand_side, *preconditioner);
    }
    catch (const SolverControl::NoConvergence &)
    {
      std::ostringstream message;
      message << "The implicit heat step at time " << time << " did not converge within "
              << control.last_step() << " iterations of conjugate gradients. A smaller step, or a "
              << "larger `Tolerance`, may help.";
      throw RunError(message.str());
    }
    // Temperatures or places have changed so much that a new one pays.
    if (iterations_when_built == 0)
      iterations_when_built = control.last_step() + 1;
    else if (control.last_step() > 2 * iterations_when_built + 10)
      preconditioner.reset();
    return control.last_step();
  }

  template <int dim>
  void ImplicitHeat<dim>::advance(Scene<dim> &scene, const double time, const double step,
                                  std::vector<double> &of_condition)
  {
    ThermalModel<dim> &heat = *scene.heat;
    ThermalState &state = heat.state;
    const auto &partition = state.enthalpy.partition();
    const unsigned int n_owned = partition->n_owned();
    if (smoothed.partition() != partition)
    {
      for (NodalVector *vector : {&smoothed, &field, &direction, &image})
        vector->reinit(partition, n_slots, UnderReflection::even);
      for (NodalVector *vector : {&rate, &first_rate, &capacity})
        vector->reinit(partition, 1);
      preconditioner.reset();
    }
    const double factor = weight * step;
    const double end = time + step;

    std::vector<double> first_rates(of_condition.size(), 0.), rates;
    first_rate.set_zero();
    if (weight < 1.)
    {
      heat.find_field(scene.state.position, state.unsmoothed_temperature, smoothed, field);
      heat.heat_rate(scene.state.position, smoothed, field, time, first_rate, first_rates);
    }

    NodalVector &theta = state.next_unsmoothed_temperature;
    theta.copy_from(state.unsmoothed_temperature);
    heat.conditions.prescribe(scene.state.initial_position, end, theta);

    Vector residual(partition->owned(), partition->communicator()), correction(residual);
    double first_norm = 0;
    for (unsigned int iteration = 0;; ++iteration)
    {
      rates.assign(of_condition.size(), 0.);
      heat.find_field(scene.state.position, theta, smoothed, field);
      heat.heat_rate(scene.state.position, smoothed, field, end, rate, rates);
      for (unsigned int i = 0; i < n_owned; ++i)
      {
        *state.next_enthalpy.node(i) =
            *state.enthalpy.node(i) +
            step * (weight * *rate.node(i) + (1. - weight) * *first_rate.node(i));
        residual.local_element(i) =
            *state.next_enthalpy.node(i) - heat.nodal_enthalpy.enthalpy(i, *theta.node(i));
      }
      for (const unsigned int node : heat.conditions.constrained_nodes())
        residual.local_element(node) = 0.;
      const double norm = residual.l2_norm();
      if (iteration == 0)
        first_norm = norm;
      // A linear problem is solved at once, as far as the tolerance of its solver goes.
      if (!(norm > tolerance * first_norm) || (iteration > 0 && heat.is_linear()))
        break;
      if (iteration == max_newton_iterations || !std::isfinite(norm))
      {
        std::ostringstream message;
        message << "The implicit heat step from time " << time << " to " << end
                << " did not converge within " << iteration
                << " iterations of Newton's method: its residual is still " << norm / first_norm
                << " of the first. A smaller `Step` may help.";
        throw RunError(message.str());
      }
      for (unsigned int i = 0; i < n_owned; ++i)
        *capacity.node(i) = heat.nodal_enthalpy.capacity(i, *theta.node(i));
      linear_iterations += solve(scene, end, factor, residual, correction);
      ++newton_iterations;
      for (unsigned int i = 0; i < n_owned; ++i)
        *theta.node(i) += correction.local_element(i);
    }
    for (std::size_t c = 0; c < rates.size(); ++c)
      of_condition[c] += step * (weight * rates[c] + (1. - weight) * first_rates[c]);
    heat.find_temperature(end, state.next_enthalpy, theta, of_condition);
  }

  template <int dim>
  const StepLimit &ImplicitHeat<dim>::limit() const
  {
    return no_limit;
  }

  template <int dim>
  void ImplicitHeat<dim>::serialize(StateArchive &archive, const Scene<dim> & /*scene*/)
  {
    const auto group = archive.group("implicit heat");
    archive("linear iterations", linear_iterations);
    archive("Newton iterations", newton_iterations);
    // A preconditioner made anew at the same step gives the same bits only if all have one.
    preconditioner.reset();
  }

  template <int dim>
  unsigned long ImplicitHeat<dim>::n_linear_iterations() const
  {
    return linear_iterations;
  }

  template <int dim>
  unsigned long ImplicitHeat<dim>::n_newton_iterations() const
  {
    return newton_iterations;
  }

  template class ImplicitHeat<2>;
  template class ImplicitHeat<3>;
  template class BackwardEulerHeat<2>;
  template class BackwardEulerHeat<3>;
  template class CrankNicolsonHeat<2>;
  template class CrankNicolsonHeat<3>;

  TOMBOLO_REGISTER_FOR_DIMENSIONS(HeatIntegrator, BackwardEulerHeat, "backward Euler",
                                  "implicit steps of first order, without oscillations")
  TOMBOLO_REGISTER_FOR_DIMENSIONS(HeatIntegrator, CrankNicolsonHeat, "Crank-Nicolson",
                                  "implicit steps of second order")
} // namespace tombolo
