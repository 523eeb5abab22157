/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each row is written as differences from its neighbours, of the kind whose sizes sum up to least; of what is left only
   runs of one byte are shortened, and a Huffman code for each block does the rest [RFC 1950, RFC 1951]. On shaded
   pictures that is as small as a search for repetitions, and several times as quick. */
#include "png.h"
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

typedef struct stream {
  unsigned char *at; /* eight bytes behind it are writable */
  uint64_t bits;
  int count; /* of the bits that wait, below 8 */
} stream;

static inline void put(stream *s, unsigned value, int count) {
  s->bits |= (uint64_t)value << s->count, s->count += count;
  for (int k = 0; k < 8; k++) s->at[k] = (unsigned char)(s->bits >> 8 * k);
  s->at += s->count >> 3, s->bits >>= s->count & ~7, s->count &= 7;
}

static void flush(stream *s) {
  if (s->count) put(s, 0, 8 - s->count);
}

enum { LITERALS = 286, LONGEST = 15, END = 256, RUN = 258, PART = 1 << 16 };

typedef struct code {
  unsigned value[LITERALS];
  unsigned char length[LITERALS];
} code;

/* Depths of the n leaves in Huffman's tree, n >= 2; weight: theirs, lightest first, with room for the inner nodes. */
static void depths(unsigned *weight, int n, int *depth) {
  int parent[2 * LITERALS], leaf = 0, inner = n;
  for (int next = n; next < 2 * n - 1; next++) {
    weight[next] = 0;
    for (int k = 0; k < 2; k++) {
      int least = leaf < n && (inner >= next || weight[leaf] <= weight[inner]) ? leaf++ : inner++;
      weight[next] += weight[least], parent[least] = next;
    }
  }
  int level[2 * LITERALS];
  level[2 * n - 2] = 0;
  for (int i = 2 * n - 3; i >= 0; i--) level[i] = level[parent[i]] + 1;
  for (int i = 0; i < n; i++) depth[i] = level[i];
}

/* No code longer than LONGEST: the rarest are shortened, and others lengthened until the code is complete again. */
static void limit(int *depth, int n) {
  long full = 1L << LONGEST, used = 0;
  for (int i = 0; i < n; i++) depth[i] = depth[i] < LONGEST ? depth[i] : LONGEST, used += full >> depth[i];
  for (int i = 0; used > full; i = i + 1 < n ? i + 1 : 0) /* rarest first */
    if (depth[i] < LONGEST) used -= full >> (depth[i] + 1), depth[i]++;
  for (int i = n - 1; i >= 0; i--) /* what that has freed, to the commonest */
    while (depth[i] > 1 && used + (full >> depth[i]) <= full) used += full >> depth[i], depth[i]--;
}

static int by_count(const void *a, const void *b) {
  uint64_t x = *(const uint64_t *)a, y = *(const uint64_t *)b;
  return (x > y) - (x < y);
}

/* The canonical code for symbols that are so frequent; value: with the first bit lowest. */
static void make_code(const unsigned *count, code *c) {
  uint64_t order[LITERALS];
  unsigned weight[2 * LITERALS], next[LONGEST + 2] = {0};
  int depth[LITERALS], n = 0;
  for (int i = 0; i < LITERALS; i++)
    if (count[i]) order[n++] = (uint64_t)count[i] << 16 | (unsigned)i;
  qsort(order, (size_t)n, sizeof *order, by_count);
  for (int i = 0; i < n; i++) weight[i] = (unsigned)(order[i] >> 16);
  depths(weight, n, depth), limit(depth, n);
  memset(c, 0, sizeof *c);
  for (int i = 0; i < n; i++) c->length[order[i] & 0xffff] = (unsigned char)depth[i], next[depth[i] + 1]++;
  for (int k = 1; k <= LONGEST; k++) next[k] = (next[k] + next[k - 1]) << 1;
  for (int i = 0; i < LITERALS; i++) {
    unsigned v = c->length[i] ? next[c->length[i]]++ : 0;
    for (int k = 0; k < c->length[i]; k++, v >>= 1) c->value[i] = c->value[i] << 1 | (v & 1);
  }
}

/* Lengths in four bits each: a complete code of the code lengths 0 to 15, which needs no table of its own. */
static void put_lengths(stream *s, const code *c) {
  static const unsigned char order[19] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
  put(s, LITERALS - 257, 5), put(s, 0, 5), put(s, 19 - 4, 4); /* one distance */
  for (int i = 0; i < 19; i++) put(s, order[i] < 16 ? 4 : 0, 3);
  for (int i = 0; i <= LITERALS; i++) {
    unsigned v = i < LITERALS ? c->length[i] : 1, reversed = 0;
    for (int k = 0; k < 4; k++) reversed |= (v >> k & 1) << (3 - k);
    put(s, reversed, 4);
  }
}

typedef struct run {
  int symbol, extra, bits;
} run;

/* The symbol of a run's length, 3 to RUN. */
static run run_of(int length) {
  int n = length - 3, bits = 0;
  if (length == RUN) return (run){285, 0, 0};
  while (n >> bits >= 8) bits++;
  return (run){257 + 4 * bits + (n >> bits), n & ((1 << bits) - 1), bits};
}

enum { WORTH = 8 }; /* shorter runs cost about what their bytes do */

/* How many bytes from `at` on are the one before it; 0 for less than WORTH. */
static int run_at(const unsigned char *at, const unsigned char *end) {
  uint64_t next, same = at[-1] * 0x0101010101010101u;
  if (end - at < WORTH || (memcpy(&next, at, sizeof next), next != same)) return 0;
  const unsigned char *p = at + WORTH;
  if (end - at > RUN) end = at + RUN;
  while (p < end && *p == at[-1]) p++;
  return (int)(p - at);
}

/* One block of n bytes, n <= PART; sign: room for as many, each a byte or, above END, a run. */
static void put_block(stream *s, const unsigned char *from, size_t n, bool last, unsigned short *sign) {
  unsigned count[2][LITERALS] = {{0}}; /* two, as an increment waits for the one before in the same place */
  size_t signs = 0;
  code c;
  for (const unsigned char *p = from, *end = from + n; p < end; signs++) {
    int length = p > from ? run_at(p, end) : 0;
    sign[signs] = (unsigned short)(length ? END + length : *p);
    count[signs & 1][length ? run_of(length).symbol : *p]++;
    p += length ? length : 1;
  }
  for (int i = 0; i < LITERALS; i++) count[0][i] += count[1][i];
  count[0][END]++, count[0][0]++; /* at least two of them */
  make_code(count[0], &c);
  stream to = *s; /* in registers: nothing else points to it */
  put(&to, last, 1), put(&to, 2, 2), put_lengths(&to, &c);
  for (size_t i = 0; i < signs; i++) {
    if (sign[i] < END) {
      put(&to, c.value[sign[i]], c.length[sign[i]]);
    } else {
      run r = run_of(sign[i] - END);
      put(&to, c.value[r.symbol], c.length[r.symbol]), put(&to, (unsigned)r.extra, r.bits), put(&to, 0, 1);
    }
  }
  put(&to, c.value[END], c.length[END]);
  *s = to;
}

static uint32_t adler(const unsigned char *p, size_t n) {
  uint32_t a = 1, b = 0;
  for (size_t i = 0; i < n;) {
    size_t end = i + 5552 < n ? i + 5552 : n; /* so many before the sums overflow */
    for (; i < end; i++) a += p[i], b += a;
    a %= 65521, b %= 65521;
  }
  return b << 16 | a;
}

static void put_big(unsigned char *out, uint32_t v) {
  for (int k = 0; k < 4; k++) out[k] = (unsigned char)(v >> (24 - 8 * k));
}

/* Type and data stand behind `out` + 4; writes what is around them, and returns the end. */
static unsigned char *close_chunk(unsigned char *out, const char *type, size_t n) {
  uint32_t table[8][256], crc = 0xffffffffu;
  for (uint32_t i = 0; i < 256; i++) {
    uint32_t v = i;
    for (int k = 0; k < 8; k++) v = v >> 1 ^ (v & 1 ? 0xedb88320u : 0);
    table[0][i] = v;
  }
  for (int k = 1; k < 8; k++) /* a byte and k zeros behind it */
    for (int i = 0; i < 256; i++) table[k][i] = table[k - 1][i] >> 8 ^ table[0][table[k - 1][i] & 255];
  put_big(out, (uint32_t)n), memcpy(out + 4, type, 4);
  const unsigned char *p = out + 4, *end = p + 4 + n;
  for (; end - p >= 8; p += 8) {
    uint32_t low = crc ^ (p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24);
    crc = table[7][low & 255] ^ table[6][low >> 8 & 255] ^ table[5][low >> 16 & 255] ^ table[4][low >> 24] ^
          table[3][p[4]] ^ table[2][p[5]] ^ table[1][p[6]] ^ table[0][p[7]];
  }
  for (; p < end; p++) crc = crc >> 8 ^ table[0][(crc ^ *p) & 255];
  put_big(out + 8 + n, ~crc);
  return out + 12 + n;
}

static unsigned size_of(const unsigned char *p, size_t n) {
  unsigned sum = 0;
  for (size_t i = 0; i < n; i++) sum += p[i] < 128 ? p[i] : 256u - p[i];
  return sum;
}

/* A row's bytes less those to the left, those above, or the mean of both: filters 1, 2 and 3. */
static void differ(int kind, const unsigned char *row, const unsigned char *above, size_t step, size_t n,
                   unsigned char *out) {
  for (size_t i = 0; i < step; i++) out[i] = (unsigned char)(row[i] - (kind == 1 ? 0 : above[i] >> (kind - 2)));
  row += step, above += step, out += step, n -= step;
  const unsigned char *left = row - step;
  if (kind == 1)
    for (size_t i = 0; i < n; i++) out[i] = (unsigned char)(row[i] - left[i]);
  else if (kind == 2)
    for (size_t i = 0; i < n; i++) out[i] = (unsigned char)(row[i] - above[i]);
  else
    for (size_t i = 0; i < n; i++) out[i] = (unsigned char)(row[i] - ((left[i] + above[i]) >> 1));
}

/* The filtered rows, each behind the filter's number; work: rows of n bytes: two of pixels, and one for each filter. */
static void filter_rows(int width, int height, int bits, const void *rgb, unsigned char *work, unsigned char *out) {
  size_t step = 3 * (size_t)bits / 8, n = (size_t)width * step;
  unsigned char *above = work, *row = work + n, *tried[4] = {NULL, row + n, row + 2 * n, row + 3 * n};
  memset(above, 0, n);
  for (int y = 0; y < height; y++) {
    const unsigned short *deep = (const unsigned short *)rgb + (size_t)y * n / 2;
    if (bits == 16)
      for (size_t i = 0; i < n / 2; i++)
        row[2 * i] = (unsigned char)(deep[i] >> 8), row[2 * i + 1] = (unsigned char)deep[i];
    else
      memcpy(row, (const unsigned char *)rgb + (size_t)y * n, n);
    unsigned least = 0;
    int best = 0;
    for (int kind = 1; kind <= 3; kind++) {
      differ(kind, row, above, step, n, tried[kind]);
      unsigned size = size_of(tried[kind], n);
      if (!best || size < least) least = size, best = kind;
    }
    *out++ = (unsigned char)best;
    memcpy(out, tried[best], n), out += n;
    unsigned char *old = above;
    above = row, row = old;
  }
}

bool png_encode(int width, int height, int bits, const void *rgb, unsigned char **bytes, size_t *n) {
  size_t row = 3 * (size_t)width * (size_t)bits / 8, all = (row + 1) * (size_t)height;
  unsigned char *work = malloc(5 * row), *rows = malloc(all);
  /* no byte takes more than 15 bits */
  unsigned char *out = *bytes = malloc(2 * all + 512 * (all / PART + 2));
  unsigned short *signs = malloc(PART * sizeof *signs);
  bool room = work && rows && out && signs;
  if (!room) {
    free(out), *bytes = NULL;
    goto done;
  }
  filter_rows(width, height, bits, rgb, work, rows);
  memcpy(out, "\x89PNG\r\n\x1a\n", 8), out += 8;
  put_big(out + 8, (uint32_t)width), put_big(out + 12, (uint32_t)height);
  memcpy(out + 16, (unsigned char[5]){(unsigned char)bits, 2}, 5);
  out = close_chunk(out, "IHDR", 13);
  stream s = {.at = out + 8};
  *s.at++ = 0x78, *s.at++ = 0x01;
  for (size_t from = 0; from < all; from += PART)
    put_block(&s, rows + from, all - from < PART ? all - from : PART, all - from <= PART, signs);
  flush(&s);
  put_big(s.at, adler(rows, all));
  out = close_chunk(out, "IDAT", (size_t)(s.at + 4 - (out + 8)));
  out = close_chunk(out, "IEND", 0);
  *n = (size_t)(out - *bytes);
done:
  free(work), free(rows), free(signs);
  return room;
}
