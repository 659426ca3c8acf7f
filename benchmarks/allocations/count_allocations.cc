// SPDX-License-Identifier: LGPL-2.1-or-later
// Preloaded into a program (LD_PRELOAD), counts what it allocates, and writes the number at its end
// to the file TOMBOLO_ALLOCATIONS.PID. For the GNU C library.
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <unistd.h>

extern "C" {
void *__libc_malloc(size_t);
void *__libc_calloc(size_t, size_t);
void *__libc_realloc(void *, size_t);
void *__libc_memalign(size_t, size_t);
}

namespace
{
  std::atomic<unsigned long> n_allocations{0};

  struct AtTheEnd
  {
    ~AtTheEnd()
    {
      const char *const name = std::getenv("TOMBOLO_ALLOCATIONS");
      if (name == nullptr)
        return;
      char path[4096];
      std::snprintf(path, sizeof path, "%s.%d", name, static_cast<int>(getpid()));
      if (FILE *const file = std::fopen(path, "w"))
      {
        std::fprintf(file, "%lu\n", n_allocations.load());
        std::fclose(file);
      }
    }
  } at_the_end;
} // namespace

extern "C" {
void *malloc(const size_t size)
{
  ++n_allocations;
  return __libc_malloc(size);
}

void *calloc(const size_t n, const size_t size)
{
  ++n_allocations;
  return __libc_calloc(n, size);
}

void *realloc(void *const old, const size_t size)
{
  ++n_allocations;
  return __libc_realloc(old, size);
}

void *memalign(const size_t alignment, const size_t size)
{
  ++n_allocations;
  return __libc_memalign(alignment, size);
}

void *aligned_alloc(const size_t alignment, const size_t size)
{
  return memalign(alignment, size);
}

int posix_memalign(void **const result, const size_t alignment, const size_t size)
{
  *result = memalign(alignment, size);
  return *result == nullptr ? ENOMEM : 0;
}
}
