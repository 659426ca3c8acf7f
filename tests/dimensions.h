// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <gtest/gtest.h>

namespace tombolo
{
  namespace testing
  {
    template <int dim>
    struct Dimension
    {
      static constexpr int value = dim;
    };

    /** The types of suites whose tests are made in two and in three dimensions. */
    using Dimensions = ::testing::Types<Dimension<2>, Dimension<3>>;
  } // namespace testing
} // namespace tombolo
