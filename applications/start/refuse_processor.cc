// SPDX-License-Identifier: LGPL-2.1-or-later
#include "processor_features.h"

#if defined(__x86_64__) && defined(__linux__)

#  include <cstring>

#  include <unistd.h>

namespace
{
  void say(const char *const text)
  {
    // What cannot be said cannot be said otherwise either.
    if (write(STDERR_FILENO, text, std::strlen(text)) < 0)
      return;
  }

  /** Ends the process where the processor lacks an extension that the programs use: it would end
   * with "illegal instruction" otherwise. This file is compiled for every processor of its kind,
   * and uses nothing of the library, which is not. */
  void refuse_unsuitable_processor()
  {
    __builtin_cpu_init();
    unsigned int present = 0;
#  define TOMBOLO_IS_PRESENT(bit, name) present |= __builtin_cpu_supports(name) ? 1u << (bit) : 0u;
    TOMBOLO_PROCESSOR_FEATURES(TOMBOLO_IS_PRESENT)
    const unsigned int missing = tombolo_compiled_features & ~present;
    if (missing == 0)
      return;
    say("\nError: This program is built for processors like ");
    say(std::strcmp(tombolo_architecture, "native") == 0 ? "that of the machine it was built on"
                                                         : tombolo_architecture);
    say(". This processor lacks:");
#  define TOMBOLO_SAY_MISSING(bit, name)                                                           \
    if ((missing & (1u << (bit))) != 0u)                                                           \
      say(" " name);
    TOMBOLO_PROCESSOR_FEATURES(TOMBOLO_SAY_MISSING)
    say(". Build it from its sources on this machine (scripts/build).\n");
    _exit(1);
  }
} // namespace

// The initializers of the shared libraries, which come before main(), have instructions of the
// extensions too: this comes before those.
extern "C"
    __attribute__((section(".preinit_array"),
                   used)) void (*const tombolo_refuse_processor)() = refuse_unsuitable_processor;

#endif
