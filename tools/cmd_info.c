/* SPDX-License-Identifier: GPL-3.0-or-later */
/* skelfield info: what a scene holds. */
#include "info.h"
#include "core/vec3.h"

static void gather_element(const skf_element *e, info_body *out) {
  skf_shape shape = e->primitive.shape;
  double measure = skf_primitive_measure(&e->primitive);
  skf_box box = skf_primitive_bounds(&e->primitive);
  info_kernel *k = out->kernels + e->kernel.type;
  out->count[shape]++;
  out->measure[shape] += measure;
  out->profiled += e->profile != NULL;
  out->total += e->strength * skf_element_measure(e);
  out->skeleton = box_join(out->skeleton, box);
  if (!k->count++) k->least = k->most = e->kernel.param;
  k->least = fmin(k->least, e->kernel.param);
  k->most = fmax(k->most, e->kernel.param);
  out->pairs[e->kernel.type][shape] = true;
}

void info_gather(const skf_scene *scene, const skf_body *body, info_body *out) {
  *out = (info_body){.body = body, .skeleton = box_empty()};
  for (size_t i = 0; i < body->element_count; i++) gather_element(body->elements + i, out);
  out->massless = !body->has_mass && !isfinite(out->total);
  out->mass = out->massless ? NAN : body->has_mass ? body->mass : body->rho * out->total;
  out->gm = isinf(out->total) && body->rho == 0 ? 0 : scene->G * out->mass;
  out->surface = skf_surface_region(body->field, body->iso, &out->region, &out->around);
}

const char *info_surface(const info_body *b) {
  return b->surface == SKF_OK              ? "bounded"
         : b->surface == SKF_ERR_UNBOUNDED ? "unbounded"
         : b->surface == SKF_ERR_EMPTY     ? "none"
                                           : skf_status_text(b->surface);
}

const char *info_contact(skf_contact_mode mode) {
  static const char *const names[] = {
      [SKF_CONTACT_NONE] = "none",   [SKF_CONTACT_STOP] = "stop",     [SKF_CONTACT_BOUNCE] = "bounce",
      [SKF_CONTACT_STICK] = "stick", [SKF_CONTACT_ABSORB] = "absorb", [SKF_CONTACT_PASS] = "pass"};
  return names[mode];
}

static int run(cli *c) {
  skf_scene *scene;
  const char *path = cli_operand(c, 0);
  int status = cli_scene(c, path, &scene);
  if (status != CLI_DONE) return status;
  cli_out out;
  status = cli_out_open(&out, cli_value(c, "output"));
  if (status == CLI_DONE) {
    (cli_given(c, "json") ? info_json : info_text)(out.file, scene, path);
    status = cli_out_commit(&out);
  }
  skf_scene_free(scene);
  return status;
}

static const cli_option options[] = {
    {'j', "json", NULL, "one JSON object; what is infinite is null"},
    {'o', "output", "FILE", "where it goes (default: stdout)"},
};

static const char notes[] =
    "For each body: its primitives and their measures (count, length, area), mass, density in force and G M,\n"
    "the bounds of the skeleton and a box that holds the whole surface (and the inside, but where iso < 0 and the\n"
    "field fades to 0: there the inside is around it), and for each kernel on each kind of\n"
    "primitive whether the field is a closed form or adaptive quadrature, to what relative error, and where it\n"
    "is singular. Where handles (radius, blobbiness, influence) gave parameter and strength: these, and the handles\n"
    "as they came out, the radius found anew on the field of the entry alone.\n"
    "example: skelfield info data/donut.yaml --json";

static const char *const writes[] = {"output", NULL};

const cli_command cmd_info = {
    .name = "info",
    .operands = "SCENE",
    .summary = "what a scene holds: primitives, measures, masses, bounds",
    .operand_count = 1,
    .options = options,
    .option_count = sizeof options / sizeof *options,
    .notes = notes,
    .run = run,
    .writes = writes,
};
