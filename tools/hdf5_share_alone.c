/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "hdf5_share.h"

bool hdf5_share_new(hdf5_share *s, const team *crew, size_t count, size_t rows) {
  (void)crew, (void)rows;
  *s = (hdf5_share){.size = 1, .count = count, .mine = count, .end = count};
  return true;
}

void hdf5_share_free(hdf5_share *s) { (void)s; }

void hdf5_share_access(hid_t access, hid_t transfer) { (void)access, (void)transfer; }

const double *hdf5_share_columns(const hdf5_share *s, const double *own, size_t rows, size_t width) {
  (void)s, (void)rows, (void)width;
  return own;
}
