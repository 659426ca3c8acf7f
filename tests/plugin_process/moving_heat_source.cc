// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/model.h>
#include <tombolo/output/time_table.h>
#include <tombolo/state/state_archive.h>

#include <cmath>
#include <ostream>
#include <string>

namespace tombolo
{
  /** A source of heat that moves along a path: its power is spread over the nodes by their heat
   * capacity and a Gaussian of the distance from its centre. */
  template <int dim>
  class MovingHeatSource : public Process<dim>
  {
  public:
    static void declare_parameters(dealii::ParameterHandler &handler)
    {
      handler.declare_entry("Power", "0", dealii::Patterns::Anything(),
                            "A function of t. Units: M L^2/T^3.");
      handler.declare_entry("Path", "", dealii::Patterns::Anything(),
                            "The centre: components separated by `;`, functions of t. Units: L.");
      handler.declare_entry("Radius", "0", dealii::Patterns::Double(),
                            "Where the density is 1/e of that at the centre. Units: L.");
    }

    explicit MovingHeatSource(const Section &section)
        : power(section, "Power", 1), path(section, "Path", dim),
          radius(section.get_positive("Radius"))
    {}

    void initialize(const Section &section, Model<dim> &model) override
    {
      name = section.name();
      if (!model.heat)
        section.fail("Type", "the scene has no heat; give its materials a section \"Heat\".");
    }

    bool heats() const override
    {
      return true;
    }

    void add_heat(Model<dim> &model, const double begin, const double end,
                  NodalVector &heat) override
    {
      time = 0.5 * (begin + end);
      const dealii::Point<dim> centre = position(time);
      const unsigned int n_owned = heat.partition()->n_owned();
      std::vector<double> weight(n_owned);
      double sum = 0;
      for (unsigned int i = 0; i < n_owned; ++i)
      {
        double square = 0;
        for (unsigned int d = 0; d < dim; ++d)
          square += std::pow(model.state.position.node(i)[d] - centre[d], 2);
        weight[i] = *model.heat->bridge.mass().node(i) * std::exp(-square / (radius * radius));
        sum += weight[i];
      }
      sum = ordered_sum(sum, model.communicator);
      if (!(sum > 0.))
        throw RunError("The heat source \"" + name + "\" is too far from all nodes at time " +
                       std::to_string(time) + ".");
      const double energy = power.value(centre, time) * (end - begin);
      for (unsigned int i = 0; i < n_owned; ++i)
        *heat.node(i) += energy * weight[i] / sum;
      given += energy;
    }

    void account_heat(EnergyAccounts &accounts) const override
    {
      accounts.add_replicated("heat of " + name, EnergyKind::external, given);
    }

    void report_heat(const Model<dim> &, TimeTable &table) const override
    {
      for (unsigned int d = 0; d < dim; ++d)
        table.add(name + " " + "xyz"[d], "L", position(time)[d]);
    }

    void describe(const Model<dim> &, std::ostream &text) const override
    {
      text << "  heat source \"" << name << "\" of radius " << radius << "\n";
    }

    void serialize(Model<dim> &, StateArchive &archive) override
    {
      const auto group = archive.group("heat source " + name);
      archive("given", given);
      archive("time", time);
    }

  private:
    dealii::Point<dim> position(const double at_time) const
    {
      dealii::Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = path.value(dealii::Point<dim>(), at_time, d);
      return result;
    }

    Expression<dim> power, path;
    double radius;
    std::string name;
    double time = 0;  // of the last add_heat()
    double given = 0; // since the start, over all ranks
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Process, MovingHeatSource, "moving heat source",
                                  "heat along a path")
} // namespace tombolo
