/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a scene file may hold, from the registries. */
#include "cli_private.h"

static const char *const types[] = {
    [SKF_PARAM_NUMBER] = "number",
    [SKF_PARAM_ANGLE] = "number",
    [SKF_PARAM_VECTOR] = "[x, y, z]",
    [SKF_PARAM_VECTORS] = "[[x, y, z], ...]",
};

static void put_shape(FILE *f, const skf_shape_info *s) {
  fprintf(f, "  %s: %s\n", s->name, s->doc);
  for (int i = 0; i < s->param_count; i++) {
    const skf_param *p = s->params + i;
    fprintf(f, "    %-10s %-17s %s [%s]\n", p->name, types[p->type], p->doc, p->unit);
  }
}

void cli_help_scene(FILE *f) {
  fputs("primitives, each of which may also have strength and kernel:\n", f);
  for (int i = 0; i < SKF_SHAPE_COUNT; i++) put_shape(f, skf_shape_get((skf_shape)i));
  fputs("\nkernels, h(r):\n", f);
  for (int i = 0; i < SKF_KERNEL_COUNT; i++) {
    const skf_kernel_info *k = skf_kernel_get((skf_kernel_type)i);
    fprintf(f, "  %-16s %s; %s\n", k->name, k->formula, k->doc);
    if (k->param) fprintf(f, "    %-14s number > 0, %s [%s]\n", k->param, k->param_doc, k->param_unit);
  }
}
