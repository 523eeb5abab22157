/* SPDX-License-Identifier: MIT */
/* Samples the lattice around the cubes that may hold the surface, and finds where it cuts the lattice's edges. */
#include "surface/mesher.h"

/* Corners of a cube by bits (x, y, z); the corners of face f (-x +x -y +y -z +z) counter-clockwise about its axis. */
static const unsigned char face_corners[6][4] = {
    {0, 2, 6, 4}, {1, 3, 7, 5}, {0, 4, 5, 1}, {2, 6, 7, 3}, {0, 1, 3, 2}, {4, 5, 7, 6},
};

static skf_key neighbour(skf_key cube, int dx, int dy, int dz) {
  int x[3];
  skf_key_get(cube, x);
  return skf_key_of((int[3]){x[0] + dx, x[1] + dy, x[2] + dz});
}

static skf_key corner(skf_key cube, int c) { return neighbour(cube, 2 * (c & 1) - 1, (c & 2) - 1, (c >> 1 & 2) - 1); }

static skf_key across(skf_key cube, int face) {
  int d[3] = {0, 0, 0};
  d[face / 2] = face & 1 ? 2 : -2;
  return neighbour(cube, d[0], d[1], d[2]);
}

/* Nodes 0 .. cube_count - 1 are the centres of the cubes; then their corners and the centres of their neighbours. */
static skf_status sample(skf_mesher *m) {
  skf_nodes *n = &m->nodes;
  for (size_t i = 0; i < m->cube_count; i++)
    if (skf_nodes_add(n, &m->lattice, m->cubes[i]) == SKF_NONE) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < m->cube_count; i++) {
    for (int c = 0; c < 8; c++)
      if (skf_nodes_add(n, &m->lattice, corner(m->cubes[i], c)) == SKF_NONE) return SKF_ERR_NOMEM;
    for (int f = 0; f < 6; f++)
      if (skf_nodes_add(n, &m->lattice, across(m->cubes[i], f)) == SKF_NONE) return SKF_ERR_NOMEM;
  }
  skf_status s = skf_sample(m->field, n->count, n->at, n->F, NULL);
  /* A tie F = iso counts as outside; F = NaN too, so that it cannot open the surface. */
  for (size_t i = 0; i < n->count && !s; i++) n->sign[i] = n->F[i] > m->iso ? 1 : -1;
  return s;
}

static bool push_tet(skf_mesher *m, size_t *capacity, unsigned a, unsigned b, unsigned c, unsigned d) {
  if (m->tet_count == *capacity) {
    size_t more = *capacity ? 2 * *capacity : 4096;
    void *p = skf_realloc(m->tets, more, sizeof *m->tets);
    if (!p) return false;
    m->tets = p, *capacity = more;
  }
  unsigned *t = m->tets[m->tet_count++];
  t[0] = a, t[1] = b, t[2] = c, t[3] = d;
  return true;
}

static skf_status list_tets(skf_mesher *m) {
  const skf_nodes *n = &m->nodes;
  size_t capacity = 0;
  for (size_t i = 0; i < m->cube_count; i++) {
    unsigned corners[8];
    int sum = 0;
    for (int c = 0; c < 8; c++) sum += n->sign[corners[c] = skf_nodes_find(n, corner(m->cubes[i], c))];
    for (int f = 0; f < 6; f++) {
      unsigned other = skf_nodes_find(n, across(m->cubes[i], f));
      if (other < i) continue; /* that cube has listed this face */
      if (sum == 8 * n->sign[i] && n->sign[other] == n->sign[i]) continue;
      unsigned c0 = f & 1 ? (unsigned)i : other, c1 = f & 1 ? other : (unsigned)i;
      for (int k = 0; k < 4; k++) {
        unsigned a = corners[face_corners[f][k]], b = corners[face_corners[f][(k + 1) & 3]];
        int s = n->sign[a] + n->sign[b] + n->sign[c0] + n->sign[c1];
        if (s == 4 || s == -4) continue;
        if (!push_tet(m, &capacity, c0, c1, a, b)) return SKF_ERR_NOMEM;
      }
    }
    if (m->tet_count > 2 * m->limit) return SKF_ERR_CAPACITY;
  }
  return SKF_OK;
}

static skf_status list_cuts(skf_mesher *m) {
  const skf_nodes *n = &m->nodes;
  m->cut_of = skf_alloc(n->count, 7 * sizeof *m->cut_of);
  if (!m->cut_of) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < 7 * n->count; i++) m->cut_of[i] = SKF_NONE;
  size_t capacity = 0;
  for (size_t t = 0; t < m->tet_count; t++)
    for (int i = 0; i < 4; i++)
      for (int j = i + 1; j < 4; j++) {
        unsigned a = m->tets[t][i], b = m->tets[t][j];
        if (n->sign[a] == n->sign[b]) continue;
        size_t slot = skf_edge_slot(n, a, b);
        if (m->cut_of[slot] != SKF_NONE) continue;
        if (m->cut_count == capacity) {
          capacity = capacity ? 2 * capacity : 4096;
          void *p = capacity < SKF_NONE ? skf_realloc(m->cuts, capacity, sizeof *m->cuts) : NULL;
          if (!p) return SKF_ERR_NOMEM;
          m->cuts = p;
        }
        m->cuts[m->cut_count] = n->sign[a] > 0 ? (skf_cut){a, b} : (skf_cut){b, a};
        m->cut_of[slot] = (unsigned)m->cut_count++;
      }
  return SKF_OK;
}

skf_status skf_mesher_cuts(skf_mesher *m) {
  skf_status s = sample(m);
  if (!s) s = list_tets(m);
  if (!s && skf_cancelled(m->progress, 0.4)) s = SKF_ERR_CANCELLED;
  if (!s) s = list_cuts(m);
  if (s) return s;
  skf_vec3 *in = skf_alloc(m->cut_count, sizeof *in), *out = skf_alloc(m->cut_count, sizeof *out);
  m->cut_at = skf_alloc(m->cut_count, sizeof *m->cut_at);
  s = in && out && m->cut_at ? SKF_OK : SKF_ERR_NOMEM;
  for (size_t i = 0; i < m->cut_count && !s; i++)
    in[i] = m->nodes.at[m->cuts[i].in], out[i] = m->nodes.at[m->cuts[i].out];
  if (!s) s = skf_polish_segments(m->field, m->iso, m->cut_count, in, out, m->cut_at);
  skf_free(in), skf_free(out);
  return s;
}
