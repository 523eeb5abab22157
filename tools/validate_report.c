/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The report of validate: as text and as JSON. */
#include "validate.h"
#include <stdarg.h>

void section_start(section *s, const char *format, ...) {
  va_list args;
  s->findings = s->figures = 0;
  va_start(args, format);
  vsnprintf(s->title, sizeof s->title, format, args);
  va_end(args);
}

static void add(section *s, verdict v, const char *name, const char *format, va_list args) {
  if (s->findings == (int)(sizeof s->finding / sizeof *s->finding)) return;
  finding *f = s->finding + s->findings++;
  f->verdict = v, f->name = name;
  vsnprintf(f->detail, sizeof f->detail, format, args);
}

void section_check(section *s, const char *name, bool ok, const char *format, ...) {
  va_list args;
  va_start(args, format);
  add(s, ok ? VERDICT_OK : VERDICT_FAIL, name, format, args);
  va_end(args);
}

void section_note(section *s, const char *name, const char *format, ...) {
  va_list args;
  va_start(args, format);
  add(s, VERDICT_NOTE, name, format, args);
  va_end(args);
}

static void put(section *s, figure f) {
  if (s->figures < (int)(sizeof s->figure / sizeof *s->figure)) s->figure[s->figures++] = f;
}

void section_number(section *s, const char *name, const char *unit, double value) {
  put(s, (figure){name, unit, value, false});
}

void section_count(section *s, const char *name, double value) { put(s, (figure){name, "", value, true}); }

bool section_ok(const section *s) {
  for (int i = 0; i < s->findings; i++)
    if (s->finding[i].verdict == VERDICT_FAIL) return false;
  return true;
}

void section_print(const section *s, FILE *f) {
  static const char *const words[] = {"FAIL", "ok", "note"};
  fprintf(f, "%s\n", s->title);
  for (int i = 0; i < s->findings; i++) {
    const finding *x = s->finding + i;
    fprintf(f, "  %-5s %-22s %s\n", words[x->verdict], x->name, x->detail);
  }
  for (int i = 0; i < s->figures; i++) {
    const figure *x = s->figure + i;
    fprintf(f, x->integer ? "        %-22s %.0f%s%s\n" : "        %-22s %.9g%s%s\n", x->name, x->value,
            x->unit[0] ? " " : "", x->unit);
  }
}

/* Names of JSON members: words joined by underscores. */
static const char *key_of(const char *name, char key[48]) {
  int n = 0;
  for (; name[n] && n < 47; n++) key[n] = name[n] == ' ' || name[n] == '-' ? '_' : name[n];
  key[n] = 0;
  return key;
}

void section_json(const section *s, cli_json *j) {
  char key[48];
  json_open(j, NULL, '{');
  json_string(j, "title", s->title);
  json_bool(j, "ok", section_ok(s));
  json_open(j, "checks", '[');
  for (int i = 0; i < s->findings; i++) {
    const finding *x = s->finding + i;
    json_open(j, NULL, '{');
    json_string(j, "name", key_of(x->name, key));
    if (x->verdict == VERDICT_NOTE)
      json_bool(j, "note", true);
    else
      json_bool(j, "ok", x->verdict == VERDICT_OK);
    json_string(j, "detail", x->detail);
    json_close(j, '}');
  }
  json_close(j, ']');
  json_open(j, "figures", '{');
  for (int i = 0; i < s->figures; i++) {
    const figure *x = s->figure + i;
    if (x->integer)
      json_integer(j, key_of(x->name, key), (long)x->value);
    else
      json_number(j, key_of(x->name, key), x->value);
  }
  json_close(j, '}');
  json_close(j, '}');
}
