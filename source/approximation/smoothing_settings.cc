// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/approximation/smoothing_settings.h>

#include <tombolo/approximation/moving_least_squares.h>
#include <tombolo/base/input/entries.h>

#include <cmath>
#include <cstdlib>
#include <numeric>

namespace tombolo
{
  namespace
  {
    double moment(const std::vector<double> &row, const int power)
    {
      const int n = static_cast<int>(row.size() / 2);
      double sum = 0;
      for (int j = -n; j <= n; ++j)
        sum += row[static_cast<std::size_t>(j + n)] * std::pow(j, power);
      return sum;
    }
  } // namespace

  double LatticeRow::second_moment() const
  {
    return moment(value, 2);
  }

  double LatticeRow::third_moment() const
  {
    return moment(gradient, 3);
  }

  namespace SmoothingStrength
  {
    LatticeRow lattice_row(const Kernel &kernel, const double dilation)
    {
      if (!(dilation > 1.))
        throw InputError("A dilation of " + std::to_string(dilation) +
                         " leaves a particle without neighbours; allowed are numbers above 1, "
                         "usual are 1.5 to 1.9.");
      // A plane patch is enough: the rows of a lattice are products over the axes.
      const unsigned int n = static_cast<unsigned int>(std::ceil(dilation));
      const unsigned int width = 2 * n + 1;
      const unsigned int n_nodes = width * width;
      std::vector<double> position(n_nodes * node_stride, 0.),
          support(n_nodes * node_stride, dilation);
      Stencils shape;
      shape.particle_node = {n_nodes / 2};
      shape.row_start = {0, n_nodes};
      shape.neighbour.resize(n_nodes);
      std::iota(shape.neighbour.begin(), shape.neighbour.end(), 0u);
      for (unsigned int i = 0; i < n_nodes; ++i)
      {
        position[i * node_stride] = double(i % width) - n;
        position[i * node_stride + 1] = double(i / width) - n;
      }
      MovingLeastSquares<2> least_squares(
          std::shared_ptr<const Kernel>(std::shared_ptr<const Kernel>(), &kernel));
      const auto &defects =
          least_squares.compute(shape.neighbour, position.data(), support.data(), shape);
      if (!defects.empty())
        throw InputError("A dilation of " + std::to_string(dilation) +
                         " is too close to 1 for the shape functions of a lattice.");
      LatticeRow row;
      row.value.assign(width, 0.);
      row.gradient.assign(width, 0.);
      for (unsigned int i = 0; i < n_nodes; ++i)
      {
        row.value[i % width] += shape.value[i];
        row.gradient[i % width] += shape.gradient[i * Stencils::n_gradient];
      }
      return row;
    }

    double fe_matched(const LatticeRow &row)
    {
      return 0.5 * (1. + (row.third_moment() / 3. - 1. / 12.) / row.second_moment());
    }

    double phase(const LatticeRow &row)
    {
      return 0.5 * (1. + row.third_moment() / (3. * row.second_moment()));
    }
  } // namespace SmoothingStrength

  SmoothingSettings SmoothingSettings::read(const Entries &e, const Kernel &kernel,
                                            const double dilation)
  {
    SmoothingSettings settings;
    const std::string smoothing = e.text(
        "Smoothing", "affine", "",
        "How velocities are smoothed: `paper` (momentum-consistent smoothing of Pan et al. "
        "2019), `fe matched` and `phase` (sharpened to the phase speed of finite elements, and "
        "to fourth order), `affine` (linear fields are reproduced, so that angular momentum is "
        "conserved), `none`, or a number gamma for S (I + gamma (I - Phi S)).");
    settings.smallest_mass_share = e.number(
        "Smallest smoothed mass", "0.01", between(0., 0.15), "1",
        "Where neighbours mix, a node can have hardly any smoothed mass m left; its velocity, "
        "a sum of positive and negative shares over m, is then far from those around it. "
        "Where m is at most this share of the node's own mass, rows with a negative share of "
        "it lose their negative shares. On lattices, disordered ones too, m is above 0.18. "
        "0.1 for flows that stir.");
    if (e.declares())
      return settings;
    if (smoothing == "none")
      settings.is_active = false;
    else if (smoothing == "affine")
      settings.affine = true;
    else if (smoothing == "fe matched")
      settings.gamma =
          SmoothingStrength::fe_matched(SmoothingStrength::lattice_row(kernel, dilation));
    else if (smoothing == "phase")
      settings.gamma = SmoothingStrength::phase(SmoothingStrength::lattice_row(kernel, dilation));
    else if (smoothing != "paper")
    {
      char *end = nullptr;
      settings.gamma = std::strtod(smoothing.c_str(), &end);
      if (smoothing.empty() || *end != '\0' || !(std::abs(settings.gamma) <= 10.))
      {
        const std::string nearest =
            nearest_name(smoothing, {"paper", "fe matched", "phase", "affine", "none"});
        e.section().fail("Smoothing",
                         "allowed is paper, fe matched, phase, affine, none, or a number "
                         "between -10 and 10" +
                             (nearest.empty() ? "" : "; did you mean \"" + nearest + "\"?"));
      }
    }
    return settings;
  }
} // namespace tombolo
