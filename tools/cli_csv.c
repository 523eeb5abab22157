/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tables of numbers: comma-separated, one header line. */
#include "cli.h"
#include "core/number.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>

void cli_put(FILE *f, double x) {
  char text[SKF_NUMBER_SIZE];
  fwrite(text, 1, skf_number_write(text, x), f);
}

/* The whole file with a NUL at its end; NULL after the message. */
static char *slurp(const char *path, const char *label, size_t *size) {
  FILE *f = strcmp(path, "-") == 0 ? stdin : fopen(path, "rb");
  if (!f) return cli_fail(CLI_BAD, "%s: %s", label, strerror(errno)), NULL;
  size_t capacity = 1 << 16, n = 0, got;
  char *text = malloc(capacity);
  while (text && (got = fread(text + n, 1, capacity - n - 1, f)) > 0) {
    n += got;
    if (capacity - n - 1 > 0) continue;
    char *more = realloc(text, capacity *= 2);
    if (!more) free(text);
    text = more;
  }
  int error = !text ? ENOMEM : ferror(f) ? errno : 0;
  if (f != stdin) fclose(f);
  if (error) return free(text), cli_fail(CLI_BAD, "%s: %s", label, strerror(error)), NULL;
  text[n] = 0;
  *size = n;
  return text;
}

static const char *skip(const char *p) {
  while (*p == ' ' || *p == '\t') p++;
  return p;
}

/* Past the end of a line: LF, CRLF or the end of the text; NULL when something else stands there. */
static const char *end_of_line(const char *p, const char *end) {
  p = skip(p);
  if (*p == '\r' && p[1] == '\n') p++;
  return *p == '\n' ? p + 1 : p == end ? p : NULL;
}

typedef struct reader {
  const char *label, *header, *p, *end;
  int columns;
  const char *(*check)(const double *row);
  size_t line;
} reader;

static int bad(const reader *r, const char *what) {
  return cli_fail(CLI_BAD, "%s:%zu: %s, expected %d numbers a row (%s)", r->label, r->line, what, r->columns,
                  r->header);
}

static int read_header(reader *r) {
  const char *start = r->p;
  if (strncmp(start, "\xef\xbb\xbf", 3) == 0) start += 3; /* the byte order mark of some spreadsheets */
  size_t n = strlen(r->header);
  r->p = strncmp(start, r->header, n) == 0 ? end_of_line(start + n, r->end) : NULL;
  if (r->p) return CLI_DONE;
  int shown = (int)strcspn(start, "\r\n");
  return cli_fail(CLI_BAD, "%s:1: header is '%.*s', expected '%s'", r->label, shown > 80 ? 80 : shown, start,
                  r->header);
}

static int read_row(reader *r, double *row) {
  const char *p = r->p;
  for (int k = 0; k < r->columns; k++) {
    if (k && *p++ != ',') return bad(r, "too few numbers, or one that is malformed");
    size_t used;
    p = skip(p);
    skf_status s = skf_number_read(p, &used, row + k);
    if (s == SKF_ERR_RANGE) return bad(r, "a number is too large");
    if (s != SKF_OK) return bad(r, "malformed, missing or non-finite number");
    p = skip(p + used);
  }
  r->p = end_of_line(p, r->end);
  if (!r->p) return bad(r, *p == ',' ? "too many numbers" : "text after the numbers");
  const char *wrong = r->check ? r->check(row) : NULL;
  return wrong ? cli_fail(CLI_BAD, "%s:%zu: %s", r->label, r->line, wrong) : CLI_DONE;
}

static int read_rows(reader *r, double **rows, size_t *count) {
  size_t capacity = 0, columns = (size_t)r->columns;
  *rows = NULL, *count = 0;
  for (r->line = 2; r->p < r->end; r->line++) {
    const char *next = end_of_line(r->p, r->end);
    if (next) { /* a blank line */
      r->p = next;
      continue;
    }
    if (*count == capacity) {
      capacity = capacity ? capacity + capacity / 2 : 1024;
      double *more = realloc(*rows, capacity * columns * sizeof **rows);
      if (!more) return cli_fail(CLI_FAILED, "%s: out of memory", r->label);
      *rows = more;
    }
    int status = read_row(r, *rows + *count * columns);
    if (status != CLI_DONE) return status;
    ++*count;
  }
  return CLI_DONE;
}

int cli_csv(const char *path, const char *header, int columns, const char *(*check)(const double *row), double **rows,
            size_t *count) {
  const char *label = strcmp(path, "-") == 0 ? "stdin" : path;
  size_t size;
  char *text = slurp(path, label, &size);
  *rows = NULL, *count = 0;
  if (!text) return CLI_BAD;
  reader r = {label, header, text, text + size, columns, check, 1};
  int status = read_header(&r);
  if (status == CLI_DONE) status = read_rows(&r, rows, count);
  free(text);
  if (status != CLI_DONE) {
    free(*rows);
    *rows = NULL, *count = 0;
  }
  return status;
}
