// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/exceptions.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/ordered_sum.h>
#include <tombolo/model/model.h>
#include <tombolo/output/time_table.h>

#include <cmath>
#include <ostream>
#include <sstream>
#include <string>
#include <vector>

namespace tombolo
{
  /**
   * A source of heat that moves along a path x_c(t) with the power P(t). In a thermal step from t_a
   * to t_b the node i gets the heat
   *
   * @verbatim
   *   Q_i = E w_i / Σ_j w_j,   E = ∫ P dt,   w_i = C_i exp(-|x_i - x_c|² / R²)
   * @endverbatim
   *
   * with its capacity C_i and its present position x_i, and x_c in the middle of the step. The sum
   * over the nodes is E, whatever the mesh is. E is by Simpson's rule: exact for a cubic P.
   * doc/add_a_process.md walks through it.
   */
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
      Parameters::declare_mandatory(handler, "Radius", dealii::Patterns::Double(),
                                    "Where the density is 1/e of that at the centre. Units: L.");
    }

    explicit MovingHeatSource(const Section &section)
        : power(section, "Power", 1), path(section, "Path", dim),
          radius(section.get_positive("Radius"))
    {
      if (power.depends_on_position())
        section.fail("Power", "the power is that of the whole source; allowed is a function of t.");
      if (path.depends_on_position())
        section.fail("Path", "allowed are functions of t.");
    }

    void initialize(const Section &section, const Model<dim> &model) override
    {
      name = section.name();
      if (!model.heat)
        section.fail("Type", "the scene has no heat; give its materials a section \"Heat\".");
      torch = &this->actions.add_heat("heat source " + name, "heat of " + name);
      this->observed.columns.connect(
          [this](TimeTable &table)
          {
            const double time = table.present("time");
            table.add("power of " + name, "M L^2/T^3", power_at(time));
            for (unsigned int d = 0; d < dim; ++d)
              table.add(name + " " + "xyz"[d], "L", centre(time)[d]);
          });
      this->observed.audit.connect(
          [this](std::ostream &text)
          {
            text << "  heat source \"" << name << "\" of radius " << radius << ", at ("
                 << centre(0.) << ") at time 0\n";
          });
    }

    void add_heat(const Model<dim> &model, const double begin, const double end) override
    {
      const double middle = 0.5 * (begin + end);
      const double energy =
          (end - begin) / 6. * (power_at(begin) + 4. * power_at(middle) + power_at(end));
      if (energy == 0.)
        return;
      const dealii::Point<dim> at = centre(middle);
      const unsigned int n_owned = model.state.partition()->n_owned();
      std::vector<double> weight(n_owned);
      double sum = 0;
      for (unsigned int i = 0; i < n_owned; ++i)
      {
        double square = 0;
        for (unsigned int d = 0; d < dim; ++d)
          square += std::pow(model.state.position.node(i)[d] - at[d], 2);
        weight[i] = *model.heat->bridge.mass().node(i) * std::exp(-square / (radius * radius));
        sum += weight[i];
      }
      sum = ordered_sum(sum, model.communicator);
      if (!(sum > 0.))
      {
        std::ostringstream message;
        message << "The heat source \"" << name << "\" is too far from all nodes at time " << middle
                << ", where its centre is at (" << at << ").";
        throw RunError(message.str());
      }
      for (unsigned int i = 0; i < n_owned; ++i)
        torch->add_heat(i, energy * weight[i] / sum);
    }

  private:
    double power_at(const double time) const
    {
      return power.value(dealii::Point<dim>(), time);
    }

    dealii::Point<dim> centre(const double time) const
    {
      dealii::Point<dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = path.value(dealii::Point<dim>(), time, d);
      return result;
    }

    Expression<dim> power, path;
    double radius; // [L]
    std::string name;
    HeatAction *torch = nullptr;
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Process, MovingHeatSource, "moving heat source",
                                  "heat along a path")
} // namespace tombolo
