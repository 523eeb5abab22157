/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of `skelfield validate` share: a report of checks and figures, in sections. */
#ifndef SKF_TOOLS_VALIDATE_H
#define SKF_TOOLS_VALIDATE_H

#include "cli.h"

typedef enum verdict { VERDICT_FAIL, VERDICT_OK, VERDICT_NOTE } verdict;

typedef struct finding {
  verdict verdict;
  const char *name;
  char detail[224];
} finding;

typedef struct figure {
  const char *name, *unit;
  double value;
  bool integer;
} figure;

/* A mesh, a body or a skeleton. */
typedef struct section {
  char title[160];
  int findings, figures;
  finding finding[24];
  figure figure[32];
} section;

void section_start(section *s, const char *format, ...) __attribute__((format(printf, 2, 3)));
/* A check that holds or fails, with what was found. */
void section_check(section *s, const char *name, bool ok, const char *format, ...)
    __attribute__((format(printf, 4, 5)));
/* Something to know that is no defect. */
void section_note(section *s, const char *name, const char *format, ...) __attribute__((format(printf, 3, 4)));
void section_number(section *s, const char *name, const char *unit, double value);
void section_count(section *s, const char *name, double value);
bool section_ok(const section *s);
void section_print(const section *s, FILE *f);
void section_json(const section *s, cli_json *j);

/* Adds the checks of a mesh by itself; `around`: of the mesh turned over, since it is the outside that it encloses. */
skf_status validate_mesh(const skf_mesh *mesh, bool around, section *s);
/* Adds the checks of a body's mesh against its field: distance, rays, volume. */
skf_status validate_against_field(const skf_body *body, const skf_mesh *mesh, const skf_mesh_report *made, section *s);
/* Adds the checks of a body's skeleton. */
skf_status validate_skeleton(const skf_body *body, section *s);

#endif
