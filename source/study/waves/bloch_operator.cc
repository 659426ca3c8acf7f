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

  int BlochOperator::reach() const
  {
    return operator_reach;
  }

  int BlochOperator::first() const
  {
    return first_source;
  }

  int BlochOperator::last() const
  {
    return last_source;
  }

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
} // namespace tombolo
