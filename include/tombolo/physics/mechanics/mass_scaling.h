// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/format.h>
#include <tombolo/base/input/entries.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/model.h>
#include <tombolo/model/moving_parts.h>
#include <tombolo/model/process.h>
#include <tombolo/output/time_table.h>
#include <tombolo/physics/mechanics/spectral_estimator.h>

#include <deal.II/base/mpi.h>

#include <mpi.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <ostream>
#include <set>

namespace tombolo
{
  /**
   * Section "Scaling": makes a quasi-static process cheaper with explicit steps.
   *
   * A process that runs s times faster, with all quantities with a unit of time scaled
   * (conductivity, film coefficients and radiation times s, reference strain rates times s,
   * functions of s t), is in its own time the same as one with s² times the inertia and nothing
   * else changed. So only inertia is multiplied, by inertia_factor(), and the file stays in the
   * time of the process.
   */
  struct ScalingSettings
  {
    /** Nothing scaled. */
    ScalingSettings() = default;

    explicit ScalingSettings(const Entries &e);

    /** Of the density of all materials. */
    double inertia_factor() const
    {
      return mass_factor * process_time_factor * process_time_factor;
    }

    /** Whether anything is scaled. */
    bool is_active() const
    {
      return inertia_factor() != 1. || is_selective();
    }

    /** Whether the mass of single cells and particles is. */
    bool is_selective() const
    {
      return target_time_step > 0.;
    }

    double mass_factor = 1.;
    double process_time_factor = 1.;
    double target_time_step = 0.; ///< by eq. (41) [T]; zero: none
    unsigned int interval = 0;    ///< steps between checks of the target

    /** The largest factor allowed; its inverse is the smallest. */
    static constexpr double largest_factor = 1e12;
  };

  /**
   * The inertia of the parts of a scene where it is not that of their densities. The uniform factor
   * is that of the materials (Material::scale_inertia); this process finds the factors of single
   * cells and particles (Part::inertia), which raise each of them to the target step, and reports
   * the scaling. By the theorem of element eigenvalues the step of a mesh is at least the smallest
   * one of its elements, each with its own mass.
   */
  template <int dim>
  class MassScaling : public Process<dim>
  {
  public:
    /** Finds the factors for the initial positions and sets the masses of the model by them. Throws
     * InputError where the target has no effect, or needs too large factors. Collective. */
    MassScaling(const Section &section, const ScalingSettings &settings, Model<dim> &model)
        : section(section), settings(settings), communicator(model.communicator)
    {
      this->roles.divided_cells = ProcessRole::is_refused;
      this->records.group("mass scaling").sums("work", work);
      this->observed.audit.connect([this, &model](std::ostream &text) { describe(model, text); });
      this->observed.columns.connect([this, &model](TimeTable &table) { report(model, table); });
      this->observed.results.connect([this, &model](const TimeTable &table, Json &summary)
                                     { summary["scaling"] = results(model, table); });
      if (!settings.is_selective())
        return;
      this->observed.warnings.connect(
          [this, &model](const Clock &, const auto occasion, std::vector<std::string> &result)
          {
            if (occasion == Process<dim>::Occasion::audit)
              warn_of_mass(model, result);
          });
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

    ModelChange change_model(Model<dim> &model, const Clock &clock) override
    {
      ModelChange change;
      const bool is_due =
          settings.is_selective() && clock.step > 0 && clock.step % settings.interval == 0;
      change.masses = is_due && raise_masses(model);
      return change;
    }

    /** Adds mass to cells and particles whose step has fallen below the target. Returns whether
     * there are any, on any rank. Collective. */
    bool raise_masses(Model<dim> &model)
    {
      if (!settings.is_selective() || !raise_factors(model))
        return false;
      NodalVector before(model.state.partition(), Quantity::scalar);
      before.copy_from(model.bridge->mass());
      model.renew_inertia();
      account_for_added_mass(model, before);
      return true;
    }

    /** Numbers over all ranks. Collective. */
    struct Extent
    {
      unsigned long cells = 0, particles = 0; ///< that have more than the uniform factor
      double smallest_step = 0;               ///< by eq. (41), without any scaling [T]
    };
    Extent extent(const Model<dim> &model) const
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
            constexpr double removed_limit = 1e299;
            if (part.inertia[i] > 1. && steps[i] < removed_limit)
              ++count;
            smallest = std::min(smallest, steps[i]);
          }
        }
        else
          smallest =
              std::min(smallest, part.formulation->courant_limit(model.state.position).time_step);
      }
      extent.cells = dealii::Utilities::MPI::sum(extent.cells, communicator);
      extent.particles = dealii::Utilities::MPI::sum(extent.particles, communicator);
      extent.smallest_step = dealii::Utilities::MPI::min(smallest, communicator) /
                             std::sqrt(settings.inertia_factor());
      return extent;
    }

    /** True mass, added mass and inertia, in the time of the process [M]. */
    struct Masses
    {
      double true_mass, added, inertia;
    };
    /** Collective. */
    Masses masses(const Model<dim> &model) const
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

    static void declare_parameters(Parameters &parameters)
    {
      declare_section<ScalingSettings>(parameters, "Scaling");
    }

    static void prepare(const Parameters &parameters, std::vector<Part<dim>> &parts)
    {
      const double factor = ScalingSettings(parameters.section("Scaling")).inertia_factor();
      std::set<Material *> materials;
      for (const Part<dim> &part : parts)
        if (materials.insert(part.material.get()).second)
          part.material->scale_inertia(factor);
    }

    static void validate(const Parameters &parameters, const std::vector<Part<dim>> &parts)
    {
      const Section scaling = parameters.section("Scaling");
      if (ScalingSettings(scaling).is_active() && !parts.empty() &&
          std::none_of(parts.begin(), parts.end(),
                       [](const Part<dim> &part) { return has_motion(part); }))
        scaling.fail("", "the scene has no mechanics, since its materials have no stresses; "
                         "scaled inertia would do nothing.");
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &parameters, Model<dim> &model)
    {
      const Section section = parameters.section("Scaling");
      const ScalingSettings settings(section);
      if (!settings.is_active())
        return nullptr;
      return std::make_unique<MassScaling>(section, settings, model);
    }

  private:
    void start(Model<dim> &model)
    {
      std::vector<double> steps;
      double smallest = 1e300;
      for (Part<dim> &part : model.parts)
      {
        part.formulation->courant_limits(model.state.position, steps);
        const bool has_all_steps =
            steps.size() >= std::max<std::size_t>(part.formulation->n_cells(),
                                                  part.formulation->particle_nodes().size());
        if (dealii::Utilities::MPI::min(has_all_steps ? 1 : 0, communicator) == 0)
          section.fail("Target time step", "cells of part \"" + part.name +
                                               "\" cannot be given mass one by one; allowed is a "
                                               "uniform `Mass factor`.");
        part.inertia.assign(steps.size(), 1.);
        for (const double step : steps)
          smallest = std::min(smallest, step);
      }
      smallest = dealii::Utilities::MPI::min(smallest, communicator);
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

    void warn_of_mass(const Model<dim> &model, std::vector<std::string> &result) const
    {
      const Masses mass = masses(model);
      if (mass.added > mass.true_mass)
        result.push_back(as_text("`Scaling/Target time step` adds ", mass.added / mass.true_mass,
                                 " times the mass of the bodies: forces of inertia grow as much. "
                                 "What moves slowly bears that while the column `kinetic over "
                                 "internal energy` stays below some 0.05; a smaller target adds "
                                 "less."));
    }

    void describe(const Model<dim> &model, std::ostream &text) const
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

    void report(const Model<dim> &model, TimeTable &table) const
    {
      table.add("added mass", "M", masses(model).added);
      const double internal =
          table.present("elastic energy") + table.present("plastic dissipation");
      const double kinetic = table.present("kinetic energy");
      if (internal > 1e-15 * std::abs(kinetic)) // and not round-off
        table.add("kinetic over internal energy", "1", kinetic / internal);
    }

    Json results(const Model<dim> &model, const TimeTable &table) const
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

    /** Finds the factors for the present positions; whether any has risen. Collective. */
    bool raise_factors(Model<dim> &model) const
    {
      int has_risen = 0;
      std::vector<double> steps;
      for (Part<dim> &part : model.parts)
      {
        part.formulation->courant_limits(model.state.position, steps);
        for (std::size_t i = 0; i < steps.size(); ++i)
        {
          const double ratio = settings.target_time_step / steps[i];
          // A cell turned inside out has no step; the forces report it.
          const double wanted = std::min(ratio * ratio, ScalingSettings::largest_factor);
          if (!(steps[i] > 0.) || !(wanted > part.inertia[i]))
            continue;
          part.inertia[i] = wanted;
          has_risen = 1;
        }
      }
      return dealii::Utilities::MPI::max(has_risen, communicator) == 1;
    }

    /** Energy and momentum of mass that was added to nodes in motion, whose velocity stays. */
    void account_for_added_mass(Model<dim> &model, const NodalVector &previous_mass)
    {
      LoadSum impulses;
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
          work += 0.5 * momentum[d] * v_hat[d];
        }
        impulses.add(model.state.position_of_unsmoothed().node(i), momentum.data());
      }
      model.impulses.add_now(impulses.force, impulses.moment);
    }

    Section section;
    ScalingSettings settings;
    MPI_Comm communicator;
    double work = 0; ///< this rank's share [M L^2/T^2]
  };
} // namespace tombolo
