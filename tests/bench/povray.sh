#!/bin/bash
# SPDX-License-Identifier: MIT
# First hits beside POV-Ray's pictures of the same bodies, in one run, one thread each, user time, and
# on how many pixels they agree about what is covered:
#   tests/bench/povray.sh build/tests/bench/bench_ray [SIZE]
# POV-Ray's time is net of a picture of one pixel; it includes its simplest shading, ours none. inverse91 takes it
# minutes and is left out unless ALL=1.
set -eu
bench=${1:?usage: povray.sh BENCH_RAY [SIZE]}
size=${2:-512}
command -v povray >/dev/null || { echo "povray is not installed: nothing to compare with"; exit 0; }
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
"$bench" --pov "$dir"

user() { # user seconds of a command
  local TIMEFORMAT=%U
  { time "$@" >/dev/null 2>&1; } 2>&1
}
pov() { user povray "+I$dir/$1.pov" "+W$2" "+H$2" +WT1 -A -D -F -V -P; }

for name in flake91 flake820 flake7381 tree543 inverse10 inverse91; do
  [ "$name" != inverse91 ] || [ "${ALL:-0}" = 1 ] || continue
  runs=3
  case $name in inverse*) runs=1 ;; esac
  best=
  for _ in $(seq $runs); do
    whole=$(pov "$name" "$size")
    start=$(pov "$name" 1)
    best=$(echo "$whole $start ${best:-1e9}" | awk '{ t = $1 - $2; print t < $3 ? t : $3 }')
  done
  povray "+I$dir/$name.pov" "+W$size" "+H$size" +WT1 -A -D +FP "+O$dir/$name.ppm" -V -P >/dev/null 2>&1
  ours=$(OMP_NUM_THREADS=1 "$bench" "$size" "$name" "$dir/$name.ppm")
  echo "$ours" | awk -v pov="$best" -v name="$name" '{
    for (i = 1; i <= NF; i++) { if ($i == "frame") first = $(i + 1); if ($i == "then") warm = $(i + 1)
                                if ($i == "agrees") agree = $(i + 2) }
    printf "%-10s POV-Ray %7.3f s; ours %7.3f s on the first frame, %5.1fx; then %7.3f s, %5.1fx; coverage agrees on %s %%\n",
           name, pov, first, pov / first, warm, pov / warm, agree }'
done
