// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/study/waves/linearized_operators.h>

#include <tombolo/base/exceptions.h>
#include <tombolo/base/simd/vectorization.h>
#include <tombolo/model/assembly.h>

#include <algorithm>
#include <cmath>
#include <string>

namespace tombolo
{
  using namespace dealii;

  namespace
  {
    // No operator couples nodes farther apart than this many reaches of the shape functions: the
    // stiffness between the interpolations of the trace bridge, S(I + γT) and its adjoint.
    constexpr int reaches_per_operator = 4;
    // Mass and shape functions of a node differ from those of the lattice this close to an edge.
    constexpr int reaches_of_edges = 2;
    constexpr double probe_round_off = 1e-11;

    void require(const bool condition, const std::string &message)
    {
      if (!condition)
        throw RunError(message);
    }

    std::vector<double> distinct(std::vector<double> values)
    {
      std::sort(values.begin(), values.end());
      const double tolerance = 1e-9 * (values.back() - values.front());
      std::vector<double> result;
      for (const double value : values)
        if (result.empty() || value - result.back() > tolerance)
          result.push_back(value);
      return result;
    }

    unsigned int nearest(const std::vector<double> &sorted, const double value)
    {
      const auto above = std::lower_bound(sorted.begin(), sorted.end(), value);
      auto index = static_cast<unsigned int>(above - sorted.begin());
      if (index == sorted.size() ||
          (index > 0 && value - sorted[index - 1] < sorted[index] - value))
        --index;
      return index;
    }
  } // namespace

  LinearizedOperators::StripSize LinearizedOperators::strip_size(const unsigned int neighbour_reach)
  {
    const unsigned int margin = (reaches_per_operator + reaches_of_edges) * neighbour_reach;
    // The two outermost probed columns see no interface; they are compared with each other.
    return {2 * margin + 4, 2 * margin + 2};
  }

  LinearizedOperators::LinearizedOperators(const Model<2> &model,
                                           const unsigned int neighbour_reach)
      : reach(reaches_per_operator * static_cast<int>(neighbour_reach)),
        n_probed((reaches_per_operator + reaches_of_edges) * static_cast<int>(neighbour_reach) + 2)
  {
    find_lattice(model);
    Bridge &bridge = *model.bridge;
    const NodalVector &position = model.state.position;

    for (int column = -n_columns; column <= n_columns; ++column)
    {
      const unsigned int i = node(column, middle);
      masses.insert(masses.end(), {*bridge.mass().node(i), bridge.nodal_mass().node(i)[0],
                                   bridge.nodal_mass().node(i)[1]});
    }

    smoothing = probe(position, [&](const NodalVector &in, NodalVector &out)
                      { bridge.apply_smoothing(in, out); });
    interpolation = probe(position, [&](const NodalVector &in, NodalVector &out)
                          { bridge.apply_adjoint(in, out); });
    short_wave_part = probe(position, [&](const NodalVector &in, NodalVector &out)
                            { bridge.apply_short_wave_part(in, out); });

    Assembly<2> assembly(model.parts);
    const auto apply_stiffness =
        [&](const NodalVector &in, const double time_step, NodalVector &out)
    {
      assembly.assemble(
          bridge, in, out,
          [&](const Part<2> &part, const NodalVector &seen, NodalVector &result)
          { part.formulation->apply_elastic_stiffness(position, seen, time_step, result); });
      for (unsigned int i = 0; i < position.partition()->n_owned(); ++i)
        store_node(load_node(out.node(i)) / load_node(bridge.nodal_mass().node(i)), out.node(i));
    };
    // K v + (2/Δt) C v
    constexpr double long_step = 1e200;
    stiffness = probe(position, [&](const NodalVector &in, NodalVector &out)
                      { apply_stiffness(in, long_step, out); });
    viscosity = probe(position, [&](const NodalVector &in, NodalVector &out)
                      { apply_stiffness(in, 2., out); });
    for (std::size_t k = 0; k < viscosity.values.size(); ++k)
      viscosity.values[k] -= stiffness.values[k];

    for (const Probe *of : {&smoothing, &interpolation, &short_wave_part, &stiffness})
      check_far_columns(*of);
  }

  void LinearizedOperators::find_lattice(const Model<2> &model)
  {
    const NodalVector &position = model.state.initial_position;
    const unsigned int n = position.partition()->n_owned();
    require(position.partition()->n_global() == n,
            "The strip of an update operator must be on one rank.");
    std::vector<double> x(n), y(n);
    for (unsigned int i = 0; i < n; ++i)
    {
      x[i] = position.node(i)[0];
      y[i] = position.node(i)[1];
    }
    x_coordinates = distinct(x);
    y_coordinates = distinct(y);
    n_columns = static_cast<int>(nearest(x_coordinates, 0.));
    middle = static_cast<unsigned int>(y_coordinates.size() / 2);
    require(n == x_coordinates.size() * y_coordinates.size() &&
                static_cast<int>(x_coordinates.size()) == 2 * n_columns + 1 &&
                n_columns >= n_probed + reach,
            "The strip of an update operator must be a lattice with the interface in "
            "its middle, of the size that strip_size() names.");
    nodes.resize(n);
    for (unsigned int i = 0; i < n; ++i)
      nodes[nearest(x_coordinates, x[i]) * y_coordinates.size() + nearest(y_coordinates, y[i])] = i;
  }

  double LinearizedOperators::spacing(const ChainSide side) const
  {
    const auto interface = static_cast<std::size_t>(n_columns);
    return side == ChainSide::left ? x_coordinates[interface] - x_coordinates[interface - 1]
                                   : x_coordinates[interface + 1] - x_coordinates[interface];
  }

  LinearizedOperators::Probe LinearizedOperators::probe(const NodalVector &like,
                                                        const Operator &apply) const
  {
    Probe result;
    result.reach = reach;
    NodalVector in, out;
    in.reinit(like.partition());
    out.reinit(like.partition());
    const int n_rows = static_cast<int>(y_coordinates.size());
    for (int source = -n_probed; source <= n_probed; ++source)
      for (unsigned int of = 0; of < 2; ++of)
      {
        double *const unit = in.node(node(source, middle)) + of;
        *unit = 1.;
        apply(in, out);
        *unit = 0.;

        double largest = 0, largest_outside = 0;
        for (int column = -n_columns; column <= n_columns; ++column)
          for (int row = 0; row < n_rows; ++row)
          {
            const double *const response = out.node(node(column, static_cast<unsigned int>(row)));
            const bool is_inside = std::abs(column - source) <= reach &&
                                   std::abs(row - static_cast<int>(middle)) <= reach;
            double &target = is_inside ? largest : largest_outside;
            target = std::max({target, std::abs(response[0]), std::abs(response[1])});
          }
        require(largest_outside <= probe_round_off * largest,
                "An operator reaches farther than its strip was made for.");
        for (int column = source - reach; column <= source + reach; ++column)
          for (int row = -reach; row <= reach; ++row)
          {
            const auto of_row = static_cast<unsigned int>(static_cast<int>(middle) + row);
            const double *const response = out.node(node(column, of_row));
            result.values.insert(result.values.end(), {response[0], response[1]});
          }
      }
    return result;
  }

  double LinearizedOperators::value(const Probe &probe, const int source, const unsigned int of,
                                    const int column, const int row, const unsigned int on) const
  {
    const int width = 2 * probe.reach + 1;
    const int place =
        (((source + n_probed) * 2 + static_cast<int>(of)) * width + column - source + probe.reach) *
            width +
        row + probe.reach;
    return probe.values[static_cast<std::size_t>(place) * 2 + on];
  }

  void LinearizedOperators::check_far_columns(const Probe &probe) const
  {
    double largest = 0, difference = 0;
    for (const int outermost : {-n_probed, n_probed})
    {
      const int inside = outermost < 0 ? 1 : -1;
      for (unsigned int of = 0; of < 2; ++of)
        for (int column = outermost - probe.reach; column <= outermost + probe.reach; ++column)
          for (int row = -probe.reach; row <= probe.reach; ++row)
            for (unsigned int on = 0; on < 2; ++on)
            {
              const double here = value(probe, outermost, of, column, row, on);
              const double beside = value(probe, outermost + inside, of, column + inside, row, on);
              largest = std::max(largest, std::abs(here));
              difference = std::max(difference, std::abs(here - beside));
            }
    }
    require(difference <= probe_round_off * largest,
            "The outer columns of the strip see its ends or the interface.");
  }

  BlochOperator LinearizedOperators::reduce(const Probe &probe, const double wave_number) const
  {
    const double row_height = y_coordinates[middle + 1] - y_coordinates[middle];
    BlochOperator result(probe.reach, -n_probed, n_probed);
    for (int row = -probe.reach; row <= probe.reach; ++row)
    {
      const std::complex<double> factor = std::polar(1., -wave_number * row * row_height);
      for (int source = -n_probed; source <= n_probed; ++source)
        for (int column = source - probe.reach; column <= source + probe.reach; ++column)
        {
          ChainBlock &block = result.given_block(column, source);
          for (unsigned int on = 0; on < 2; ++on)
            for (unsigned int of = 0; of < 2; ++of)
              block[2 * on + of] += factor * value(probe, source, of, column, row, on);
        }
    }
    result.drop_round_off(1e-14);
    return result;
  }

  ReducedOperators LinearizedOperators::reduce(const double wave_number) const
  {
    const BlochOperator s = reduce(smoothing, wave_number);
    const BlochOperator k = reduce(stiffness, wave_number);
    const BlochOperator c = reduce(viscosity, wave_number);
    const BlochOperator phi = reduce(interpolation, wave_number);
    BlochOperator update = phi * (k * s);
    BlochOperator damping = phi * (c * s);
    update.drop_round_off(1e-14);
    // Without viscosity nothing but the round-off of a difference is left.
    damping.drop_round_off(damping.largest_entry() > 1e-10 * std::sqrt(k.largest_entry()) ? 1e-14
                                                                                          : 2.);
    return {s, k, c, phi, reduce(short_wave_part, wave_number), update, damping};
  }
} // namespace tombolo
