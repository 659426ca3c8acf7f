// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/physics/mechanics/mass_scaling.h>

#include <tombolo/base/format.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/model.h>
#include <tombolo/model/moving_parts.h>
#include <tombolo/output/time_table.h>
#include <tombolo/physics/mechanics/courant_limit.h>

#include <deal.II/base/mpi.h>

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <set>

namespace tombolo
{
  using namespace dealii;

  ScalingSettings::ScalingSettings(const Entries &e)
  {
    mass_factor = e.number("Mass factor", "1", positive(), "1",
                           "Mass scaling: inertia is that of so many times the density, and steps "
                           "are larger by its root. Heat capacity and body forces stay.");
    process_time_factor = e.number(
        "Process time factor", "1", positive(), "1",
        "The process is run so many times faster, and conductivities, film and radiation "
        "coefficients and reference strain rates are carried along. All entries, functions and "
        "results stay in the time of the process: steps are so many times larger.");
    const double factor = inertia_factor();
    e.refuse(!(factor <= largest_factor && factor >= 1. / largest_factor),
             process_time_factor == 1. ? "Mass factor" : "Process time factor",
             "inertia would be multiplied by " + format_number(mass_factor) + " x " +
                 format_number(process_time_factor) +
                 "^2; allowed are factors from 1e-12 to 1e12.");
    if (!e.when(e.is_set("Target time step")))
      return;
    target_time_step =
        e.optional_number("Target time step", positive(), "T",
                          "Selective mass scaling: mass is added to each cell and particle whose "
                          "own stable step by eq. (41) of Pan et al. 2019 is smaller, so that it "
                          "becomes this one; empty for none.")
            .value_or(0.);
    interval = e.integer("Interval", "20", between(1, 1000000),
                         "With a target: after so many steps mass is added again where cells have "
                         "become smaller. It is never taken away.");
  }

  template <int dim>
  MassScaling<dim>::MassScaling(const Section &section, const ScalingSettings &settings,
                                Model<dim> &model)
      : section(section), settings(settings), communicator(model.communicator)
  {
    this->roles.rest = ProcessRole::is_idle;
    this->roles.divided_cells = ProcessRole::is_refused;
    this->records.group("mass scaling").sums("work", work);
    this->observed.audit.connect([this, &model](std::ostream &text) { describe(model, text); });
    this->observed.columns.connect([this, &model](TimeTable &table) { report(model, table); });
    this->observed.results.connect([this, &model](const TimeTable &table, Json &summary)
                                   { summary["scaling"] = results(model, table); });
    if (!settings.is_selective())
      return;
    this->observed.energy("mass scaling work", EnergyKind::external, work);
    for (unsigned int p = 0; p < model.parts.size(); ++p)
      this->structure.group("inertia of part " + model.parts[p].name)
          .archived(
              [&model, p](StateArchive &archive)
              {
                archive.set_rows(model.persistent_ids_of_points(p));
                archive.rows("inertia factors", 1, model.parts[p].inertia);
              });
    start(model);
    raise_factors(model);
    model.inertia_is_mass = false;
    model.renew_masses();
  }

  template <int dim>
  void MassScaling<dim>::start(Model<dim> &model)
  {
    std::vector<double> steps;
    double smallest = 1e300;
    for (Part<dim> &part : model.parts)
    {
      part.formulation->courant_limits(model.state.position, steps);
      const bool knows_all =
          steps.size() >= std::max<std::size_t>(part.formulation->n_cells(),
                                                part.formulation->particle_nodes().size());
      if (Utilities::MPI::min(knows_all ? 1 : 0, communicator) == 0)
        section.fail("Target time step", "cells of part \"" + part.name +
                                             "\" cannot be given mass one by one; allowed is a "
                                             "uniform `Mass factor`.");
      part.inertia.assign(steps.size(), 1.);
      for (const double step : steps)
        smallest = std::min(smallest, step);
    }
    smallest = Utilities::MPI::min(smallest, communicator);
    if (smallest >= settings.target_time_step)
      section.fail("Target time step",
                   "it would do nothing: the smallest stable step of a cell or particle is " +
                       format_number(smallest) + " already; allowed are larger ones.");
    const double largest = std::pow(settings.target_time_step / smallest, 2);
    if (!(largest <= ScalingSettings::largest_factor))
      section.fail("Target time step", "the smallest stable step of a cell or particle is " +
                                           format_number(smallest) +
                                           "; allowed are up to a million times as many.");
  }

  template <int dim>
  bool MassScaling<dim>::raise_factors(Model<dim> &model) const
  {
    int has_risen = 0;
    std::vector<double> steps;
    for (Part<dim> &part : model.parts)
    {
      part.formulation->courant_limits(model.state.position, steps);
      for (std::size_t i = 0; i < steps.size(); ++i)
      {
        const double ratio = settings.target_time_step / steps[i];
        // A cell turned inside out has no step; the forces say so.
        const double wanted = std::min(ratio * ratio, ScalingSettings::largest_factor);
        if (!(steps[i] > 0.) || !(wanted > part.inertia[i]))
          continue;
        part.inertia[i] = wanted;
        has_risen = 1;
      }
    }
    return Utilities::MPI::max(has_risen, communicator) == 1;
  }

  template <int dim>
  bool MassScaling<dim>::raise_masses(Model<dim> &model)
  {
    if (!settings.is_selective() || !raise_factors(model))
      return false;
    NodalVector before(model.state.partition(), Quantity::scalar);
    before.copy_from(model.bridge->mass());
    model.renew_inertia();
    account_for_added_mass(model, before);
    return true;
  }

  template <int dim>
  ModelChange MassScaling<dim>::change_model(Model<dim> &model, const Clock &clock)
  {
    ModelChange change;
    const bool is_due =
        settings.is_selective() && clock.step > 0 && clock.step % settings.interval == 0;
    change.masses = is_due && raise_masses(model);
    return change;
  }

  template <int dim>
  void MassScaling<dim>::account_for_added_mass(Model<dim> &model, const NodalVector &previous_mass)
  {
    ImpulseAccount::Vector impulse{}, moment{};
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      const double added = *model.bridge->mass().node(i) - *previous_mass.node(i);
      if (added == 0.)
        continue;
      const double *const v_hat = model.state.unsmoothed_velocity.node(i);
      ImpulseAccount::Vector momentum;
      for (unsigned int d = 0; d < 3; ++d)
      {
        momentum[d] = added * v_hat[d];
        impulse[d] += momentum[d];
        work += 0.5 * momentum[d] * v_hat[d];
      }
      add_moment(model.state.position_of_unsmoothed().node(i), momentum.data(), moment);
    }
    model.impulses.add_now(impulse, moment);
  }

  template <int dim>
  typename MassScaling<dim>::Extent MassScaling<dim>::extent(const Model<dim> &model) const
  {
    Extent extent;
    double smallest = 1e300;
    for (const Part<dim> &part : model.parts)
    {
      if (settings.is_selective())
      {
        unsigned long &count = part.particles != nullptr ? extent.particles : extent.cells;
        std::vector<double> steps;
        part.formulation->courant_limits(model.state.position, steps);
        for (std::size_t i = 0; i < steps.size(); ++i)
        {
          constexpr double of_removed_cells = 1e299;
          if (part.inertia[i] > 1. && steps[i] < of_removed_cells)
            ++count;
          smallest = std::min(smallest, steps[i]);
        }
      }
      else
        smallest =
            std::min(smallest, part.formulation->courant_limit(model.state.position).time_step);
    }
    extent.cells = Utilities::MPI::sum(extent.cells, communicator);
    extent.particles = Utilities::MPI::sum(extent.particles, communicator);
    extent.smallest_step =
        Utilities::MPI::min(smallest, communicator) / std::sqrt(settings.inertia_factor());
    return extent;
  }

  template <int dim>
  typename MassScaling<dim>::Masses MassScaling<dim>::masses(const Model<dim> &model) const
  {
    std::array<double, 2> sums{};
    for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
    {
      sums[0] += *model.body_mass().node(i);
      sums[1] += *model.state.mass.node(i);
    }
    sums = ordered_sum(sums, communicator);
    Masses result;
    result.true_mass = sums[0];
    result.inertia =
        settings.is_selective() ? sums[1] : settings.inertia_factor() * result.true_mass;
    result.added = (settings.mass_factor - 1.) * result.true_mass;
    if (settings.is_selective())
      result.added += (result.inertia - settings.inertia_factor() * result.true_mass) /
                      (settings.process_time_factor * settings.process_time_factor);
    return result;
  }

  template <int dim>
  void MassScaling<dim>::describe(const Model<dim> &model, std::ostream &text) const
  {
    const Masses mass = masses(model);
    const Extent present = extent(model);
    text << "  scaled inertia: mass factor " << settings.mass_factor << ", process "
         << settings.process_time_factor << " times faster, mass " << mass.added << " added ("
         << 100. * mass.added / mass.true_mass << " %)";
    if (settings.is_selective())
      text << " with the target step " << settings.target_time_step << " in " << present.cells
           << " cells and " << present.particles << " particles";
    text << "; inertia, and kinetic energy with it, is " << mass.inertia / mass.true_mass
         << " times that of the mass\n"
         << "  smallest step by eq. (41) " << present.smallest_step << " without scaling, "
         << courant_limit(model).time_step << " with it\n";
  }

  template <int dim>
  void MassScaling<dim>::report(const Model<dim> &model, TimeTable &table) const
  {
    table.add("added mass", "M", masses(model).added);
    const double internal = table.present("elastic energy") + table.present("plastic dissipation");
    if (internal > 0.)
      table.add("kinetic over internal energy", "1", table.present("kinetic energy") / internal);
  }

  template <int dim>
  Json MassScaling<dim>::results(const Model<dim> &model, const TimeTable &table) const
  {
    const Masses mass = masses(model);
    const Extent present = extent(model);
    Json result = Json::object();
    result["mass_factor"] = settings.mass_factor;
    result["process_time_factor"] = settings.process_time_factor;
    if (settings.is_selective())
    {
      result["target_time_step"] = settings.target_time_step;
      result["cells_with_added_mass"] = present.cells;
      result["particles_with_added_mass"] = present.particles;
    }
    result["mass"] = mass.true_mass;
    result["added_mass"] = mass.added;
    result["inertia_over_mass"] = mass.inertia / mass.true_mass;
    result["smallest_step_unscaled"] = present.smallest_step;
    result["smallest_step_scaled"] = courant_limit(model).time_step;

    const auto elastic = table.column("elastic energy");
    const auto plastic = table.column("plastic dissipation");
    const auto kinetic = table.column("kinetic energy");
    double largest = 0.;
    for (std::size_t i = 0; i < elastic.size(); ++i)
      largest = std::max(largest, elastic[i] + plastic[i]);
    result["largest_kinetic_over_internal_energy"] = Json();
    double ratio = 0.;
    for (std::size_t i = 0; i < elastic.size(); ++i)
      if (elastic[i] + plastic[i] > 0. && elastic[i] + plastic[i] >= 0.01 * largest)
      {
        ratio = std::max(ratio, kinetic[i] / (elastic[i] + plastic[i]));
        result["largest_kinetic_over_internal_energy"] = ratio;
      }
    return result;
  }

  namespace
  {
    template <int dim>
    class MassScalingKind : public ProcessKind<dim>
    {
    public:
      void declare_parameters(Parameters &parameters) const override
      {
        declare_section<ScalingSettings>(parameters, "Scaling");
      }

      void prepare(const Parameters &parameters, std::vector<Part<dim>> &parts) const override
      {
        const double factor = ScalingSettings(parameters.section("Scaling")).inertia_factor();
        std::set<Material *> materials;
        for (const Part<dim> &part : parts)
          if (materials.insert(part.material.get()).second)
            part.material->scale_inertia(factor);
      }

      void validate(const Parameters &parameters,
                    const std::vector<Part<dim>> &parts) const override
      {
        const Section scaling = parameters.section("Scaling");
        if (ScalingSettings(scaling).is_active() && !parts.empty() &&
            std::none_of(parts.begin(), parts.end(),
                         [](const Part<dim> &part) { return has_motion(part); }))
          scaling.fail("", "the scene has no mechanics, since its materials have no stresses; "
                           "scaled inertia would do nothing.");
      }

      std::unique_ptr<Process<dim>> create_one(const Parameters &parameters,
                                               Model<dim> &model) const override
      {
        const Section section = parameters.section("Scaling");
        const ScalingSettings settings(section);
        if (!settings.is_active())
          return nullptr;
        return std::make_unique<MassScaling<dim>>(section, settings, model);
      }
    };
  } // namespace

  template class MassScaling<2>;
  template class MassScaling<3>;

  TOMBOLO_REGISTER_PROCESS_KIND(MassScalingKind, process_order::mass_scaling)
} // namespace tombolo
