# SPDX-License-Identifier: MIT
# skelfield simulate under mpirun: the bytes of one process for any number of them, also after kills and on another
# number; without MPI in the build, or for other commands, a refusal.
. "$(dirname "$0")/harness.sh"

scene() { # t_end, contact
  cat <<END
skelfield: 1
gravity: {G: 1}
bodies:
  - {name: ring, iso: 9, kernel: {type: inverse}, mass: 1, spin: {axis: [1, 0, 0], rate: 0.3},
     skeleton: [{arc: {center: [0, 0, 0], normal: [0, 0, 1], start: [1, 0, 0], radius: 1, sweep: 360}}]}
particles:
  - {name: rain, shell: {inner: 1.5, outer: 2, count: 60, tangential: 0.3}}
  - {name: dust, disc: {inner: 2, outer: 3, count: 40, circular: 1}}
simulation: {t_end: $1, output_every: 0.5, contact: $2, restitution: 0.8}
END
}
scene 5 bounce >rain.yaml

# As one of several processes, without a launcher behind it.
alone() { env OMPI_COMM_WORLD_SIZE=2 OMPI_COMM_WORLD_RANK=$1 SKELFIELD_MPI=$2 "$SKF_PROGRAM" "${@:3}"; }
# runs COMMAND...: like run, for another command
runs() {
  find . -type f -exec cksum {} + | sort >"$kept/before"
  "$@" </dev/null >"$kept/out" 2>"$kept/err"
  ran_status=$? ran=$*
  find . -type f -exec cksum {} + | sort >"$kept/after"
}
runs alone 0 on info rain.yaml
expect_refused "another command" 'info: one of 2 processes of an MPI launcher, but only simulate shares its work'
runs alone 1 on info rain.yaml
expect "the second process is silent" eval '[ $ran_status = 0 ] && [ ! -s "$kept/err" ] && nothing_written'
runs alone 1 off info rain.yaml
expect_out "unless it works by itself" 'ring'
runs alone 0 on --version
expect_out "the first process tells the version" '^skelfield '

if ! has mpi; then
  runs alone 0 on simulate rain.yaml -o run.csv
  expect_refused "a build without MPI" 'one of 2 processes of an MPI launcher, but this build has no MPI'
  tap_done
  exit
fi
if ! command -v mpirun >/dev/null; then
  pass "no mpirun on this machine: runs of several processes are skipped"
  tap_done
  exit
fi

export OMPI_ALLOW_RUN_AS_ROOT=1 OMPI_ALLOW_RUN_AS_ROOT_CONFIRM=1
# Open MPI keeps some memory until its process ends.
export ASAN_OPTIONS=${ASAN_OPTIONS:-}:detect_leaks=0
# share N ARGUMENTS...: runs N processes
share() { timeout 120 mpirun --oversubscribe --mca mpi_yield_when_idle 1 -n "$1" "$SKF_PROGRAM" "${@:2}"; }

bins= formats=csv
has geographiclib && bins="--contact-bins bins.csv"
has hdf5 && formats="csv h5"
for f in $formats; do
  run simulate rain.yaml -o whole.$f --contacts whole-hits.csv --approach whole-near.csv --json $bins
  expect_status "one process, $f" 0
  cp "$kept/out" whole.json
  cp "$kept/err" whole.err
  [ -z "$bins" ] || mv bins.csv whole-bins.csv
  for n in 1 2 3 4; do
    runs share $n simulate rain.yaml -o run.$f --contacts hits.csv --approach near.csv --json $bins
    expect_status "$n processes, $f" 0
    expect_same "the same rows" whole.$f run.$f
    expect_same "the same contacts" whole-hits.csv hits.csv
    expect_same "the same approaches" whole-near.csv near.csv
    [ -z "$bins" ] || expect_same "the same bins" whole-bins.csv bins.csv
    expect_same "the same summary" whole.json out
    expect "the same words" cmp whole.err "$kept/err"
  done
done
runs share 2 simulate rain.yaml
expect_same "to stdout" whole.csv out

# HDF5 by all of them, each its share of the particles: more than a chunk of them, and what several rows add to them
if ! has hdf5-mpi; then
  pass "no HDF5 of MPI in the build: one process writes for all, the others' part is skipped"
else
  sed -e 's/count: 60/count: 5000/' -e 's/count: 40/count: 3001/' -e 's/t_end: 5/t_end: 1/' rain.yaml >crowd.yaml
  more="--invariants --frame body"
  run simulate crowd.yaml -o crowd.h5 $more
  expect_status "8001 particles" 0
  for n in 2 3; do
    rm -f "$kept"/loaded.*
    LD_DEBUG=files LD_DEBUG_OUTPUT="$kept/loaded" share $n simulate crowd.yaml -o run.h5 $more >/dev/null 2>"$kept/err"
    ran_status=$? ran="simulate on $n processes, HDF5"
    expect_same "$ran: the same bytes" crowd.h5 run.h5
    expect "each of them writes" [ "$(grep -l 'skelfield-hdf5-mpi.so' "$kept"/loaded.* | wc -l)" = $n ]
  done
  runs share 3 simulate crowd.yaml -o run.h5 $more --checkpoint part.ckpt
  expect_same "with checkpoints one does" crowd.h5 run.h5
  # Files that may not grow: of all of them, of one.
  limited() { (trap '' XFSZ && ulimit -f 20 && exec "$SKF_PROGRAM" "$@"); }
  export -f limited
  one=(-n 1 bash -c 'limited "$@"' limited) all=(-n 2 bash -c 'limited "$@"' limited) other=(-n 1 "$SKF_PROGRAM")
  fly=(simulate crowd.yaml -o full.h5)
  for who in all one-other other-one; do
    case $who in
      all) line=("${all[@]}" "${fly[@]}") ;;
      one-other) line=("${one[@]}" "${fly[@]}" : "${other[@]}" "${fly[@]}") ;;
      other-one) line=("${other[@]}" "${fly[@]}" : "${one[@]}" "${fly[@]}") ;;
    esac
    timeout 60 mpirun -q --oversubscribe --mca mpi_yield_when_idle 1 "${line[@]}" >/dev/null 2>"$kept/err"
    ran_status=$? ran="simulate, full disk: $who"
    expect "it ends" [ $ran_status -ne 0 ]
    expect "in time" [ $ran_status -ne 124 ]
    expect "it is told once" [ "$(grep -c '^skelfield: .*full.h5: HDF5 could not write' "$kept/err")" = 1 ]
    expect "nothing is left" [ -z "$(find . -name '*full.h5*')" ]
  done
  rm crowd.* part.ckpt
fi
sed -e '/dust/d' -e 's/count: 60/count: 2/' rain.yaml >two.yaml
run simulate two.yaml -o two.csv
runs share 3 simulate two.yaml -o three.csv
expect_same "more processes than particles" two.csv three.csv
rm -f ./*.json ./*.err two.* three.csv

# What one of them finds wrong
runs share 2 simulate no.yaml
expect_status "no scene" 2
expect "is told once" [ "$(grep -c '^skelfield: no.yaml' "$kept/err")" = 1 ]
sed '/rain,/s/name: rain, /&mass: 1, /' rain.yaml >heavy.yaml
runs share 2 simulate heavy.yaml -o heavy.csv
expect_status "particles that attract each other" 2
expect_err "are refused" "^skelfield: heavy.yaml:7: particle 'rain-[0-9]*' has a mass, but 2 processes share the run"
scene 5 stick >stick.yaml
runs timeout 60 mpirun --oversubscribe -n 1 "$SKF_PROGRAM" simulate rain.yaml -o a.csv : -n 1 "$SKF_PROGRAM" simulate stick.yaml -o a.csv
expect_status "two scenes" 2
expect_err "are told" '^skelfield: process 1 flies another scene'
runs share 2 simulate rain.yaml -o no-folder/run.csv
expect_status "a table that cannot be written" 1
expect "nothing is made" [ ! -e a.csv ]
rm stick.yaml heavy.yaml

# In the background, as the process that kill reaches.
share_on() { exec mpirun --oversubscribe --mca mpi_yield_when_idle 1 -n "$1" "$SKF_PROGRAM" "${@:2}" </dev/null >/dev/null 2>"$kept/err"; }

# One process killed at random, each time on another number of them.
scene 9 bounce >rain.yaml
run simulate rain.yaml -o whole.csv --contacts whole-hits.csv
kills=0 tries=0
rm -f run.* hits.csv
while [ $tries -lt 20 ]; do
  tries=$((tries + 1))
  share_on $((1 + tries % 4)) simulate rain.yaml -o run.csv --contacts hits.csv --checkpoint part.ckpt --resume part.ckpt \
    --every-seconds 0.02 &
  pid=$!
  if [ $kills -lt "${SKF_KILLS:-3}" ]; then
    sleep "$((RANDOM % 2)).$((5 + RANDOM % 5))"
    victim=$(pgrep -P $pid skelfield | sort -R | head -n 1)
    [ -n "$victim" ] && kill -9 "$victim" 2>/dev/null && kills=$((kills + 1))
  fi
  wait $pid && break
done
ran="simulate, killed $kills times" ran_status=0
expect_same "$ran: the same rows" whole.csv run.csv
expect_same "the same contacts" whole-hits.csv hits.csv

# Interrupted: the outputs hold what was done, and one process can go on from there.
scene 4000 none >long.yaml
share_on 3 simulate long.yaml -o long.csv --checkpoint long.ckpt --every-seconds 100 &
pid=$!
for _ in $(seq 400); do [ -s long.ckpt ] && break; sleep 0.05; done
sleep 0.3
kill -TERM $pid
wait $pid
ran_status=$? ran="simulate on 3 processes, SIGTERM"
expect "SIGTERM ends it" [ "$ran_status" -ne 0 ]
expect_err "it says how to go on" 'to go on: --resume long.ckpt'
[ ! -e long.csv ] || expect "the table is whole" awk -F, 'NF != 8 { exit 1 }' long.csv
run simulate rain.yaml -o run.csv --resume long.ckpt
expect_refused "its checkpoint for another scene" 'long.ckpt: a checkpoint of another scene'
runs share 2 simulate rain.yaml -o run.csv --resume long.ckpt
expect_status "by two processes, too" 2
expect_err "in the same words" '^skelfield: long.ckpt: a checkpoint of another scene'
tap_done
