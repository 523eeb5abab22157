/* SPDX-License-Identifier: MIT */
/* Dormand and Prince's 8(5,3) pair with its 7th-order dense output [Hairer, Norsett & Wanner 1993, II.5 and II.6,
   DOP853]. */
#include "motion/integrator.h"
#include <float.h>
#include <string.h>

enum { STAGES = 16, LAST = 12, DENSE = 7 };

/* Stage 12 is the derivative at the end of the step, its row the weights of order 8; stages 13 to 15 serve the dense
   output. */
static const double node[STAGES] = {0.0,
                                    0.052600151958767731879,
                                    0.078900227938151597818,
                                    0.11835034190722739673,
                                    0.28164965809277260327,
                                    0.33333333333333333333,
                                    0.25,
                                    0.30769230769230769231,
                                    0.65128205128205128205,
                                    0.6,
                                    0.85714285714285714286,
                                    1.0,
                                    1.0,
                                    0.1,
                                    0.2,
                                    0.77777777777777777778};
static const double a[STAGES][STAGES] = {
    {0.0},
    {0.052600151958767731879},
    {0.019725056984537899454, 0.059175170953613698363},
    {0.029587585476806849182, 0.0, 0.088762756430420547545},
    {0.2413651341592666855, 0.0, -0.88454947932828608534, 0.92483400326179200312},
    {0.037037037037037037037, 0.0, 0.0, 0.17082860872947387128, 0.12546768756682242502},
    {0.037109375, 0.0, 0.0, 0.17025221101954403931, 0.060216538980455960685, -0.017578125},
    {0.037092000118504792711, 0.0, 0.0, 0.17038392571223999381, 0.10726203044637328465, -0.015319437748624401753,
     8.2737891638140228876e-3},
    {0.62411095871607571711, 0.0, 0.0, -3.3608926294469412941, -0.86821934684172600682, 27.592099699446708305,
     20.154067550477893409, -43.489884181069958848},
    {0.47766253643826436589, 0.0, 0.0, -2.4881146199716676419, -0.59029082683684299637, 21.230051448181194235,
     15.279233632882423583, -33.288210968984862919, -0.020331201708508626136},
    {-0.93714243008598732572, 0.0, 0.0, 5.1863724288440637083, 1.0914373489967295782, -8.1497870107469261251,
     -18.520065659996959864, 22.739487099350504282, 2.4936055526796523899, -3.0467644718982195004},
    {2.2733101475165382079, 0.0, 0.0, -10.534495466737250198, -2.0008720582248624991, -17.958931863118798917,
     27.948884529419960051, -2.8589982771350236947, -8.8728569335306295443, 12.360567175794303065,
     0.64339274601576353036},
    {0.054293734116568762238, 0.0, 0.0, 0.0, 0.0, 4.4503128927524088814, 1.891517899314500383, -5.8012039600105847815,
     0.31116436695781989441, -0.15216094966251607856, 0.20136540080403034837, 0.044710615727772590518},
    {0.056167502283047952339, 0.0, 0.0, 0.0, 0.0, 0.0, 0.25350021021662481109, -0.24623903747080248992,
     -0.12419142326381636047, 0.15329179827876569731, 8.2010522956346898849e-3, 7.5678976605456997614e-3, -8.298e-3},
    {0.031834648163502140506, 0.0, 0.0, 0.0, 0.0, 0.028300909672366775529, 0.053541988307438567622,
     -0.054923748571390988465, 0.0, 0.0, -1.0834732869724932286e-4, 3.8257109083565841295e-4, -3.404650086874045608e-4,
     0.14131244367463250028},
    {-0.42889630158379192341, 0.0, 0.0, 0.0, 0.0, -4.6976214153611638431, 7.6834211960625990418, 4.0689898183971100797,
     0.35672718745528110927, 0.0, 0.0, 0.0, -1.3990241651590146213e-3, 2.947514789152772339, -9.1509584721798700108},
};

/* Weights of the errors of order 3 and 5. */
static const double third[LAST] = {-0.18980075407240761571,
                                   0.0,
                                   0.0,
                                   0.0,
                                   0.0,
                                   4.4503128927524088814,
                                   1.891517899314500383,
                                   -5.8012039600105847815,
                                   -0.42268232132379196293,
                                   -0.15216094966251607856,
                                   0.20136540080403034837,
                                   0.022651792198360825812};
static const double fifth[LAST] = {0.013120044994194880733,
                                   0.0,
                                   0.0,
                                   0.0,
                                   0.0,
                                   -1.2251564463762044407,
                                   -0.49575894965725019152,
                                   1.664377182454986537,
                                   -0.35032884874997368169,
                                   0.33417911871301747903,
                                   0.081923206485115712466,
                                   -0.022355307863886295259};

/* Dense output: its last four terms. */
static const double tail[4][STAGES] = {
    {-8.4289382761090128651, 0.0, 0.0, 0.0, 0.0, 0.56671495351937776963, -3.0689499459498916913, 2.3846676565120698288,
     2.1170345824450282767, -0.87139158377797299207, 2.2404374302607882759, 0.63157877876946881816,
     -0.088990336451333310821, 18.148505520854727257, -9.1946323924783554, -4.4360363875948939664},
    {10.427508642579134603, 0.0, 0.0, 0.0, 0.0, 242.28349177525818288, 165.20045171727028199, -374.5467547226902028,
     -22.113666853125306036, 7.733432668472263839, -30.674084731089398182, -9.332130526430227873, 15.697238121770843886,
     -31.139403219565177677, -9.3529243588444783866, 35.816841486394083752},
    {19.985053242002433821, 0.0, 0.0, 0.0, 0.0, -387.03730874935176555, -189.17813819516756883, 527.80815920542364901,
     -11.573902539959630126, 6.881232694696300017, -1.0006050966910838403, 0.77771377980534432093,
     -2.7782057523535084066, -60.196695231264120758, 84.320405506677161018, 11.992291136182789328},
    {-25.693933462703749003, 0.0, 0.0, 0.0, 0.0, -154.18974869023643374, -231.52937917604549568, 357.63911791061412378,
     93.405324183624310004, -37.458323136451633157, 104.09964950896230045, 29.840293426660503123,
     -43.533456590011143754, 96.324553959188282948, -39.177261675615439165, -149.72683625798562581},
};

typedef struct dop853 {
  double h, done;
  skf_orbit from;
  skf_vec3 v[STAGES], a[STAGES]; /* of each stage: the derivatives of x and of v */
  skf_orbit to;
  skf_vec3 a_next; /* at the start of the next step */
  double noise;
} dop853;

static skf_status begin(void *work, skf_ode *ode, const skf_orbit *at, double h) {
  dop853 *w = work;
  memset(w, 0, sizeof *w);
  w->h = h;
  return skf_ode_feel(ode, at->t, v3_add(at->x, at->x_low), v3_add(at->v, at->v_low), &w->a_next, &w->noise)
             ? SKF_OK
             : SKF_ERR_CONVERGENCE;
}

static skf_vec3 weigh(const double *weight, const skf_vec3 *k, int n) {
  skf_vec3 sum = {0, 0, 0};
  for (int j = 0; j < n; j++)
    if (weight[j] != 0) sum = v3_mad(sum, weight[j], k[j]);
  return sum;
}

static bool stage(dop853 *w, skf_ode *ode, double h, int i) {
  skf_vec3 dx = weigh(a[i], w->v, i), dv = weigh(a[i], w->a, i);
  double noise = 0;
  w->v[i] = v3_add(w->from.v, v3_mad(w->from.v_low, h, dv));
  bool ok = skf_ode_feel(ode, clock_add(w->from.t, h * node[i]), v3_add(w->from.x, v3_mad(w->from.x_low, h, dx)),
                         w->v[i], w->a + i, i % 4 == 0 ? &noise : NULL);
  w->noise = fmax(w->noise, noise);
  return ok;
}

static double largest(skf_vec3 p) { return fmax(fabs(p.x), fmax(fabs(p.y), fabs(p.z))); }

/* Errors of an orbit's steps add up in the same direction: a step may have this share of the tolerance. */
#define SHARE 0.1

/* The step's error as a multiple of the tolerance. Velocities count relative to the larger of the velocity and its
   change, positions relative to the path, so that neither the place nor the size of the world matters. */
static double error_of(const dop853 *w, double h, double tolerance) {
  double speed = fmax(largest(w->v[0]), largest(w->v[LAST])) + h * fmax(largest(w->a[0]), largest(w->a[LAST]));
  if (!(speed > 0)) return 0;
  double rough = 5 * h * w->noise; /* sum |fifth| is 4.2 */
  double e5 = fmax(h * largest(weigh(fifth, w->a, LAST)) - rough, largest(weigh(fifth, w->v, LAST)));
  double e3 = fmax(h * largest(weigh(third, w->a, LAST)), largest(weigh(third, w->v, LAST)));
  e5 = fmax(0, e5 / speed - 8 * DBL_EPSILON) / (SHARE * tolerance);
  e3 = e3 / speed / (SHARE * tolerance);
  return e5 > 0 ? e5 * e5 / sqrt(e5 * e5 + 0.01 * e3 * e3) : 0;
}

static bool attempt(dop853 *w, skf_ode *ode, double h) {
  for (int i = 1; i < LAST; i++)
    if (!stage(w, ode, h, i)) return false;
  w->to = w->from;
  skf_vec3 v = w->from.v, hv = v3_scale(h, v), mean = weigh(a[LAST], w->v, LAST);
  skf_vec3 rest = v3(fma(h, v.x, -hv.x), fma(h, v.y, -hv.y), fma(h, v.z, -hv.z));
  skf_orbit_add(&w->to.x, &w->to.x_low, rest);
  skf_orbit_add(&w->to.x, &w->to.x_low, v3_scale(h, v3_sub(mean, v)));
  skf_orbit_add(&w->to.x, &w->to.x_low, hv);
  skf_orbit_add(&w->to.v, &w->to.v_low, v3_scale(h, weigh(a[LAST], w->a, LAST)));
  w->to.t = clock_add(w->from.t, h);
  w->v[LAST] = v3_add(w->to.v, w->to.v_low);
  return skf_ode_feel(ode, w->to.t, v3_add(w->to.x, w->to.x_low), w->v[LAST], w->a + LAST, NULL);
}

static skf_status step(void *work, skf_ode *ode, const skf_step_control *control, skf_orbit *at, size_t *rejected) {
  dop853 *w = work;
  double h = fmin(w->h, control->h_max);
  bool refused = false;
  w->from = *at;
  w->v[0] = v3_add(at->v, at->v_low);
  w->a[0] = w->a_next;
  w->done = 0; /* no dense output while the stages change */
  for (;; (*rejected)++, refused = true) {
    if (!(h > skf_step_floor(at->t)) || !isfinite(h)) return SKF_ERR_CONVERGENCE;
    w->noise = 0;
    if (!attempt(w, ode, h)) {
      h *= 0.25;
      continue;
    }
    double error = error_of(w, h, control->tolerance);
    double q = 0.9 * pow(error, -1.0 / 8); /* +infinity without an error */
    if (error <= 1) {
      w->h = h * fmin(refused ? 1 : 6, q);
      break;
    }
    h *= fmax(q, 0.2);
  }
  w->a_next = w->a[LAST];
  w->done = h;
  *at = w->to;
  return SKF_OK;
}

/* Hairer's nested form r0 + s(r1 + (1-s)(r2 + s(r3 + ...))) as powers of s; the constant term stays apart. */
static void unnest(const skf_vec3 r[DENSE], skf_vec3 out[DENSE]) {
  skf_vec3 c[DENSE + 1] = {{0, 0, 0}};
  for (int i = DENSE; i-- > 0;) {
    c[0] = v3_add(c[0], r[i]);
    for (int k = DENSE; k > 0; k--) c[k] = i % 2 == 0 ? c[k - 1] : v3_sub(c[k], c[k - 1]);
    if (i % 2 == 0) c[0] = v3(0, 0, 0);
  }
  memcpy(out, c + 1, DENSE * sizeof *out);
}

static void terms(const skf_vec3 *k, double h, skf_vec3 delta, skf_vec3 out[DENSE]) {
  skf_vec3 r[DENSE] = {delta, v3_sub(v3_scale(h, k[0]), delta),
                       v3_sub(v3_scale(2, delta), v3_scale(h, v3_add(k[0], k[LAST])))};
  for (int i = 0; i < 4; i++) r[3 + i] = v3_scale(h, weigh(tail[i], k, STAGES));
  unnest(r, out);
}

static skf_status dense(void *work, skf_ode *ode, skf_path *path) {
  dop853 *w = work;
  double h = w->done;
  for (int i = LAST + 1; i < STAGES; i++)
    if (!stage(w, ode, h, i)) return SKF_ERR_CONVERGENCE;
  *path = skf_path_begin(&w->from, h, DENSE);
  terms(w->v, h, v3_add(v3_sub(w->to.x, w->from.x), v3_sub(w->to.x_low, w->from.x_low)), path->x);
  terms(w->a, h, v3_add(v3_sub(w->to.v, w->from.v), v3_sub(w->to.v_low, w->from.v_low)), path->v);
  return SKF_OK;
}

const skf_integrator_ops skf_integrator_dop853 = {
    .info = {"dop853", "Dormand-Prince 8(5,3), fewer evaluations at moderate tolerances", 8, 7, true},
    .takes = SKF_TAKES_DRAG,
    .work_size = sizeof(dop853),
    .begin = begin,
    .step = step,
    .dense = dense,
};
