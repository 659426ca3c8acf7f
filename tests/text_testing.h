// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <deal.II/base/exceptions.h>

#include <tombolo/base/exceptions.h>

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

    /** The text with @p from, which is in it, replaced by @p to. */
    inline std::string changed(std::string text, const std::string &from, const std::string &to)
    {
      const std::size_t position = text.find(from);
      AssertThrow(position != std::string::npos, dealii::ExcMessage("no " + from));
      return text.replace(position, from.size(), to);
    }

    /** The message of the InputError that an action throws; empty if it throws none. Fails the
     * test where ranks disagree about it. */
    template <typename Action>
    std::string input_error(const Action &action)
    {
      std::string message;
      try
      {
        action();
      }
      catch (const InputError &error)
      {
        message = error.what();
      }
      for (const auto &other : texts_of_ranks(MPI_COMM_WORLD, message))
        EXPECT_EQ(other, message);
      return message;
    }
  } // namespace testing
} // namespace tombolo
