/* SPDX-License-Identifier: MIT */
/* Finds and opens the drawing module, and lists the formats of picture files. */
#include "adapt/plot.h"
#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <stdlib.h>
#include <unistd.h>

static const skf_picture_format formats[] = {
    {"png", "lossless, 8 bits", false},
    {"jpg", "lossy, quality 95", false},
    {"jpeg", "the same as jpg", false},
    {"tif", "lossless, 8 bits", false},
    {"tiff", "the same as tif", false},
    {"webp", "lossless, 8 bits", false},
    {"bmp", "uncompressed, 8 bits", false},
    {"ppm", "uncompressed, 8 bits", false},
    {"exr", "linear light, 32-bit floats", true},
    {"pfm", "linear light, 32-bit floats, uncompressed", true},
    {"hdr", "linear light, shared exponent", true},
};

enum { FORMAT_COUNT = sizeof formats / sizeof *formats };

const skf_picture_format *skf_picture_format_get(int i) { return i >= 0 && i < FORMAT_COUNT ? formats + i : NULL; }

const skf_picture_format *skf_picture_format_find(const char *path) {
  const char *slash = strrchr(path, '/'), *dot = strrchr(slash ? slash : path, '.');
  for (int i = 0; dot && i < FORMAT_COUNT; i++)
    if (!strcasecmp(dot + 1, formats[i].ending)) return formats + i;
  return NULL;
}

#ifdef SKF_HAVE_OPENCV

/* Opens folder/module if that file exists. A module that exists but cannot be used leaves its reason in `error`. */
static const skf_plot *open_in(const char *folder, size_t length, char error[256]) {
  char path[PATH_MAX];
  int n = snprintf(path, sizeof path, "%.*s/%s", (int)length, folder, SKF_PLOT_MODULE);
  if (n < 0 || (size_t)n >= sizeof path || access(path, R_OK)) return NULL;
  void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    const char *why = dlerror();
    return snprintf(error, 256, "the drawing module cannot be loaded: %.180s", why ? why : path), NULL;
  }
  const skf_plot *plot = dlsym(handle, SKF_PLOT_SYMBOL);
  if (plot && plot->abi == SKF_PLOT_ABI) return plot;
  snprintf(error, 256, "%.180s does not belong to this program", path);
  dlclose(handle);
  return NULL;
}

/* The folders of a list separated by colons. */
static const skf_plot *open_listed(const char *list, char error[256]) {
  const skf_plot *plot = NULL;
  while (list && *list && !plot) {
    size_t n = strcspn(list, ":");
    if (n) plot = open_in(list, n, error);
    list += n + (list[n] == ':');
  }
  return plot;
}

/* Relative to the program: beside it, the build's folder, the installed folder. */
static const skf_plot *open_beside(char error[256]) {
  static const char *const relative[] = {"", "/../lib/adapt", "/" SKF_MODULES_RELATIVE};
  char self[PATH_MAX], folder[PATH_MAX + 256];
  ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
  if (n <= 0) return NULL;
  self[n] = 0;
  char *slash = strrchr(self, '/');
  if (!slash) return NULL;
  *slash = 0;
  const skf_plot *plot = NULL;
  for (size_t i = 0; i < sizeof relative / sizeof *relative && !plot; i++) {
    int m = snprintf(folder, sizeof folder, "%s%s", self, relative[i]);
    if (m > 0 && (size_t)m < sizeof folder) plot = open_in(folder, (size_t)m, error);
  }
  return plot;
}

const skf_plot *skf_plot_load(char error[256]) {
  snprintf(error, 256, "the drawing module %s was not found; set SKELFIELD_MODULES to its folder", SKF_PLOT_MODULE);
  const skf_plot *plot = open_listed(getenv("SKELFIELD_MODULES"), error);
  if (!plot) plot = open_beside(error);
  if (!plot) plot = open_in(SKF_MODULES_FOLDER, strlen(SKF_MODULES_FOLDER), error);
  return plot;
}

#else

const skf_plot *skf_plot_load(char error[256]) {
  return snprintf(error, 256, "this build has no OpenCV and writes no pictures"), NULL;
}

#endif
