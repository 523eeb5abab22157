/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the commands share: the table of commands, options, messages, atomic output, progress. */
#ifndef SKF_TOOLS_CLI_H
#define SKF_TOOLS_CLI_H

#include "skelfield/skelfield.h"
#include <stdio.h>

enum { CLI_DONE = 0, CLI_FAILED = 1, CLI_BAD = 2 };

/* An option of a command: `arg` names its value in the help, NULL for a flag. Every command also has --threads N and
   --help. */
typedef struct cli_option {
  char letter; /* 0: long form only */
  const char *name, *arg, *doc;
} cli_option;

typedef struct cli cli; /* a parsed command line */

typedef struct cli_command {
  const char *name, *operands, *summary; /* "eval", "SCENE POINTS.csv", one line */
  int operand_count;
  const cli_option *options;
  int option_count;
  const char *notes; /* more help: columns, units, examples; may be NULL */
  int (*run)(cli *c);
  bool shares; /* its work among the processes of an MPI launcher; others are refused there */
  const char *const *writes, *const *reads; /* options that name files, besides the operands; NULL ends each */
} cli_command;

/* Operand i; the value of an option (last one wins) or NULL; whether an option or flag was given. */
const char *cli_operand(const cli *c, int i);
const char *cli_value(const cli *c, const char *option);
bool cli_given(const cli *c, const char *option);
/* Parses the option's value as a finite number > above (or returns CLI_BAD after the message); leaves *out when absent.
 */
int cli_number(const cli *c, const char *option, double above, double *out);

/* The same for a whole number from least to most. */
int cli_whole(const cli *c, const char *option, int least, int most, int *out);

/* Prints "skelfield: ..." as one line on stderr and returns status. */
int cli_fail(int status, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* The same for a library status: CLI_BAD for bad input, CLI_FAILED otherwise. */
int cli_fail_status(skf_status status, const char *what);
/* Talk on stderr, without a prefix. */
void cli_say(const char *format, ...) __attribute__((format(printf, 1, 2)));

/* Reads a scene; on failure the message is out and CLI_BAD is returned, also where an option writes a file that the
   scene names. */
int cli_scene(const cli *c, const char *path, skf_scene **out);
/* The same with its animated numbers as they are at a time, without warnings. */
int cli_scene_at(const cli *c, const char *path, double time, skf_scene **out);
/* Makes the bodies' fields anew to the --accuracy that is given; where none is, to 1e-12 those that are so large that
   it saves time at so many points. *made: whether any was. */
int cli_accuracy(const cli *c, skf_scene *scene, size_t points, bool *made);
/* The option's row, for the commands that have it. */
#define CLI_ACCURACY                                                                                                   \
  { 0, "accuracy", "A", "sum many primitives by expansions, to A of the absolute sum; exact: never (see below)" }
/* Index of a body by name, or -1 after the message. */
int cli_body(const skf_scene *scene, const char *name);

/* An output that appears whole or not at all. Data is written to a temporary file in the same folder and renamed by
   commit; path NULL or "-" is stdout. Interrupts and exits remove what was not committed. */
typedef struct cli_out {
  FILE *file; /* NULL after cli_out_path */
  char path[4096], temp[4096];
} cli_out;
bool cli_streams(const char *path);             /* no name, -, a device or a pipe: its ending tells no format */
int cli_out_open(cli_out *o, const char *path); /* CLI_DONE, or CLI_FAILED after the message */
/* For writers that want a file name: o->temp is the name to write to, with the same ending as path. */
int cli_out_name(cli_out *o, const char *path);
int cli_out_commit(cli_out *o); /* flushes, syncs, checks for errors, renames */
void cli_out_abort(cli_out *o);
/* Whether an operand, or an option of those that name files, names this one. */
bool cli_names(const cli *c, const char *path);

/* A clock that never goes back [s]. */
double cli_seconds(void);

/* A number with 17 significant digits, as every CSV here has it. */
void cli_put(FILE *f, double x);

/* Reads a CSV of `columns` numbers a row with exactly this header ("x,y,z"); *rows is an array of count * columns.
   `check`, unless NULL, says what is wrong with a row ("..., expected ..."), or NULL when it will do. */
int cli_csv(const char *path, const char *header, int columns, const char *(*check)(const double *row), double **rows,
            size_t *count);

/* A progress bar on a terminal (nothing elsewhere), which also notices Ctrl-C. */
skf_progress cli_progress(const char *label);
void cli_progress_end(void);
bool cli_interrupted(void);

/* JSON writer: strings are escaped, numbers carry 17 digits, non-finite numbers become null. */
typedef struct cli_json {
  FILE *file;
  int depth;
  bool comma;
} cli_json;
void json_open(cli_json *j, const char *key, char bracket); /* '{' or '['; key NULL inside arrays */
void json_close(cli_json *j, char bracket);
void json_string(cli_json *j, const char *key, const char *value); /* NULL becomes null */
void json_number(cli_json *j, const char *key, double value);
void json_integer(cli_json *j, const char *key, long value);
void json_bool(cli_json *j, const char *key, bool value);
void json_vector(cli_json *j, const char *key, skf_vec3 v);

extern const cli_command cmd_eval, cmd_trace, cmd_simulate, cmd_map, cmd_render, cmd_mesh, cmd_validate, cmd_info;

#endif
