#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Each source says its licence once, in its first lines: MIT in the library and the tests, GPL-3.0-or-later in the
# program and in what includes CGAL.
set -u
. "$(dirname "$0")/../tap.sh"
cd "$SKF_SOURCE_ROOT" || exit 1

sources() { find "$@" -name '*.[ch]' -o -name '*.cpp' -o -name '*.sh' -o -name '*.awk' -o -name '*.py' | sort; }
expected() {
  if [ "${1%%/*}" = tools ] || grep -q '^#include <CGAL/' "$1"; then echo GPL-3.0-or-later; else echo MIT; fi
}

wrong=0
for file in $(sources lib tools tests); do
  lines=$(grep -cE '^(/\*|//|#) SPDX-License-Identifier: ' "$file")
  named=$(head -2 "$file" | sed -nE 's@^(/\*|//|#) SPDX-License-Identifier: ([^ ]*).*@\2@p')
  if [ "$lines" != 1 ] || [ "$named" != "$(expected "$file")" ]; then
    echo "$file: $lines SPDX lines, '$named' on top, expected one: $(expected "$file")"
    wrong=1
  fi
done
check "each source names its licence once" [ "$wrong" = 0 ]
tap_done
