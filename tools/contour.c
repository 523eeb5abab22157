/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Iso-lines of values on a grid: marching squares, with the pieces joined to lines. */
#include "contour.h"
#include <math.h>
#include <stdlib.h>

/* Edges are numbered: 2 k from value k to its right neighbour, 2 k + 1 to the one below. An edge that the level crosses
   is in at most two cells, so a line is a chain of edges, each with up to two neighbours. */
typedef struct web {
  const double *values;
  int nx, ny;
  double level;
  int (*next)[2]; /* of each edge: its neighbours, -1 for none */
  int *crossed;   /* edges with a neighbour, in the order of their discovery */
  size_t count;
} web;

static void join(web *w, int a, int b) {
  const int pair[2][2] = {{a, b}, {b, a}};
  for (int k = 0; k < 2; k++) {
    int *next = w->next[pair[k][0]];
    if (next[0] < 0 && next[1] < 0) w->crossed[w->count++] = pair[k][0];
    next[next[0] < 0 ? 0 : 1] = pair[k][1];
  }
}

static void cell(web *w, int i, int j) {
  int k = j * w->nx + i, right = k + 1, below = k + w->nx;
  const double v[4] = {w->values[k], w->values[right], w->values[below + 1], w->values[below]};
  const int edge[4] = {2 * k, 2 * right + 1, 2 * below, 2 * k + 1};
  int mask = 0;
  for (int c = 0; c < 4; c++) {
    if (isnan(v[c])) return;
    mask |= (v[c] > w->level) << c;
  }
  if (mask == 0 || mask == 15) return;
  if (mask == 5 || mask == 10) { /* two opposite corners: the mean decides which of them hang together */
    bool high = (v[0] + v[1] + v[2] + v[3]) / 4 > w->level, first = (mask == 5) == high;
    join(w, edge[0], edge[first ? 1 : 3]);
    join(w, edge[2], edge[first ? 3 : 1]);
    return;
  }
  int ends[2], n = 0;
  for (int c = 0; c < 4; c++)
    if ((mask >> c & 1) != (mask >> ((c + 1) & 3) & 1)) ends[n++] = edge[c];
  join(w, ends[0], ends[1]);
}

static void place(const web *w, int edge, double xy[2]) {
  int k = edge / 2, other = edge & 1 ? k + w->nx : k + 1;
  double a = w->values[k] - w->level, b = w->values[other] - w->level, t = 0.5;
  if (isfinite(a) && isfinite(b)) t = a / (a - b);
  xy[0] = k % w->nx + (edge & 1 ? 0 : t);
  int row = k / w->nx;
  xy[1] = row + (edge & 1 ? t : 0);
}

/* Cuts `to` out of the neighbours of `from`. */
static void cut(web *w, int from, int to) { w->next[from][w->next[from][0] == to ? 0 : 1] = -1; }

/* Follows the chain from `start` and takes it apart on the way. */
static bool follow(web *w, int start, contours *out) {
  size_t capacity = 64;
  contour line = {malloc(capacity * sizeof *line.xy), 0, false};
  for (int at = start; line.xy && at >= 0;) {
    if (line.n == capacity) {
      double(*more)[2] = realloc(line.xy, (capacity *= 2) * sizeof *more);
      if (!more) free(line.xy);
      line.xy = more;
      if (!more) break;
    }
    place(w, at, line.xy[line.n++]);
    int next = w->next[at][0] >= 0 ? w->next[at][0] : w->next[at][1];
    if (next >= 0) cut(w, at, next), cut(w, next, at);
    line.closed = next == start;
    at = next == start ? -1 : next;
  }
  contour *more = line.xy ? realloc(out->lines, (out->count + 1) * sizeof *more) : NULL;
  if (!more) return free(line.xy), false;
  out->lines = more;
  out->lines[out->count++] = line;
  return true;
}

static bool all_lines(web *w, contours *out) {
  for (int j = 0; j + 1 < w->ny; j++)
    for (int i = 0; i + 1 < w->nx; i++) cell(w, i, j);
  /* Open lines start at their ends; what is left then is closed. */
  for (int closed = 0; closed < 2; closed++)
    for (size_t k = 0; k < w->count; k++) {
      const int *next = w->next[w->crossed[k]];
      int degree = (next[0] >= 0) + (next[1] >= 0);
      if (degree == 0 || (degree == 2 && !closed)) continue;
      if (!follow(w, w->crossed[k], out)) return false;
    }
  return true;
}

bool contour_find(const double *values, int nx, int ny, double level, contours *out) {
  *out = (contours){NULL, 0};
  if (nx < 2 || ny < 2) return true;
  size_t edges = 2 * (size_t)nx * ny;
  web w = {values, nx, ny, level, malloc(edges * sizeof *w.next), malloc(edges * sizeof *w.crossed), 0};
  bool done = w.next && w.crossed;
  for (size_t k = 0; done && k < edges; k++) w.next[k][0] = w.next[k][1] = -1;
  done = done && all_lines(&w, out);
  free(w.next), free(w.crossed);
  if (!done) contour_free(out);
  return done;
}

void contour_free(contours *c) {
  for (size_t i = 0; i < c->count; i++) free(c->lines[i].xy);
  free(c->lines);
  *c = (contours){NULL, 0};
}
