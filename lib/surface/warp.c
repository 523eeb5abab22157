/* SPDX-License-Identifier: MIT */
/* Moves lattice nodes that the surface nearly touches onto it. */
#include "surface/mesher.h"

/* Shares of an edge within which a node is warped to the cut [Labelle & Shewchuk 2007, table 1]. */
static const double near_long = 0.24999, near_short = 0.41189;
/* A warped tetrahedron keeps at least this share of its volume. */
static const double least_volume = 0.05;
/* A cut nearer than this share to a node that cannot be warped makes the node step aside ... */
static const double too_near = 1e-3;
/* ... by this share of the cube's side; where that fails, the cut keeps at least this share of its edge. */
static const double step_aside = 0.12, least_share = 1e-6;

/* A node with its 14 neighbours. Neighbours that are not sampled have the node's own sign: they are only in cubes that
   the surface provably does not meet. */
typedef struct star {
  unsigned node[14];     /* SKF_NONE: not sampled */
  signed char state[14]; /* 1, -1, or 0 on the surface */
  skf_vec3 at[14];
} star;

static void gather(const skf_mesher *m, unsigned v, star *s) {
  const skf_nodes *n = &m->nodes;
  int x[3];
  skf_key_get(n->key[v], x);
  for (int k = 0; k < 14; k++) {
    skf_key key = skf_key_of((int[3]){x[0] + skf_star[k][0], x[1] + skf_star[k][1], x[2] + skf_star[k][2]});
    unsigned w = s->node[k] = skf_nodes_find(n, key);
    s->state[k] = w == SKF_NONE ? n->sign[v] : n->zero[w] ? 0 : n->sign[w];
    s->at[k] = w == SKF_NONE ? skf_lattice_at(&m->lattice, key) : n->at[w];
  }
}

/* Whether the neighbours with this state are one connected, non-empty patch. */
static bool one_patch(const signed char state[14], int sign) {
  unsigned all = 0, seen = 0;
  for (int k = 0; k < 14; k++)
    if (state[k] == sign) all |= 1u << k;
  if (!all) return false;
  seen = all & -all;
  for (unsigned before = 0; before != seen;) {
    before = seen;
    for (int f = 0; f < 24; f++) {
      const unsigned char *t = skf_star_faces[f];
      unsigned bits = (1u << t[0] | 1u << t[1] | 1u << t[2]) & all;
      if (bits & seen) seen |= bits;
    }
  }
  return seen == all;
}

/* Whether the surface around a node on it is one disc: on the sphere of its neighbours, one positive and one negative
   patch with one closed curve between them. */
static bool is_disc(const signed char state[14]) {
  for (int f = 0; f < 24; f++) {
    const unsigned char *t = skf_star_faces[f];
    if (!state[t[0]] && !state[t[1]] && !state[t[2]]) return false;
  }
  for (int k = 0; k < 14; k++) {
    if (state[k]) continue;
    /* The curve passes from the positive to the negative side at each of its nodes and along each of its edges. */
    int changes = 0, sides[14] = {0};
    for (int f = 0; f < 24; f++)
      for (int c = 0; c < 3; c++) {
        const unsigned char *t = skf_star_faces[f];
        if (t[c] != k) continue;
        int a = t[(c + 1) % 3], b = t[(c + 2) % 3];
        changes += state[a] * state[b] < 0;
        if (!state[a]) sides[a] += state[b];
        if (!state[b]) sides[b] += state[a];
      }
    for (int j = 0; j < 14; j++)
      if (sides[j]) return false; /* an edge of the curve with the same sign on both sides */
    int zeros = 0;
    for (int f = 0; f < 24; f++)
      for (int c = 0; c < 3; c++)
        if (skf_star_faces[f][c] == k) zeros += !state[skf_star_faces[f][(c + 1) % 3]];
    if (changes + zeros != 2) return false;
  }
  return one_patch(state, 1) && one_patch(state, -1);
}

/* Whether the surface stays a manifold when v is put onto it: at v, and at its neighbours that are on it already. */
static bool may_warp(skf_mesher *m, unsigned v, const star *s) {
  if (!is_disc(s->state)) return false;
  bool good = true;
  m->nodes.zero[v] = 1;
  for (int k = 0; k < 14 && good; k++)
    if (!s->state[k]) {
      star t;
      gather(m, s->node[k], &t);
      good = is_disc(t.state);
    }
  m->nodes.zero[v] = 0;
  return good;
}

/* Whether all tetrahedra at v keep enough volume when v is at p. */
static bool has_room(const skf_mesher *m, const star *s, skf_vec3 p) {
  double least = least_volume * 4 * m->lattice.half * m->lattice.half * m->lattice.half;
  for (int f = 0; f < 24; f++) {
    const unsigned char *t = skf_star_faces[f];
    skf_vec3 a = v3_sub(s->at[t[0]], p), b = v3_sub(s->at[t[1]], p), c = v3_sub(s->at[t[2]], p);
    if (!(v3_dot(a, v3_cross(b, c)) > least)) return false;
  }
  return true;
}

static unsigned cut_between(const skf_mesher *m, unsigned v, unsigned w) {
  return m->cut_of[skf_edge_slot(&m->nodes, v, w)];
}

/* The live cut at v that is nearest in shares of `near`; the share of the edge goes to *share. */
static unsigned nearest_cut(const skf_mesher *m, unsigned v, const star *s, double *ratio, double *share) {
  unsigned best = SKF_NONE;
  *ratio = *share = INFINITY;
  for (int k = 0; k < 14; k++) {
    if (s->node[k] == SKF_NONE || s->state[k] != -m->nodes.sign[v]) continue;
    unsigned c = cut_between(m, v, s->node[k]);
    double part = v3_dist(m->cut_at[c], m->nodes.at[v]) / v3_dist(s->at[k], m->nodes.at[v]);
    double r = part / (k < 6 ? near_long : near_short);
    if (r < *ratio) *ratio = r, best = c;
    *share = fmin(*share, part);
  }
  return best;
}

/* Finds the cuts at v anew, after v has moved. */
static skf_status recut(skf_mesher *m, unsigned v, const star *s) {
  for (int k = 0; k < 14; k++) {
    if (s->node[k] == SKF_NONE || s->state[k] != -m->nodes.sign[v]) continue;
    unsigned c = cut_between(m, v, s->node[k]);
    skf_vec3 in = m->nodes.at[m->cuts[c].in], out = m->nodes.at[m->cuts[c].out];
    skf_status e = skf_polish_segments(m->field, m->iso, 1, &in, &out, m->cut_at + c);
    if (e) return e;
  }
  return SKF_OK;
}

/* Moves a node that touches the surface but cannot lie on it away from it; then holds its cuts apart from it. */
static skf_status move_aside(skf_mesher *m, unsigned v, const star *s) {
  skf_vec3 g, old = m->nodes.at[v];
  double ratio, share;
  skf_field_at(m->field, old, &g);
  g = v3_unit(g);
  skf_vec3 p = v3_mad(old, m->nodes.sign[v] * step_aside * 2 * m->lattice.half, g);
  int side = v3_finite(p) && skf_field_at(m->field, p, NULL) > m->iso ? 1 : -1;
  if (v3_finite(p) && v3_norm2(g) > 0 && side == m->nodes.sign[v] && has_room(m, s, p)) {
    m->nodes.at[v] = p;
    skf_status e = recut(m, v, s);
    if (e) return e;
  }
  nearest_cut(m, v, s, &ratio, &share);
  if (share >= least_share) return SKF_OK;
  for (int k = 0; k < 14; k++) {
    if (s->node[k] == SKF_NONE || s->state[k] != -m->nodes.sign[v]) continue;
    skf_vec3 *c = m->cut_at + cut_between(m, v, s->node[k]), d = v3_sub(s->at[k], m->nodes.at[v]);
    if (v3_dist(*c, m->nodes.at[v]) < least_share * v3_norm(d))
      *c = v3_mad(m->nodes.at[v], least_share, d), m->clamped++;
  }
  return SKF_OK;
}

skf_status skf_mesher_warp(skf_mesher *m) {
  skf_nodes *n = &m->nodes;
  signed char *candidate = skf_alloc(n->count, 1);
  if (!candidate) return SKF_ERR_NOMEM;
  for (size_t i = 0; i < m->cut_count; i++) {
    skf_vec3 in = n->at[m->cuts[i].in], out = n->at[m->cuts[i].out];
    double part = v3_dist(in, m->cut_at[i]) / v3_dist(in, out);
    if (part < near_short) candidate[m->cuts[i].in] = 1;
    if (1 - part < near_short) candidate[m->cuts[i].out] = 1;
  }
  skf_status e = SKF_OK;
  for (unsigned v = 0; v < n->count && !e; v++) {
    if (!candidate[v]) continue;
    star s;
    double ratio, share;
    gather(m, v, &s);
    unsigned c = nearest_cut(m, v, &s, &ratio, &share);
    if (ratio >= 1) continue;
    if (has_room(m, &s, m->cut_at[c]) && may_warp(m, v, &s))
      n->at[v] = m->cut_at[c], n->zero[v] = 1;
    else if (share < too_near)
      e = move_aside(m, v, &s);
  }
  skf_free(candidate);
  return e;
}
