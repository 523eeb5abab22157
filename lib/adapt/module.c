/* SPDX-License-Identifier: MIT */
#include "adapt/module.h"
#include <dlfcn.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* What is looked for, and why it was not found. */
typedef struct wanted {
  const char *file, *symbol;
  char *error;
} wanted;

/* Opens folder/file if it exists. A module that exists but cannot be used leaves its reason in the error. */
static const void *open_in(const wanted *w, const char *folder, size_t length) {
  char path[PATH_MAX];
  int n = snprintf(path, sizeof path, "%.*s/%s", (int)length, folder, w->file);
  if (n < 0 || (size_t)n >= sizeof path || access(path, R_OK)) return NULL;
  void *handle = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  if (!handle) {
    const char *why = dlerror();
    return snprintf(w->error, 256, "a module cannot be loaded: %.180s", why ? why : path), NULL;
  }
  const void *symbol = dlsym(handle, w->symbol);
  if (symbol) return symbol;
  snprintf(w->error, 256, "%.180s does not belong to this program", path);
  dlclose(handle);
  return NULL;
}

/* The folders of a list separated by colons. */
static const void *open_listed(const wanted *w, const char *list) {
  const void *symbol = NULL;
  while (list && *list && !symbol) {
    size_t n = strcspn(list, ":");
    if (n) symbol = open_in(w, list, n);
    list += n + (list[n] == ':');
  }
  return symbol;
}

/* Relative to the program: beside it, the build's folder, the installed folder. */
static const void *open_beside(const wanted *w) {
  static const char *const relative[] = {"", "/../lib/adapt", "/" SKF_MODULES_RELATIVE};
  char self[PATH_MAX], folder[PATH_MAX + 256];
  ssize_t n = readlink("/proc/self/exe", self, sizeof self - 1);
  if (n <= 0) return NULL;
  self[n] = 0;
  char *slash = strrchr(self, '/');
  if (!slash) return NULL;
  *slash = 0;
  const void *symbol = NULL;
  for (size_t i = 0; i < sizeof relative / sizeof *relative && !symbol; i++) {
    int m = snprintf(folder, sizeof folder, "%s%s", self, relative[i]);
    if (m > 0 && (size_t)m < sizeof folder) symbol = open_in(w, folder, (size_t)m);
  }
  return symbol;
}

const void *skf_module_symbol(const char *file, const char *symbol, char error[256]) {
  snprintf(error, 256, "the module %s was not found; set SKELFIELD_MODULES to its folder", file);
  wanted w = {file, symbol, error};
  const void *found = open_listed(&w, getenv("SKELFIELD_MODULES"));
  if (!found) found = open_beside(&w);
  if (!found) found = open_in(&w, SKF_MODULES_FOLDER, strlen(SKF_MODULES_FOLDER));
  return found;
}
