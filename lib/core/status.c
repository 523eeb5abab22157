/* SPDX-License-Identifier: MIT */
#include "skelfield/core.h"

const char *skf_status_text(skf_status status) {
  static const char *const text[] = {
#define SKF_STATUS_TEXT(code, words) words,
      SKF_STATUS_LIST(SKF_STATUS_TEXT)
#undef SKF_STATUS_TEXT
  };
  return (unsigned)status < SKF_STATUS_COUNT ? text[status] : "unknown status";
}

const char *skf_version(void) { return SKF_VERSION; }
