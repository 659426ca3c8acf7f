// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/lattice_filter.h>

#include <tombolo/base/simd/vectorization.h>
#include <tombolo/model/model.h>
#include <tombolo/physics/statics/rest_entries.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  template <int dim>
  double lattice_filter_rate(const Model<dim> &model)
  {
    double rate = 0;
    for (const ParticleFormulation<dim> *const particles : model.particle_parts())
      rate = std::max(rate, particles->material().longitudinal_wave_speed() /
                                particles->smallest_spacing());
    return Utilities::MPI::max(rate, model.communicator);
  }

  template <int dim>
  LatticeFilter<dim>::LatticeFilter(const LatticeFilterSettings &settings) : settings(settings)
  {}

  template <int dim>
  bool LatticeFilter<dim>::is_due(const Clock &clock) const
  {
    return (clock.step + 1) % settings.interval == 0;
  }

  template <int dim>
  void LatticeFilter<dim>::model_changed(Model<dim> &model)
  {
    settings.rate = lattice_filter_rate(model);
  }

  template <int dim>
  void LatticeFilter<dim>::after_acceleration(Model<dim> &model, const Clock &clock)
  {
    if (!is_due(clock))
      return;
    if (half_kick.partition() != model.state.partition())
      half_kick.reinit(model.state.partition());
    half_kick.copy_from(model.state.unsmoothed_velocity);
  }

  template <int dim>
  void LatticeFilter<dim>::after_motion(Model<dim> &model, const Clock &clock)
  {
    time_since_filter += clock.next_step;
    if (!is_due(clock))
      return;
    NodalVector &v_hat = model.state.unsmoothed_velocity;
    const std::size_t n = static_cast<std::size_t>(v_hat.partition()->n_local()) * node_stride;
    for (std::size_t i = 0; i < n; ++i)
    {
      half_kick.data()[i] = 0.5 * (v_hat.data()[i] - half_kick.data()[i]);
      v_hat.data()[i] -= half_kick.data()[i];
    }
    dissipated += filter(model, time_since_filter);
    for (std::size_t i = 0; i < n; ++i)
      v_hat.data()[i] += half_kick.data()[i];
    v_hat.update_ghosts();
    time_since_filter = 0;
    const ConstraintReaction reaction = model.bridge->take_constraint_reaction();
    model.impulses.add_now(reaction.impulse, reaction.angular_impulse);
  }

  template <int dim>
  double LatticeFilter<dim>::filter(Model<dim> &model, const double elapsed)
  {
    Bridge &bridge = *model.bridge;
    NodalVector &v_hat = model.state.unsmoothed_velocity;
    if (settings.power == 0 || bridge.operators() == Bridge::Operators::identity)
      return 0.;
    const double before = bridge.kinetic_energy(v_hat);
    const double delta = std::min(1., settings.strength * settings.rate * elapsed);
    for (NodalVector *const vector : {&change, &image})
      if (vector->partition() != v_hat.partition())
        vector->reinit(v_hat.partition());
    // With lumped rows one application takes less than all of the shortest waves.
    const auto n_passes =
        static_cast<unsigned int>(std::ceil(bridge.mass_split().largest_mass_ratio()));
    for (unsigned int pass = 0; pass < n_passes; ++pass)
    {
      change.copy_from(v_hat);
      for (unsigned int k = 0; k < settings.power; ++k)
      {
        bridge.apply_short_wave_part(change, image);
        std::swap(change, image);
      }
      bridge.mass_split().make_symmetric(change);
      for (unsigned int i = 0; i < v_hat.partition()->n_owned(); ++i)
        store_node(load_node(change.node(i)) * delta, change.node(i));
      bridge.remove_from_velocity(change, model.state);
    }
    return before - bridge.kinetic_energy(v_hat);
  }

  template <int dim>
  void LatticeFilter<dim>::account(EnergyAccounts &accounts) const
  {
    accounts.add_replicated("filter dissipation", EnergyKind::artificial, dissipated);
  }

  template <int dim>
  void LatticeFilter<dim>::serialize(Model<dim> &, StateArchive &archive)
  {
    const auto group = archive.group("lattice filter");
    archive("time since filter", time_since_filter);
    archive("dissipated", dissipated);
  }

  namespace
  {
    LatticeFilterSettings read_filter_settings(const Parameters &parameters)
    {
      const Section section = parameters.section("Lattice filter");
      LatticeFilterSettings settings;
      settings.power = section.get_unsigned("Power");
      settings.strength = section.get_double("Strength");
      settings.interval = section.get_unsigned("Interval");
      return settings;
    }

    template <int dim>
    class LatticeFilterKind : public ProcessKind<dim>
    {
    public:
      void declare_parameters(Parameters &parameters) const override
      {
        ParameterHandler &handler = parameters.handler();
        handler.enter_subsection("Lattice filter");
        handler.declare_entry(
            "Power", "0", Patterns::Integer(0, 16),
            "p of v <- v - delta (I - Phi S)^p v, which removes the waves that alternate "
            "between neighbouring particles; 0 is no filter. 4 suits waves, 6 or more impact.");
        handler.declare_entry("Strength", "0.5", Patterns::Double(0., 10.),
                              "beta of delta = beta c dt n / h.");
        handler.declare_entry("Interval", "3", Patterns::Integer(1, 1000),
                              "The filter is applied every so many steps.");
        handler.leave_subsection();
      }

      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        if (std::any_of(parts.begin(), parts.end(),
                        [](const Part<dim> &part) { return part.material->has_mechanics(); }))
          if (read_filter_settings(parameters).power > 0)
            refuse_at_rest<dim>(parameters.section("Lattice filter"), "Power",
                                "it filters velocities", "0, or no such entry");
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        if (!model.has_mechanics)
          return nullptr;
        const LatticeFilterSettings settings = read_filter_settings(parameters);
        if (settings.power == 0)
          return nullptr;
        return std::make_unique<LatticeFilter<dim>>(settings);
      }
    };
  } // namespace

  template class LatticeFilter<2>;
  template class LatticeFilter<3>;
  template double lattice_filter_rate(const Model<2> &);
  template double lattice_filter_rate(const Model<3> &);

  TOMBOLO_REGISTER_PROCESS_KIND(LatticeFilterKind, process_order::lattice_filter)
} // namespace tombolo
