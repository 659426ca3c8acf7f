// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/study/waves/bloch_motion.h>

#include <algorithm>

namespace tombolo
{
  ChainField::ChainField(const int first, const int last, const int padding)
      : first_column(first), last_column(last), padding(padding)
  {
    for (auto &part : values)
      part.resize(static_cast<std::size_t>(last - first + 1 + 2 * padding), 0.);
  }

  int ChainField::first() const
  {
    return first_column;
  }

  int ChainField::last() const
  {
    return last_column;
  }

  double *ChainField::part(const unsigned int component, const unsigned int part)
  {
    return values[2 * component + part].data() + (padding - first_column);
  }

  const double *ChainField::part(const unsigned int component, const unsigned int part) const
  {
    return values[2 * component + part].data() + (padding - first_column);
  }

  std::complex<double> ChainField::get(const int column, const unsigned int component) const
  {
    return {part(component, 0)[column], part(component, 1)[column]};
  }

  void ChainField::set(const int column, const unsigned int component,
                       const std::complex<double> value)
  {
    part(component, 0)[column] = value.real();
    part(component, 1)[column] = value.imag();
  }

  void ChainField::set_zero()
  {
    for (auto &part : values)
      std::fill(part.begin(), part.end(), 0.);
  }

  void ChainField::add(const std::complex<double> factor, const ChainField &other)
  {
    const double real = factor.real(), imaginary = factor.imag();
    for (unsigned int c = 0; c < 2; ++c)
    {
      double *const re = part(c, 0);
      double *const im = part(c, 1);
      const double *const other_re = other.part(c, 0);
      const double *const other_im = other.part(c, 1);
      for (int i = first_column; i <= last_column; ++i)
      {
        re[i] += real * other_re[i] - imaginary * other_im[i];
        im[i] += real * other_im[i] + imaginary * other_re[i];
      }
    }
  }

  ChainSweep::ChainSweep(const BlochOperator &bloch_operator, const int first, const int last)
      : operator_reach(bloch_operator.reach())
  {
    const int reach = operator_reach;
    // Rows that only sources far to one side act on are alike.
    const int left_end = std::clamp(bloch_operator.first() - reach + 1, first, last + 1);
    const int right_begin = std::clamp(bloch_operator.last() + reach, left_end, last + 1);
    const auto add_stretch = [&](const int begin, const int end)
    {
      if (begin >= end)
        return;
      Stretch stretch{begin, end, {}};
      for (int offset = -reach; offset <= reach; ++offset)
      {
        const ChainBlock block = bloch_operator.block(begin, begin + offset);
        for (unsigned int k = 0; k < 4; ++k)
          if (block[k] != 0.)
            stretch.coefficients.push_back({offset, k / 2, k % 2, block[k]});
      }
      if (!stretch.coefficients.empty())
        stretches.push_back(std::move(stretch));
    };
    add_stretch(first, left_end);
    for (int row = left_end; row < right_begin; ++row)
      add_stretch(row, row + 1);
    add_stretch(right_begin, last + 1);
  }

  int ChainSweep::reach() const
  {
    return operator_reach;
  }

  bool ChainSweep::is_zero() const
  {
    return stretches.empty();
  }

  void ChainSweep::add(const double factor, const ChainField &field, ChainField &result) const
  {
    // Tiles small enough that the result stays in the first cache over all coefficients.
    constexpr int tile = 256;
    for (const Stretch &stretch : stretches)
      for (int begin = stretch.begin; begin < stretch.end; begin += tile)
      {
        const int end = std::min(begin + tile, stretch.end);
        for (const Coefficient &coefficient : stretch.coefficients)
        {
          const double re = factor * coefficient.value.real();
          const double im = factor * coefficient.value.imag();
          const double *const from_re = field.part(coefficient.from, 0) + coefficient.offset;
          const double *const from_im = field.part(coefficient.from, 1) + coefficient.offset;
          double *const to_re = result.part(coefficient.to, 0);
          double *const to_im = result.part(coefficient.to, 1);
          // By the mirror symmetry of the rows, entries are real or imaginary as a rule.
          if (im == 0.)
            for (int i = begin; i < end; ++i)
            {
              to_re[i] += re * from_re[i];
              to_im[i] += re * from_im[i];
            }
          else if (re == 0.)
            for (int i = begin; i < end; ++i)
            {
              to_re[i] -= im * from_im[i];
              to_im[i] += im * from_re[i];
            }
          else
            for (int i = begin; i < end; ++i)
            {
              to_re[i] += re * from_re[i] - im * from_im[i];
              to_im[i] += re * from_im[i] + im * from_re[i];
            }
        }
      }
  }

  BlochMotion::BlochMotion(const BlochOperator &update, const BlochOperator &damping,
                           const BlochOperator &short_wave_part, const Filter &filter,
                           const double time_step, const int first, const int last)
      : update(update, first, last), damping(damping, first, last),
        short_wave_part(short_wave_part, first, last), filter(filter), time_step(time_step),
        first(first), last(last), force(make_field()), work(make_field()), second_work(make_field())
  {}

  ChainField BlochMotion::make_field() const
  {
    return {first, last, std::max({update.reach(), damping.reach(), short_wave_part.reach()})};
  }

  void BlochMotion::advance(ChainField &displacement, ChainField &velocity)
  {
    ++step;
    const bool filters = filter.power > 0 && step % filter.interval == 0;
    if (filters)
      work = velocity;
    if (!damping.is_zero())
    {
      force.set_zero();
      damping.add(time_step, velocity, force);
    }
    update.add(-time_step, displacement, velocity);
    if (!damping.is_zero())
      velocity.add(-1., force);
    if (filters)
    {
      // of the mean of the velocities before and after, as MechanicalStep does
      work.add(1., velocity);
      for (unsigned int k = 0; k < filter.power; ++k)
      {
        second_work.set_zero();
        short_wave_part.add(1., work, second_work);
        std::swap(work, second_work);
      }
      velocity.add(-0.5 * filter.fraction, work);
    }
    displacement.add(time_step, velocity);
  }
} // namespace tombolo
