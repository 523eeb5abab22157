/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program: a table of commands. */
#include "cli_private.h"
#include "team.h"
#include <errno.h>
#include <fcntl.h>
#include <omp.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* One row for each command; each is one file cmd_*.c that ends in its table. */
const cli_command *const cli_commands[] = {
    /* fields */
    &cmd_eval,
    /* rays */
    &cmd_trace,
    /* motion */
    &cmd_simulate,
    /* pictures */
    &cmd_map,
    &cmd_render,
    /* surfaces */
    &cmd_mesh,
    &cmd_validate,
    /* scenes */
    &cmd_info,
    NULL,
};

static const cli_command *find(const char *name) {
  const cli_command *const *row = cli_commands;
  while (*row && strcmp((*row)->name, name) != 0) row++;
  return *row;
}

static int bad_command(const char *name) {
  return cli_fail(CLI_BAD, "unknown command '%s' (skelfield --help lists them)", name);
}

/* A file that is opened must not take the place of a closed standard stream. */
static void reserve_streams(void) {
  for (int fd = 0; fd <= 2; fd++)
    if (fcntl(fd, F_GETFD) < 0 && open("/dev/null", O_RDONLY) != fd) _Exit(CLI_FAILED);
}

static int flush(int status) {
  errno = 0;
  if ((fflush(stdout) != 0 || ferror(stdout)) && status == CLI_DONE)
    return cli_fail(CLI_FAILED, "stdout: %s", errno ? strerror(errno) : "write failed");
  return status;
}

static int help(int argc, char **argv) {
  if (argc == 0 || strcmp(argv[0], "help") == 0) {
    cli_help_program(stdout);
  } else if (strcmp(argv[0], "scene") == 0) {
    cli_help_scene(stdout);
  } else {
    const cli_command *command = find(argv[0]);
    if (!command) return bad_command(argv[0]);
    cli_help_command(stdout, command);
  }
  return CLI_DONE;
}

/* Processes on one machine share its cores. */
static void default_threads(void) {
  int neighbours = team_neighbours(), share = (int)sysconf(_SC_NPROCESSORS_ONLN) / neighbours;
  if (share > omp_get_num_procs()) share = omp_get_num_procs(); /* the launcher has bound it to some of them */
  if (neighbours > 1 && !getenv("OMP_NUM_THREADS")) omp_set_num_threads(share > 1 ? share : 1);
}

static int threads(const cli *c) {
  const char *text = cli_value(c, "threads");
  if (!text) return default_threads(), CLI_DONE;
  char *end;
  errno = 0;
  long n = strtol(text, &end, 10);
  if (*end || end == text || errno || n < 1 || n > 4096)
    return cli_fail(CLI_BAD, "--threads %s: expected a whole number from 1 to 4096", text);
  omp_set_num_threads((int)n);
  return CLI_DONE;
}

static int run(const cli_command *command, int argc, char **argv) {
  cli c;
  int status = cli_parse(&c, command, argc, argv);
  if (status == CLI_DONE && cli_given(&c, "help")) return cli_help_command(stdout, command), CLI_DONE;
  if (status == CLI_DONE) status = threads(&c);
  if (status == CLI_DONE) status = cli_check_files(&c);
  int rank, size = team_launched(&rank);
  if (status == CLI_DONE && size > 1 && !command->shares)
    status = cli_fail(CLI_BAD,
                      "%s: one of %d processes of an MPI launcher, but only simulate shares its work, expected one "
                      "process (SKELFIELD_MPI=off lets each work by itself)",
                      command->name, size);
  if (status != CLI_DONE) return status;
  cli_signals();
  status = command->run(&c);
  cli_progress_end();
  cli_out_cleanup();
  return cli_signal() && status != CLI_DONE ? 128 + cli_signal() : status;
}

int main(int argc, char **argv) {
  reserve_streams();
  const char *first = argc > 1 ? argv[1] : NULL;
  int status = CLI_DONE, rank;
  team_launched(&rank);
  if (rank > 0) cli_mute(); /* the first process speaks for all */
  if (!first) {
    status = cli_fail(CLI_BAD, "no command (skelfield --help lists them)");
  } else if (strcmp(first, "--help") == 0 || strcmp(first, "-h") == 0) {
    cli_help_program(stdout);
  } else if (strcmp(first, "--version") == 0) {
    printf("skelfield %s\n", skf_version());
  } else if (strcmp(first, "help") == 0) {
    status = help(argc - 2, argv + 2);
  } else if (*first == '-') {
    status = cli_fail(CLI_BAD, "a command is expected before '%s' (skelfield --help lists them)", first);
  } else {
    const cli_command *command = find(first);
    status = command ? run(command, argc - 2, argv + 2) : bad_command(first);
  }
  return rank > 0 ? CLI_DONE : flush(status);
}
