/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Help texts, all made from the tables. */
#include "cli_private.h"
#include <string.h>

static const char usage[] = "usage: skelfield";

static void put_option(FILE *f, const cli_option *o) {
  char head[64], letter[8] = "    ";
  if (o->letter) snprintf(letter, sizeof letter, "-%c, ", o->letter);
  snprintf(head, sizeof head, "%s--%s%s%s", letter, o->name, o->arg ? " " : "", o->arg ? o->arg : "");
  fprintf(f, "  %-28s %s\n", head, o->doc);
}

void cli_help_command(FILE *f, const cli_command *c) {
  fprintf(f, "%s %s %s [options]\n\n%s.\n\noptions:\n", usage, c->name, c->operands, c->summary);
  for (int i = 0; i < c->option_count; i++) put_option(f, c->options + i);
  for (int i = 0; i < cli_common_count; i++) put_option(f, cli_common + i);
  if (c->notes) fprintf(f, "\n%s%s", c->notes, c->notes[strlen(c->notes) - 1] == '\n' ? "" : "\n");
}

void cli_help_program(FILE *f) {
  fprintf(f, "%s COMMAND ... [options]\n\nFields of skeletal bodies: potential, gradient, contact, surfaces.\n\n",
          usage);
  fputs("commands:\n", f);
  for (const cli_command *const *c = cli_commands; *c; c++) fprintf(f, "  %-10s %s\n", (*c)->name, (*c)->summary);
  fputs("  help       help on a command, or on scene files: skelfield help scene\n\n", f);
  fputs("options:\n", f);
  put_option(f, &(cli_option){'h', "help", NULL, "this help; after a command: help on it"});
  put_option(f, &(cli_option){0, "version", NULL, "the version"});
  fputs("\nData goes to the file named by -o, or to stdout when it is absent or -; messages go to stderr.\n"
        "Exit status: 0 done, 1 the work failed or a check found defects, 2 bad usage or bad input.\n",
        f);
}
