#!/bin/bash
# SPDX-License-Identifier: MIT
# First hits beside POV-Ray's pictures of the same bodies, in one run, one thread each, and on how many pixels they agree
# about what is covered:
#   tests/bench/povray.sh build/tests/bench/bench_ray [SIZE [build/tools/skelfield]]
# Programs take turns, RUNS of each (5 unless told); of the time, of the cycles and of the instructions, all outside of
# the kernel, the least is taken, net of a picture of one pixel. Instructions do not depend on who else uses the machine;
# they are counted by perf, or else by valgrind. POV-Ray's include its simplest shading; those of first hits none, those
# of `skelfield render`, where it is given, its own and the PNG, as POV-Ray's then do. inverse91 takes POV-Ray minutes
# and is left out unless ALL=1.
set -eu
bench=${1:?usage: povray.sh BENCH_RAY [SIZE [SKELFIELD]]}
size=${2:-512}
program=${3:-}
command -v povray >/dev/null || { echo "povray is not installed: nothing to compare with"; exit 0; }
dir=$(mktemp -d)
trap 'rm -rf "$dir"' EXIT
"$bench" --pov "$dir"
export OMP_NUM_THREADS=1

counter=none
if perf stat -x, -e instructions:u,cycles:u -o "$dir/count" true 2>/dev/null &&
  ! grep -q -e 'not supported' -e 'not counted' "$dir/count"; then
  counter=perf
elif command -v valgrind >/dev/null; then
  counter=valgrind
fi

# cost KEY COMMAND: adds user seconds, cycles and instructions, or nan, to the key's list
cost() {
  local TIMEFORMAT=%U key=$1 seconds cycles=nan instructions=nan
  shift
  if [ $counter = perf ]; then
    seconds=$({ time perf stat -x, -e instructions:u,cycles:u -o "$dir/count" "$@" >/dev/null 2>&1; } 2>&1)
    instructions=$(awk -F, '/instructions/ { print $1 }' "$dir/count")
    cycles=$(awk -F, '/cycles/ { print $1 }' "$dir/count")
  else
    seconds=$({ time "$@" >/dev/null 2>&1; } 2>&1)
    if [ $counter = valgrind ] && [ ! -e "$dir/$key" ]; then # the same each time
      instructions=$(valgrind --tool=callgrind --callgrind-out-file=/dev/null "$@" 2>&1 >/dev/null |
        awk '/Collected/ { print $NF }')
    fi
  fi
  echo "$seconds $cycles $instructions" >>"$dir/$key"
}

pov() { cost "$1.$2.pov$4" povray "+I$dir/$1.pov" "+W$3" "+H$3" +WT1 -A -D "$5" "+O$dir/pov.png" -V -P; }
render() {
  cost "$1.$2.render" "$program" render "$dir/$1.yaml" --from "$4" --to "$5" --up 0,1,0 --fov 40 --threads 1 \
    --size "$3x$3" --quality draft --spp 1 -o "$dir/render.png"
}

# least of each column, whole less start
net() {
  awk 'function least(i) { if ($i != "nan" && (!((FNR != NR) + 0 "," i in m) || $i < m[(FNR != NR) + 0 "," i]))
                             m[(FNR != NR) + 0 "," i] = $i + 0 }
       { least(1); least(2); least(3) }
       END { for (i = 1; i < 4; i++) printf "%s ", "0," i in m ? m["0," i] - m["1," i] : "nan" }' "$dir/$1.whole.$2" "$dir/$1.start.$2"
}

# WHAT THEIRS OURS: both and their ratios
tell() {
  echo "$2 $3" | awk -v what="$1" '
    function ratio(a, b) { return a == "nan" || b == "nan" || !(b > 0) ? "      -" : sprintf("%6.2fx", a / b) }
    { printf "  %-16s %7.3f s beside %7.3f s %s", what, $4, $1, ratio($1, $4)
      if ($5 != "nan") printf "; cycles %6.0f M beside %6.0f M %s", $5 / 1e6, $2 / 1e6, ratio($2, $5)
      if ($6 != "nan") printf "; instructions %6.0f M beside %6.0f M %s", $6 / 1e6, $3 / 1e6, ratio($3, $6)
      print "" }'
}

for name in flake91 flake820 flake7381 tree543 inverse10 inverse91; do
  [ "$name" != inverse91 ] || [ "${ALL:-0}" = 1 ] || continue
  runs=${RUNS:-5}
  case $name in inverse*) runs=1 ;; esac
  read -r from to <"$dir/$name.camera"
  for _ in $(seq "$runs"); do
    for part in whole start; do
      side=$size
      [ $part = whole ] || side=1
      pov "$name" $part $side "" -F
      cost "$name.$part.first" "$bench" --once "$side" "$name"
      [ -n "$program" ] || continue
      pov "$name" $part $side png +FN
      [ $part = whole ] || side=16
      render "$name" $part $side "$from" "$to"
    done
  done
  povray "+I$dir/$name.pov" "+W$size" "+H$size" +WT1 -A -D +FP "+O$dir/$name.ppm" -V -P >/dev/null 2>&1
  echo "$name: coverage agrees on $("$bench" --cover "$size" "$name" "$dir/$name.ppm") of the pixels"
  tell "first hits" "$(net "$name" pov)" "$(net "$name" first)"
  [ -z "$program" ] || tell "render" "$(net "$name" povpng)" "$(net "$name" render)"
done
