/* SPDX-License-Identifier: MIT */
/* The 12(10) pair of Dormand, El-Mikkawy and Prince for x'' = a(t, x), 17 stages [Dormand, El-Mikkawy & Prince 1987,
   IMA J. Numer. Anal. 7, 423, RKN12(10)17M]: one attempt of a step by LANES particles at once, each with a step and an
   end of its own. Included by a translation unit for one particle and for many, and by the translation unit of each
   instruction set; every lane gets the same bits everywhere. */
#include "motion/nystrom.h"
#include "num/exact.h"
#include "simd/vec.h"
#include <float.h>

#ifndef SKF_MOTION_NYSTROM_TABLE
#define SKF_MOTION_NYSTROM_TABLE

enum { STAGES = SKF_NYSTROM_STAGES };

static const double node[STAGES] = {0,
                                    0.02,
                                    0.04,
                                    0.1,
                                    0.133333333333333333333,
                                    0.16,
                                    0.05,
                                    0.2,
                                    0.25,
                                    0.333333333333333333333,
                                    0.5,
                                    0.555555555555555555556,
                                    0.75,
                                    0.857142857142857142857,
                                    0.945216222272014340130,
                                    1,
                                    1};
static const double inner[STAGES][STAGES] = {
    {0},
    {0.00020},
    {0.000266666666666666666667, 0.000533333333333333333333},
    {0.00291666666666666666667, -0.00416666666666666666667, 0.00625},
    {0.00164609053497942386831, 0, 0.00548696844993141289438, 0.00175582990397805212620},
    {0.0019456, 0, 0.00715174603174603174603, 0.00291271111111111111111, 0.000789942857142857142857},
    {0.00056640625, 0, 0.000880973048941798941799, -0.000436921296296296296296, 0.000339006696428571428571,
     -0.0000994646990740740740741},
    {0.00308333333333333333333, 0, 0, 0.00177777777777777777778, 0.0027, 0.00157828282828282828283,
     0.0108606060606060606061},
    {0.00365183937480112971375, 0, 0.00396517171407234306618, 0.00319725826293062822350, 0.00822146730685543536969,
     -0.00131309269595723798362, 0.00977158696806486781563, 0.00375576906923283379488},
    {0.00370724106871850081020, 0, 0.00508204585455528598076, 0.00117470800217541204474, -0.0211476299151269914996,
     0.0601046369810788081223, 0.0201057347685061881847, -0.0283507501229335808430, 0.0148795689185819327556},
    {0.0351253765607334415311, 0, -0.00861574919513847910341, -0.00579144805100791652168, 1.94555482378261584239,
     -3.43512386745651359637, -0.109307011074752217584, 2.34963831189951663943, -0.756009408687022978027,
     0.109528972221569264247},
    {0.0205277925374824966510, 0, -0.00728644676448017991778, -0.00211535560796184024069, 0.927580796872352224257,
     -1.65228248442573667907, -0.0210795630056865698192, 1.20653643262078715448, -0.413714477001066141325,
     0.0907987398280965375957, 0.00535555260053398504917},
    {-0.143240788755455150459, 0, 0.0125287037730918172778, 0.00682601916396982712868, -4.79955539557438726550,
     5.69862504395194143379, 0.755343036952364522249, -0.127554878582810837175, -1.96059260511173843289,
     0.918560905663526240976, -0.238800855052844310535, 0.159110813572342155139},
    {0.804501920552048948697, 0, -0.0166585270670112451779, -0.0214158340426297348117, 16.8272359289624658702,
     -11.1728353571760979268, -3.37715929722632374149, -15.2433266553608456462, 17.1798357382154165620,
     -5.43771923982399464535, 1.38786716183646557551, -0.592582773265281165348, 0.0296038731712973527962},
    {-0.913296766697358082096, 0, 0.00241127257578051783924, 0.0176581226938617419821, -14.8516497797203838246,
     2.15897086700457560031, 3.99791558311787990115, 28.4341518002322318985, -25.2593643549415984379,
     7.73387854236223736553, -1.89130289484786746104, 1.00148450702247178037, 0.00464119959910905190511,
     0.0112187550221489570340},
    {-0.275196297205593938206, 0, 0.0366118887791549201342, 0.00978951968823156262465, -12.2930623458862103042,
     14.2072264539379026943, 1.58664769067895368322, 2.45777353275959454390, -8.93519369440327190552,
     4.37367273161340694839, -1.83471817654494916304, 1.15920852890614912078, -0.0172902531653839221518,
     0.0193259779044607666728, 0.00520444293755499311185},
    {1.30763918474040575880, 0, 0.0173641091897458418671, -0.0185444564542657950244, 14.8115220328677268968,
     9.38317630848247090788, -5.22842619994454225415, -48.9512805258476508040, 38.2970960343379225626,
     -10.5873813369759797092, 2.43323043762262763585, -1.04534060425754442849, 0.0717732095086725945198,
     0.00216221097080827826906, 0.00700959575960251423699, 0},
};
/* Weights of the end. */
static const double to_x[STAGES] = {0.0121278685171854149769,
                                    0,
                                    0,
                                    0,
                                    0,
                                    0,
                                    0.0862974625156887444364,
                                    0.252546958118714719432,
                                    -0.197418679932682303358,
                                    0.203186919078972590809,
                                    -0.0207758080777149166122,
                                    0.109678048745020136250,
                                    0.0380651325264665057345,
                                    0.0116340688043242296441,
                                    0.00465802970402487868694,
                                    0,
                                    0};
static const double to_v[STAGES] = {0.0121278685171854149769,
                                    0,
                                    0,
                                    0,
                                    0,
                                    0,
                                    0.0908394342270407836172,
                                    0.315683697648393399290,
                                    -0.263224906576909737811,
                                    0.304780378618458886214,
                                    -0.0415516161554298332244,
                                    0.246775609676295306563,
                                    0.152260530105866022938,
                                    0.0814384816302696075086,
                                    0.0850257119389081128008,
                                    -0.00915518963007796287314,
                                    0.025};
/* What the result of order 10 has more. */
static const double off_x[STAGES] = {-0.00488083338982157677587,
                                     0,
                                     0,
                                     0,
                                     0,
                                     0,
                                     0.0140381265848573374875,
                                     -0.119479219208038325956,
                                     0.204402465076621218081,
                                     -0.132268149222379075887,
                                     0.110530692997616891818,
                                     -0.0797538578710285164725,
                                     0.0112243304864374578291,
                                     -0.00467159680159369424943,
                                     0.000858041347328284125270,
                                     0,
                                     0};
static const double off_v[STAGES] = {-0.00488083338982157677587,
                                     0,
                                     0,
                                     0,
                                     0,
                                     0,
                                     0.0147769753524814078816,
                                     -0.149349024010047907445,
                                     0.272536620102161624108,
                                     -0.198402223833568613831,
                                     0.221061385995233783636,
                                     -0.179446180209814162063,
                                     0.0448973219457498313165,
                                     -0.0327011776111558597460,
                                     0.0156623252888594357917,
                                     -0.0291551896300779628731,
                                     0.025};

/* Stages 1 to 5 have no weight at the end. */
enum { LAST_EMPTY = 5, MIDDLE = 10 };
/* A little more than the sum of |off_v|: what noise of the accelerations becomes in the error. */
#define ROUGH 1.5
/* Errors of an orbit's steps add up in the same direction: the estimate, which is of the lower order and so far too
   large, may be this share of the tolerance. */
#define SHARE 0.05

/* Errors below this share of the tolerance tell nothing about the next one. */
#define FLOOR 1e-3

/* What rounding of the weights to_x and to_v takes from their sums, and from the sums of weight times node, put on two
   stages: else energy would drift by it, always the same way. */
enum { LOW_A = 8, LOW_B = 12 };
static const double low_x[2] = {1.9687762142760370e-17, -4.9426125969574600e-18};
static const double low_v[2] = {-1.7684898401487522e-17, 9.0112810216031767e-18};

/* The first of the stages 1 to i - 1 that stage i looks at: stage 0 always counts. */
static inline int first_of(int i) { return i < 4 ? 1 : i == 7 ? 3 : 2; }

#endif

enum { NAME(WIDTH) = LANES == 1 ? 4 : 3 * LANES, NAME(BLOCK) = LANES == 1 ? 1 : 6 };

/* sum_j weight[j] k[j] over stage 0 and the stages from `first` to n - 1, for BLOCK vectors from i on */
SKF_INLINE void NAME(weigh)(const double *weight, const double k[STAGES][NAME(WIDTH)], int first, int n, int i,
                            skf_vd sum[NAME(BLOCK)]) {
  for (int u = 0; u < NAME(BLOCK); u++) sum[u] = vd_set(weight[0]) * vd_load(k[0] + i + u * SKF_LANES);
  for (int j = first; j < n; j++) {
    const skf_vd w = vd_set(weight[j]);
    for (int u = 0; u < NAME(BLOCK); u++) sum[u] += w * vd_load(k[j] + i + u * SKF_LANES);
  }
}

/* Accelerations of stage i at p, NAN where they are not finite; those of a particle alone are also returned, and may
   be left as they are where *rest, which is 0, becomes NAN. */
SKF_INLINE skf_vd NAME(force)(NAME(lanes) * s, const skf_ode *ode, int i, double *p, skf_vd *rest) {
  double *k = s->k[i], t_hi[LANES], t_lo[LANES];
  for (int l = 0; l < LANES && ode->timed; l++) {
    skf_clock t = clock_add((skf_clock){s->t_hi[l], s->t_lo[l]}, s->h[l] * node[i]);
    t_hi[l] = t.hi, t_lo[l] = t.lo;
  }
#if LANES == 1
  skf_vd all;
  if (ode->quick) {
    skf_vd g = ode->quick(ode->tile, vd_load(p));
    *rest += g - g;
    if (i == MIDDLE) *s->noise = skf_body_noise(ode->lone, v3(p[0], p[1], p[2]), g[3], v3(g[0], g[1], g[2]));
    all = vd_set(0) + vd_set(ode->lone->is.gain) * g; /* never -0, as in a sum */
  } else {
    skf_vec3 a, x = v3(p[0], p[1], p[2]);
    skf_clock t = {0, 0};
    if (ode->timed) t = (skf_clock){*t_hi, *t_lo};
    if (!ode->eval(ode->user, t, &x, &a, i == MIDDLE ? s->noise : NULL)) a = v3(NAN, NAN, NAN), *s->noise = 0;
    all = (skf_vd){a.x, a.y, a.z, 0};
  }
  vd_store(k, all);
  return all;
#else
  const double *const at[3] = {p, p + LANES, p + 2 * LANES};
  double *const to[3] = {k, k + LANES, k + 2 * LANES};
  ode->many(ode->user, LANES, t_hi, t_lo, at, to, i == MIDDLE ? s->noise : NULL);
  return *rest;
#endif
}

/* a lane's numbers for each of its coordinates */
SKF_INLINE void NAME(spread)(const double *lane, double *all) {
  for (int i = 0; i < NAME(WIDTH); i++) all[i] = lane[i % LANES];
}

/* sum += d with the rounding errors kept */
SKF_INLINE void NAME(sum_add)(skf_vd *sum, skf_vd *low, skf_vd d) {
  skf_vd s = *sum + d, b = s - *sum;
  *low += (*sum - (s - b)) + (d - b);
  *sum = s;
}

/* The end, small terms first, the product of step and velocity exact; the two estimates of the error. */
SKF_INLINE void NAME(finish)(NAME(lanes) * s, const double *h, double *off_position, double *off_velocity) {
  for (int i = 0; i < NAME(WIDTH); i += NAME(BLOCK) * SKF_LANES) {
    skf_vd dx[NAME(BLOCK)], dv[NAME(BLOCK)], ex[NAME(BLOCK)], ev[NAME(BLOCK)];
    NAME(weigh)(to_x, s->k, LAST_EMPTY + 1, STAGES - 2, i, dx);
    NAME(weigh)(to_v, s->k, LAST_EMPTY + 1, STAGES, i, dv);
    NAME(weigh)(off_x, s->k, LAST_EMPTY + 1, STAGES - 2, i, ex);
    NAME(weigh)(off_v, s->k, LAST_EMPTY + 1, STAGES, i, ev);
    for (int u = 0; u < NAME(BLOCK); u++) {
      const int at = i + u * SKF_LANES;
      skf_vd step = vd_load(h + at), v = vd_load(s->v + at), v_low = vd_load(s->v_low + at), hv = step * v, rest;
      skf_vd x = vd_load(s->x + at), x_low = vd_load(s->x_low + at);
      skf_vd ka = vd_load(s->k[LOW_A] + at), kb = vd_load(s->k[LOW_B] + at);
      for (int l = 0; l < SKF_LANES; l++) rest[l] = dd_two_prod(step[l], v[l]).lo;
      NAME(sum_add)(&x, &x_low, rest + step * (v_low + step * (vd_set(low_x[0]) * ka + vd_set(low_x[1]) * kb)));
      NAME(sum_add)(&x, &x_low, step * step * dx[u]);
      NAME(sum_add)(&x, &x_low, hv);
      NAME(sum_add)(&v, &v_low, step * (vd_set(low_v[0]) * ka + vd_set(low_v[1]) * kb));
      NAME(sum_add)(&v, &v_low, step * dv[u]);
      vd_store(s->to_x + at, x), vd_store(s->to_x_low + at, x_low);
      vd_store(s->to_v + at, v), vd_store(s->to_v_low + at, v_low);
      vd_store(off_position + at, vd_abs(step * ex[u])), vd_store(off_velocity + at, vd_abs(step * ev[u]));
    }
  }
}

/* Some lanes' numbers: one, or as many as a vector has. */
SKF_INLINE skf_vd NAME(few)(const double *p, int l) { return LANES == 1 ? vd_set(p[l]) : vd_load(p + l); }
/* a where they are equal; NAN where a is */
SKF_INLINE skf_vd NAME(larger)(skf_vd a, skf_vd b) { return vd_select(a < b, b, a); }
/* The largest coordinate. */
SKF_INLINE skf_vd NAME(largest)(const double *p, int l) {
  skf_vd x = vd_abs(NAME(few)(p, l)), y = vd_abs(NAME(few)(p, LANES + l)), z = vd_abs(NAME(few)(p, 2 * LANES + l));
  return NAME(larger)(NAME(larger)(x + vd_set(0) * (y + z), y), z);
}

/* Velocities count relative to the larger of the velocity and its change, positions relative to the path, so that
   neither the place nor the size of the world matters. */
static void NAME(judge)(NAME(lanes) * s, const double *ox, const double *ov) {
  enum { ONCE = LANES == 1 ? 1 : SKF_LANES };
  for (int l = 0; l < LANES; l += ONCE) {
    skf_vd speed = NAME(larger)(NAME(largest)(s->v, l), NAME(largest)(s->to_v, l)), h = NAME(few)(s->h, l);
    speed += h * NAME(larger)(NAME(largest)(s->k[0], l), NAME(largest)(s->k[STAGES - 1], l));
    skf_vd e = NAME(larger)(NAME(largest)(ox, l), NAME(largest)(ov, l)), one = vd_set(1);
    skf_vd share = vd_set(SHARE) * NAME(few)(s->tolerance, l) + vd_set(8 * DBL_EPSILON);
    skf_vd error = e / (speed * share + vd_set(ROUGH) * h * NAME(few)(s->noise, l)), finite = speed + e;
    error = vd_select(finite - finite == vd_set(0), vd_select(speed > vd_set(0), error, vd_set(0)), one / vd_set(0));
    /* about the 11th root: square roots are the same everywhere */
    e = NAME(larger)(error, vd_set(FLOOR));
    skf_vd r8 = vd_sqrt(vd_sqrt(vd_sqrt(e))), r16 = vd_sqrt(r8), r = r16 * vd_sqrt(r16);
    memcpy(s->error + l, &error, ONCE * sizeof(double)), memcpy(s->root + l, &r, ONCE * sizeof(double));
  }
}

static void NAME(attempt)(NAME(lanes) * s, const skf_ode *ode) {
  double h[NAME(WIDTH)], p[NAME(WIDTH)], off_position[NAME(WIDTH)], off_velocity[NAME(WIDTH)];
  NAME(spread)(s->h, h);
  for (int i = 0; i < NAME(WIDTH); i++) p[i] = s->x[i] + s->x_low[i];
  skf_vd rest = vd_set(0), last = NAME(force)(s, ode, 0, p, &rest);
  for (int n = 1; n < STAGES; n++) {
    const skf_vd c = vd_set(node[n]);
    const int stored = LANES == 1 && n > 1 ? n - 1 : n; /* the newest one need not come back from memory */
    for (int i = 0; i < NAME(WIDTH); i += NAME(BLOCK) * SKF_LANES) {
      skf_vd sum[NAME(BLOCK)];
      NAME(weigh)(inner[n], s->k, first_of(n), stored, i, sum);
      if (stored < n) sum[0] += vd_set(inner[n][stored]) * last;
      for (int u = 0; u < NAME(BLOCK); u++) {
        const int at = i + u * SKF_LANES;
        skf_vd step = vd_load(h + at), v = vd_load(s->v + at) + vd_load(s->v_low + at);
        skf_vd d = step * (c * v + step * sum[u]) + vd_load(s->x_low + at);
        vd_store(p + at, vd_load(s->x + at) + d);
      }
    }
    last = NAME(force)(s, ode, n, p, &rest);
  }
  NAME(finish)(s, h, off_position, off_velocity);
  NAME(judge)(s, off_position, off_velocity);
  if (LANES == 1 && vi_any(rest != rest)) s->error[0] = s->root[0] = INFINITY;
}
