// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/output/unit_labels.h>

#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/registry.h>

#include <deal.II/base/utilities.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace tombolo
{
  namespace
  {
    struct LabelledQuantity
    {
      const char *name;
      std::vector<std::string> units; ///< the spellings that descriptions use
    };

    const std::vector<LabelledQuantity> quantities = {
        {"length", {"L"}},
        {"mass", {"M"}},
        {"time", {"T"}},
        {"temperature", {"K", "temperature"}},
        {"velocity", {"L/T"}},
        {"force", {"M L/T^2"}},
        {"stress", {"M/(L T^2)", "M/(T^2 L)"}},
        {"energy", {"M L^2/T^2"}},
        {"power", {"M L^2/T^3"}},
        {"momentum", {"M L/T"}},
        {"angular momentum", {"M L^2/T"}},
        {"torque", {"M L^2/T^2"}},
        {"density", {"M/L^3"}},
    };
  } // namespace

  UnitLabels::UnitLabels(const Entries &e)
  {
    std::vector<std::string> names;
    std::string allowed;
    for (const LabelledQuantity &quantity : quantities)
    {
      names.emplace_back(quantity.name);
      allowed += (allowed.empty() ? "" : ", ") + names.back();
    }

    const std::string labels =
        e.text("Unit labels", "", "",
               "Names of the units that the numbers of this file are in, for headers and plots: a "
               "list of `quantity: name`, for example `length: mm, mass: t, time: s, stress: MPa`. "
               "Quantities: length, mass, time, temperature, and for shorter names velocity, "
               "force, stress, energy, power, momentum, angular momentum, density. Force, stress, "
               "energy and power follow from units of length, mass and time that are known, as N "
               "from `mm, t, s`. They change no number: the units of a file must be consistent in "
               "themselves.");
    const Section &root = e.section();
    for (const std::string &item : Utilities::split_string_list(labels, ','))
    {
      const std::vector<std::string> pair = Utilities::split_string_list(item, ':');
      if (pair.size() != 2 || pair[1].empty())
        root.fail("Unit labels", "\"" + item +
                                     "\" is not of the form `quantity: name`, for example "
                                     "`length: mm`");
      if (std::find(names.begin(), names.end(), pair[0]) == names.end())
      {
        const std::string nearest = nearest_name(pair[0], names);
        root.fail("Unit labels",
                  "there is no quantity \"" + pair[0] + "\"" +
                      (nearest.empty() ? "" : ", did you mean \"" + nearest + "\"?") +
                      " Allowed: " + allowed);
      }
      for (const auto &other : given)
        if (other.first == pair[0])
          root.fail("Unit labels", "\"" + pair[0] + "\" is named twice");
      given.emplace_back(pair[0], pair[1]);
    }
    const auto length = in_si("L"), mass = in_si("M"), time = in_si("T");
    if (length && mass && time)
    {
      const double force = *mass * *length / (*time * *time);
      derive("force", force);
      derive("stress", force / (*length * *length));
      derive("energy", force * *length);
      derive("torque", force * *length);
      derive("power", force * *length / *time);
    }
  }

  std::optional<double> UnitLabels::in_si(const std::string &symbol) const
  {
    static const std::map<std::string, std::map<std::string, double>> units = {
        {"L",
         {{"m", 1.},
          {"cm", 1e-2},
          {"mm", 1e-3},
          {"um", 1e-6},
          {"µm", 1e-6},
          {"μm", 1e-6},
          {"nm", 1e-9}}},
        {"M", {{"t", 1e3}, {"kg", 1.}, {"g", 1e-3}, {"mg", 1e-6}}},
        {"T", {{"s", 1.}, {"ms", 1e-3}, {"us", 1e-6}, {"µs", 1e-6}, {"μs", 1e-6}, {"ns", 1e-9}}}};
    const auto &known = units.at(symbol);
    const auto found = known.find(label(symbol));
    return found == known.end() ? std::nullopt : std::optional<double>(found->second);
  }

  void UnitLabels::derive(const std::string &quantity, const double in_si)
  {
    static const std::map<std::string, std::string> units = {
        {"force", "N"}, {"stress", "Pa"}, {"energy", "J"}, {"torque", "N m"}, {"power", "W"}};
    static const std::pair<double, const char *> prefixes[] = {
        {1e-9, "n"}, {1e-6, "u"}, {1e-3, "m"}, {1., ""}, {1e3, "k"}, {1e6, "M"}, {1e9, "G"}};
    for (const auto &[factor, prefix] : prefixes)
      if (std::abs(in_si / factor - 1.) < 1e-9)
        derived.emplace_back(quantity, prefix + units.at(quantity));
  }

  std::string UnitLabels::label(const std::string &unit) const
  {
    for (const LabelledQuantity &quantity : quantities)
      if (std::find(quantity.units.begin(), quantity.units.end(), unit) != quantity.units.end())
        for (const auto *const labels : {&given, &derived})
          for (const auto &entry : *labels)
            if (entry.first == quantity.name)
              return entry.second;

    std::string result;
    for (const char symbol : unit)
    {
      const char *name = symbol == 'L'   ? "length"
                         : symbol == 'M' ? "mass"
                         : symbol == 'T' ? "time"
                         : symbol == 'K' ? "temperature"
                                         : nullptr;
      const auto entry =
          std::find_if(given.begin(), given.end(),
                       [name](const auto &pair) { return name != nullptr && pair.first == name; });
      if (entry != given.end())
        result += entry->second;
      else
        result += symbol;
    }
    return result;
  }

  std::string UnitLabels::label_of(const std::string &name, const std::string &unit) const
  {
    const bool is_moment =
        name.find("torque") != std::string::npos ||
        (name.find("moment") != std::string::npos && name.find("momentum") == std::string::npos);
    if (is_moment && unit == "M L^2/T^2")
      for (const auto *const labels : {&given, &derived})
        for (const auto &entry : *labels)
          if (entry.first == "torque")
            return entry.second;
    return label(unit);
  }

  std::string UnitLabels::heading(const std::string &name, const std::string &unit) const
  {
    return unit.empty() || unit == "1" ? name : name + " [" + label_of(name, unit) + "]";
  }
} // namespace tombolo
