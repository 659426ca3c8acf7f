// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/expression.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/base/input/read_vector.h>
#include <tombolo/model/model.h>
#include <tombolo/model/tangent.h>
#include <tombolo/output/history.h>
#include <tombolo/state/body_point.h>

#include <deal.II/base/mpi.h>

#include <array>
#include <cmath>
#include <limits>
#include <string>

namespace tombolo
{
  namespace
  {
    constexpr const char *spring_history = "spring history";
    const HistoryRegistration of_springs({spring_history, "springs.csv",
                                          "Lengths and forces of springs (springs.csv)."});
  } // namespace

  /**
   * A spring that pulls a point of a body with the force
   *
   * @verbatim
   *   f = k (x_e(t) - x_i)
   * @endverbatim
   *
   * at the position x_i of the node i that is next to the point at the start, and the other end of
   * the spring at x_e(t). doc/add_a_process.md walks through it.
   */
  template <int dim>
  class PointSpring : public Process<dim>
  {
  public:
    static void declare_parameters(dealii::ParameterHandler &handler)
    {
      Parameters::declare_mandatory(handler, "Point", dealii::Patterns::Anything(),
                                    "Of the body at the start. Units: L.");
      Parameters::declare_mandatory(handler, "Stiffness", dealii::Patterns::Double(),
                                    "k. Units: M/T^2.");
      Parameters::declare_mandatory(handler, "End", dealii::Patterns::Anything(),
                                    "x_e: components separated by `;`, functions of t. Units: L.");
    }

    explicit PointSpring(const Section &section)
        : point(read_vector<dim>(section, "Point")), stiffness(section.get_positive("Stiffness")),
          end(section, "End", dim)
    {
      if (end.depends_on_position())
        section.fail("End", "allowed are functions of t.");
    }

    void initialize(const Section &section, const Model<dim> &model) override
    {
      if (!model.has_mechanics)
        section.fail("Type", "the scene has no mechanics; nothing can be pulled.");
      name = section.name();
      pull = &this->actions.add("spring " + name, ActsAt::positions)
                  .books("work of " + name, EnergyKind::external)
                  .comes_from_outside();
      this->observed.history(spring_history,
                             [this, &model](BalanceHistory<dim> &row)
                             {
                               const auto pull = pull_at(model, row.present().time);
                               std::array<double, 3> force{};
                               for (unsigned int d = 0; d < dim; ++d)
                                 force[d] = stiffness * pull[d];
                               row.begin_item({name});
                               row.add("length", "L", pull.norm());
                               row.add("force", "M L/T^2", force);
                             });
      // By the largest frequency of the bodies, 2 over the step, and of the spring.
      this->observed.step_limits.connect(
          [this](const double step, double &fraction) {
            fraction =
                std::min(fraction, 1. / std::sqrt(1. + 0.25 * step * step * stiffness / lightest));
          });
      end_of_spring.find(*model.nodes, model.state, point, this->records.group("point of " + name));
      // A node between others passes its force to them; none is lighter than the lightest.
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
        if (const double mass = *model.bridge->mass().node(i); mass > 0.)
          lightest = std::min(lightest, mass);
      lightest = dealii::Utilities::MPI::min(lightest, model.communicator);
    }

    void add_forces(const Model<dim> &model, const Clock &clock, const NodalVector &) override
    {
      const auto force = stiffness * pull_at(model, clock.time);
      if (end_of_spring.is_here())
        pull->add_force(end_of_spring.node(), force);
    }

    void linearize(const Model<dim> &, const Clock &, Tangent<dim> &tangent) override
    {
      if (end_of_spring.is_here())
        tangent.add_spring(end_of_spring.node(), stiffness);
    }

  private:
    /** From the body to the other end of the spring. Collective. */
    dealii::Tensor<1, dim> pull_at(const Model<dim> &model, const double time) const
    {
      dealii::Tensor<1, dim> result = -end_of_spring.value(model.state.position);
      for (unsigned int d = 0; d < dim; ++d)
        result[d] += end.value(dealii::Point<dim>(), time, d);
      return result;
    }

    dealii::Tensor<1, dim> point;
    double stiffness;
    Expression<dim> end;
    std::string name;
    Action *pull = nullptr;
    BodyPoint<dim> end_of_spring;
    double lightest = std::numeric_limits<double>::max();
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Process, PointSpring, "point spring",
                                  "a spring that pulls a point of a body")
} // namespace tombolo
