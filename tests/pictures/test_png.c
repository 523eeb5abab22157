/* SPDX-License-Identifier: MIT */
/* PNG files read back by libpng's own reader: every value comes back, of 8 bits and of 16. */
#include "adapt/png_file.h"
#include "check.h"
#include "random.h"
#include <png.h>

static unsigned value(int kind, int x, int y, uint64_t *seed) {
  double noise = rnd(seed, 0, 1);
  return kind == 0   ? 0                                           /* one colour */
         : kind == 1 ? (unsigned)(65535 * noise)                   /* nothing to save */
                     : 100u * x + 70u * y + (unsigned)(9 * noise); /* shades */
}

typedef struct source {
  const unsigned char *at;
  size_t left;
} source;

static void give(png_structp png, png_bytep to, size_t n) {
  source *s = png_get_io_ptr(png);
  assert_true(n <= s->left);
  for (size_t i = 0; i < n; i++) to[i] = s->at[i];
  s->at += n, s->left -= n;
}

static void check_picture(int w, int h, int bits, int kind) {
  uint64_t seed = 7;
  int values = 3 * w * h;
  unsigned short *deep = malloc(sizeof *deep * values);
  unsigned char *shallow = malloc(values), *bytes;
  for (int k = 0; k < values; k++) deep[k] = (unsigned short)value(kind, k / 3 % w, k / 3 / w, &seed);
  for (int k = 0; k < values; k++) shallow[k] = (unsigned char)(deep[k] >> 8);
  size_t n;
  assert_int_equal(skf_png_encode(w, h, bits, bits == 16 ? (void *)deep : shallow, &bytes, &n), SKF_OK);

  source from = {bytes, n};
  png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, NULL, NULL, NULL);
  png_infop info = png_create_info_struct(png);
  png_set_read_fn(png, &from, give);
  png_read_info(png, info);
  assert_int_equal(png_get_image_width(png, info), w);
  assert_int_equal(png_get_image_height(png, info), h);
  assert_int_equal(png_get_bit_depth(png, info), bits);
  assert_int_equal(png_get_color_type(png, info), PNG_COLOR_TYPE_RGB);
  unsigned char *row = malloc(png_get_rowbytes(png, info));
  for (int y = 0; y < h; y++) {
    png_read_row(png, row, NULL);
    for (int x = 0; x < 3 * w; x++) {
      int k = 3 * w * y + x;
      if (bits == 16)
        assert_int_equal(row[2 * x] << 8 | row[2 * x + 1], deep[k]);
      else
        assert_int_equal(row[x], shallow[k]);
    }
  }
  png_read_end(png, NULL);
  assert_int_equal(from.left, 0);
  png_destroy_read_struct(&png, &info, NULL);
  free(row), free(bytes), free(shallow), free(deep);
}

static void all_come_back(void **state) {
  (void)state;
  static const int sizes[][2] = {{1, 1}, {1, 7}, {5, 1}, {33, 21}, {257, 300}};
  for (size_t s = 0; s < sizeof sizes / sizeof *sizes; s++)
    for (int kind = 0; kind < 3; kind++)
      for (int bits = 8; bits <= 16; bits += 8) check_picture(sizes[s][0], sizes[s][1], bits, kind);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(all_come_back)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
