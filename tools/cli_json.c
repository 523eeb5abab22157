/* SPDX-License-Identifier: GPL-3.0-or-later */
/* JSON, indented by two spaces. */
#include "cli.h"
#include "core/number.h"
#include <math.h>

static void put_string(FILE *f, const char *s) {
  fputc('"', f);
  for (; *s; s++) {
    unsigned char c = (unsigned char)*s;
    if (c == '"' || c == '\\')
      fprintf(f, "\\%c", c);
    else if (c < 32)
      fprintf(f, "\\u%04x", c);
    else
      fputc(c, f);
  }
  fputc('"', f);
}

static void put_key(cli_json *j, const char *key) {
  if (j->comma) fputc(',', j->file);
  if (j->depth) fprintf(j->file, "\n%*s", 2 * j->depth, "");
  if (key) {
    put_string(j->file, key);
    fputs(": ", j->file);
  }
  j->comma = true;
}

static void put_number(FILE *f, double x) {
  char text[SKF_NUMBER_SIZE];
  skf_number_write(text, x);
  fputs(isfinite(x) ? text : "null", f);
}

void json_open(cli_json *j, const char *key, char bracket) {
  put_key(j, key);
  fputc(bracket, j->file);
  j->depth++;
  j->comma = false;
}

void json_close(cli_json *j, char bracket) {
  j->depth--;
  if (j->comma) fprintf(j->file, "\n%*s", 2 * j->depth, "");
  fputc(bracket, j->file);
  if (!j->depth) fputc('\n', j->file);
  j->comma = true;
}

void json_string(cli_json *j, const char *key, const char *value) {
  put_key(j, key);
  if (value)
    put_string(j->file, value);
  else
    fputs("null", j->file);
}

void json_number(cli_json *j, const char *key, double value) {
  put_key(j, key);
  put_number(j->file, value);
}

void json_integer(cli_json *j, const char *key, long value) {
  put_key(j, key);
  fprintf(j->file, "%ld", value);
}

void json_bool(cli_json *j, const char *key, bool value) {
  put_key(j, key);
  fputs(value ? "true" : "false", j->file);
}

void json_vector(cli_json *j, const char *key, skf_vec3 v) {
  put_key(j, key);
  const double x[3] = {v.x, v.y, v.z};
  for (int i = 0; i < 3; i++) {
    fputs(i ? ", " : "[", j->file);
    put_number(j->file, x[i]);
  }
  fputc(']', j->file);
}
