/* SPDX-License-Identifier: MIT */
/* The drawing module: it loads, draws where it should, and writes every format that is listed. */
#include "check.h"
#include "adapt/plot.h"
#include <string.h>
#include <unistd.h>

static const double black[4] = {0, 0, 0, 1}, half[4] = {0, 0, 0, 0.5};

static const skf_plot *module(void) {
  char error[256] = "";
  const skf_plot *plot = skf_plot_load(error);
  if (!plot) {
    print_message("no module: %s\n", error);
    skip();
  }
  return plot;
}

/* Darkness of the canvas in pixels: the sum of 1 - value over all pixels, from its own PPM. */
static double darkness(const skf_plot *plot, skf_canvas *c, int w, int h) {
  unsigned char *bytes;
  size_t n;
  char error[256];
  assert_int_equal(plot->encode(c, "ppm", &bytes, &n, error), SKF_OK);
  assert_true(n > (size_t)(3 * w * h));
  double sum = 0;
  for (size_t i = n - (size_t)(3 * w * h); i < n; i++) sum += 1 - bytes[i] / 255.0;
  plot->release(bytes);
  return sum / 3;
}

static void formats_by_ending(void **state) {
  (void)state;
  assert_ptr_equal(skf_picture_format_find("a/b.c/map.PNG"), skf_picture_format_get(0));
  assert_null(skf_picture_format_find("map"));
  assert_null(skf_picture_format_find("dir.png/map"));
  assert_null(skf_picture_format_find("map.gif"));
  assert_null(skf_picture_format_get(-1));
  for (int i = 0; skf_picture_format_get(i); i++) {
    char path[64];
    snprintf(path, sizeof path, "x.%s", skf_picture_format_get(i)->ending);
    assert_ptr_equal(skf_picture_format_find(path), skf_picture_format_get(i));
  }
}

static void every_format_is_written(void **state) {
  (void)state;
  const skf_plot *plot = module();
  char error[256];
  float light[5 * 4 * 3];
  for (int i = 0; i < 60; i++) light[i] = (float)i;
  skf_canvas *c = plot->create(5, 4, NULL, error);
  assert_non_null(c);
  for (int i = 0; skf_picture_format_get(i); i++) {
    const skf_picture_format *f = skf_picture_format_get(i);
    unsigned char *bytes = NULL;
    size_t n = 0;
    skf_status s = f->linear ? plot->encode_linear(5, 4, light, f->ending, &bytes, &n, error)
                             : plot->encode(c, f->ending, &bytes, &n, error);
    if (s) fail_msg("%s: %s", f->ending, error);
    assert_true(n > 20);
    if (!strcmp(f->ending, "png")) {
      static const unsigned char head[8] = {0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};
      assert_memory_equal(bytes, head, 8);
      assert_int_equal(bytes[19], 5); /* width and height, big-endian, in IHDR */
      assert_int_equal(bytes[23], 4);
      assert_int_equal(bytes[24], 8); /* bits */
    }
    plot->release(bytes);
  }
  unsigned char *bytes;
  size_t n;
  assert_int_not_equal(plot->encode(c, "gif", &bytes, &n, error), SKF_OK);
  assert_null(bytes);
  plot->destroy(c);
}

/* 16 bits are written as they are, whoever reads 8 of them gets the upper ones. */
static void deep_pictures_come_back(void **state) {
  (void)state;
  const skf_plot *plot = module();
  unsigned short deep[6 * 3 * 3];
  for (int i = 0; i < 54; i++) deep[i] = (unsigned short)(257 * (4 * i + 1) + (i % 3 ? 100 : -100));
  const char *const endings[] = {"png", "tif"};
  for (int k = 0; k < 2; k++) {
    char error[256], path[] = "/tmp/skelfield-deep-XXXXXX";
    unsigned char *bytes, *back;
    size_t n;
    int w, h, file = mkstemp(path);
    assert_true(file >= 0);
    if (plot->encode_deep(6, 3, deep, endings[k], &bytes, &n, error)) fail_msg("%s: %s", endings[k], error);
    if (k == 0) assert_int_equal(bytes[24], 16);
    assert_int_equal(write(file, bytes, n), (ssize_t)n);
    close(file);
    plot->release(bytes);
    if (plot->decode(path, &w, &h, &back, error)) fail_msg("%s: %s", endings[k], error);
    unlink(path);
    assert_true(w == 6 && h == 3);
    for (int i = 0; i < 54; i++) assert_true(fabs(back[i] - deep[i] / 257.0) <= 1);
    plot->release(back);
  }
  unsigned char *back;
  char error[256];
  int w, h;
  assert_int_not_equal(plot->decode("/nowhere/none.png", &w, &h, &back, error), SKF_OK);
  assert_null(back);
}

static void pictures_keep_their_pixels(void **state) {
  (void)state;
  const skf_plot *plot = module();
  char error[256];
  unsigned char rgb[6 * 3], *bytes;
  for (int i = 0; i < 18; i++) rgb[i] = (unsigned char)(13 * i + 1);
  skf_canvas *c = plot->create(4, 4, NULL, error);
  plot->image(c, 1, 2, 3, 2, rgb);
  size_t n;
  assert_int_equal(plot->encode(c, "ppm", &bytes, &n, error), SKF_OK);
  const unsigned char *px = bytes + n - 48;
  assert_memory_equal(px + 3 * (2 * 4 + 1), rgb, 9);
  assert_memory_equal(px + 3 * (3 * 4 + 1), rgb + 9, 9);
  for (int i = 0; i < 2 * 4 * 3; i++) assert_int_equal(px[i], 255);
  plot->release(bytes);
  plot->destroy(c);
}

static void lines_and_areas_cover_what_they_should(void **state) {
  (void)state;
  const skf_plot *plot = module();
  char error[256];
  skf_canvas *c = plot->create(100, 80, NULL, error);
  const double square[4][2] = {{10.25, 20.5}, {50.25, 20.5}, {50.25, 60.5}, {10.25, 60.5}};
  plot->fill(c, square, 4, black);
  check_close(darkness(plot, c, 100, 80), 1600.0, 0.03); /* the outline adds a fraction of a pixel */
  plot->destroy(c);
  c = plot->create(100, 80, NULL, error);
  const double line[2][2] = {{10, 10}, {90, 70}};
  plot->stroke(c, line, 2, false, 4, half);
  check_close(darkness(plot, c, 100, 80), 0.5 * (4 * 100 + 4 * 3.14159), 0.06); /* round ends */
  plot->destroy(c);
  c = plot->create(100, 80, NULL, error);
  plot->clip(c, 0, 0, 30, 80);
  plot->fill(c, square, 4, black);
  check_close(darkness(plot, c, 100, 80), 19.75 * 40, 0.03);
  plot->destroy(c);
}

static void text_has_its_extent(void **state) {
  (void)state;
  const skf_plot *plot = module();
  char error[256];
  const char *words = "\xe2\x88\x92"
                      "12 \xe2\x88\x87\xce\xa6 10\xe2\x81\xbb\xc2\xb3";
  skf_canvas *c = plot->create(200, 200, NULL, error);
  print_message("font: %s\n", plot->font(c));
  skf_text_extent e = plot->extent(c, words);
  assert_true(e.width > 3 && e.width < 9 && e.height > 0.5 && e.height < 1.2);
  for (int turned = 0; turned < 2; turned++) {
    skf_canvas *d = plot->create(200, 200, NULL, error);
    plot->clip(d, 0, 0, 200, 200);
    plot->text(d, (skf_text_place){100, 100, 0.5, 0.5, turned * 1.5707963, 20}, words, black);
    double all = darkness(plot, d, 200, 200);
    assert_true(all > 50);
    plot->destroy(d);
    /* The same text seen through its own box only: nothing is lost but what hangs below the baseline. */
    d = plot->create(200, 200, NULL, error);
    double w = 10 * e.width + 2, h = 10 * e.height + 6;
    if (turned)
      plot->clip(d, 100 - h, 100 - w, 100 + h, 100 + w);
    else
      plot->clip(d, 100 - w, 100 - h, 100 + w, 100 + h);
    plot->text(d, (skf_text_place){100, 100, 0.5, 0.5, turned * 1.5707963, 20}, words, black);
    check_close(darkness(plot, d, 200, 200), all, 0.01);
    plot->destroy(d);
  }
  plot->destroy(c);
  assert_null(plot->create(10, 10, "/nonexistent/font.ttf", error));
  assert_non_null(strstr(error, "/nonexistent/font.ttf"));
}

static void colormaps_grow_brighter(void **state) {
  (void)state;
  const skf_plot *plot = module();
  unsigned char rgb[256][3];
  assert_false(plot->colormap("jet-like", rgb));
  for (int m = 0; plot->colormaps[m]; m++) {
    assert_true(plot->colormap(plot->colormaps[m], rgb));
    double last = -1;
    for (int k = 0; k < 256; k += 15) {
      double l = 0;
      for (int j = 0; j < 3; j++) l += (const double[]){0.2126, 0.7152, 0.0722}[j] * pow(rgb[k][j] / 255.0, 2.2);
      if (!(l > last)) fail_msg("%s is not brighter at %d", plot->colormaps[m], k);
      last = l;
    }
  }
}

int main(void) {
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(formats_by_ending),
      cmocka_unit_test(every_format_is_written),
      cmocka_unit_test(deep_pictures_come_back),
      cmocka_unit_test(pictures_keep_their_pixels),
      cmocka_unit_test(lines_and_areas_cover_what_they_should),
      cmocka_unit_test(text_has_its_extent),
      cmocka_unit_test(colormaps_grow_brighter),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
