// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/input/entries.h>
#include <tombolo/formulations/elements/split_number.h>
#include <tombolo/materials/temperature_table.h>
#include <tombolo/state/state_archive.h>

#include <deal.II/base/mpi.h>
#include <deal.II/base/tensor.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <tuple>
#include <utility>
#include <vector>

namespace tombolo
{
  /** How the particles of a part rub and conduct where they touch. */
  struct RubbingLaw
  {
    TemperatureTable friction;    ///< μ over the temperature
    TemperatureTable conductance; ///< h over the pressure [M/(T^3 temperature)]

    /** Throws InputError. */
    static RubbingLaw create(const Entries &e)
    {
      auto friction = e.object<TemperatureTable>(
          "Self-contact friction", "0", "",
          "Coulomb's coefficient between particles that touch, from 0 to 10; 0 is frictionless "
          "contact. In scenes with heat also pairs `temperature: value` separated by commas, over "
          "the temperature of the hotter particle, joined by straight lines; the heat of friction "
          "is that of both particles, half each. Of two parts the smaller one. Only with "
          "`Self-contact`.");
      e.refuse(!(friction.smallest() >= 0. && friction.largest() <= 10.), "Self-contact friction",
               friction.is_constant() ? "allowed is a number from 0 to 10."
                                      : "allowed are coefficients from 0 to 10.");
      auto conductance = e.object<TemperatureTable>(
          "Self-contact conductance", "0", "M/(T^3 temperature)",
          "h of the heat h (difference of temperatures) that goes from one particle to the other "
          "per area in contact and time: one number, or pairs `pressure: value` separated by "
          "commas, joined by straight lines. 0: nothing is conducted. Of two parts the smaller "
          "one. Only in scenes with heat.",
          "pressure");
      e.refuse(!(conductance.smallest() >= 0.), "Self-contact conductance",
               "allowed are numbers from zero on.");
      return {std::move(friction), std::move(conductance)};
    }

    /** Throws InputError where @p section has laws that need heat. */
    static void refuse_without_heat(const Section &section)
    {
      const RubbingLaw law = create(section);
      if (!law.rubs() && !law.conducts())
        return;
      if (!law.friction.is_constant())
        section.fail("Self-contact friction",
                     "the scene has no temperature; allowed is one number, or materials with a "
                     "section \"Heat\".");
      if (law.conducts())
        section.fail("Self-contact conductance",
                     "the scene has no temperature; allowed is 0, or materials with a section "
                     "\"Heat\".");
    }

    bool rubs() const
    {
      return friction.largest() > 0.;
    }
    bool conducts() const
    {
      return conductance.largest() > 0.;
    }
  };

  /** The spring along the surface between two particles. */
  template <int dim>
  struct RubbingSpring
  {
    double stiffness = 0; ///< zero: open [M/T^2]
    dealii::Tensor<1, dim> slip;
  };

  /** The state of the friction of the particles of one part. */
  template <int dim>
  struct FrictionOfPart
  {
    struct KnownSpring
    {
      std::uint64_t own, partner; ///< persistent identifiers
      unsigned int mirrors;       ///< of the partner
      RubbingSpring<dim> spring;

      bool operator<(const KnownSpring &other) const
      {
        return std::tie(own, partner, mirrors) < std::tie(other.own, other.partner, other.mirrors);
      }
    };
    /** Of mirrors in checkpoints, above half a number. */
    static constexpr double mirror_unit = 4294967296.;

    double stored = 0;     ///< in the springs, of this rank [M L^2/T^2]
    double dissipated = 0; ///< heat of friction since the start, of this rank
    /** The closed ones that no pair has, in the order of their identifiers. */
    std::vector<KnownSpring> springs;
    /** Moves all springs of pairs to the parts of their particles. */
    std::function<void()> fetch_springs;

    /** Writes to a checkpoint or reads it: rows of the particles @p own_ids. Collective. */
    void serialize(StateArchive &archive, const std::vector<std::uint64_t> &own_ids)
    {
      const auto group = archive.group("friction between fragments");
      archive.sums("energies", {&stored, &dissipated});
      if (fetch_springs)
        fetch_springs();
      if (archive.is_reading())
        springs.clear();
      // Rows of the file are of one length, that of the particle with most springs.
      std::vector<std::vector<double>> row_numbers(own_ids.size());
      for (std::size_t i = 0; i < own_ids.size() && !springs.empty(); ++i)
        for (auto known = std::lower_bound(springs.begin(), springs.end(), own_ids[i],
                                           [](const KnownSpring &spring, const std::uint64_t id)
                                           { return spring.own < id; });
             known != springs.end() && known->own == own_ids[i]; ++known)
        {
          row_numbers[i].insert(row_numbers[i].end(),
                                {upper_half(known->partner) + mirror_unit * known->mirrors,
                                 lower_half(known->partner), known->spring.stiffness});
          for (unsigned int d = 0; d < dim; ++d)
            row_numbers[i].push_back(known->spring.slip[d]);
        }
      constexpr unsigned int n_numbers = 3 + dim;
      unsigned int longest = 0;
      for (const std::vector<double> &row : row_numbers)
        longest = std::max(longest, static_cast<unsigned int>(row.size()));
      longest = dealii::Utilities::MPI::max(longest, archive.communicator());
      archive("numbers of a row", longest);
      if (longest == 0)
        return;
      std::vector<double> values;
      for (std::vector<double> &row : row_numbers)
      {
        row.resize(longest, 0.);
        values.insert(values.end(), row.begin(), row.end());
      }
      archive.rows("springs", longest, values);
      if (!archive.is_reading())
        return;
      for (std::size_t i = 0; i < own_ids.size(); ++i)
        for (std::size_t k = i * longest; k < (i + 1) * longest; k += n_numbers)
          if (values[k + 2] > 0.)
          {
            RubbingSpring<dim> spring{values[k + 2], {}};
            for (unsigned int d = 0; d < dim; ++d)
              spring.slip[d] = values[k + 3 + d];
            const double mirrors = std::floor(values[k] / mirror_unit);
            springs.push_back({own_ids[i], joined(values[k] - mirrors * mirror_unit, values[k + 1]),
                               static_cast<unsigned int>(mirrors), spring});
          }
      std::sort(springs.begin(), springs.end());
    }
  };
} // namespace tombolo
