// SPDX-License-Identifier: LGPL-2.1-or-later
#pragma once

#include <tombolo/base/clock.h>
#include <tombolo/state/state_archive.h>

namespace tombolo
{
  /** Writes the clock of a run to a checkpoint, or reads it. Collective. */
  inline void serialize_clock(Clock &clock, StateArchive &archive)
  {
    const auto group = archive.group("clock");
    archive("step", clock.step);
    archive("time", clock.time);
    archive("previous step", clock.previous_step);
    archive("next step", clock.next_step);
    archive("stable step", clock.stable_step);
  }
} // namespace tombolo
