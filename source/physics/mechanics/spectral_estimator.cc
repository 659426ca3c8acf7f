// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/spectral_estimator.h>

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/model/tangent.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

namespace tombolo
{
  namespace
  {
    /** Holds the positions of particles during its lifetime. */
    template <int dim>
    class HeldPositions
    {
    public:
      explicit HeldPositions(const Model<dim> &model) : model(model)
      {
        for (ParticleFormulation<dim> *const particles : model.particle_parts())
          particles->hold_position(&model.state.position);
      }
      ~HeldPositions()
      {
        for (ParticleFormulation<dim> *const particles : model.particle_parts())
          particles->hold_position(nullptr);
      }
      HeldPositions(const HeldPositions &) = delete;
      HeldPositions &operator=(const HeldPositions &) = delete;

    private:
      const Model<dim> &model;
    };
  } // namespace

  double round_down(const double step)
  {
    int exponent;
    const double mantissa = std::frexp(step, &exponent);
    return std::ldexp(std::floor(mantissa * 512.) / 512., exponent);
  }

  template <int dim>
  StepLimit courant_limit(const Model<dim> &model)
  {
    std::vector<StepLimit> part_limits;
    for (const Part<dim> &part : model.parts)
    {
      part_limits.push_back(
          part.formulation->courant_limit(model.state.position, part.inertia, part.step_ratios));
      part_limits.back().entity += " of part \"" + part.name + "\"";
    }
    return smallest_limit(part_limits, model.communicator);
  }

  template StepLimit courant_limit<2>(const Model<2> &);
  template StepLimit courant_limit<3>(const Model<3> &);

  template <int dim>
  SpectralEstimator<dim>::SpectralEstimator(const Entries &e, const bool by_groups)
      : by_groups(by_groups),
        solver{
            e.number("Tolerance", "1e-4", between(1e-8, 0.01), "",
                     "The iteration ends when the eigenvalue has grown by less than this fraction "
                     "over ten iterations (four, where it starts from an earlier mode)."),
            e.integer("Max iterations", "400", between(10, 100000),
                      "Limit of the iterations of one estimate.")} // in this order
  {}

  template <int dim>
  void SpectralEstimator<dim>::list(Records &records, const Model<dim> &model)
  {
    records.value("calls", n_calls);
    records.value("has viscosity", has_viscosity);
    records.list(
        [this, &model](Records &now)
        {
          if (n_calls == 0)
            return;
          solver.set_partition(model.state.partition());
          now.nodal("mode", 3, solver.mode);
        });
  }

  template <int dim>
  void SpectralEstimator<dim>::remove_constrained(const Model<dim> &model,
                                                  NodalVector &vector) const
  {
    if (!model.conditions->has_constraints())
      return;
    model.conditions->remove_prescribed(vector);
    vector.update_ghosts();
  }

  template <int dim>
  void SpectralEstimator<dim>::apply(const Model<dim> &model, const NodalVector &v_hat,
                                     const double time_step, NodalVector &result)
  {
    ++count;
    Bridge &bridge = *model.bridge;
    bridge.apply_smoothing(v_hat, velocity);
    remove_constrained(model, velocity);
    apply_elastic_stiffness(model, velocity, time_step, force, by_groups);
    Tangent<dim> tangent;
    tangent.velocity = &velocity;
    tangent.factor = 2. / time_step;
    tangent.force = &force;
    for (const auto &process : model.processes)
      process->linearize(model, Clock(), tangent);
    force.fill([&](const unsigned int i, double *const value)
               { store_node(load_node(value) / load_node(bridge.nodal_mass().node(i)), value); });
    remove_constrained(model, force);
    bridge.apply_adjoint(force, result);
    remove_constrained(model, result);
    force.set_zero();
  }

  template <int dim>
  double SpectralEstimator<dim>::largest_eigenvalue(const Model<dim> &model, const double time_step,
                                                    const Lobpcg::Stop &stop)
  {
    remove_constrained(model, solver.mode);
    return solver.find(
        model.bridge->mass(),
        [&](const NodalVector &field, NodalVector &image)
        { apply(model, field, time_step, image); },
        stop);
  }

  template <int dim>
  double SpectralEstimator<dim>::quotient(const Model<dim> &model, const double time_step)
  {
    return solver.rayleigh_quotient(model.bridge->mass(),
                                    [&](const NodalVector &field, NodalVector &image)
                                    { apply(model, field, time_step, image); });
  }

  template <int dim>
  double SpectralEstimator<dim>::viscous_part(const Model<dim> &model, const double time_step,
                                              const double whole)
  {
    // K + 2C/Δt and K + C/Δt
    const double difference = whole - quotient(model, 2. * time_step);
    return difference > 1e-9 * whole ? difference * time_step : 0.;
  }

  template <int dim>
  StepLimit SpectralEstimator<dim>::estimate(const Model<dim> &model, const double expected)
  {
    count = 0;
    const HeldPositions<dim> held(model);
    const auto &partition = model.state.partition();
    const bool is_first = n_calls == 0;
    for (NodalVector *vector : {&velocity, &force})
      vector->fit_to(partition);
    solver.set_partition(partition);
    solver.add_noise(model.bridge->mass(), model.state.initial_position, dim, is_first ? 1. : 0.1,
                     n_calls);
    // A mode that the last eigenvector does not hold, of kernels that were renewed since, shows in
    // the acceleration of this step, where there is one, when it begins to grow.
    if (!is_first && by_groups)
      solver.add(model.bridge->mass(), model.state.acceleration, 0.3);
    ++n_calls;

    double time_step = expected > 0. ? expected : courant_limit(model).time_step;
    const auto step_with_viscosity = [&](const double last, const double eigenvalue)
    {
      // For a given mode, Δt² k + 2 Δt c = 4.
      const double viscous = viscous_part(model, last, eigenvalue);
      const double elastic = eigenvalue - 2. * viscous / last;
      return 4. / (viscous + std::sqrt(viscous * viscous + 4. * elastic));
    };
    Lobpcg::Stop stop = solver.from_last_mode();
    if (is_first)
    {
      has_viscosity = viscous_part(model, time_step, quotient(model, time_step)) > 0.;
      stop = solver.from_noise(static_cast<double>(partition->n_global()) * dim);
      if (has_viscosity)
      {
        // The first iterations from noise find the step at which viscosity acts.
        const double eigenvalue = largest_eigenvalue(model, time_step, Lobpcg::to_one_percent());
        // Three applications gave the start.
        stop.min_iterations -= std::min(stop.min_iterations, count - 3);
        time_step = step_with_viscosity(time_step, eigenvalue);
      }
    }
    for (unsigned int pass = 0; pass < 12; ++pass)
    {
      const double eigenvalue = largest_eigenvalue(model, time_step, stop);
      stop = solver.from_last_mode();
      const double last = time_step;
      if (!(eigenvalue > 0.)) // no cell is left
        return {};
      time_step =
          has_viscosity ? step_with_viscosity(last, eigenvalue) : 2. / std::sqrt(eigenvalue);
      // The mode depends on Δt in second order: the last step need not be met closely.
      if (!has_viscosity || std::abs(time_step - last) < 0.01 * time_step)
        break;
    }

    StepLimit limit;
    // The eigenvalue was approached from below: the margin covers the error by the tolerance.
    limit.time_step = time_step * 0.994;
    find_entity(model, limit);
    return limit;
  }

  template <int dim>
  void SpectralEstimator<dim>::find_entity(const Model<dim> &model, StepLimit &limit) const
  {
    const unsigned int n_owned = model.state.partition()->n_owned();
    const auto share = [&](const unsigned int i)
    {
      const double *const v = solver.mode.node(i);
      return *model.bridge->mass().node(i) * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    };
    double largest = 0.;
    for (unsigned int i = 0; i < n_owned; ++i)
      largest = std::max(largest, share(i));
    largest = Utilities::MPI::max(largest, model.communicator);

    // Symmetric bodies have nearly equal shares; neither round-off nor the numbers of nodes on
    // ranks must decide among them: of all that come close, the smallest persistent id.
    const auto &ids = model.nodes->persistent_ids();
    auto first = std::numeric_limits<std::uint64_t>::max();
    unsigned int node = 0;
    for (unsigned int i = 0; i < n_owned; ++i)
      if (share(i) >= 0.999 * largest && ids[i] < first)
      {
        first = ids[i];
        node = i;
      }
    std::string entity;
    Point<3> position;
    if (first != std::numeric_limits<std::uint64_t>::max())
    {
      bool is_particle = false;
      for (const Part<dim> &part : model.parts)
      {
        const auto &list = part.formulation->particle_nodes();
        is_particle = is_particle || std::find(list.begin(), list.end(), node) != list.end();
      }
      const bool is_element_node = *model.element_mass.node(node) > 0.;
      entity = is_particle && is_element_node ? "shared node"
               : is_particle                  ? "particle"
                                              : "FE node";
      for (unsigned int d = 0; d < 3; ++d)
        position[d] = model.state.position.node(node)[d];
    }
    auto smallest = std::numeric_limits<std::uint64_t>::max();
    for (const auto &[id, rank_entity, rank_position] :
         Utilities::MPI::all_gather(model.communicator, std::make_tuple(first, entity, position)))
      if (id < smallest)
      {
        smallest = id;
        limit.entity = rank_entity;
        limit.position = rank_position;
      }
  }

  template class SpectralEstimator<2>;
  template class SpectralEstimator<3>;
} // namespace tombolo
