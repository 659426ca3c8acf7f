// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/format.h>
#include <tombolo/base/on_ranks.h>
#include <tombolo/model/model.h>
#include <tombolo/model/process.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/symmetric_tensor.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iomanip>
#include <string>
#include <utility>
#include <vector>

namespace tombolo
{
  namespace
  {
    /** Above it the error of the energy is visible: at 0.16 it is 0.05. */
    constexpr double large_strain = 0.05;

    /** The largest principal value of C⁻¹ : σ over all points. Collective. */
    template <int dim>
    double largest_elastic_strain(const Model<dim> &model, const Part<dim> &part)
    {
      const MaterialPoints &points = part.formulation->points();
      const double twice_shear = 2. * part.material->shear_modulus(),
                   bulk = part.material->bulk_modulus();
      double largest = 0;
      for (unsigned int i = 0; i < points.size(); ++i)
      {
        SymmetricTensor<2, 3> stress;
        constexpr unsigned int entries[6][2] = {{0, 0}, {1, 1}, {2, 2}, {1, 2}, {0, 2}, {0, 1}};
        for (unsigned int c = 0; c < 6; ++c)
          stress[entries[c][0]][entries[c][1]] = points.component(MaterialPoints::stress, c)[i];
        const double mean = trace(stress) / 3.;
        for (const double principal : eigenvalues(stress))
          largest =
              std::max(largest, std::abs((principal - mean) / twice_shear + mean / (3. * bulk)));
      }
      return Utilities::MPI::max(largest, model.communicator);
    }

    /** The displacement of a node where displacements and clamps prescribe all its components. */
    template <int dim>
    bool find_displacement(const MechanicalConditions<dim> &conditions, const std::size_t k,
                           const Point<dim> &position, const double time,
                           Tensor<1, dim> &displacement)
    {
      for (unsigned int d = 0; d < dim; ++d)
      {
        const int c = conditions.prescribing_condition(k, d);
        if (c < 0)
          return false;
        const MechanicalCondition<dim> &condition = conditions.all()[static_cast<std::size_t>(c)];
        if (condition.axes.are_local() || condition.is_timed())
          return false;
        if (condition.type == MechanicalConditionType::displacement)
          displacement[d] = condition.displacement(position, d, time);
        else if (condition.type == MechanicalConditionType::clamp)
          displacement[d] = 0.;
        else
          return false;
      }
      return true;
    }

    /** The relative change of the distance of two prescribed nodes until @p end_time: of those with
     * the largest displacements along each axis, either way. Collective. */
    template <int dim>
    double foreseen_strain(const Model<dim> &model, const double end_time)
    {
      constexpr unsigned int n_moments = 8;
      const MechanicalConditions<dim> &conditions = *model.conditions;
      double largest = 0;
      for (unsigned int moment = 1; moment <= n_moments; ++moment)
      {
        // For each axis and direction: the displacement, the positions before and then.
        using Farthest = std::array<double, 1 + 2 * dim>;
        std::vector<Farthest> farthest(2 * dim);
        for (Farthest &entry : farthest)
          entry[0] = -1e300;
        for (std::size_t k = 0; k < conditions.constrained_nodes().size(); ++k)
        {
          const Point<dim> position =
              point_of<dim>(model.state.initial_position.node(conditions.constrained_nodes()[k]));
          Tensor<1, dim> displacement;
          try
          {
            if (!find_displacement(conditions, k, position, end_time * moment / n_moments,
                                   displacement))
              continue;
          }
          catch (const RunError &)
          {
            continue; // a function without a value stops the run with its own message
          }
          for (unsigned int direction = 0; direction < 2 * dim; ++direction)
          {
            Farthest entry;
            entry[0] = (direction % 2 == 0 ? 1. : -1.) * displacement[direction / 2];
            for (unsigned int d = 0; d < dim; ++d)
            {
              entry[1 + d] = position[d];
              entry[1 + dim + d] = position[d] + displacement[d];
            }
            farthest[direction] = std::max(farthest[direction], entry);
          }
        }
        for (const auto &rank_farthest : items_by_rank(farthest, model.communicator))
          for (unsigned int direction = 0; direction < 2 * dim; ++direction)
            farthest[direction] = std::max(farthest[direction], rank_farthest[direction]);
        for (unsigned int axis = 0; axis < dim; ++axis)
        {
          const Farthest &a = farthest[2 * axis], &b = farthest[2 * axis + 1];
          double before = 0, after = 0;
          for (unsigned int d = 0; d < dim && a[0] > -1e300; ++d)
          {
            before = std::hypot(before, a[1 + d] - b[1 + d]);
            after = std::hypot(after, a[1 + dim + d] - b[1 + dim + d]);
          }
          if (before > 0.)
            largest = std::max(largest, std::abs(after / before - 1.));
        }
      }
      return largest;
    }

    std::string percent_of(const double strain)
    {
      return as_text(std::setprecision(2), 100. * strain, " %");
    }

    std::string sentence(const std::string &what, const double strain, const std::string &cure)
    {
      return what + " by " + percent_of(strain) +
             ". Its stress follows the rate of deformation and derives from no energy, so that the "
             "balance of energy will not hold, with any step; with `" +
             cure + "` it does.";
    }

    /** The value of an entry; empty where nothing declares it: formulations differ, and a model can
     * stand without a run. */
    std::string value_of(const Section &section, const std::string &entry)
    {
      return section.is_declared(entry) ? section.get(entry) : "";
    }

    /** The entry by which the stress of a part derives from an energy; empty where it does, or
     * where the formulation has no such choice. */
    std::string cure_of(const Section &part)
    {
      const Section method = part.subsection(part.get("Formulation"));
      const std::string measure = value_of(method, "Strain measure");
      const std::string smoothing = value_of(method, "Smoothing");
      // Positions have to move with the velocity that strains.
      if (!measure.empty() && !smoothing.empty() && smoothing != "affine" && smoothing != "none")
        return method.path() + "/Smoothing = affine";
      const bool is_rate =
          measure == "rate" || (measure == "automatic" && value_of(method, "Gradient") == "paper");
      return is_rate ? method.path() + "/Strain measure = logarithmic" : "";
    }
  } // namespace

  /**
   * Watches the strain of elastic parts whose stress follows the rate of deformation
   * (StrainMeasure::rate). Such a stress is the derivative of no energy: at a large strain the
   * balance of energy is off by a like share, with any step. Warns of it once, before the run where
   * prescribed displacements determine the strain.
   */
  template <int dim>
  class ElasticStrain : public Process<dim>
  {
  public:
    /** A part and the change of its section by which its stress has an energy. */
    struct WatchedPart
    {
      unsigned int part; ///< in the model
      std::string cure;  ///< entry and value
      bool has_warned = false;
    };

    /** @p foreseen: the largest strain by prescribed displacements. */
    ElasticStrain(std::vector<WatchedPart> watched_parts, const double foreseen,
                  const Model<dim> &model)
        : parts(std::move(watched_parts)), foreseen(foreseen)
    {
      parts.front().has_warned = foreseen > large_strain;
      this->observed.warnings.connect([this, &model](auto &, const auto occasion, auto &warnings)
                                      { add_warnings(model, occasion, warnings); });
    }

    static std::unique_ptr<Process<dim>> make(const Parameters &parameters, Model<dim> &model)
    {
      const Section run = parameters.section("");
      const std::string integration = value_of(run, "Time integration");
      if (!model.has_mechanics || !(integration.empty() || integration == "explicit"))
        return nullptr;
      std::vector<WatchedPart> parts;
      for (unsigned int p = 0; p < model.parts.size(); ++p)
      {
        const Part<dim> &part = model.parts[p];
        const MaterialPoints &points = part.formulation->points();
        if (!part.material->has_mechanics() ||
            points.find_field("plastic work") < points.fields().size())
          continue;
        const std::string cure = cure_of(parameters.section("Part: " + part.name));
        if (!cure.empty())
          parts.push_back({p, cure});
      }
      if (parts.empty())
        return nullptr;
      const bool is_run = !value_of(run, "End time").empty();
      return std::make_unique<ElasticStrain>(
          std::move(parts), is_run ? foreseen_strain(model, run.get_double("End time")) : 0.,
          model);
    }

  private:
    void add_warnings(const Model<dim> &model, const typename Process<dim>::Occasion occasion,
                      std::vector<std::string> &warnings)
    {
      using Occasion = typename Process<dim>::Occasion;
      if (occasion == Occasion::energy_lost)
        add_advice(model, warnings);
      if (occasion == Occasion::audit && foreseen > large_strain)
        warnings.push_back(sentence("Prescribed displacements change distances of an elastic body",
                                    foreseen, parts.front().cure));
      if (occasion != Occasion::row)
        return;
      for (WatchedPart &watched : parts)
      {
        if (watched.has_warned)
          continue;
        const Part<dim> &part = model.parts[watched.part];
        const double strain = largest_elastic_strain(model, part);
        watched.has_warned = strain > large_strain;
        if (watched.has_warned)
          warnings.push_back(
              sentence("Part \"" + part.name + "\" is elastic and strained", strain, watched.cure));
      }
    }

    /** Adds advice where the balance of energy stops a run: on the part with the largest strain, or
     * nothing where all are small. Collective. */
    void add_advice(const Model<dim> &model, std::vector<std::string> &warnings) const
    {
      double largest = large_strain;
      std::string text;
      for (const WatchedPart &watched : parts)
      {
        const Part<dim> &part = model.parts[watched.part];
        const double strain = largest_elastic_strain(model, part);
        if (!(strain > largest))
          continue;
        largest = strain;
        text = sentence("Part \"" + part.name + "\" is elastic and strained", strain, watched.cure);
      }
      if (!text.empty())
        warnings.push_back(text);
    }

    std::vector<WatchedPart> parts;
    double foreseen;
  };

  TOMBOLO_REGISTER_PROCESS(ElasticStrain, process_order::sections)
} // namespace tombolo
