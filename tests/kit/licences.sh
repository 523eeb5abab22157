#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Each source says its licence once, in its first three lines: MIT in the library, the tests and the notebooks,
# GPL-3.0-or-later in the program and its scripts and in what includes CGAL.
set -u
. "$(dirname "$0")/../tap.sh"
cd "$SKF_SOURCE_ROOT" || exit 1

# A source is a file of code by its name, or a script by its first line.
sources() {
  find lib tools tests notebooks-c -type f | grep -E '(\.(c|h|cpp|sh|awk|py)|/[a-z]+)$' | sort
}
read_licences() {
  awk 'function close_file() {
      if (name == "") return
      want = gpl ? "GPL-3.0-or-later" : "MIT"
      if (count != 1 || found != want) { print name ": " count + 0 " SPDX lines on top, \"" found "\", expected one: " want; bad = 1 }
    }
    FNR == 1 { close_file(); name = FILENAME; gpl = name ~ /^tools\//; count = 0; found = "" }
    /^(\/\*|\/\/|#) SPDX-License-Identifier: / { if (FNR <= 3) { count++; found = $3 } else count = -1 }
    /^#include <CGAL\// { gpl = 1 }
    END { close_file(); exit bad }' "$@"
}
check "each source names its licence once" read_licences $(sources)
tap_done
