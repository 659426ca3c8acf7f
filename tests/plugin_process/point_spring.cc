// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/expression.h>
#include <tombolo/base/input/parameters.h>
#include <tombolo/contact/read_vector.h>
#include <tombolo/model/model.h>
#include <tombolo/model/tangent.h>
#include <tombolo/output/time_table.h>

#include <deal.II/base/mpi.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

namespace tombolo
{
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
      if (end.depends_on_place())
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
      this->observed.columns.connect(
          [this, &model](TimeTable &table)
          {
            const double time = table.present("time");
            const double here = is_here ? (end_at(time) - position(model)).norm() : 0.;
            table.add("length of " + name, "L",
                      dealii::Utilities::MPI::sum(here, model.communicator));
          });
      // By the largest frequency of the bodies, 2 over the step, and of the spring.
      this->observed.step_limits.connect(
          [this](const double step, double &fraction) {
            fraction =
                std::min(fraction, 1. / std::sqrt(1. + 0.25 * step * step * stiffness / lightest));
          });
      find_node(model);
      // A node between others gives its force to them; none is lighter than the lightest.
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
        if (const double mass = *model.bridge->mass().node(i); mass > 0.)
          lightest = std::min(lightest, mass);
      lightest = dealii::Utilities::MPI::min(lightest, model.communicator);
    }

    void add_forces(const Model<dim> &model, const Clock &clock, const NodalVector &) override
    {
      if (is_here)
        pull->add_force(node, stiffness * (end_at(clock.time) - position(model)));
    }

    void linearize(const Model<dim> &, const Clock &, Tangent<dim> &tangent) override
    {
      if (is_here)
        tangent.add_spring(node, stiffness);
    }

  private:
    /** The node next to the point; of several, the one with the least number of the mesh. */
    void find_node(const Model<dim> &model)
    {
      std::pair<double, std::uint64_t> least(std::numeric_limits<double>::max(), 0);
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
      {
        double square = 0;
        for (unsigned int d = 0; d < dim; ++d)
          square += std::pow(model.state.initial_position.node(i)[d] - point[d], 2);
        const std::pair<double, std::uint64_t> here(square, model.nodes->persistent_ids()[i]);
        if (here < least)
        {
          least = here;
          node = i;
        }
      }
      is_here = true;
      for (const auto &of_rank : dealii::Utilities::MPI::all_gather(model.communicator, least))
        is_here = is_here && !(of_rank < least);
    }

    dealii::Tensor<1, dim> position(const Model<dim> &model) const
    {
      dealii::Tensor<1, dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = model.state.position.node(node)[d];
      return result;
    }

    dealii::Tensor<1, dim> end_at(const double time) const
    {
      dealii::Tensor<1, dim> result;
      for (unsigned int d = 0; d < dim; ++d)
        result[d] = end.value(dealii::Point<dim>(), time, d);
      return result;
    }

    dealii::Tensor<1, dim> point;
    double stiffness;
    Expression<dim> end;
    std::string name;
    Action *pull = nullptr;
    unsigned int node = 0; // owned
    bool is_here = false;  // whether this rank owns it
    double lightest = std::numeric_limits<double>::max();
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Process, PointSpring, "point spring",
                                  "a spring that pulls a point of a body")
} // namespace tombolo
