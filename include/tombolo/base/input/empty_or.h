// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/patterns.h>

#include <memory>
#include <string>

namespace tombolo
{
  /** A mandatory entry has no default: makes the handler accept the empty text for it. */
  class EmptyOr : public dealii::Patterns::PatternBase
  {
  public:
    explicit EmptyOr(std::unique_ptr<dealii::Patterns::PatternBase> pattern)
        : pattern(std::move(pattern))
    {}

    bool match(const std::string &text) const override
    {
      return text.empty() || pattern->match(text);
    }

    std::string description(const OutputStyle style) const override
    {
      return pattern->description(style);
    }

    std::unique_ptr<dealii::Patterns::PatternBase> clone() const override
    {
      return std::make_unique<EmptyOr>(pattern->clone());
    }

  private:
    std::unique_ptr<dealii::Patterns::PatternBase> pattern;
  };
} // namespace tombolo
