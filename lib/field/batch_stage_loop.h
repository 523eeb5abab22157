/* SPDX-License-Identifier: MIT */
/* The loop of the forms in stages, for doubles and floats: lanes are points. Included by batch_loop.h. */
#ifndef SKF_FIELD_BATCH_STAGE_LOOP_H
#define SKF_FIELD_BATCH_STAGE_LOOP_H

/* For vectors some of whose lanes are not good: those are noted, the others kept. */
static inline size_t lanes_note(skf_vi good, size_t i, size_t *bad, size_t bads) {
  for (size_t k = 0; k < SKF_LANES; k++)
    if (!good[k]) bad[bads++] = i + k;
  return bads;
}
SKF_INLINE skf_vvalue vv_kept(const skf_vvalue *v) {
  const skf_vd zero = vd_set(0);
  return (skf_vvalue){vd_select(v->good, v->F, zero), vd3_select(v->good, v->g, (skf_v3d){zero, zero, zero}), v->good};
}

/* The points at[0], at[1], ..., the last one again in lanes from n on; values to where they belong */
static inline skf_v3d points_gather(const skf_real *const p[3], const size_t *at, size_t n) {
  skf_v3d x;
  for (size_t k = 0; k < SKF_LANES; k++) {
    size_t i = at[k < n ? k : n - 1];
    x.x[k] = p[0][i], x.y[k] = p[1][i], x.z[k] = p[2][i];
  }
  return x;
}
static inline void vv_scatter(loop_factor by, const skf_vvalue *v, skf_real *const out[4], const size_t *at, size_t n,
                              bool more) {
  const skf_vd part[4] = {by.F * v->F, by.g * v->g.x, by.g * v->g.y, by.g * v->g.z};
  if (!more) {
    for (size_t k = 0; k < SKF_LANES && k < n; k++)
      for (int c = 0; c < 4; c++) out[c][at[k]] = part[c][k];
    return;
  }
  const skf_vd whole[4] = {v->F, v->g.x, v->g.y, v->g.z};
  for (int c = 0; c < 4; c++) {
    skf_vd sum = vd_set(0);
    for (size_t k = 0; k < SKF_LANES && k < n; k++) sum[k] = out[c][at[k]];
    sum = vd_fma(c ? by.g : by.F, whole[c], sum);
    for (size_t k = 0; k < SKF_LANES && k < n; k++) out[c][at[k]] = sum[k];
  }
}

/* Stage after stage, for many vectors each: their chains of operations are short enough to overlap, and what is between
   waits in memory, so that few registers are needed. A stage best ends with its roots and quotients: what waits for
   them fills the scheduler. Nor is there a call in these loops, which would spill the constants. */
#define SKF_BATCH_STAGES(name, woven, look, one, two, three, gather)                                                   \
  /* some of the points by themselves, whatever lanes they came from */                                                \
  static __attribute__((noinline)) void name##_apart(const skf_tile *tile, size_t j, const skf_real *const p[3],       \
                                                     const size_t *at, size_t count, loop_factor by,                   \
                                                     skf_real *const out[4], bool more) {                              \
    name##_row row;                                                                                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                               \
    for (size_t k = 0; k < count; k += SKF_LANES) {                                                                    \
      const skf_v3d x = points_gather(p, at + k, count - k);                                                           \
      skf_vvalue v = name##_again(&row, x);                                                                            \
      for (size_t lane = count - k; lane < SKF_LANES; lane++) v.good[lane] = -1; /* nobody's */                        \
      lanes_closed(tile->element + j, 0, name##_inner, &x, &v);                                                        \
      vv_scatter(by, &v, out, at + k, count - k, more);                                                                \
    }                                                                                                                  \
  }                                                                                                                    \
  /* element j at all points; out is set, or added to */                                                               \
  SKF_INLINE void name##_all(const skf_tile *tile, size_t j, const double *scale, size_t n,                            \
                             const skf_real *const p[3], skf_real *const out[4], const bool more) {                    \
    skf_real *const to[4] = {out[0], out[1], out[2], out[3]};                                                          \
    const skf_real *const in[3] = {p[0], p[1], p[2]};                                                                  \
    const bool laced = (woven) == SKF_THREE_WITH_ONE, gathered = (woven) == SKF_GATHER_WITH_ONE;                       \
    const bool twofold = laced || gathered || (woven) == SKF_WITH_ONE;                                                 \
    const loop_factor by = loop_factor_of(tile, j, scale);                                                             \
    name##_row row;                                                                                                    \
    name##_state room[(woven) >= SKF_WITH_ONE ? 2 : 1][SKF_FLIGHT], *old = room[0];                                    \
    row_spread((skf_vd *)&row, sizeof row / sizeof(skf_vd), tile->column + SKF_TILE, j);                               \
    size_t last = 0, next = 0, bad[(SKF_FLIGHT + 1) * SKF_LANES], bads = 0;                                            \
    do {                                                                                                               \
      const size_t flying = (next - last) / SKF_LANES, left = (n - next) / SKF_LANES;                                  \
      const size_t m = left < SKF_FLIGHT ? left : SKF_FLIGHT, both = flying < m ? flying : m;                          \
      skf_real *const there[4] = {to[0] + last, to[1] + last, to[2] + last, to[3] + last};                             \
      const skf_real *const here[3] = {in[0] + next, in[1] + next, in[2] + next};                                      \
      name##_state *const s = twofold && old == room[0] ? room[1] : room[0];                                           \
      if (twofold) {                                                                                                   \
        SKF_ROLLED for (size_t u = 0; u < m; u++) name##_begin(&row, points_load(here, u *SKF_LANES), s + u);          \
      }                                                                                                                \
      if (gathered) {                                                                                                  \
        SKF_ROLLED for (size_t u = 0; u < m; u++) look(&row, s + u);                                                   \
        SKF_ROLLED for (size_t u = 0; u < both; u++) {                                                                 \
          gather(&row, old + u);                                                                                       \
          one(&row, s + u);                                                                                            \
        }                                                                                                              \
        SKF_ROLLED for (size_t u = both; u < flying; u++) gather(&row, old + u);                                       \
      }                                                                                                                \
      if (laced) {                                                                                                     \
        SKF_ROLLED for (size_t u = 0; u < both; u++) {                                                                 \
          one(&row, s + u);                                                                                            \
          three(&row, old + u);                                                                                        \
        }                                                                                                              \
        SKF_ROLLED for (size_t u = both; u < flying; u++) three(&row, old + u);                                        \
      }                                                                                                                \
      SKF_ROLLED for (size_t u = 0; u < flying; u++) {                                                                 \
        skf_vvalue v = name##_end(&row, old + u);                                                                      \
        if (__builtin_expect(!vi_all(v.good), 0)) {                                                                    \
          bads = lanes_note(v.good, last + u * SKF_LANES, bad, bads);                                                  \
          if (more) v = vv_kept(&v);                                                                                   \
        }                                                                                                              \
        if (more)                                                                                                      \
          vv_add(by, &v, there, u *SKF_LANES);                                                                         \
        else if (name##_inner && !scale)                                                                               \
          vv_put(&v, there, u *SKF_LANES);                                                                             \
        else                                                                                                           \
          vv_store(by, &v, there, u *SKF_LANES);                                                                       \
        if ((woven) == SKF_WITH_BEGIN && u < m) name##_begin(&row, points_load(here, u *SKF_LANES), s + u);            \
        if ((woven) == SKF_WITH_ONE && u < m) one(&row, s + u);                                                        \
      }                                                                                                                \
      if (!twofold) {                                                                                                  \
        SKF_ROLLED for (size_t u = (woven) == SKF_WITH_BEGIN ? flying : 0; u < m; u++)                                 \
            name##_begin(&row, points_load(here, u *SKF_LANES), s + u);                                                \
      }                                                                                                                \
      SKF_ROLLED for (size_t u = twofold ? both : 0; u < m; u++) one(&row, s + u);                                     \
      SKF_ROLLED for (size_t u = 0; u < m; u++) two(&row, s + u);                                                      \
      if (!laced) { SKF_ROLLED for (size_t u = 0; u < m; u++) three(&row, s + u); }                                    \
      if (bads >= SKF_LANES || (bads > 0 && m == 0)) {                                                                 \
        const size_t most = m == 0 ? bads : bads / SKF_LANES * SKF_LANES;                                              \
        name##_apart(tile, j, in, bad, most, by, to, more);                                                            \
        bads -= most;                                                                                                  \
        for (size_t k = 0; k < bads; k++) bad[k] = bad[most + k];                                                      \
      }                                                                                                                \
      last = next, next += m * SKF_LANES, old = s;                                                                     \
    } while (last < next);                                                                                             \
  }                                                                                                                    \
  SKF_BATCH_WHOLE(name)

#endif
