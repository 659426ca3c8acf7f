// SPDX-License-Identifier: LGPL-2.1-or-later
/* Runs a program many times in one process: what is loaded and initialized before main is paid once.
 *
 * Preloaded into a program (LD_PRELOAD) whose environment names two descriptors in
 * TOMBOLO_FORK_SERVER ("IN,OUT"), it reads requests and calls main in a child of its own for each.
 * A request is the length of what follows as a line, then texts that end with a zero byte each: the
 * directory to run in, the file for all that is printed, the largest size of the address space and
 * of a file [bytes] (0: no limit), and the arguments of main, its name first. The answers are lines:
 * the number of the child's process, and, when it has ended, the status that waitpid gives. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

typedef int (*main_function)(int, char **, char **);
typedef int (*start_function)(main_function, int, char **, void (*)(void), void (*)(void),
                              void (*)(void), void *);

enum
{
  largest_request = 1 << 16,
  most_arguments = 64
};

static main_function program_main;

static void limit(const int resource, const char *bytes)
{
  const rlim_t value = strtoull(bytes, NULL, 10);
  const struct rlimit both = {value, value};
  if (value > 0)
    setrlimit(resource, &both);
}

/* In the child. Fields: directory, file, address space, file size, arguments. */
static int run(char **fields, const int n_fields, char **environment)
{
  char *arguments[most_arguments + 1];
  const int output = open(fields[1], O_WRONLY | O_CREAT | O_TRUNC, 0644);
  const int input = open("/dev/null", O_RDONLY);
  const struct rlimit no_core = {0, 0};
  int i;
  if (output < 0 || input < 0 || chdir(fields[0]) != 0)
    _exit(120);
  dup2(input, 0);
  dup2(output, 1);
  dup2(output, 2);
  close(input);
  close(output);
  prctl(PR_SET_PDEATHSIG, SIGKILL);
  setrlimit(RLIMIT_CORE, &no_core);
  limit(RLIMIT_AS, fields[2]);
  limit(RLIMIT_FSIZE, fields[3]);
  unsetenv("LD_PRELOAD");
  unsetenv("TOMBOLO_FORK_SERVER");
  for (i = 4; i < n_fields; ++i)
    arguments[i - 4] = fields[i];
  arguments[n_fields - 4] = NULL;
  return program_main(n_fields - 4, arguments, environment);
}

static int serve(int argc, char **argv, char **environment)
{
  static char request[largest_request];
  char *fields[most_arguments + 4];
  int descriptors[2], length, status, n_fields, i;
  FILE *in;
  (void)argc;
  (void)argv;
  if (sscanf(getenv("TOMBOLO_FORK_SERVER"), "%d,%d", &descriptors[0], &descriptors[1]) != 2)
    return 121;
  in = fdopen(descriptors[0], "r");
  while (in != NULL && fscanf(in, "%d", &length) == 1 && fgetc(in) == '\n')
  {
    if (length <= 0 || length > largest_request || fread(request, 1, (size_t)length, in) != (size_t)length)
      return 122;
    n_fields = 0;
    for (i = 0; i < length && n_fields < most_arguments + 4; i += (int)strlen(request + i) + 1)
      fields[n_fields++] = request + i;
    if (n_fields < 5)
      return 123;
    const pid_t child = fork();
    if (child == 0)
    {
      fclose(in);
      close(descriptors[1]);
      exit(run(fields, n_fields, environment));
    }
    dprintf(descriptors[1], "%d\n", (int)child);
    if (child < 0 || waitpid(child, &status, 0) != child)
      return 124;
    dprintf(descriptors[1], "%d\n", status);
  }
  return 0;
}

int __libc_start_main(main_function main, int argc, char **argv, void (*init)(void),
                      void (*fini)(void), void (*rtld_fini)(void), void *stack_end)
{
  const start_function start = (start_function)dlsym(RTLD_NEXT, "__libc_start_main");
  program_main = main;
  return start(getenv("TOMBOLO_FORK_SERVER") != NULL ? serve : main, argc, argv, init, fini, rtld_fini,
               stack_end);
}
