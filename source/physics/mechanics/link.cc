// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/base/input/entries.h>
#include <tombolo/base/input/expression.h>
#include <tombolo/base/input/read_vector.h>
#include <tombolo/model/model.h>
#include <tombolo/model/tangent.h>
#include <tombolo/output/history.h>
#include <tombolo/state/body_point.h>

#include <deal.II/base/mpi.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

namespace tombolo
{
  namespace
  {
    constexpr const char *link_history = "link history";
    const HistoryRegistration link_registration({link_history, "links.csv",
                                                 "Lengths and forces of links (links.csv)."});
  } // namespace

  /**
   * A spring and a dashpot between a point of a body and another one, or a position in space. With
   * the vector r from the first end to the second, its length l and n = r/l, the first end is
   * pulled by
   *
   * @verbatim
   *   f = (k (l - L) + c n · dr/dt) n,   or  f = k r + c dr/dt  where L is always zero (a joint)
   * @endverbatim
   *
   * and the second by -f. The length L without force may change with time, as that of an actuator.
   * Beyond its stops, a shortest and a longest length l_s and l_l, it has in addition
   *
   * @verbatim
   *   f_s = k_s (l - l_l) n  where l > l_l,   f_s = k_s (l - l_s) n  where l < l_s
   * @endverbatim
   *
   * A link costs a sum over ranks in a step for each of its points, another with a dashpot, and
   * nothing else where its points are not.
   */
  template <int dim>
  class Link : public Process<dim>
  {
  public:
    explicit Link(const Entries &e)
    {
      e.text("Point", mandatory, "L",
             "The place at the start of a point of a body, numbers separated by commas: the node "
             "next to it is pulled.");
      e.text("Other point", "", "L", "The same of the other end, where that is a point of a body.");
      end = e.optional<Expression<dim>>(
          "End", "L",
          "Where the other end is no point of a body: its place, components separated by `;`, "
          "functions of t.",
          dim);
      stiffness = e.number("Stiffness", "0", zero_or_positive(), "M/T^2",
                           "$k$: force per change of the length.");
      damping =
          e.number("Damping", "0", zero_or_positive(), "M/T", "$c$: force per rate of the length.");
      free_length = e.optional<Expression<dim>>(
          "Length", "L",
          "The length without force, a function of t; that of the start if empty. With 0 the link "
          "is a joint, which resists every motion of one end against the other.",
          1);
      shortest = e.optional_number("Shortest length", positive(), "L",
                                   "A stop: a link that is shorter is pushed apart by the `Stop "
                                   "stiffness` as well; empty is none. A joint has no such.");
      longest = e.optional_number("Longest length", positive(), "L",
                                  "A stop: a link that is longer is pulled together by the `Stop "
                                  "stiffness` as well; empty is none. Of a joint it is the play.");
      stop_stiffness = e.number("Stop stiffness", "0", zero_or_positive(), "M/T^2",
                                "$k_s$: force per length beyond a stop. The stable step is that "
                                "with a stop that acts.");
      if (e.declares())
        return;
      entries.emplace(e.section());
      point = read_vector<dim>(e.section(), "Point");
      if (e.is_set("Other point"))
        other_point = read_vector<dim>(e.section(), "Other point");
      e.refuse(end.has_value() == other_point.has_value(), "End",
               "a link ends at a place, \"End\", or at a point of a body, \"Other point\"; allowed "
               "is one of both.");
      for (const auto *const function : {&end, &free_length})
        e.refuse(function->has_value() && (*function)->depends_on_position(),
                 function == &end ? "End" : "Length", "allowed are functions of t.");
      e.refuse(!(stiffness > 0. || damping > 0. || stop_stiffness > 0.), "Stiffness",
               "a link needs a stiffness or a damping larger than zero, or stops.");
      e.refuse(
          (shortest || longest) != (stop_stiffness > 0.), "Stop stiffness",
          "stops are a \"Shortest length\" or a \"Longest length\", and a stiffness larger than "
          "zero.");
      e.refuse(shortest && longest && !(*shortest < *longest), "Longest length",
               "allowed is one above \"Shortest length\".");
      is_joint = free_length && !free_length->depends_on_time() &&
                 free_length->value(Point<dim>(), 0.) == 0.;
      e.refuse(is_joint && shortest, "Shortest length",
               "a joint has no direction in which its ends could be pushed apart.");
    }

    void initialize(const Section &section, const Model<dim> &model) override
    {
      if (!model.has_mechanics)
        section.fail("Type", "the scene has no mechanics; nothing can be linked.");
      name = section.name();
      const auto add_pull = [&](const std::string &what) -> Action &
      {
        Action &action = this->actions.add(what + name, ActsAt::positions)
                             .books("work of " + name, EnergyKind::external);
        return end ? action.comes_from_outside() : action;
      };
      first.pull = &add_pull("link ");
      const auto find = [&](BodyPoint<dim> &node, const Vector &place, const std::string &entry,
                            const std::string &records_name)
      {
        node.find(*model.nodes, model.state, place, this->records.group(records_name + name));
        if (const std::string why = node.why_outside(); !why.empty())
          entries->fail(entry, why + ".");
      };
      find(first.node, point, "Point", "point of ");
      if (other_point)
      {
        second.pull = &add_pull("other end of link ");
        find(second.node, *other_point, "Other point", "other point of ");
        if (first.node.persistent_id() == second.node.persistent_id())
          entries->fail("Other point",
                        "the same node is next to \"Point\"; allowed is another one.");
      }
      length_at_start = reach(model, 0.).norm();
      this->records.value("length at the start of " + name, length_at_start);
      this->records.value("force of " + name, force);
      this->records.value("length of " + name, length);
      if (!is_joint && !(length_at_start > 0.))
        entries->fail(other_point ? "Other point" : "End",
                      "both ends are at one place at the start; allowed are two, or `Length = 0`.");
      this->observed.object(*this);
      find_masses(model);
      model.signals.trials.connect([this](const Clock &, double) { resists_no_rates = true; });
      this->observed.history(link_history, [this](BalanceHistory<dim> &row) { add_row(row); });
      this->observed.step_limits.connect([this](const double step, double &fraction)
                                         { fraction = std::min(fraction, stable_share(step)); });
    }

    void model_changed(const Model<dim> &model) override
    {
      find_masses(model);
    }

    void add_forces(const Model<dim> &model, const Clock &clock, const NodalVector &) override
    {
      const Vector r = reach(model, clock.time);
      length = r.norm();
      force =
          pull(r, damping > 0. && !resists_no_rates ? rate(model, clock) : Vector(), clock.time);
      if (first.node.is_here())
        first.pull->add_force(first.node.node(), force);
      if (second.pull != nullptr && second.node.is_here())
        second.pull->add_force(second.node.node(), -force);
    }

    void linearize(const Model<dim> &model, const Clock &clock, Tangent<dim> &tangent) override
    {
      if (!(stiffness > 0. || stop_stiffness > 0.))
        return;
      const Vector r = reach(model, clock.time);
      const double squared = r.norm_square();
      Tensor<2, dim> change;
      // The stiffness across a compressed link would be negative: it counts as zero.
      const auto add = [&](const double along, const double length_of_none)
      {
        const double across = along * std::max(0., 1. - length_of_none / std::sqrt(squared));
        for (unsigned int d = 0; d < dim; ++d)
          change[d][d] += across;
        change += (along - across) / squared * outer_product(r, r);
      };
      if (is_joint)
        for (unsigned int d = 0; d < dim; ++d)
          change[d][d] = stiffness;
      else
        add(stiffness, length_without_force(clock.time));
      if (const double beyond = beyond_stop(std::sqrt(squared)); beyond != 0.)
        add(stop_stiffness, std::sqrt(squared) - beyond);
      if (second.pull == nullptr)
      {
        if (first.node.is_here())
          tangent.add_spring(first.node.node(), change);
      }
      else
        tangent.add_spring(first.node, second.node, change);
    }

  private:
    using Vector = Tensor<1, dim>;

    /** A point of a body that is pulled; null where the end is a position in space. */
    struct PulledPoint
    {
      BodyPoint<dim> node;
      Action *pull = nullptr;
    };

    /** From the first end to the second. Collective. */
    Vector reach(const Model<dim> &model, const double time) const
    {
      Vector result = -first.node.value(model.state.position);
      if (second.pull != nullptr)
        return result + second.node.value(model.state.position);
      for (unsigned int d = 0; d < dim; ++d)
        result[d] += end->value(Point<dim>(), time, d);
      return result;
    }
    /** dr/dt, that of bodies at t_{n-1/2}. Collective. */
    Vector rate(const Model<dim> &model, const Clock &clock) const
    {
      Vector result = -first.node.value(model.state.velocity);
      if (second.pull != nullptr)
        return result + second.node.value(model.state.velocity);
      const double step = clock.previous_step;
      for (unsigned int d = 0; d < dim && step > 0.; ++d)
        result[d] += (end->value(Point<dim>(), clock.time, d) -
                      end->value(Point<dim>(), clock.time - step, d)) /
                     step;
      return result;
    }
    double length_without_force(const double time) const
    {
      return free_length ? free_length->value(Point<dim>(), time) : length_at_start;
    }

    /** By how much a link of a length is longer than its longest, or shorter than its shortest,
     * which is negative. */
    double beyond_stop(const double now) const
    {
      if (longest && now > *longest)
        return now - *longest;
      return shortest && now < *shortest ? now - *shortest : 0.;
    }

    /** The force on the first end, by r and dr/dt. */
    Vector pull(const Vector &r, const Vector &v, const double time) const
    {
      const Vector n = length > 0. ? r / length : Vector();
      const Vector stop_force = stop_stiffness * beyond_stop(length) * n;
      if (is_joint)
        return stiffness * r + damping * v + stop_force;
      return stop_force +
             (stiffness * (length - length_without_force(time)) + damping * (n * v)) * n;
    }

    /** Finds the lightest mass that an end may have. Collective. */
    void find_masses(const Model<dim> &model)
    {
      // The force on a node between others acts on them; none is lighter than the lightest.
      double lightest = std::numeric_limits<double>::max();
      for (unsigned int i = 0; i < model.state.partition()->n_owned(); ++i)
        if (const double mass = *model.bridge->mass().node(i); mass > 0.)
          lightest = std::min(lightest, mass);
      mobility = (other_point ? 2. : 1.) / Utilities::MPI::min(lightest, model.communicator);
      // An end may be that of several links, which add up.
      at_ends = {};
      for (const PulledPoint *const end_point : {&first, &second})
      {
        Sum resistance;
        for (const Link *const other : shown_by_processes<Link<dim>>(model))
          other->add_at(end_point->node.persistent_id(), resistance);
        at_ends.stiffness = std::max(at_ends.stiffness, resistance.stiffness);
        at_ends.damping = std::max(at_ends.damping, resistance.damping);
        if (second.pull == nullptr)
          break;
      }
    }

    /** The stiffness and damping of the links at a node. */
    struct Sum
    {
      double stiffness = 0, damping = 0;
    };

    /** Adds this link where it ends at the node. */
    void add_at(const std::uint64_t node, Sum &sum) const
    {
      if (first.node.persistent_id() != node &&
          (second.pull == nullptr || second.node.persistent_id() != node))
        return;
      sum.stiffness += stiffness + stop_stiffness;
      sum.damping += damping;
    }

    /** The share of the @p step of the bodies, 2 over their largest frequency, that is stable with
     * the link: (2/ω) (√(1 + ξ²) - ξ) with both in ω and the damping as far as it lags behind.
     * Bodies without a limit move by prescribed motion alone. */
    double stable_share(const double step) const
    {
      if (!std::isfinite(step))
        return 1.;
      const double relative = std::sqrt(1. + 0.25 * step * step * at_ends.stiffness * mobility);
      const double lag = 0.25 * step * at_ends.damping * mobility / relative;
      return (std::sqrt(1. + lag * lag) - lag) / relative;
    }

    void add_row(BalanceHistory<dim> &row) const
    {
      std::array<double, 3> components{};
      for (unsigned int d = 0; d < dim; ++d)
        components[d] = force[d];
      row.begin_item({name});
      row.add("length", "L", length);
      row.add("force", "M L/T^2", components);
    }

    std::optional<Section> entries;
    Vector point;
    std::optional<Vector> other_point;
    std::optional<Expression<dim>> end, free_length;
    double stiffness, damping, stop_stiffness;
    std::optional<double> shortest, longest;
    bool is_joint = false, resists_no_rates = false;
    std::string name;
    PulledPoint first, second;
    Vector force;      // on the first end at t_n
    double length = 0; // at t_n
    double length_at_start = 0, mobility = 0;
    Sum at_ends;
  };

  TOMBOLO_REGISTER_FOR_DIMENSIONS(Process, Link, "link",
                                  "a spring and a dashpot, or a joint, between a point of a body "
                                  "and another one or a place")
} // namespace tombolo
