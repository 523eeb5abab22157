/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Command lines against a command's table of options, and messages. */
#include "cli_private.h"
#include "core/number.h"
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

const cli_option cli_common[] = {
    {0, "threads", "N", "threads to use (default: all cores); never changes a result"},
    {'h', "help", NULL, "this help"},
};
const int cli_common_count = sizeof cli_common / sizeof *cli_common;

static const cli_option *option_at(const cli_command *command, int i) {
  return i < command->option_count ? command->options + i : cli_common + (i - command->option_count);
}

static int option_count(const cli_command *command) { return command->option_count + cli_common_count; }

static int find_long(const cli_command *command, const char *name, size_t length) {
  for (int i = 0; i < option_count(command); i++) {
    const char *known = option_at(command, i)->name;
    if (strlen(known) == length && memcmp(known, name, length) == 0) return i;
  }
  return -1;
}

static int find_letter(const cli_command *command, char letter) {
  for (int i = 0; i < option_count(command); i++)
    if (option_at(command, i)->letter == letter) return i;
  return -1;
}

static int refuse(const cli *c, const char *what, const char *arg) {
  const char *name = c->command->name;
  return cli_fail(CLI_BAD, "%s: %s '%s' (see skelfield %s --help)", name, what, arg, name);
}

/* "--name", "--name=value", "--name value"; *taken tells whether the next argument was used. */
static int long_option(cli *c, const char *arg, const char *next, bool *taken) {
  const char *name = arg + 2, *equals = strchr(name, '=');
  int i = find_long(c->command, name, equals ? (size_t)(equals - name) : strlen(name));
  if (i < 0) return refuse(c, "unknown option", arg);
  c->given[i] = true;
  if (!option_at(c->command, i)->arg) return equals ? refuse(c, "no value is expected in", arg) : CLI_DONE;
  c->values[i] = equals ? equals + 1 : next;
  *taken = !equals;
  return c->values[i] ? CLI_DONE : refuse(c, "a value is expected after", arg);
}

/* "-j", "-o FILE", "-oFILE", "-jo FILE". */
static int short_options(cli *c, const char *arg, const char *next, bool *taken) {
  for (const char *p = arg + 1; *p; p++) {
    int i = find_letter(c->command, *p);
    if (i < 0) return refuse(c, "unknown option", arg);
    c->given[i] = true;
    if (!option_at(c->command, i)->arg) continue;
    *taken = !p[1];
    c->values[i] = p[1] ? p + 1 : next;
    return c->values[i] ? CLI_DONE : refuse(c, "a value is expected after", arg);
  }
  return CLI_DONE;
}

int cli_parse(cli *c, const cli_command *command, int argc, char **argv) {
  *c = (cli){.command = command};
  bool options = true;
  for (int k = 0; k < argc; k++) {
    const char *arg = argv[k], *next = k + 1 < argc ? argv[k + 1] : NULL;
    bool taken = false;
    int status = CLI_DONE;
    if (options && strcmp(arg, "--") == 0)
      options = false;
    else if (options && arg[0] == '-' && arg[1] == '-')
      status = long_option(c, arg, next, &taken);
    else if (options && arg[0] == '-' && arg[1])
      status = short_options(c, arg, next, &taken);
    else if (c->operand_count == command->operand_count)
      status = refuse(c, "one argument too many:", arg);
    else
      c->operands[c->operand_count++] = arg;
    if (status != CLI_DONE) return status;
    k += taken;
  }
  if (!cli_given(c, "help") && c->operand_count < command->operand_count)
    return cli_fail(CLI_BAD, "%s: expected %s (see skelfield %s --help)", command->name, command->operands,
                    command->name);
  return CLI_DONE;
}

const char *cli_operand(const cli *c, int i) { return i < c->operand_count ? c->operands[i] : NULL; }

const char *cli_value(const cli *c, const char *option) {
  int i = find_long(c->command, option, strlen(option));
  return i < 0 ? NULL : c->values[i];
}

bool cli_given(const cli *c, const char *option) {
  int i = find_long(c->command, option, strlen(option));
  return i >= 0 && c->given[i];
}

int cli_number(const cli *c, const char *option, double above, double *out) {
  const char *text = cli_value(c, option);
  if (!text) return CLI_DONE;
  size_t used;
  double x;
  if (skf_number_read(text, &used, &x) != SKF_OK || text[used] || !(x > above)) {
    char bound[SKF_NUMBER_SIZE];
    skf_number_write(bound, above);
    bool any = above < -1e300; /* -INFINITY, or -DBL_MAX: no bound worth telling */
    return cli_fail(CLI_BAD, "--%s %s: expected a finite number%s%s", option, text, any ? "" : " > ", any ? "" : bound);
  }
  *out = x;
  return CLI_DONE;
}

int cli_whole(const cli *c, const char *option, int least, int most, int *out) {
  const char *text = cli_value(c, option);
  if (!text) return CLI_DONE;
  size_t used;
  double x;
  if (skf_number_read(text, &used, &x) != SKF_OK || text[used] || x != floor(x) || x < least || x > most)
    return cli_fail(CLI_BAD, "--%s %s: expected a whole number from %d to %d", option, text, least, most);
  *out = (int)x;
  return CLI_DONE;
}

/* What a muted process would have said last. */
static struct {
  bool on;
  char text[512];
} mute;

void cli_mute(void) {
  mute.on = true;
  FILE *nowhere = freopen("/dev/null", "w", stdout);
  (void)nowhere; /* without one writes fail, unheard */
}

bool cli_is_muted(void) { return mute.on; }
const char *cli_muted(void) { return mute.on ? mute.text : ""; }

static void one_line(const char *prefix, const char *format, va_list args) {
  char text[8192];
  vsnprintf(text, sizeof text, format, args);
  if (mute.on) {
    snprintf(mute.text, sizeof mute.text, "%.*s", (int)sizeof mute.text - 1, text);
    return;
  }
  for (char *p = text; *p; p++)
    if ((unsigned char)*p < 32 || *p == 127) *p = '?'; /* a name with a line feed must not make two lines */
  fprintf(stderr, "%s%s\n", prefix, text);
}

int cli_fail(int status, const char *format, ...) {
  cli_progress_end();
  va_list args;
  va_start(args, format);
  one_line("skelfield: ", format, args);
  va_end(args);
  return status;
}

int cli_fail_status(skf_status status, const char *what) {
  bool bad =
      status == SKF_ERR_ARG || status == SKF_ERR_RANGE || status == SKF_ERR_DEGENERATE || status == SKF_ERR_PARSE;
  return cli_fail(bad ? CLI_BAD : CLI_FAILED, "%s: %s", what, skf_status_text(status));
}

void cli_say(const char *format, ...) {
  va_list args;
  va_start(args, format);
  one_line("", format, args);
  va_end(args);
}
