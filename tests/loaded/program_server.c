/* SPDX-License-Identifier: LGPL-2.1-or-later */
/* Runs a program many times and loads its libraries once, which is half of a short run.
 *
 * Preloaded into a program (LD_PRELOAD) whose environment names a socket and a descriptor in
 * TOMBOLO_PROGRAM_SERVER ("DESCRIPTOR,PATH"), it waits for start_loaded.c at the socket and calls main
 * in a process of its own for each: with the streams, the working directory, the arguments and the
 * environment of the caller, so that it can be a rank of MPI. It ends when the descriptor is closed at
 * the other end. */
#define _GNU_SOURCE
#include "messages.h"
#include <dlfcn.h>
#include <fcntl.h>
#include <poll.h>
#include <signal.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

typedef int (*main_function)(int, char **, char **);
typedef int (*start_function)(main_function, int, char **, void (*)(void), void (*)(void),
                              void (*)(void), void *);

static main_function program_main;
static char bytes[largest_request];
static char *texts[most_texts + 1];

/* The request, its streams in `streams`; 0 where it is not whole. */
static int receive(const int connection, struct request *request, int *streams)
{
  char control[CMSG_SPACE(n_streams * sizeof(int))];
  struct iovec piece = {request, sizeof(*request)};
  struct msghdr message = {0};
  struct cmsghdr *header;
  int n_bytes = 0;
  message.msg_iov = &piece;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof(control);
  if (recvmsg(connection, &message, 0) != (ssize_t)sizeof(*request))
    return 0;
  header = CMSG_FIRSTHDR(&message);
  if (header == NULL || header->cmsg_type != SCM_RIGHTS ||
      header->cmsg_len != CMSG_LEN(n_streams * sizeof(int)))
    return 0;
  memcpy(streams, CMSG_DATA(header), n_streams * sizeof(int));
  while (n_bytes < request->length)
  {
    const ssize_t n = read(connection, bytes + n_bytes, (size_t)(request->length - n_bytes));
    if (n <= 0)
      return 0;
    n_bytes += (int)n;
  }
  return 1;
}

/* In the process of the run. */
static int run(const struct request *request, const int *streams)
{
  int n_texts = 0, i;
  char **environment;
  for (i = 0; i < request->length && n_texts < most_texts; i += (int)strlen(bytes + i) + 1)
    texts[n_texts++] = bytes + i;
  texts[n_texts] = NULL;
  for (i = 0; i < n_streams; ++i)
    dup2(streams[i], i);
  for (i = 0; i < n_streams; ++i)
    if (streams[i] >= n_streams)
      close(streams[i]);
  if (chdir(texts[0]) != 0)
    _exit(120);
  environment = texts + 1 + request->n_arguments;
  clearenv();
  for (i = 0; environment[i] != NULL; ++i)
    putenv(environment[i]);
  texts[1 + request->n_arguments] = NULL;
  return program_main(request->n_arguments, texts + 1, environment);
}

/* In a process of its own for each connection. */
static void serve_one(const int connection)
{
  struct request request;
  struct pollfd waits[2];
  int streams[n_streams], status = 0, i;
  pid_t child;
  if (!receive(connection, &request, streams))
    _exit(121);
  child = fork();
  if (child == 0)
  {
    close(connection);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    exit(run(&request, streams));
  }
  for (i = 0; i < n_streams; ++i)
    close(streams[i]);
  waits[0].fd = connection;
  waits[1].fd = (int)syscall(SYS_pidfd_open, child, 0);
  waits[0].events = waits[1].events = POLLIN;
  while (waitpid(child, &status, WNOHANG) == 0)
  {
    unsigned char number;
    poll(waits, 2, -1);
    if (waits[0].revents != 0)
      kill(child, read(connection, &number, 1) == 1 ? number : SIGKILL);
  }
  if (write(connection, &status, sizeof(status)) != (ssize_t)sizeof(status))
    _exit(122);
  _exit(0);
}

static int serve(int argc, char **argv, char **environment)
{
  struct sockaddr_un address = {0};
  struct pollfd waits[2];
  int place = 0;
  const char *const where = getenv("TOMBOLO_PROGRAM_SERVER");
  (void)argc;
  (void)argv;
  (void)environment;
  address.sun_family = AF_UNIX;
  waits[0].fd = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (sscanf(where, "%d,%n", &waits[1].fd, &place) != 1 ||
      strlen(where + place) >= sizeof(address.sun_path))
    return 123;
  strcpy(address.sun_path, where + place);
  fcntl(waits[1].fd, F_SETFD, FD_CLOEXEC);
  if (bind(waits[0].fd, (const struct sockaddr *)&address, sizeof(address)) != 0 ||
      listen(waits[0].fd, 64) != 0)
    return 124;
  waits[0].events = waits[1].events = POLLIN;
  while (poll(waits, 2, -1) > 0 && waits[1].revents == 0)
  {
    const int connection = accept4(waits[0].fd, NULL, NULL, SOCK_CLOEXEC);
    while (waitpid(-1, NULL, WNOHANG) > 0)
      ;
    if (connection < 0)
      continue;
    if (fork() == 0)
    {
      close(waits[0].fd);
      close(waits[1].fd);
      serve_one(connection);
    }
    close(connection);
  }
  return 0;
}

int __libc_start_main(main_function main, int argc, char **argv, void (*init)(void),
                      void (*fini)(void), void (*rtld_fini)(void), void *stack_end)
{
  const start_function start = (start_function)dlsym(RTLD_NEXT, "__libc_start_main");
  program_main = main;
  return start(getenv("TOMBOLO_PROGRAM_SERVER") != NULL ? serve : main, argc, argv, init, fini,
               rtld_fini, stack_end);
}
