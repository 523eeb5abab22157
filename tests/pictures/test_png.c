/* SPDX-License-Identifier: MIT */
/* PNG files against a reader that is written from the standards: every pixel comes back. */
#include "check.h"
#include "png.h"
#include "random.h"
#include <string.h>

typedef struct reader {
  const unsigned char *at, *end;
  unsigned bits;
  int count;
} reader;

static unsigned take(reader *r, int count) {
  for (; r->count < count; r->count += 8) {
    assert_true(r->at < r->end);
    r->bits |= (unsigned)*r->at++ << r->count;
  }
  unsigned v = r->bits & ((1u << count) - 1);
  r->bits >>= count, r->count -= count;
  return v;
}

typedef struct huffman {
  int count[16], symbol[288];
} huffman;

/* Complete, or with a single symbol of one bit [RFC 1951, 3.2.2]. */
static void build(huffman *h, const unsigned char *length, int n) {
  memset(h, 0, sizeof *h);
  for (int i = 0; i < n; i++) h->count[length[i]]++;
  int left = 1, at[16] = {0};
  h->count[0] = 0;
  for (int k = 1; k < 16; k++) left = 2 * left - h->count[k], assert_true(left >= 0);
  assert_true(left == 0 || (n == 1 && h->count[1] == 1));
  for (int k = 1; k < 15; k++) at[k + 1] = at[k] + h->count[k];
  for (int i = 0; i < n; i++)
    if (length[i]) h->symbol[at[length[i]]++] = i;
}

static int symbol(reader *r, const huffman *h) {
  int code = 0, first = 0, index = 0;
  for (int k = 1; k < 16; k++) {
    code |= (int)take(r, 1);
    if (code - first < h->count[k]) return h->symbol[index + code - first];
    index += h->count[k], first = (first + h->count[k]) << 1, code <<= 1;
  }
  fail_msg("no such code");
  return -1;
}

static void tables(reader *r, huffman *literal, huffman *distance) {
  static const int order[19] = {16, 17, 18, 0, 8, 7, 9, 6, 10, 5, 11, 4, 12, 3, 13, 2, 14, 1, 15};
  unsigned char length[320] = {0};
  int literals = (int)take(r, 5) + 257, distances = (int)take(r, 5) + 1, codes = (int)take(r, 4) + 4;
  huffman h;
  for (int i = 0; i < codes; i++) length[order[i]] = (unsigned char)take(r, 3);
  build(&h, length, 19);
  for (int i = 0; i < literals + distances; i++) {
    int s = symbol(r, &h);
    assert_true(s < 16); /* the writer repeats none */
    length[i] = (unsigned char)s;
  }
  build(literal, length, literals), build(distance, length + literals, distances);
}

/* Fills out with n bytes, exactly. */
static void inflate(reader *r, unsigned char *out, size_t n) {
  size_t k = 0;
  for (bool last = false; !last;) {
    huffman literal, distance;
    last = take(r, 1);
    assert_int_equal(take(r, 2), 2);
    tables(r, &literal, &distance);
    for (int s; (s = symbol(r, &literal)) != 256;) {
      int length = 1, extra = s < 265 || s == 285 ? 0 : (s - 261) / 4;
      if (s > 256) {
        length = s == 285 ? 258 : s < 265 ? s - 254 : ((4 + (s - 265) % 4) << extra) + 3 + (int)take(r, extra);
        assert_int_equal(symbol(r, &distance), 0); /* the byte before */
        assert_true(k > 0);
      }
      assert_true(k + (size_t)length <= n);
      for (int i = 0; i < length; i++, k++) out[k] = s < 256 ? (unsigned char)s : out[k - 1];
    }
  }
  assert_int_equal(k, n);
}

static unsigned big(const unsigned char *p) { return (unsigned)p[0] << 24 | p[1] << 16 | p[2] << 8 | p[3]; }

static unsigned crc(const unsigned char *p, size_t n) {
  unsigned c = ~0u;
  for (size_t i = 0; i < n; i++) {
    c ^= p[i];
    for (int k = 0; k < 8; k++) c = c >> 1 ^ (c & 1 ? 0xedb88320u : 0);
  }
  return ~c;
}

static unsigned adler(const unsigned char *p, size_t n) {
  unsigned a = 1, b = 0;
  for (size_t i = 0; i < n; i++) a = (a + p[i]) % 65521, b = (b + a) % 65521;
  return b << 16 | a;
}

/* The next chunk's data; *at moves behind it. */
static const unsigned char *chunk(const unsigned char **at, const unsigned char *end, const char *type, size_t *n) {
  const unsigned char *p = *at;
  assert_true(end - p >= 12);
  *n = big(p);
  assert_true((size_t)(end - p) >= 12 + *n);
  assert_memory_equal(p + 4, type, 4);
  assert_int_equal(crc(p + 4, *n + 4), big(p + 8 + *n));
  *at = p + 12 + *n;
  return p + 8;
}

static void check_picture(int width, int height, int bits, const void *rgb) {
  unsigned char *bytes;
  size_t size, n, step = 3 * (size_t)bits / 8, row = step * (size_t)width, all = (row + 1) * (size_t)height;
  assert_true(png_encode(width, height, bits, rgb, &bytes, &size));
  const unsigned char *at = bytes + 8, *end = bytes + size;
  assert_memory_equal(bytes, "\x89PNG\r\n\x1a\n", 8);
  const unsigned char *head = chunk(&at, end, "IHDR", &n);
  assert_int_equal(n, 13);
  assert_int_equal(big(head), width);
  assert_int_equal(big(head + 4), height);
  const unsigned char kind[5] = {(unsigned char)bits, 2, 0, 0, 0};
  assert_memory_equal(head + 8, kind, 5);
  const unsigned char *data = chunk(&at, end, "IDAT", &n);
  assert_int_equal((data[0] * 256 + data[1]) % 31, 0);
  assert_int_equal(data[0], 0x78);
  reader r = {data + 2, data + n - 4, 0, 0};
  unsigned char *raw = malloc(all), *before = calloc(row, 1);
  inflate(&r, raw, all);
  assert_ptr_equal(r.at, r.end);
  assert_int_equal(adler(raw, all), big(data + n - 4));
  chunk(&at, end, "IEND", &n);
  assert_int_equal(n, 0);
  assert_ptr_equal(at, end);
  for (int y = 0; y < height; y++) {
    unsigned char *p = raw + (size_t)y * (row + 1) + 1, *up = y ? p - row - 1 : before;
    for (size_t i = 0; i < row; i++) {
      int left = i >= step ? p[i - step] : 0;
      assert_true(p[-1] >= 1 && p[-1] <= 3);
      p[i] = (unsigned char)(p[i] + (p[-1] == 1 ? left : p[-1] == 2 ? up[i] : (left + up[i]) / 2));
      size_t k = (size_t)y * row + i;
      int want = bits == 8 ? ((const unsigned char *)rgb)[k] : ((const unsigned short *)rgb)[k / 2] >> (k & 1 ? 0 : 8);
      assert_int_equal(p[i], want & 255);
    }
  }
  free(raw), free(before), free(bytes);
}

static void all_come_back(void **state) {
  (void)state;
  static const int sizes[][2] = {{1, 1}, {1, 7}, {5, 1}, {16, 16}, {33, 21}, {257, 300}};
  uint64_t seed = 7;
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
    for (int bits = 8; bits <= 16; bits += 8)
      for (int kind = 0; kind < 5; kind++) {
        int w = sizes[s][0], h = sizes[s][1];
        unsigned short *deep = malloc(3 * sizeof *deep * (size_t)w * (size_t)h);
        for (int k = 0; k < 3 * w * h; k++) {
          int x = k / 3 % w, y = k / 3 / w;
          double noise = rnd(&seed, 0, 1);
          int v = kind == 0   ? 0                                      /* one colour */
                  : kind == 1 ? (int)(65536 * noise)                   /* nothing to save */
                  : kind == 2 ? 100 * x + 70 * y + (int)(9 * noise)    /* shades */
                  : kind == 3 ? (noise < 1e-3 ? 40000 : 300)           /* long runs */
                              : (int)(65535 * pow(noise, 40) * noise); /* bytes of very different frequency */
          if (bits == 16)
            deep[k] = (unsigned short)v;
          else
            ((unsigned char *)deep)[k] = (unsigned char)(v >> (kind == 2 ? 4 : 8));
        }
        check_picture(w, h, bits, deep);
        free(deep);
      }
}

/* Frequencies like Fibonacci's numbers want codes of 22 bits; 15 are the most. */
static void no_code_is_too_long(void **state) {
  (void)state;
  enum { W = 21845, N = 3 * W, KINDS = 22 };
  unsigned char *rgb = malloc(N), *line = malloc(N);
  size_t n = 0, a = 1, b = 1;
  for (int v = 0; v < KINDS && n < N; v++) {
    for (size_t k = 0; k < a && n < N; k++) line[n++] = (unsigned char)(v + 1);
    size_t next = a + b;
    a = b, b = next;
  }
  while (n < N) line[n++] = 30;
  uint64_t seed = 11;
  for (size_t i = n - 1; i > 0; i--) { /* shuffled, so that there are no runs */
    size_t k = (size_t)rnd(&seed, 0, (double)i + 1);
    unsigned char t = line[i];
    line[i] = line[k], line[k] = t;
  }
  for (size_t k = 0; k < N; k++) rgb[k] = (unsigned char)(line[k] + (k >= 3 ? rgb[k - 3] : 0));
  check_picture(W, 1, 8, rgb);
  free(rgb), free(line);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(all_come_back), cmocka_unit_test(no_code_is_too_long)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
