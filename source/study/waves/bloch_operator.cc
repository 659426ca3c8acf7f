// SPDX-License-Identifier: LGPL-2.1-or-later
#include <tombolo/study/waves/bloch_operator.h>

#include <deal.II/base/exceptions.h>

#include <algorithm>
#include <cmath>

namespace tombolo
{
  BlochOperator::BlochOperator(const int reach, const int first, const int last)
      : operator_reach(reach), first_source(first), last_source(last),
        blocks(static_cast<std::size_t>(last - first + 1) * static_cast<std::size_t>(2 * reach + 1),
               ChainBlock{})
  {}

  ChainBlock BlochOperator::block(const int target, const int source) const
  {
    const int offset = target - source;
    if (std::abs(offset) > operator_reach)
      return {};
    const int like = std::clamp(source, first_source, last_source);
    return blocks[static_cast<std::size_t>((like - first_source) * (2 * operator_reach + 1) +
                                           offset + operator_reach)];
  }

  ChainBlock &BlochOperator::given_block(const int target, const int source)
  {
    const int offset = target - source;
    Assert(source >= first_source && source <= last_source && std::abs(offset) <= operator_reach,
           dealii::ExcInternalError());
    return blocks[static_cast<std::size_t>((source - first_source) * (2 * operator_reach + 1) +
                                           offset + operator_reach)];
  }

  double BlochOperator::largest_entry() const
  {
    double largest = 0;
    for (const ChainBlock &block : blocks)
      for (const auto &entry : block)
        largest = std::max({largest, std::abs(entry.real()), std::abs(entry.imag())});
    return largest;
  }

  void BlochOperator::drop_round_off(const double tolerance)
  {
    const double threshold = tolerance * largest_entry();
    for (ChainBlock &block : blocks)
      for (auto &entry : block)
        entry = {std::abs(entry.real()) > threshold ? entry.real() : 0.,
                 std::abs(entry.imag()) > threshold ? entry.imag() : 0.};
    int needed = 0;
    for (int source = first_source; source <= last_source; ++source)
      for (int target = source - operator_reach; target <= source + operator_reach; ++target)
        if (block(target, source) != ChainBlock{})
          needed = std::max(needed, std::abs(target - source));
    if (needed == operator_reach)
      return;
    BlochOperator trimmed(needed, first_source, last_source);
    for (int source = first_source; source <= last_source; ++source)
      for (int target = source - needed; target <= source + needed; ++target)
        trimmed.given_block(target, source) = block(target, source);
    *this = std::move(trimmed);
  }

  BlochOperator BlochOperator::operator*(const BlochOperator &other) const
  {
    // A source is far to a side if all that it acts on is.
    const int first = std::min(other.first_source, first_source - other.operator_reach);
    const int last = std::max(other.last_source, last_source + other.operator_reach);
    BlochOperator product(operator_reach + other.operator_reach, first, last);
    for (int source = first; source <= last; ++source)
      for (int via = source - other.operator_reach; via <= source + other.operator_reach; ++via)
      {
        const ChainBlock b = other.block(via, source);
        for (int target = via - operator_reach; target <= via + operator_reach; ++target)
        {
          const ChainBlock a = block(target, via);
          ChainBlock &sum = product.given_block(target, source);
          sum[0] += a[0] * b[0] + a[1] * b[2];
          sum[1] += a[0] * b[1] + a[1] * b[3];
          sum[2] += a[2] * b[0] + a[3] * b[2];
          sum[3] += a[2] * b[1] + a[3] * b[3];
        }
      }
    return product;
  }

  BlochOperator BlochOperator::homogeneous(const ChainSide side) const
  {
    const int source = side == ChainSide::left ? first_source : last_source;
    BlochOperator result(operator_reach, 0, 0);
    for (int offset = -operator_reach; offset <= operator_reach; ++offset)
      result.given_block(offset, 0) = block(source + offset, source);
    return result;
  }

  ChainBlock BlochOperator::symbol(const ChainSide side, const double phase) const
  {
    const int source = side == ChainSide::left ? first_source : last_source;
    ChainBlock sum{};
    for (int offset = -operator_reach; offset <= operator_reach; ++offset)
    {
      const ChainBlock term = block(source + offset, source);
      const std::complex<double> factor = std::polar(1., -phase * offset);
      for (unsigned int k = 0; k < 4; ++k)
        sum[k] += factor * term[k];
    }
    return sum;
  }

  ChainField::ChainField(const int first, const int last, const int padding)
      : first_column(first), last_column(last), padding(padding)
  {
    for (auto &part : values)
      part.resize(static_cast<std::size_t>(last - first + 1 + 2 * padding), 0.);
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
