/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outputs that appear whole or not at all, also when a signal ends the program. */
#include "cli_private.h"
#include <errno.h>
#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

enum { OUTPUTS = 16 };

/* What a signal handler has to remove. */
static struct {
  volatile sig_atomic_t live;
  char name[sizeof((cli_out *)0)->temp];
} temps[OUTPUTS];

/* Seconds that work has to notice a signal. */
enum { PATIENCE = 5 };

static volatile sig_atomic_t caught, polite;

static void remove_temps(void) {
  for (int i = 0; i < OUTPUTS; i++)
    if (temps[i].live) unlink(temps[i].name);
}

static void on_signal(int number) {
  bool again = caught != 0;
  caught = number;
  if (polite && !again) {
    alarm(PATIENCE);
    return;
  }
  remove_temps();
  signal(number, SIG_DFL);
  raise(number);
}

/* The work has not looked at it in time. */
static void on_alarm(int number) {
  (void)number;
  remove_temps();
  signal(caught, SIG_DFL);
  raise(caught);
}

void cli_signals(void) {
  const int numbers[] = {SIGINT, SIGTERM, SIGHUP};
  for (size_t i = 0; i < sizeof numbers / sizeof *numbers; i++) {
    struct sigaction action = {.sa_handler = on_signal}, old;
    sigemptyset(&action.sa_mask);
    if (sigaction(numbers[i], NULL, &old) == 0 && old.sa_handler != SIG_IGN) sigaction(numbers[i], &action, NULL);
  }
  signal(SIGPIPE, SIG_IGN);
  signal(SIGALRM, on_alarm);
}

int cli_signal(void) { return caught; }
void cli_polite(bool on) {
  polite = on;
  if (!on) alarm(0);
}
bool cli_interrupted(void) {
  if (caught) alarm(0);
  return caught != 0;
}

static void forget(const char *temp) {
  for (int i = 0; i < OUTPUTS; i++)
    if (temps[i].live && strcmp(temps[i].name, temp) == 0) temps[i].live = 0;
}

void cli_out_cleanup(void) {
  remove_temps();
  for (int i = 0; i < OUTPUTS; i++) temps[i].live = 0;
}

static int fail(const char *path, int error) { return cli_fail(CLI_FAILED, "%s: %s", path, strerror(error)); }

/* Makes the temporary file beside path, ".NAME.PID-N.ENDING", and notes it for the signal handler. */
static int make_temp(cli_out *o) {
  const char *slash = strrchr(o->path, '/'), *name = slash ? slash + 1 : o->path, *dot = strrchr(name, '.');
  int folder = (int)(name - o->path), slot = 0;
  while (slot < OUTPUTS && temps[slot].live) slot++;
  if (slot == OUTPUTS) return cli_fail(CLI_FAILED, "%s: too many outputs at once", o->path);
  for (int n = 0;; n++) {
    int length =
        snprintf(o->temp, sizeof o->temp, "%.*s.%s.%ld-%d%s", folder, o->path, name, (long)getpid(), n, dot ? dot : "");
    if (length >= (int)sizeof o->temp) return fail(o->path, ENAMETOOLONG);
    strcpy(temps[slot].name, o->temp);
    int fd = open(o->temp, O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd < 0 && errno == EEXIST && n < 100) continue;
    if (fd < 0) return fail(o->path, errno);
    temps[slot].live = 1;
    close(fd);
    return CLI_DONE;
  }
}

bool cli_streams(const char *path) {
  struct stat info;
  if (!path || strcmp(path, "-") == 0) return true;
  return stat(path, &info) == 0 && !S_ISREG(info.st_mode) && !S_ISDIR(info.st_mode);
}

/* Settles where the data goes: through links, and straight into what is not a regular file (a device, a pipe). */
int cli_out_name(cli_out *o, const char *path) {
  o->file = NULL;
  o->path[0] = o->temp[0] = 0;
  if (!path || strcmp(path, "-") == 0) return cli_fail(CLI_BAD, "a file name is expected: -o FILE");
  struct stat info;
  bool exists = stat(path, &info) == 0;
  if (exists && S_ISDIR(info.st_mode)) return fail(path, EISDIR);
  char *real = exists ? realpath(path, NULL) : NULL;
  int length = snprintf(o->path, sizeof o->path, "%s", real ? real : path);
  free(real);
  if (length >= (int)sizeof o->path) return fail(path, ENAMETOOLONG);
  if (exists && !S_ISREG(info.st_mode)) return strcpy(o->temp, o->path), CLI_DONE;
  return make_temp(o);
}

int cli_out_open(cli_out *o, const char *path) {
  if (!path || strcmp(path, "-") == 0) {
    *o = (cli_out){.file = stdout};
    return CLI_DONE;
  }
  int status = cli_out_name(o, path);
  if (status != CLI_DONE) return status;
  o->file = fopen(o->temp, "w");
  if (!o->file) {
    int error = errno;
    cli_out_abort(o);
    return fail(path, error);
  }
  return CLI_DONE;
}

/* Flushes and closes o->file; 0 or the error. */
static int finish(cli_out *o) {
  FILE *f = o->file;
  o->file = NULL;
  errno = 0;
  bool failed = fflush(f) != 0 || ferror(f);
  int error = failed ? errno ? errno : EIO : 0;
  if (f != stdout && fclose(f) != 0 && !error) error = errno;
  return error;
}

/* The data must be on the disk before the name is: after a crash the file is the old one or the new one. */
static int sync_temp(const cli_out *o) {
  int fd = open(o->temp, O_WRONLY | O_CLOEXEC);
  if (fd < 0) return errno;
  int error = fsync(fd) == 0 || errno == EINVAL || errno == EROFS ? 0 : errno;
  close(fd);
  return error;
}

int cli_out_commit(cli_out *o) {
  cli_progress_end();
  bool to_stdout = o->file == stdout;
  int error = o->file ? finish(o) : 0;
  if (to_stdout) return error ? fail("stdout", error) : CLI_DONE;
  bool direct = strcmp(o->temp, o->path) == 0;
  if (!error && !direct) error = sync_temp(o);
  struct stat old;
  if (!error && !direct && stat(o->path, &old) == 0) chmod(o->temp, old.st_mode & 07777);
  if (!error && !direct && rename(o->temp, o->path) != 0) error = errno;
  if (error) {
    fail(o->path, error);
    cli_out_abort(o);
    return CLI_FAILED;
  }
  forget(o->temp);
  return CLI_DONE;
}

void cli_out_abort(cli_out *o) {
  if (o->file && o->file != stdout) fclose(o->file);
  o->file = NULL;
  if (o->temp[0] && strcmp(o->temp, o->path) != 0) unlink(o->temp);
  forget(o->temp);
}
