// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/study/waves/lattice_waves.h>

#include <tombolo/base/exceptions.h>

#include <deal.II/base/numbers.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  using dealii::numbers::PI;

  namespace
  {
    using Vector2 = std::array<std::complex<double>, 2>;

    std::complex<double> product(const Vector2 &a, const Vector2 &b)
    {
      return std::conj(a[0]) * b[0] + std::conj(a[1]) * b[1];
    }
  } // namespace

  LatticeWaves::LatticeWaves(const BlochOperator &update, const ChainSide side,
                             const double spacing, const double k_y, const double time_step)
      : update(update.homogeneous(side)), column_spacing(spacing), k_y(k_y), time_step(time_step)
  {}

  std::array<LatticeWaves::Eigenpair, 2> LatticeWaves::eigenpairs(const double k_x) const
  {
    // Hermitian, since all masses of a uniform lattice are equal.
    const ChainBlock a = update.symbol(ChainSide::left, k_x * column_spacing);
    const double mean = 0.5 * (a[0].real() + a[3].real());
    const double half_difference = 0.5 * (a[0].real() - a[3].real());
    const std::complex<double> b = 0.5 * (a[1] + std::conj(a[2]));
    const double radius = std::hypot(half_difference, std::abs(b));
    std::array<Eigenpair, 2> pairs;
    pairs[0].value = mean - radius;
    pairs[1].value = mean + radius;
    // The row of a - λ with the larger diagonal entry gives the vector without cancellation.
    Vector2 upper = half_difference >= 0. ? Vector2{{radius + half_difference, std::conj(b)}}
                                          : Vector2{{b, radius - half_difference}};
    const double length = std::sqrt(product(upper, upper).real());
    if (length > 0.)
      upper = {{upper[0] / length, upper[1] / length}};
    else
      upper = {{1., 0.}};
    pairs[1].vector = upper;
    pairs[0].vector = {{-std::conj(upper[1]), std::conj(upper[0])}};
    return pairs;
  }

  LatticeMode LatticeWaves::complete(const double k_x, const unsigned int branch) const
  {
    const auto pairs = eigenpairs(k_x);
    LatticeMode mode;
    mode.wave_number = k_x;
    mode.eigenvalue = std::max(0., pairs[branch].value);
    mode.polarization = pairs[branch].vector;
    const double sine = 0.5 * time_step * std::sqrt(mode.eigenvalue);
    if (sine >= 1.)
      throw RunError("The time step is too long for the wave: the step factor must be smaller.");
    mode.frequency = 2. / time_step * std::asin(sine);

    // dλ/dk of this branch, from the derivative of the symbol (Hellmann and Feynman).
    const double step = 1e-5 / column_spacing;
    const ChainBlock up = update.symbol(ChainSide::left, (k_x + step) * column_spacing);
    const ChainBlock down = update.symbol(ChainSide::left, (k_x - step) * column_spacing);
    const Vector2 &p = mode.polarization;
    double slope = 0;
    for (unsigned int i = 0; i < 2; ++i)
      for (unsigned int j = 0; j < 2; ++j)
        slope += (std::conj(p[i]) * (up[2 * i + j] - down[2 * i + j]) * p[j]).real() / (2. * step);
    if (mode.eigenvalue > 0.)
      mode.group_velocity = slope / (2. * std::sqrt(mode.eigenvalue) * std::sqrt(1. - sine * sine));

    const double along = std::abs(p[0] * k_x + p[1] * k_y);
    mode.type = 2. * along * along > k_x * k_x + k_y * k_y ? WaveType::P : WaveType::S;
    mode.is_short = mode.group_velocity * k_x < 0.;
    return mode;
  }

  LatticeMode LatticeWaves::mode(const double k_x, const WaveType type) const
  {
    const LatticeMode lower = complete(k_x, 0);
    LatticeMode result = lower.type == type ? lower : complete(k_x, 1);
    // The phase in which the larger component is real and positive.
    const auto &p = result.polarization;
    const std::complex<double> largest = std::norm(p[0]) > std::norm(p[1]) ? p[0] : p[1];
    const std::complex<double> factor = std::abs(largest) / largest;
    result.polarization = {{p[0] * factor, p[1] * factor}};
    return result;
  }

  LatticeMode LatticeWaves::continued(const LatticeMode &neighbour, const double k_x) const
  {
    const auto pairs = eigenpairs(k_x);
    const unsigned int branch = std::norm(product(pairs[0].vector, neighbour.polarization)) >
                                        std::norm(product(pairs[1].vector, neighbour.polarization))
                                    ? 0
                                    : 1;
    LatticeMode result = complete(k_x, branch);
    const std::complex<double> overlap = product(result.polarization, neighbour.polarization);
    const std::complex<double> factor = overlap / std::abs(overlap);
    result.polarization = {{result.polarization[0] * factor, result.polarization[1] * factor}};
    return result;
  }

  std::vector<LatticeMode> LatticeWaves::outgoing(const double frequency, const ChainSide to) const
  {
    const double sine = std::sin(0.5 * frequency * time_step);
    const double target = std::pow(2. / time_step * sine, 2);
    constexpr int n_samples = 2048;
    const auto place = [&](const double sample)
    { return (-PI + 2. * PI * sample / n_samples) / column_spacing; };
    std::vector<LatticeMode> modes;
    auto before = eigenpairs(place(0));
    for (int sample = 1; sample <= n_samples; ++sample)
    {
      const auto here = eigenpairs(place(sample));
      for (unsigned int branch = 0; branch < 2; ++branch)
      {
        if ((before[branch].value < target) == (here[branch].value < target))
          continue;
        double low = sample - 1, high = sample;
        const bool rises = here[branch].value > before[branch].value;
        for (unsigned int halving = 0; halving < 50; ++halving)
        {
          const double between = 0.5 * (low + high);
          ((eigenpairs(place(between))[branch].value < target) == rises ? low : high) = between;
        }
        const LatticeMode mode = complete(place(0.5 * (low + high)), branch);
        if ((mode.group_velocity > 0.) == (to == ChainSide::right))
          modes.push_back(mode);
      }
      before = here;
    }
    return modes;
  }
} // namespace tombolo
