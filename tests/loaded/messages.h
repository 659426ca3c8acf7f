/* SPDX-License-Identifier: LGPL-2.1-or-later */
/* What program_server.c and start_loaded.c tell each other. */
#ifndef TOMBOLO_TESTS_MESSAGES_H
#define TOMBOLO_TESTS_MESSAGES_H

enum
{
  n_streams = 3,             /* of the caller: standard input, output and error */
  largest_request = 1 << 19, /* bytes of directory, arguments and environment */
  most_texts = 4096
};

/* What the caller sends first, together with its streams. Then `length` bytes follow: the working
 * directory, the arguments of main and the environment, each text with a zero byte behind it. After
 * that it sends the numbers of signals, a byte each; the answer is the status that waitpid returns,
 * an int. The end of the connection ends the program. */
struct request
{
  int length;
  int n_arguments;
};
#endif
