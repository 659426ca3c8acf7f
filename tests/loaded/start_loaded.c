/* SPDX-License-Identifier: LGPL-2.1-or-later */
/* start_loaded SOCKET ARGUMENTS...: runs the program that program_server.c serves at the socket as if
 * it had been started here: with the streams, the working directory and the environment of this
 * process. Signals are passed on; it ends as the program does. */
#define _GNU_SOURCE
#include "messages.h"
#include <errno.h>
#include <signal.h>
#include <string.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <sys/wait.h>
#include <unistd.h>

extern char **environ;

static int server;
static char bytes[largest_request];

static void pass_on(const int number)
{
  const unsigned char byte = (unsigned char)number;
  const int error = errno;
  if (write(server, &byte, 1) != 1)
    _exit(125);
  errno = error;
}

static int add(const int length, const char *text)
{
  const int n = (int)strlen(text) + 1;
  if (length + n > largest_request)
    _exit(126);
  memcpy(bytes + length, text, (size_t)n);
  return length + n;
}

static int send_request(const int argc, char **argv)
{
  char control[CMSG_SPACE(n_streams * sizeof(int))] = {0};
  const int streams[n_streams] = {0, 1, 2};
  char directory[4096];
  struct request request = {0, argc - 1};
  struct iovec piece = {&request, sizeof(request)};
  struct msghdr message = {0};
  struct cmsghdr *header;
  int i;
  if (getcwd(directory, sizeof(directory)) == NULL)
    return 0;
  request.length = add(0, directory);
  for (i = 1; i < argc; ++i)
    request.length = add(request.length, argv[i]);
  for (i = 0; environ[i] != NULL; ++i)
    request.length = add(request.length, environ[i]);
  message.msg_iov = &piece;
  message.msg_iovlen = 1;
  message.msg_control = control;
  message.msg_controllen = sizeof(control);
  header = CMSG_FIRSTHDR(&message);
  header->cmsg_level = SOL_SOCKET;
  header->cmsg_type = SCM_RIGHTS;
  header->cmsg_len = CMSG_LEN(sizeof(streams));
  memcpy(CMSG_DATA(header), streams, sizeof(streams));
  if (sendmsg(server, &message, 0) != (ssize_t)sizeof(request))
    return 0;
  for (i = 0; i < request.length;)
  {
    const ssize_t n = write(server, bytes + i, (size_t)(request.length - i));
    if (n <= 0)
      return 0;
    i += (int)n;
  }
  return 1;
}

int main(int argc, char **argv)
{
  static const int passed_on[] = {SIGTERM, SIGINT, SIGHUP, SIGUSR1, SIGUSR2, SIGCONT};
  const struct rlimit no_core = {0, 0};
  struct sockaddr_un address = {0};
  struct sigaction action = {0};
  sigset_t all, before;
  int status;
  ssize_t n;
  size_t i;
  if (argc < 2 || strlen(argv[1]) >= sizeof(address.sun_path))
    return 127;
  sigfillset(&all);
  sigprocmask(SIG_BLOCK, &all, &before);
  address.sun_family = AF_UNIX;
  strcpy(address.sun_path, argv[1]);
  server = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  /* The name of the socket stands for that of the program. */
  if (connect(server, (const struct sockaddr *)&address, sizeof(address)) != 0 ||
      !send_request(argc, argv))
    return 124;
  action.sa_handler = pass_on;
  for (i = 0; i < sizeof(passed_on) / sizeof(passed_on[0]); ++i)
    sigaction(passed_on[i], &action, NULL);
  sigprocmask(SIG_SETMASK, &before, NULL);
  do
    n = read(server, &status, sizeof(status));
  while (n < 0 && errno == EINTR);
  if (n != (ssize_t)sizeof(status))
    return 123;
  if (WIFSIGNALED(status))
  {
    setrlimit(RLIMIT_CORE, &no_core);
    signal(WTERMSIG(status), SIG_DFL);
    raise(WTERMSIG(status));
  }
  return WEXITSTATUS(status);
}
