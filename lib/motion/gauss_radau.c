/* SPDX-License-Identifier: MIT */
/* 15th-order Gauss-Radau predictor-corrector for x'' = a(t, x) [Everhart 1985; Rein & Spiegel 2015, "IAS15"]: on a step
   a(s) = a0 + sum_k b_k s^(k+1) is the polynomial through eight Radau nodes, found by fixed-point iteration from the
   previous step's extrapolation, and summed with the rounding errors kept. */
#include "motion/gauss_radau.h"
#include <float.h>
#include <string.h>

enum { NODES = SKF_RADAU_NODES, TERMS = SKF_RADAU_TERMS };

/* Roots of (P_7 + P_8)(2 s - 1) [Everhart 1985], computed at 60 digits. */
static const double node[NODES] = {0.0,
                                   0.056262560536922146466,
                                   0.18024069173689236499,
                                   0.35262471711316963737,
                                   0.547153626330555383,
                                   0.73421017721541053152,
                                   0.88532094683909576809,
                                   0.97752061356128750189};

/* 1 / (node[n] - node[j]) */
static const double inverse[NODES][NODES] = {
    {0},
    {17.773808914078000841},
    {5.5481367185372165057, 8.0659386483818866885},
    {2.8358760786444386783, 3.3742499769626352599, 5.8010015592640614823},
    {1.8276402675175978298, 2.0371118353585847828, 2.7254422118082262838, 5.1406241058109342286},
    {1.3620078160624694969, 1.4750402175604115479, 1.8051535801402512604, 2.6206449263870350812, 5.3459768998711075141},
    {1.1295338753367899027, 1.2061876660584456166, 1.4182782637347391538, 1.8772424961868100972, 2.9571160172904557478,
     6.6176620137024244874},
    {1.0229963298234867458, 1.085472193938642384, 1.254264622281877766, 1.600266549490816261, 2.3235983002196942228,
     4.1099757783445590862, 10.846026190236844685},
};

/* s prod_{j=1..n} (s - node[j]) = sum_k newton[n][k] s^(k+1) */
static const double newton[TERMS][TERMS] = {
    {1.0},
    {-0.056262560536922146466, 1.0},
    {0.010140802830063629986, -0.23650325227381451145, 1.0},
    {-3.5758977292516175949e-3, 0.093537695259462065896, -0.58912796938698414883, 1.0},
    {1.9565654099472210769e-3, -0.054755386889068686441, 0.41588120008230686169, -1.1362815957175395318, 1.0},
    {-1.4365302363708915424e-3, 0.042158527721268707707, -0.36009959650205681229, 1.2501507118406910259,
     -1.8704917729329500634, 1.0},
    {1.2717903090268677493e-3, -0.03876035791590677037, 0.36096224345284598323, -1.4668842084004269644,
     2.9061362593084293014, -2.7558127197720458314, 1.0},
};

/* 1 / ((k + 2)(k + 3)): the position's coefficient for b_k; 1 / (k + 2): the velocity's. */
static const double twice[TERMS] = {1.0 / 6, 1.0 / 12, 1.0 / 20, 1.0 / 30, 1.0 / 42, 1.0 / 56, 1.0 / 72};
static const double once[TERMS] = {1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5, 1.0 / 6, 1.0 / 7, 1.0 / 8};

/* binomial[j][k] = (j + 1 over k + 1) */
static const double binomial[TERMS][TERMS] = {
    {1}, {2, 1}, {3, 3, 1}, {4, 6, 4, 1}, {5, 10, 10, 5, 1}, {6, 15, 20, 15, 6, 1}, {7, 21, 35, 35, 21, 7, 1},
};

/* Sum of |db_6 / da(node j)|: what rounding errors of a become in b_6. */
#define AMPLIFICATION 1.15e4
/* The largest |s prod (s - node)| is 1.6e-4 and the first term left out some tenths of the last one kept: that one may
   be this many tolerances before the acceleration is off by a tolerance inside of the step. The error at its end, of
   order 15, is then far below. */
#define LAST_TERM 1e4
/* Margin of the check at the end of the step, in tolerances and in rounding errors. */
#define JOIN 64
static skf_status begin(void *work, skf_ode *ode, const skf_orbit *at, double h) {
  skf_gauss_radau *w = work;
  memset(w, 0, sizeof *w);
  w->h = h;
  return skf_ode_feel(ode, at->t, v3_add(at->x, at->x_low), v3_add(at->v, at->v_low), &w->a0, &w->noise)
             ? SKF_OK
             : SKF_ERR_CONVERGENCE;
}

double skf_radau_node(int n) { return node[n]; }

/* The last step's polynomial, continued over a step q times as long, and corrected by how far the last prediction was
   off. */
static void predict(const skf_gauss_radau *w, double q, skf_vec3 b[TERMS], skf_vec3 e[TERMS]) {
  if (w->done == 0 || q > 20) { /* too far to extrapolate */
    memset(b, 0, TERMS * sizeof *b);
    memset(e, 0, TERMS * sizeof *e);
    return;
  }
  double power = q;
  for (int k = 0; k < TERMS; k++, power *= q) {
    skf_vec3 sum = {0, 0, 0};
    for (int j = k; j < TERMS; j++) sum = v3_mad(sum, binomial[j][k], w->b[j]);
    e[k] = v3_scale(power, sum);
    b[k] = v3_add(e[k], v3_sub(w->b[k], w->e[k]));
  }
}

/* g from b: the inverse of b_k = sum_n g_n newton[n][k]. */
static void divided(const skf_vec3 b[TERMS], skf_vec3 g[TERMS]) {
  for (int k = TERMS; k-- > 0;) {
    g[k] = b[k];
    for (int n = k + 1; n < TERMS; n++) g[k] = v3_mad(g[k], -newton[n][k], g[n]);
  }
}

static double largest(skf_vec3 a) { return fmax(fabs(a.x), fmax(fabs(a.y), fabs(a.z))); }

void skf_radau_predict(skf_gauss_radau *w, double h, skf_radau_guess *u) {
  predict(w, h / w->done, u->b, u->e);
  divided(u->b, u->g);
  u->change = 0, u->size = largest(w->a0);
  w->noise = 0;
}

/* h v s + h^2 s^2 (a0 / 2 + sum b_k s^(k+1) / ((k+2)(k+3))) */
static skf_vec3 displacement(const skf_vec3 b[TERMS], skf_vec3 a0, skf_vec3 v, double h, double s) {
  skf_vec3 r = {0, 0, 0};
  for (int k = TERMS; k-- > 0;) r = v3_mad(v3_scale(twice[k], b[k]), s, r);
  r = v3_mad(v3_scale(0.5, a0), s, r);
  return v3_scale(s * h, v3_mad(v, s * h, r));
}

/* v + h s (a0 + sum b_k s^(k+1) / (k+2)) */
static skf_vec3 velocity(const skf_gauss_radau *w, const skf_vec3 b[TERMS], double h, double s) {
  skf_vec3 r = {0, 0, 0};
  for (int k = TERMS; k-- > 0;) r = v3_mad(v3_scale(once[k], b[k]), s, r);
  return v3_mad(v3_add(w->from.v, w->from.v_low), s * h, v3_mad(w->a0, s, r));
}

void skf_radau_place(const skf_gauss_radau *w, const skf_radau_guess *u, double h, int n, skf_vec3 *x, skf_vec3 *v) {
  skf_vec3 d = displacement(u->b, w->a0, w->from.v, h, node[n]);
  *x = v3_add(w->from.x, v3_add(w->from.x_low, v3_mad(d, h * node[n], w->from.v_low)));
  if (v) *v = velocity(w, u->b, h, node[n]);
}

void skf_radau_learn(skf_gauss_radau *w, int n, skf_vec3 a, double noise, skf_radau_guess *u) {
  w->noise = fmax(w->noise, noise);
  u->size = fmax(u->size, largest(a));
  skf_vec3 d = v3_scale(inverse[n][0], v3_sub(a, w->a0));
  for (int j = 1; j < n; j++) d = v3_scale(inverse[n][j], v3_sub(d, u->g[j - 1]));
  skf_vec3 delta = v3_sub(d, u->g[n - 1]);
  u->g[n - 1] = d;
  for (int k = 0; k < n; k++) u->b[k] = v3_mad(u->b[k], newton[n - 1][k], delta);
  u->change = largest(delta);
}

/* One sweep over the nodes. Returns false where the force is not finite. */
static bool sweep(skf_gauss_radau *w, skf_ode *ode, double h, skf_radau_guess *u) {
  u->size = largest(w->a0);
  for (int n = 1; n < NODES; n++) {
    skf_vec3 a, x, v = w->from.v;
    double noise = 0;
    skf_radau_place(w, u, h, n, &x, ode->drag ? &v : NULL);
    if (!skf_ode_feel(ode, clock_add(w->from.t, h * node[n]), x, v, &a, skf_radau_listens(n) ? &noise : NULL))
      return false;
    skf_radau_learn(w, n, a, noise, u);
  }
  return true;
}

bool skf_radau_settled(const skf_radau_guess *u) { return !(u->change > 0.1 * DBL_EPSILON * u->size); }
bool skf_radau_will_do(const skf_gauss_radau *w, const skf_radau_guess *u) {
  return u->change <= 1e-6 * u->size || u->change <= AMPLIFICATION * w->noise;
}

/* Solves for b on a step of length h. False when it does not settle or the force is not finite. */
static bool solve(skf_gauss_radau *w, skf_ode *ode, double h, skf_radau_guess *u) {
  double last = INFINITY;
  for (int i = 0; i < SKF_RADAU_SWEEPS; i++) {
    if (!sweep(w, ode, h, u)) return false;
    if (skf_radau_settled(u)) return true;
    if (i > 1 && u->change >= last) return skf_radau_will_do(w, u);
    last = u->change;
  }
  return u->change <= 1e-9 * u->size;
}

/* Small terms first, the products with h exact. */
void skf_radau_finish(skf_gauss_radau *w, const skf_radau_guess *u, double h, skf_orbit *at) {
  memcpy(w->b, u->b, sizeof w->b);
  memcpy(w->e, u->e, sizeof w->e);
  w->from_a = w->a0;
  w->done = h;
  skf_vec3 dv = {0, 0, 0}, dx = {0, 0, 0};
  for (int k = TERMS; k-- > 0;) {
    dv = v3_mad(dv, once[k], w->b[k]);
    dx = v3_mad(dx, twice[k], w->b[k]);
  }
  dv = v3_add(dv, w->from_a);
  dx = v3_mad(dx, 0.5, w->from_a);
  skf_vec3 v = w->from.v, hv = v3_scale(h, v);
  skf_vec3 rest = v3(fma(h, v.x, -hv.x), fma(h, v.y, -hv.y), fma(h, v.z, -hv.z));
  skf_orbit_add(&at->x, &at->x_low, v3_mad(rest, h, w->from.v_low));
  skf_orbit_add(&at->x, &at->x_low, v3_scale(h * h, dx));
  skf_orbit_add(&at->x, &at->x_low, hv);
  skf_orbit_add(&at->v, &at->v_low, v3_scale(h, dv));
  at->t = clock_add(at->t, h);
}

/* An error of the acceleration counts relative to the acceleration, or, where that hardly matters, to the velocity;
   what rounding makes of b_6 is no error. */
double skf_radau_share(const skf_gauss_radau *w, const skf_radau_guess *u, double h, double tolerance) {
  double allowed = tolerance * (LAST_TERM * u->size + largest(w->from.v) / h);
  double error = largest(u->b[TERMS - 1]) - AMPLIFICATION * w->noise;
  if (!(error > 0)) return 4;
  return fmin(4, pow(allowed / error, 1.0 / TERMS));
}

/* The acceleration at the end of the step is known for the next one: where it is not what the polynomial says, the
   force has a join that no node has seen. A smooth force differs there by less than the tolerance, see LAST_TERM. */
bool skf_radau_meets(const skf_gauss_radau *w, double h, double size, double tolerance, skf_vec3 a) {
  skf_vec3 end = w->from_a;
  for (int k = 0; k < TERMS; k++) end = v3_add(end, w->b[k]);
  double allowed = tolerance * (JOIN * size + largest(w->from.v) / h) + JOIN * w->noise;
  return largest(v3_sub(end, a)) <= allowed;
}

/* One attempt. Returns the share of h that would meet the tolerance; below REFUSE the step has not been taken. */
static double attempt(skf_gauss_radau *w, skf_ode *ode, double h, double tolerance, skf_orbit *at) {
  skf_gauss_radau before = *w;
  skf_radau_guess u;
  skf_radau_predict(w, h, &u);
  if (!solve(w, ode, h, &u)) return 0.25;
  double q = skf_radau_share(w, &u, h, tolerance);
  if (q < SKF_RADAU_REFUSE) return fmax(q, 0.1);
  skf_orbit next = *at;
  skf_radau_finish(w, &u, h, &next);
  bool finite = skf_ode_feel(ode, next.t, v3_add(next.x, next.x_low), v3_add(next.v, next.v_low), &w->a0, NULL);
  if (!finite || !skf_radau_meets(w, h, u.size, tolerance, w->a0)) return *w = before, 0.25;
  return *at = next, q;
}

static skf_status step(void *work, skf_ode *ode, const skf_step_control *control, skf_orbit *at, size_t *rejected) {
  skf_gauss_radau *w = work;
  double h = fmin(w->h, control->h_max);
  w->from = *at;
  for (;; (*rejected)++) {
    if (!(h > skf_step_floor(at->t)) || !isfinite(h)) return SKF_ERR_CONVERGENCE;
    double q = attempt(w, ode, h, control->tolerance, at);
    if (q >= SKF_RADAU_REFUSE) return w->h = h * q, SKF_OK;
    h *= q;
  }
}

static skf_status dense(void *work, skf_ode *ode, skf_path *path) {
  (void)ode;
  const skf_gauss_radau *w = work;
  double h = w->done;
  *path = skf_path_begin(&w->from, h, TERMS + 2);
  path->x[0] = v3_scale(h, path->v0);
  path->x[1] = v3_scale(0.5 * h * h, w->from_a);
  path->v[0] = v3_scale(h, w->from_a);
  for (int k = 0; k < TERMS; k++) {
    path->x[k + 2] = v3_scale(h * h * twice[k], w->b[k]);
    path->v[k + 1] = v3_scale(h * once[k], w->b[k]);
  }
  return SKF_OK;
}

const skf_integrator_ops skf_integrator_gauss_radau = {
    .info = {"gauss-radau", "15th-order Gauss-Radau predictor-corrector, good to rounding over long runs", 15, 9, true},
    .takes = SKF_TAKES_DRAG,
    .work_size = sizeof(skf_gauss_radau),
    .begin = begin,
    .step = step,
    .dense = dense,
    .pass = skf_radau_pass,
    .path_is_free = true,
};
