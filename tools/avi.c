/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "avi.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { HEADER = 224 }; /* bytes before the first picture */

/* Little-endian words and four-letter codes, one after the other. */
static void put(unsigned char **at, uint32_t x) {
  for (int k = 0; k < 4; k++) *(*at)++ = (unsigned char)(x >> 8 * k);
}

static void put_code(unsigned char **at, const char *code) { memcpy(*at, code, 4), *at += 4; }

static void put_stream(const avi *a, unsigned char **at) {
  put_code(at, "strh"), put(at, 56), put_code(at, "vids"), put_code(at, "MJPG");
  for (int k = 0; k < 3; k++) put(at, 0);
  put(at, 1000), put(at, (uint32_t)lround(1000 * a->fps)), put(at, 0), put(at, a->count), put(at, a->largest);
  put(at, UINT32_MAX), put(at, 0), put(at, 0), put(at, (uint32_t)a->width | (uint32_t)a->height << 16);
  put_code(at, "strf"), put(at, 40), put(at, 40), put(at, (uint32_t)a->width), put(at, (uint32_t)a->height);
  put(at, 1 | 24 << 16), put_code(at, "MJPG"), put(at, 3 * (uint32_t)a->width * (uint32_t)a->height);
  for (int k = 0; k < 4; k++) put(at, 0);
}

/* Everything up to the first picture; `end` is where the pictures end. */
static int put_header(const avi *a, uint32_t end) {
  unsigned char bytes[HEADER], *at = bytes;
  put_code(&at, "RIFF"), put(&at, end + 8 + 16 * a->count - 8), put_code(&at, "AVI ");
  put_code(&at, "LIST"), put(&at, 192), put_code(&at, "hdrl");
  put_code(&at, "avih"), put(&at, 56), put(&at, (uint32_t)lround(1e6 / a->fps));
  put(&at, 0), put(&at, 0), put(&at, 0x10), put(&at, a->count), put(&at, 0), put(&at, 1), put(&at, a->largest);
  put(&at, (uint32_t)a->width), put(&at, (uint32_t)a->height);
  for (int k = 0; k < 4; k++) put(&at, 0);
  put_code(&at, "LIST"), put(&at, 116), put_code(&at, "strl");
  put_stream(a, &at);
  put_code(&at, "LIST"), put(&at, end - HEADER + 4), put_code(&at, "movi");
  return (size_t)(at - bytes) == HEADER && fwrite(bytes, 1, HEADER, a->file) == HEADER
             ? CLI_DONE
             : cli_fail(CLI_FAILED, "the film cannot be written");
}

int avi_open(avi *a, FILE *file, int width, int height, double fps) {
  *a = (avi){.file = file, .width = width, .height = height, .fps = fps};
  return put_header(a, HEADER);
}

int avi_add(avi *a, const unsigned char *jpeg, size_t n) {
  long at = ftell(a->file);
  unsigned char head[8], *p = head;
  if (at < 0 || (double)at + (double)n > 2e9) return cli_fail(CLI_FAILED, "the film is larger than 2 GB");
  if (!(a->count & (a->count - 1))) { /* full at powers of two */
    void *more = realloc(a->index, (a->count ? 2 * a->count : 1) * sizeof *a->index);
    if (!more) return cli_fail(CLI_FAILED, "out of memory");
    a->index = more;
  }
  a->index[a->count][0] = (uint32_t)(at - HEADER + 4), a->index[a->count++][1] = (uint32_t)n;
  if (n > a->largest) a->largest = (uint32_t)n;
  put_code(&p, "00dc"), put(&p, (uint32_t)n);
  fwrite(head, 1, 8, a->file);
  fwrite(jpeg, 1, n, a->file);
  if (n & 1) fputc(0, a->file);
  return ferror(a->file) ? cli_fail(CLI_FAILED, "the film cannot be written") : CLI_DONE;
}

int avi_close(avi *a) {
  long end = ftell(a->file);
  unsigned char row[16], *p = row;
  put_code(&p, "idx1"), put(&p, 16 * a->count);
  fwrite(row, 1, 8, a->file);
  for (uint32_t i = 0; i < a->count; i++) {
    p = row;
    put_code(&p, "00dc"), put(&p, 0x10), put(&p, a->index[i][0]), put(&p, a->index[i][1]);
    fwrite(row, 1, 16, a->file);
  }
  if (end < 0 || fseek(a->file, 0, SEEK_SET)) return cli_fail(CLI_FAILED, "the film cannot be written");
  int status = put_header(a, (uint32_t)end);
  if (!status && fseek(a->file, 0, SEEK_END)) status = cli_fail(CLI_FAILED, "the film cannot be written");
  return status;
}
