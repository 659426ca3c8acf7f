/* SPDX-License-Identifier: LGPL-2.1-or-later */
/* How a rank waits for another one in the tests: Open MPI calls sched_yield() again and again, and since
 * Linux 6.12 each call gives up a share of the processor, so that runs take ten times as long where
 * there are more processes than processors. Here a rank that has waited longer than messages take
 * sleeps between two looks. */
#define _GNU_SOURCE
#include <sched.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <time.h>
#include <unistd.h>

enum { nanoseconds_between_waits = 5000, nanoseconds_awake = 300000, nanoseconds_asleep = 20000 };

static long long present(void)
{
  struct timespec now;
  clock_gettime(CLOCK_MONOTONIC, &now);
  return now.tv_sec * 1000000000LL + now.tv_nsec;
}

int sched_yield(void)
{
  static const struct timespec asleep = {0, nanoseconds_asleep};
  static _Thread_local int is_exact = 0;
  static _Thread_local long long begin = 0, last = 0;
  const long long now = present();
  if (now - last > nanoseconds_between_waits)
    begin = now;
  last = now;
  if (now - begin < nanoseconds_awake)
    return (int)syscall(SYS_sched_yield);
  if (!is_exact)
    is_exact = prctl(PR_SET_TIMERSLACK, 1L) == 0; /* sleeps are 50 microseconds longer otherwise */
  nanosleep(&asleep, NULL);
  last = present();
  return 0;
}
