/* SPDX-License-Identifier: GPL-3.0-or-later */
/* skelfield eval: the field at points. */
#include "cli.h"
#include <stdlib.h>

enum { COLUMNS = 10 }; /* F, gradient, Hessian */

/* Fields at points in structure-of-arrays form: x, y, z, then the sum over the bodies, then one body's share. */
typedef struct table {
  size_t n;
  int columns; /* 4 or 10 */
  double *x[3], *sum[COLUMNS], *part[COLUMNS];
  double *memory;
} table;

static int table_new(table *t, const double *rows, size_t n, bool tensor) {
  *t = (table){.n = n, .columns = tensor ? COLUMNS : 4};
  t->memory = calloc(n * (size_t)(3 + 2 * t->columns) + 1, sizeof(double));
  if (!t->memory) return cli_fail(CLI_FAILED, "out of memory for %zu points", n);
  double *p = t->memory;
  for (int k = 0; k < 3; k++, p += n) t->x[k] = p;
  for (int k = 0; k < t->columns; k++, p += n) t->sum[k] = p;
  for (int k = 0; k < t->columns; k++, p += n) t->part[k] = p;
  for (size_t i = 0; i < n; i++)
    for (int k = 0; k < 3; k++) t->x[k][i] = rows[3 * i + (size_t)k];
  return CLI_DONE;
}

static skf_status eval_batch(table *t, const skf_field *field, size_t from, size_t n) {
  const double *x[3] = {t->x[0] + from, t->x[1] + from, t->x[2] + from};
  double *out[COLUMNS] = {0};
  for (int k = 0; k < t->columns; k++) out[k] = t->part[k] + from;
  skf_status s = skf_field_eval(field, n, x, out[0], out + 1, t->columns == COLUMNS ? out + 4 : NULL);
  if (s) return s;
  for (int k = 0; k < t->columns; k++)
    for (size_t i = from; i < from + n; i++) t->sum[k][i] += t->part[k][i];
  return SKF_OK;
}

/* Points between two looks at the progress: some tenths of a second with the slowest pairs. */
static size_t batch_size(const skf_scene *scene) {
  size_t elements = 0;
  for (size_t b = 0; b < scene->body_count; b++) elements += scene->bodies[b].element_count;
  size_t n = 65536 / (elements + 1);
  return n < 64 ? 64 : n > 16384 ? 16384 : n;
}

static int evaluate(table *t, const skf_scene *scene, int only, bool far) {
  skf_progress progress = cli_progress("eval");
  size_t batch = far ? 1 << 18 : batch_size(scene), bodies = only < 0 ? scene->body_count : 1,
         first = only < 0 ? 0 : (size_t)only;
  for (size_t from = 0; from < t->n; from += batch) {
    size_t n = t->n - from < batch ? t->n - from : batch;
    for (size_t b = first; b < first + bodies; b++) {
      skf_status s = eval_batch(t, scene->bodies[b].field, from, n);
      if (s) return cli_fail_status(s, scene->bodies[b].name);
    }
    if (progress.report(progress.user, (double)(from + n) / (double)t->n))
      return cli_fail(CLI_FAILED, "interrupted, nothing written");
  }
  cli_progress_end();
  return CLI_DONE;
}

static int write_table(const table *t, const char *path) {
  cli_out out;
  int status = cli_out_open(&out, path);
  if (status != CLI_DONE) return status;
  fprintf(out.file, "x,y,z,F,gx,gy,gz%s\n", t->columns == COLUMNS ? ",hxx,hxy,hxz,hyy,hyz,hzz" : "");
  for (size_t i = 0; i < t->n && !ferror(out.file); i++) {
    for (int k = 0; k < 3; k++) {
      if (k) putc(',', out.file);
      cli_put(out.file, t->x[k][i]);
    }
    for (int k = 0; k < t->columns; k++) {
      putc(',', out.file);
      cli_put(out.file, t->sum[k][i]);
    }
    putc('\n', out.file);
  }
  return cli_out_commit(&out);
}

static int run_with(const cli *c, skf_scene *scene) {
  const char *name = cli_value(c, "body");
  int only = name ? cli_body(scene, name) : -1;
  if (name && only < 0) return CLI_BAD;
  double *rows;
  size_t n;
  int status = cli_csv(cli_operand(c, 1), "x,y,z", 3, NULL, &rows, &n);
  if (status != CLI_DONE) return status;
  table t;
  bool tensor = cli_given(c, "tensor"), far;
  status = cli_accuracy(c, scene, tensor ? 0 : n, &far); /* second derivatives only where it is asked for */
  if (status != CLI_DONE) return free(rows), status;
  status = table_new(&t, rows, n, tensor);
  free(rows);
  if (status == CLI_DONE) status = evaluate(&t, scene, only, far);
  if (status == CLI_DONE) status = write_table(&t, cli_value(c, "output"));
  free(t.memory);
  return status;
}

static int run(cli *c) {
  skf_scene *scene;
  int status = cli_scene(c, cli_operand(c, 0), &scene);
  if (status == CLI_DONE) status = run_with(c, scene);
  skf_scene_free(scene);
  return status;
}

static const cli_option options[] = {
    {'o', "output", "FILE", "where the table goes (default: stdout)"},
    {'b', "body", "NAME", "the field of this body alone (default: the sum over all bodies)"},
    {'t', "tensor", NULL, "add the second derivatives"},
    CLI_ACCURACY,
};

static const char notes[] =
    "in:  CSV with the header x,y,z: points in the inertial frame at t = 0; - reads stdin\n"
    "out: x,y,z,F,gx,gy,gz, one row for each point, in order; F is the sum over the bodies of\n"
    "     F(p) = sum of strength times the integral of the kernel over the primitive, g its gradient;\n"
    "     --tensor adds hxx,hxy,hxz,hyy,hyz,hzz. F is inf where the field is infinite.\n"
    "     --accuracy A, from 1e-12 to 0.01, is for large skeletons: 4000 or more primitives of one kernel\n"
    "     (inverse, inverse-squared, cauchy) are summed by expansions, narrow gaussian ones where they matter,\n"
    "     wide ones by polynomials, F to A times the sum of its absolute terms. Without it this happens to 1e-12\n"
    "     at 100000 points or more (not with --tensor) in bodies of 5000 inverse or gaussian primitives or more\n"
    "     (12500 if they are points; four times as many of the other two); else, and with --accuracy exact, every\n"
    "     primitive is added up, to rounding.\n"
    "example: skelfield eval data/donut.yaml points.csv -o field.csv";

static const char *const writes[] = {"output", NULL};

const cli_command cmd_eval = {
    .name = "eval",
    .operands = "SCENE POINTS.csv",
    .summary = "the field and its gradient at points",
    .operand_count = 2,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .notes = notes,
    .run = run,
    .writes = writes,
};
