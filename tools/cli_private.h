/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Between main.c and the cli_*.c files; commands include cli.h only. */
#ifndef SKF_TOOLS_CLI_PRIVATE_H
#define SKF_TOOLS_CLI_PRIVATE_H

#include "cli.h"

enum { CLI_OPERANDS = 8, CLI_OPTIONS = 32 };

struct cli {
  const cli_command *command;
  const char *operands[CLI_OPERANDS];
  int operand_count;
  const char *values[CLI_OPTIONS]; /* of the command's options, then of the common ones */
  bool given[CLI_OPTIONS];
};

/* The options that every command has, after its own. */
extern const cli_option cli_common[];
extern const int cli_common_count;

/* The commands, in the order of the help. NULL after the last. */
extern const cli_command *const cli_commands[];

/* Parses what follows the command's name. CLI_DONE or CLI_BAD after the message. */
int cli_parse(cli *c, const cli_command *command, int argc, char **argv);

/* Whether each file that is written is named once, and not read. CLI_DONE or CLI_BAD after the message. */
int cli_check_files(const cli *c);
/* Whether a file that is read besides those is written by no option; likewise. */
int cli_check_read(const cli *c, const char *path);

void cli_help_program(FILE *f);
void cli_help_command(FILE *f, const cli_command *command);
/* "scene": what a scene file may hold. */
void cli_help_scene(FILE *f);

/* From now on nothing is printed; the last message, "" when there was none. */
void cli_mute(void);
const char *cli_muted(void);
bool cli_is_muted(void);

/* Handlers for SIGINT, SIGTERM, SIGHUP; a closed pipe becomes an error of the write. */
void cli_signals(void);
/* 0, or the signal that asked the program to stop. */
int cli_signal(void);
/* While somebody polls cli_interrupted, the first signal only sets the flag. */
void cli_polite(bool on);
/* Removes every temporary file that was not committed. */
void cli_out_cleanup(void);

#endif
