/* SPDX-License-Identifier: MIT */
/* Solids: nanoseconds per point and face, with and without the Hessian, in batches and one point at a time, on one
   thread, best of several; on a bumpy sphere of 20,480 faces and on the mesh files that are named. What the
   polyhedral-gravity-model 3.3.1 needed for potential, acceleration and tensor on this kind of machine: 540 ns. */
#include "core/vec3.h"
#include "skelfield/skelfield.h"
#include <math.h>
#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { POINTS = 256, LEVELS = 5 };

static double cpu(void) {
  struct timespec t;
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

/* The faces of an icosahedron, quartered again and again, as bumps on a sphere; their points are not yet joined. */
static size_t sphere(skf_vec3 (**out)[3]) {
  size_t n = 20;
  const double t = 1.6180339887498949;
  static const unsigned ico[20][3] = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                      {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                      {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                      {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  const skf_vec3 top[12] = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
                            {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  skf_vec3(*f)[3] = *out = malloc(20 * sizeof *f << 2 * LEVELS);
  if (!f) exit(1);
  for (int i = 0; i < 20; i++)
    for (int k = 0; k < 3; k++) f[i][k] = v3_unit(top[ico[i][k]]);
  for (int l = 0; l < LEVELS; l++, n *= 4)
    for (size_t i = 0; i < n; i++) {
      skf_vec3 a = f[i][0], b = f[i][1], c = f[i][2];
      skf_vec3 ab = v3_unit(v3_add(a, b)), bc = v3_unit(v3_add(b, c)), ca = v3_unit(v3_add(c, a));
      const skf_vec3 parts[4][3] = {{ab, bc, ca}, {a, ab, ca}, {b, bc, ab}, {c, ca, bc}};
      memcpy(f[i], parts[0], sizeof parts[0]);
      memcpy(f[n + 3 * i], parts[1], 3 * sizeof parts[1]);
    }
  for (size_t i = 0; i < 3 * n; i++) {
    skf_vec3 *u = &f[i / 3][i % 3];
    *u = v3_scale(1 + 0.1 * sin(5 * u->x + 1) * cos(4 * u->y) + 0.05 * sin(9 * u->z), *u);
  }
  return n;
}

static skf_solid *bumpy(void) {
  skf_vec3(*f)[3];
  skf_solid *s;
  size_t n = sphere(&f);
  unsigned *index = malloc(3 * n * sizeof *index);
  if (!index) exit(1);
  for (size_t i = 0; i < 3 * n; i++) index[i] = (unsigned)i;
  if (skf_solid_new(f[0], 3 * n, (const unsigned(*)[3])index, n, &s, NULL)) exit(1);
  free(f), free(index);
  return s;
}

static skf_solid *from_file(const char *path) {
  skf_mesh m;
  skf_error e;
  skf_solid *s = NULL;
  if (skf_mesh_read(path, &m, &e) ||
      skf_solid_new(m.vertices, m.vertex_count, (const unsigned(*)[3])m.triangles, m.triangle_count, &s, &e))
    printf("%s: %s\n", path, e.text);
  else
    skf_mesh_free(&m);
  return s;
}

static double p[3][POINTS], out[10][POINTS];

static void run(const skf_field *f, int mode) {
  const double *const at[3] = {p[0], p[1], p[2]};
  double *const g[3] = {out[1], out[2], out[3]}, *const h[6] = {out[4], out[5], out[6], out[7], out[8], out[9]};
  skf_vec3 ignored;
  double H[6];
  if (mode < 2) skf_field_eval(f, POINTS, at, out[0], g, mode ? h : NULL);
  for (size_t i = 0; i < POINTS && mode == 2; i += 16)
    out[0][i] = skf_field_tensor_at(f, v3(p[0][i], p[1][i], p[2][i]), &ignored, H);
}

static void measure(const char *name, skf_solid *s) {
  static const char *const modes[3] = {"F, gradient", "F, gradient, Hessian", "the same, one point"};
  const skf_solid_info *info = skf_solid_get(s);
  skf_element e = {.primitive = {.shape = SKF_SOLID, .solid = s}, .kernel = {.type = SKF_INVERSE}, .strength = 1};
  skf_field *f;
  if (skf_field_new(&e, 1, &f)) exit(1);
  double radius = skf_solid_distance_max(s, info->center);
  for (int i = 0; i < POINTS; i++) { /* a spiral over spheres of 1.05 to 2 radii */
    double z = 2 * (i + 0.5) / POINTS - 1, phi = 2.4 * i, rho = sqrt(1 - z * z),
           r = radius * (1.05 + 0.95 * i / POINTS);
    p[0][i] = info->center.x + r * rho * cos(phi), p[1][i] = info->center.y + r * rho * sin(phi);
    p[2][i] = info->center.z + r * z;
  }
  double best[3] = {INFINITY, INFINITY, INFINITY};
  for (int round = 0; round < 5; round++)
    for (int mode = 0; mode < 3; mode++) {
      double t = cpu();
      run(f, mode);
      best[mode] = fmin(best[mode], (cpu() - t) / (mode == 2 ? POINTS / 16 : POINTS));
    }
  for (int mode = 0; mode < 3; mode++)
    printf("%-24s %7zu faces  %-22s %6.2f ns per point and face, %9.1f us per point\n", name, info->faces, modes[mode],
           1e9 * best[mode] / (double)info->faces, 1e6 * best[mode]);
  skf_field_free(f);
  skf_solid_free(s);
}

int main(int argc, char **argv) {
  omp_set_num_threads(1);
  measure("bumpy sphere", bumpy());
  for (int i = 1; i < argc; i++) {
    const char *name = strrchr(argv[i], '/');
    skf_solid *s = from_file(argv[i]);
    if (s) measure(name ? name + 1 : argv[i], s);
  }
  return 0;
}
