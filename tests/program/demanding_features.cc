// SPDX-License-Identifier: LGPL-2.1-or-later
// For refuse_processor.cc: a program that needs everything, which no processor has.
#include "../../applications/start/processor_features.h"

#include <cstdio>

namespace
{
  struct Initializer
  {
    Initializer()
    {
      std::puts("initialized");
    }
  };
  const Initializer initializer;
} // namespace

extern "C" const unsigned int tombolo_compiled_features = ~0u >> 19;
extern "C" const char *const tombolo_architecture = "x86-64-v9";

int main()
{
  std::puts("begun");
}
