/* SPDX-License-Identifier: MIT */
/* What a cell can use without asking; runner.c has the functions. */
#ifndef NB_H
#define NB_H

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Shows a file in the notebook, between what was printed before and after: .png, .html, .md. */
void nb_show(const char *path);

/* Prints a shell command and runs it; the cell fails when the command does. */
void nb_run(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Ends the cell as failed, with this message. */
void nb_fail(const char *format, ...) __attribute__((format(printf, 1, 2), noreturn));

/* What a notebook claims, it requires. */
#define nb_require(condition)                                                                                          \
  do {                                                                                                                 \
    if (!(condition)) nb_fail("not true: %s", #condition);                                                             \
  } while (0)

#endif
