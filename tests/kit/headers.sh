#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: headers.sh; CC and CXX name the compilers. Each public header compiles alone, as C17 and as C++17.
set -u
. "$(dirname "$0")/../tap.sh"
lib=$SKF_SOURCE_ROOT/lib
warnings="-Wall -Wextra -Wshadow -pedantic -Werror"

# The header comes first and twice: it needs nothing before it and has a guard.
alone() { # compiler, language, standard, header
  printf '#include "skelfield/%s"\n#include "skelfield/%s"\n' "$4" "$4" |
    $1 -x "$2" -std="$3" $warnings -fsyntax-only -I "$lib" -
}

for path in "$lib"/skelfield/*.h; do
  header=$(basename "$path")
  check "$header alone as C17" alone "$CC" c c17 "$header"
  check "$header alone as C++17" alone "$CXX" c++ c++17 "$header"
  check "skelfield.h includes $header" sh -c "
    echo '#include \"skelfield/skelfield.h\"' | $CC -x c -std=c17 -I '$lib' -M - | grep -q 'skelfield/$header'"
done
tap_done
