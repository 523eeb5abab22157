/* SPDX-License-Identifier: MIT */
/* Triangles of the surface in each tetrahedron. */
#include "surface/mesher.h"

/* The mesh in the making; vertex numbers go by first use. */
typedef struct making {
  const skf_mesher *m;
  skf_mesh *mesh;
  size_t triangle_capacity;
  unsigned *node_vertex, *cut_vertex;
} making;

static unsigned vertex(making *k, unsigned *slot, skf_vec3 at) {
  if (*slot == SKF_NONE) {
    *slot = (unsigned)k->mesh->vertex_count;
    k->mesh->vertices[k->mesh->vertex_count++] = at;
  }
  return *slot;
}

static unsigned on_node(making *k, unsigned node) { return vertex(k, k->node_vertex + node, k->m->nodes.at[node]); }

static unsigned on_cut(making *k, unsigned a, unsigned b) {
  unsigned c = k->m->cut_of[skf_edge_slot(&k->m->nodes, a, b)];
  return vertex(k, k->cut_vertex + c, k->m->cut_at[c]);
}

static skf_status push(making *k, bool odd, unsigned a, unsigned b, unsigned c) {
  if (k->mesh->triangle_count == k->triangle_capacity) {
    size_t more = k->triangle_capacity ? 2 * k->triangle_capacity : 4096;
    void *p = skf_realloc(k->mesh->triangles, more, sizeof *k->mesh->triangles);
    if (!p) return SKF_ERR_NOMEM;
    k->mesh->triangles = p, k->triangle_capacity = more;
  }
  unsigned *t = k->mesh->triangles[k->mesh->triangle_count++];
  t[0] = a, t[1] = odd ? c : b, t[2] = odd ? b : c;
  return SKF_OK;
}

static skf_status push_quad(making *k, bool odd, unsigned a, unsigned b, unsigned c, unsigned d) {
  const skf_vec3 *p = k->mesh->vertices;
  bool other = v3_norm2(v3_sub(p[b], p[d])) < v3_norm2(v3_sub(p[a], p[c]));
  skf_status s = other ? push(k, odd, a, b, d) : push(k, odd, a, b, c);
  if (!s) s = other ? push(k, odd, b, c, d) : push(k, odd, a, c, d);
  return s;
}

/* Sorts the nodes into inside, on the surface, outside. odd: the order turns the tetrahedron over. */
static bool sort_nodes(const skf_nodes *n, const unsigned tet[4], unsigned q[4], int count[3]) {
  int group[4];
  bool odd = false;
  count[0] = count[1] = count[2] = 0;
  for (int i = 0; i < 4; i++) {
    q[i] = tet[i];
    group[i] = n->zero[tet[i]] ? 1 : n->sign[tet[i]] > 0 ? 0 : 2;
    count[group[i]]++;
  }
  for (int i = 1; i < 4; i++)
    for (int j = i; j > 0 && group[j - 1] > group[j]; j--) {
      int g = group[j];
      unsigned t = q[j];
      group[j] = group[j - 1], group[j - 1] = g;
      q[j] = q[j - 1], q[j - 1] = t;
      odd = !odd;
    }
  return odd;
}

/* A face that lies in the surface belongs to the tetrahedron inside of it, unless that one is not in the list: when the
   signs that its nodes had are all positive. */
static bool owns_face(const skf_nodes *n, const unsigned z[3], bool inside) {
  bool listed = n->sign[z[0]] < 0 || n->sign[z[1]] < 0 || n->sign[z[2]] < 0;
  return inside == listed;
}

static skf_status one_tet(making *k, const unsigned tet[4]) {
  const skf_nodes *n = &k->m->nodes;
  unsigned q[4], v[4];
  int count[3];
  bool odd = sort_nodes(n, tet, q, count);
  int in = count[0], zero = count[1], out = count[2];
  if (zero == 3) {
    bool inside = in == 1;
    const unsigned *z = q + inside;
    if (!owns_face(n, z, inside)) return SKF_OK;
    for (int i = 0; i < 3; i++) v[i] = on_node(k, z[i]);
    return push(k, odd, v[0], v[1], v[2]);
  }
  if (!in || !out) return SKF_OK;
  if (in == 2 && out == 2) {
    v[0] = on_cut(k, q[0], q[2]), v[1] = on_cut(k, q[0], q[3]);
    v[2] = on_cut(k, q[1], q[3]), v[3] = on_cut(k, q[1], q[2]);
    return push_quad(k, odd, v[0], v[1], v[2], v[3]);
  }
  /* One node alone on its side: a triangle in the order of the other three. */
  const unsigned *others = in == 1 ? q + 1 : q;
  unsigned alone = in == 1 ? q[0] : q[3];
  for (int i = 0; i < 3; i++) v[i] = n->zero[others[i]] ? on_node(k, others[i]) : on_cut(k, others[i], alone);
  return push(k, odd, v[0], v[1], v[2]);
}

skf_status skf_mesher_extract(skf_mesher *m, skf_mesh *out) {
  making k = {m, out, 0, NULL, NULL};
  size_t nodes = m->nodes.count;
  *out = (skf_mesh){0};
  out->vertices = skf_alloc(nodes + m->cut_count, sizeof *out->vertices);
  k.node_vertex = skf_alloc(nodes, sizeof *k.node_vertex);
  k.cut_vertex = skf_alloc(m->cut_count, sizeof *k.cut_vertex);
  skf_status s = out->vertices && k.node_vertex && k.cut_vertex ? SKF_OK : SKF_ERR_NOMEM;
  for (size_t i = 0; i < nodes && !s; i++) k.node_vertex[i] = SKF_NONE;
  for (size_t i = 0; i < m->cut_count && !s; i++) k.cut_vertex[i] = SKF_NONE;
  for (size_t i = 0; i < m->tet_count && !s; i++) s = one_tet(&k, m->tets[i]);
  skf_free(k.node_vertex), skf_free(k.cut_vertex);
  if (!s) {
    void *p = skf_realloc(out->vertices, out->vertex_count, sizeof *out->vertices);
    if (p) out->vertices = p;
  } else
    skf_mesh_free(out);
  return s;
}
