// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/ordered_sum.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/coupling/bridge.h>
#include <tombolo/model/model.h>
#include <tombolo/model/process.h>
#include <tombolo/physics/statics/rest_entries.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    struct LatticeFilterSettings
    {
      explicit LatticeFilterSettings(const Section &section)
          : power(section.get_unsigned("Power")), strength(section.get_double("Strength")),
            interval(section.get_unsigned("Interval"))
      {}

      unsigned int power; ///< 0: no filter
      double strength;    ///< β in δ = β c Δt n / h
      unsigned int interval;
    };

    /** c/h of the fastest and finest particle part [1/T]. Collective. */
    template <int dim>
    double filter_rate(const Model<dim> &model)
    {
      double rate = 0;
      for (const ParticleFormulation<dim> *const particles : model.particle_parts())
        rate = std::max(rate, particles->material().longitudinal_wave_speed() /
                                  particles->smallest_spacing());
      return Utilities::MPI::max(rate, model.communicator);
    }
  } // namespace

  /**
   * v̂ ← v̂ - δ (I - ΦS)^power v̂ every few steps (doc/method.md, section 9): removes waves that
   * alternate between neighbouring particles from the mean of the velocities before and after t_n.
   * What the scheme conserves is ½ v_n·M̂ v_n - Δt²/8 a·M a + U with v_n = (v⁻ + v⁺)/2: a filter of
   * v⁺ would change it by a term of either sign, which, taken at one phase of a short wave every
   * few steps, can make it grow.
   */
  template <int dim>
  class LatticeFilter : public Process<dim>
  {
  public:
    explicit LatticeFilter(const LatticeFilterSettings &settings) : settings(settings)
    {
      Records &all = this->records.group("lattice filter");
      all.value("time since filter", time_since_filter);
      all.value("dissipated", dissipated);
      this->observed.energies.connect(
          [this](EnergyAccounts &accounts)
          { accounts.add_replicated("filter dissipation", EnergyKind::artificial, dissipated); });
    }

    void model_changed(const Model<dim> &model) override
    {
      rate = filter_rate(model);
    }

    void after_acceleration(const Model<dim> &model, const Clock &clock) override
    {
      if (!is_due(clock))
        return;
      if (half_kick.partition() != model.state.partition())
        half_kick.reinit(model.state.partition());
      half_kick.copy_from(model.state.unsmoothed_velocity);
    }

    void after_motion(const Model<dim> &model, const Clock &clock, NodalState &state) override
    {
      time_since_filter += clock.next_step;
      if (!is_due(clock))
        return;
      NodalVector &v_hat = state.unsmoothed_velocity;
      const std::size_t n = static_cast<std::size_t>(v_hat.partition()->n_local()) * node_stride;
      for (std::size_t i = 0; i < n; ++i)
      {
        half_kick.data()[i] = 0.5 * (v_hat.data()[i] - half_kick.data()[i]);
        v_hat.data()[i] -= half_kick.data()[i];
      }
      dissipated += filter(model, state);
      for (std::size_t i = 0; i < n; ++i)
        v_hat.data()[i] += half_kick.data()[i];
      v_hat.update_ghosts();
      time_since_filter = 0;
    }

  private:
    bool is_due(const Clock &clock) const
    {
      return (clock.step + 1) % settings.interval == 0;
    }

    /** Filters v̂ once, with δ of the time since the last call, at most 1. Returns what is lost of
     * the kinetic energy and of the work of what keeps prescribed components. Collective. */
    double filter(const Model<dim> &model, NodalState &state)
    {
      Bridge &bridge = *model.bridge;
      NodalVector &v_hat = state.unsmoothed_velocity;
      if (bridge.operators() == Bridge::Operators::identity)
        return 0.;
      const double before = bridge.kinetic_energy(v_hat);
      const double delta = std::min(1., settings.strength * rate * time_since_filter);
      for (NodalVector *const vector : {&change, &image})
        if (vector->partition() != v_hat.partition())
          vector->reinit(v_hat.partition());
      // With lumped rows one application removes less than all of the shortest waves.
      const auto n_passes =
          static_cast<unsigned int>(std::ceil(bridge.mass_split().largest_mass_ratio()));
      double work = 0;
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
        work += bridge.remove_from_velocity(change, state);
      }
      return ordered_sum(work, model.communicator) + before - bridge.kinetic_energy(v_hat);
    }

    LatticeFilterSettings settings;
    double rate = 0;       ///< [1/T]
    NodalVector half_kick; // v̂ at t_{n-1/2}, then (v̂ at t_{n+1/2} - v̂ at t_{n-1/2}) / 2
    NodalVector change, image;
    double time_since_filter = 0;
    double dissipated = 0; ///< of all ranks [M L^2/T^2]
  };

  namespace
  {
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
        const Section section = parameters.section("Lattice filter");
        const bool moves =
            std::any_of(parts.begin(), parts.end(),
                        [](const Part<dim> &part) { return part.material->has_mechanics(); });
        if (moves && LatticeFilterSettings(section).power > 0)
          refuse_at_rest<dim>(section, "Power", "it filters velocities", "0, or no such entry");
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        if (!model.has_mechanics)
          return nullptr;
        const LatticeFilterSettings settings(parameters.section("Lattice filter"));
        if (settings.power == 0)
          return nullptr;
        for (const Part<dim> &part : model.parts)
          if (part.particles != nullptr && part.particles->follows_positions())
            parameters.section("Lattice filter")
                .fail("Power", "the volume of the particles of part \"" + part.name +
                                   "\" follows from positions, which a filter of velocities does "
                                   "not change; allowed is `Dilatation = of particles`, or 0 here");
        return std::make_unique<LatticeFilter<dim>>(settings);
      }
    };
  } // namespace

  // The process after it books the work and the impulse of what keeps prescribed components.
  TOMBOLO_REGISTER_PROCESS_KIND(LatticeFilterKind, process_order::prescribed_motion - 1)
} // namespace tombolo
