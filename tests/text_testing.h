// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gtest/gtest.h>

#include <string>

namespace tombolo
{
  namespace testing
  {
    /** Whether @p part stands in @p text, which the message shows. */
    inline ::testing::AssertionResult contains(const std::string &text, const std::string &part)
    {
      if (text.find(part) != std::string::npos)
        return ::testing::AssertionSuccess();
      return ::testing::AssertionFailure() << "\"" << part << "\" is not in: " << text;
    }
  } // namespace testing
} // namespace tombolo
