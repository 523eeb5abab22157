/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a scene file may hold, from the reader's tables and the registries. */
#include "cli_private.h"
#include "scene/skeleton.h"

static void put_key(FILE *f, const char *name, bool required, const char *form, const char *doc, const char *unit) {
  fprintf(f, "  %-12s %c %-30s %s", name, required ? '*' : ' ', form, doc);
  if (unit) fprintf(f, " [%s]", unit);
  fputc('\n', f);
}

static void put_keys(FILE *f, const skf_key *keys, int count) {
  char form[64];
  for (int i = 0; i < count; i++)
    put_key(f, keys[i].name, keys[i].required, skf_key_form(keys + i, form, sizeof form), keys[i].doc, keys[i].unit);
}

static void put_section(FILE *f, const skf_section *s) {
  fprintf(f, "\n%s: %s\n", s->name, s->doc);
  put_keys(f, s->keys, s->count);
}

static void put_shape(FILE *f, const skf_shape_info *s) {
  static const char *const forms[] = {[SKF_PARAM_NUMBER] = "a number",
                                      [SKF_PARAM_ANGLE] = "a number",
                                      [SKF_PARAM_VECTOR] = "[x, y, z]",
                                      [SKF_PARAM_SOLID] = "a file name"};
  fprintf(f, "\n%s: %s\n", s->name, s->doc);
  for (int i = 0; i < s->param_count; i++) {
    const skf_param *p = s->params + i;
    char several[32];
    snprintf(several, sizeof several, "%d points [x, y, z]", p->count);
    put_key(f, p->name, true, p->type == SKF_PARAM_VECTORS ? several : forms[p->type], p->doc, p->unit);
  }
}

void cli_help_scene(FILE *f) {
  fputs("A scene is a YAML file. Keys with * are required. Angles are degrees; everything else is in the scene's own\n"
        "consistent units of length L, time T and mass M; coordinates are right-handed. Coordinates and lengths of\n"
        "skeletons are at most 1e153. What is written once can be used again: anchors (&name), aliases (*name), merge\n"
        "keys (<<).\n",
        f);
  for (const skf_section *const *s = skf_sections; *s; s++) put_section(f, *s);
  fputs("\nAn entry of a skeleton is one of the following, each of which may also have\n", f);
  put_keys(f, skf_entry_keys, SKF_ENTRY_KEYS);
  for (int i = 0; i < SKF_SHAPE_COUNT; i++) put_shape(f, skf_shape_get((skf_shape)i));
  for (int i = 0; i < SKF_COMPOUND_COUNT; i++) put_section(f, &skf_compounds[i].section);
  fputs(
      "\nhandles: radius (called " SKF_OTHER_RADIUS
      " where a primitive has a radius of its own), blobbiness and influence set\n"
      "the kernel's parameter and the strength. Two of radius, blobbiness and the kernel's width give the third and "
      "the\n"
      "strength; the width is an influence or the parameter itself. Radius and strength give the parameter, influence\n"
      "alone gives it and leaves the strength. Inverse and inverse-squared have no width: radius gives the strength.\n"
      "Were the primitive alone, F = iso at the radius: all around a point, beside a segment's middle, from the middle "
      "of\n"
      "an arc along its normal, above a triangle's incentre, above a plane; of several pieces, beside the largest one "
      "in\n"
      "the field of them all. Where an entry is silent its material counts, then its body, then its body's material.\n",
      f);
  fputs(
      "\nprofile: a weight p(t) in the integral, t from 0 at one end of the curve to 1 at the other by length; a "
      "polyline,\n"
      "bezier, helix or spiral carries it along its whole chain. One of constant; hat (0 - 1 - 0); sin2 (sin^2 pi t);\n"
      "{linear: [from, to]}; {cubic: [[t, value, slope], ...]}, Hermite cubics between knots from t = 0 to t = 1. "
      "Weights\n"
      "may be negative in places. The measure that mass refers to is the integral of the profile.\n",
      f);
  fputs("\nkernel: h(r), by its type and its parameter\n", f);
  for (int i = 0; i < SKF_KERNEL_COUNT; i++) {
    const skf_kernel_info *k = skf_kernel_get((skf_kernel_type)i);
    fprintf(f, "  %-17s%s; %s\n", k->name, k->formula, k->doc);
    if (k->param) put_key(f, k->param, true, "  a finite number > 0", k->param_doc, k->param_unit);
  }
}
