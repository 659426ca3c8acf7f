/* SPDX-License-Identifier: LGPL-2.1-or-later */
/* How a rank waits for another one in the tests: Open MPI calls sched_yield() again and again, and since
 * Linux 6.12 each call gives up a share of the processor, so that runs take ten times as long where
 * there are more processes than processors. Here it sleeps between two looks. Much shorter sleeps keep
 * the processor busy with timers. */
#define _GNU_SOURCE
#include <sched.h>
#include <sys/prctl.h>
#include <time.h>

int sched_yield(void)
{
  static const struct timespec microseconds = {0, 20000};
  static _Thread_local int is_exact = 0;
  if (!is_exact)
    is_exact = prctl(PR_SET_TIMERSLACK, 1L) == 0; /* sleeps are 50 microseconds longer otherwise */
  nanosleep(&microseconds, NULL);
  return 0;
}
