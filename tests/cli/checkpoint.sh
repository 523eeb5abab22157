# SPDX-License-Identifier: MIT
# skelfield simulate --checkpoint and --resume: killed and interrupted runs end with the bytes of one that was not.
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
formats=csv
has hdf5 && formats="csv h5"
for f in $formats; do
  run simulate rain.yaml -o whole.$f --contacts whole-hits.csv
  expect_status "without interruption, $f" 0
done

# killed FORMAT TIMES: kills the run at random until it ends by itself.
killed() {
  local kills=0 pid
  rm -f part.ckpt
  while :; do
    "$SKF_PROGRAM" simulate rain.yaml -o part.$1 --contacts hits.csv --checkpoint part.ckpt --resume part.ckpt \
      --every-seconds 0.02 --threads $((1 + kills % 2)) </dev/null >/dev/null 2>"$kept/err" &
    pid=$!
    if [ $kills -lt "$2" ]; then
      sleep "0.$((RANDOM % 3))$((RANDOM % 10))"
      kill -9 $pid 2>/dev/null && kills=$((kills + 1))
    fi
    wait $pid 2>/dev/null && break
    [ $kills -le 100 ] || break
  done
  ran="simulate --resume, killed $kills times" ran_status=0
}
for f in $formats; do
  killed $f "${SKF_KILLS:-5}"
  expect_same "$ran: the same $f" whole.$f part.$f
  expect_same "the same contacts" whole-hits.csv hits.csv
  expect "the journal is gone" [ ! -e part.ckpt.journal ]
  rm part.$f hits.csv
  run simulate rain.yaml -o part.$f --resume part.ckpt
  expect_status "a run that is complete is done" 0
  expect "and makes nothing" [ ! -e part.$f ]
done
rm -f .part.* .hits.* # of a kill while the outputs were written
expect "nothing else is left" [ "$(ls -A | tr '\n' ' ' | sed 's/whole.h5 //')" = "part.ckpt rain.yaml whole-hits.csv whole.csv " ]

# Interrupted: the files hold what was done, and it can go on from there.
scene 4000 none >long.yaml
"$SKF_PROGRAM" simulate long.yaml -o long.csv --checkpoint long.ckpt --every-seconds 100 \
  </dev/null >/dev/null 2>"$kept/err" &
pid=$!
for _ in $(seq 200); do [ -s long.ckpt ] && break; sleep 0.05; done
sleep 0.3
kill -TERM $pid
wait $pid
ran_status=$? ran="simulate, SIGTERM"
expect_status "SIGTERM ends it" 143
expect_err "it says how to go on" 'to go on: --resume long.ckpt'
expect "the state is kept" [ -s long.ckpt ]
[ ! -e long.csv ] || expect "the table is whole" awk -F, 'NF != 8 { exit 1 }' long.csv

run simulate rain.yaml -o part.csv --resume long.ckpt
expect_refused "a checkpoint of another scene" 'long.ckpt: a checkpoint of another scene, expected the scene'
run simulate rain.yaml -o part.csv --resume no.ckpt
expect_refused "a checkpoint that is not there" 'no.ckpt: No such file or directory, expected a checkpoint'
run simulate rain.yaml -o part.csv --resume rain.yaml
expect_refused "the scene as a checkpoint" '--checkpoint and another argument name the same file'
run simulate rain.yaml -o part.csv --contacts ./new.ckpt.journal --checkpoint new.ckpt
expect_refused "the journal as a table" '--checkpoint and another argument name the same file'
run simulate rain.yaml -o part.csv --resume whole.csv
expect_refused "a table as a checkpoint" 'whole.csv: this is no checkpoint, expected one'
head -c 2000 long.ckpt >cut.ckpt
run simulate long.yaml -o part.csv --resume cut.ckpt
expect_refused "half a checkpoint" 'cut.ckpt: the checkpoint is damaged'
run simulate rain.yaml -o part.csv --resume long.ckpt --checkpoint other.ckpt
expect_refused "two checkpoints" '--checkpoint other.ckpt and --resume long.ckpt, expected the same file'
run simulate rain.yaml -o part.csv --every-seconds 3
expect_refused "a period without a checkpoint" '--every-seconds needs --checkpoint FILE'
run simulate rain.yaml -o a.csv --contacts ./a.csv
expect_refused "the same file by another name" '--output and --contacts name the same file'

tap_done
