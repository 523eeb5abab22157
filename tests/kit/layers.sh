#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Who includes whom: the tree keeps to the layers, and made-up trees that do not are caught.
set -u
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../tap.sh"
root=$SKF_SOURCE_ROOT
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

rule() { find "$1/lib" "$1/tools" -name '*.[ch]' -o -name '*.cpp' | sort | xargs awk -f "$here/layers.awk"; }

check "every include keeps to the layers" rule "$root"

# arrow FILE INCLUDE: a tree of this one file
arrow() {
  rm -rf "$scratch/tree"
  mkdir -p "$scratch/tree/lib" "$scratch/tree/tools" "$(dirname "$scratch/tree/$1")"
  echo "#include $2" >"$scratch/tree/$1"
  rule "$scratch/tree" >/dev/null
}
caught() { ! arrow "$@"; }

check "down is fine" arrow lib/ray/a.c '"field/kernel.h"'
check "down to a public header is fine" arrow lib/scene/a.c '"skelfield/surface.h"'
check "the same room is fine" arrow lib/field/a.c '"field/kernel.h"'
check "tools know all" arrow tools/a.c '"adapt/plot.h"'
check "adapters know the library" arrow lib/adapt/a.cpp '"skelfield/scene.h"'
check "up is caught" caught lib/field/a.c '"ray/tracer.h"'
check "up to a public header is caught" caught lib/core/a.h '"skelfield/field.h"'
check "up between public headers is caught" caught lib/skelfield/ray.h '"skelfield/scene.h"'
check "motion and surface are apart" caught lib/motion/a.c '"surface/mesher.h"'
check "the library knows no adapter" caught lib/scene/a.c '"adapt/check.h"'
check "the library knows no CGAL" caught lib/surface/a.c '<CGAL/Polyhedron_3.h>'
check "the umbrella header is for others" caught lib/scene/a.c '"skelfield/skelfield.h"'
check "a room is named" caught lib/field/a.c '"kernel.h"'
check "public headers include only public ones" caught lib/skelfield/field.h '"skeleton/shape.h"'
tap_done
