# SPDX-License-Identifier: MIT
# skelfield simulate: rigid bodies that move and collide.
. "$(dirname "$0")/harness.sh"

run simulate "$data/needle.yaml" --bodies b.csv --contacts h.csv
expect_status "a needle through a donut's hole" 0
cp h.csv "$kept/out"
expect_out "the log's header" '^t,body,other,x,y,z,nx,ny,nz,jx,jy,jz,closing$'
expect_close "it touches nothing" "$(rows)" 0 0
cp b.csv "$kept/out"
expect_out "the bodies' header" '^t,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz$'
expect_close "61 rows of two bodies" "$(rows)" 122 0
expect_close "the needle is where it should be" "$(field 123 5)" -3 1e-9

sed 's/from: \[-0.2, 0, 3\], to: \[0.2, 0, 3\]/from: [0.4, 0, 3], to: [0.8, 0, 3]/' "$data/needle.yaml" >aside.yaml
run simulate aside.yaml --bodies aside.csv --contacts h.csv
cp h.csv "$kept/out"
expect "aside it hits the donut" [ "$(rows)" -ge 1 ]
expect "the needle pushes with the speed that it has" awk -F, 'NR > 1 && !($13 > 0) { exit 1 }' h.csv
cp aside.csv "$kept/out"
expect "momentum is kept: donut 10, needle 1" awk -F, 'NR > 1 { m = $2 == "donut" ? 10 : 1; p[$1] += m * $12 }
  END { for (t in p) if (p[t] < -1 - 1e-9 || p[t] > -1 + 1e-9) exit 1 }' aside.csv
run simulate aside.yaml --bodies again.csv --threads 1
expect_same "one thread gives the same bytes" aside.csv again.csv

# Two balls of one shape fall, by forces that add up, and come to rest.
write fall.yaml <<'END'
skelfield: 1
gravity: {G: 0}
bodies:
  - name: ground
    iso: -6.283185307179586
    kernel: {type: inverse}
    skeleton: [{plane: {through: [0, 0, -1], normal: [0, 0, 1]}}]
  - name: ball
    iso: 2
    kernel: {type: inverse}
    mass: 2
    motion: {velocity: [0, 0, 0]}
    skeleton: [{point: {at: [0, 0, 0.75]}}]
  - name: far
    iso: 2
    kernel: {type: inverse}
    mass: 2
    motion: {velocity: [0, 0, 0]}
    skeleton: [{point: {at: [5, 0, 0.6]}}]
forces: [{type: push, acceleration: [0, 0, -0.75]}, {type: push, acceleration: [0.01, 0, -0.25]}]
simulation: {t_end: 10, output_every: 1, restitution: 0.2, friction: 0.5, rolling: 0.02}
END
run simulate fall.yaml --bodies fall.csv
expect_status "bodies that come to rest" 0
expect "it says so" grep -q 'all bodies are at rest from t = ' "$kept/err"
cp fall.csv "$kept/out"
expect_close "the first at its height" "$(field 22 5)" 0.5 1e-7
expect_close "and the other" "$(field 23 5)" 0.5 1e-7
expect_close "without speed" "$(field 22 10)" 0 0
sed 's/, rolling: 0.02//' fall.yaml >rolls.yaml
run simulate rolls.yaml --bodies rolls.csv
cp rolls.csv "$kept/out"
expect "without rolling friction they go on" awk -F, 'NR == 22 && !($10 > 0.01) { exit 1 }' rolls.csv

# Killed at random and resumed: the same bytes.
sed 's/output_every: 0.1/output_every: 0.02/' aside.yaml >often.yaml
run simulate often.yaml --bodies whole.csv --contacts whole-hits.csv
run simulate often.yaml --bodies part.csv --contacts part-hits.csv --checkpoint part.ckpt
expect_status "with checkpoints" 0
expect_same "by way of the journal: the same bodies" whole.csv part.csv
expect_same "and hits" whole-hits.csv part-hits.csv
rm part.ckpt part.csv part-hits.csv
kills=0
while :; do
  "$SKF_PROGRAM" simulate often.yaml --bodies part.csv --contacts part-hits.csv --checkpoint part.ckpt \
    --resume part.ckpt --every-seconds 0.001 --threads $((1 + kills % 2)) </dev/null >/dev/null 2>"$kept/err" &
  pid=$!
  if [ $kills -lt 5 ]; then
    sleep "$((RANDOM % 3)).$((RANDOM % 10))" # it weighs the bodies first
    kill -9 $pid 2>/dev/null && kills=$((kills + 1))
  fi
  wait $pid 2>/dev/null && break
  [ $kills -le 100 ] || break
done
ran="simulate --resume, killed $kills times" ran_status=0
expect_same "$ran: the same bodies" whole.csv part.csv
expect_same "the same hits" whole-hits.csv part-hits.csv
expect "the journal is gone" [ ! -e part.ckpt.journal ]
run simulate often.yaml --bodies again.csv --resume part.ckpt
expect_status "a run that is complete is done" 0
run simulate aside.yaml --bodies again.csv --resume part.ckpt
expect_refused "a checkpoint of another scene" 'part.ckpt: a checkpoint of another scene'

run simulate "$data/grazing.yaml" --bodies g.csv --contacts h.csv
cp h.csv "$kept/out"
expect_close "balls that overlap by 2e-6 at periapsis touch once" "$(rows)" 1 0
sed 's/-0.091287054881/-0.091287130954/; s/0.273861164644/0.273861392861/' "$data/grazing.yaml" >pass.yaml
run simulate pass.yaml --bodies g.csv --contacts h.csv
cp h.csv "$kept/out"
expect_close "by 2e-6 apart they do not" "$(rows)" 0 0

run simulate aside.yaml --bodies a.csv --contacts ./a.csv
expect_refused "one file for two tables" "--contacts and --bodies name the same file"
run simulate aside.yaml --bodies aside.yaml
expect_refused "the scene for rows" "--bodies aside.yaml is read, too, expected another file"
refuse_simulate() { run simulate "$2" && :; expect_refused "$1" "$3"; }
sed 's/^simulation/particles: [{name: p, position: [9, 9, 9], velocity: [0, 0, 0]}]\nsimulation/' aside.yaml >both.yaml
refuse_simulate "particles among bodies that move" both.yaml 'both.yaml: particles among bodies that move'
sed 's/motion: {velocity: \[0, 0, 0\]}/spin: {axis: [0, 0, 1], rate: 1}/' aside.yaml >spin.yaml
refuse_simulate "a spin beside a motion" spin.yaml "spin.yaml:[0-9]+: body 'donut' has a spin"
sed 's/type: push, acceleration: \[0, 0, -0.75\]/type: drag, k: 1/' fall.yaml >drag.yaml
refuse_simulate "drag on bodies that move" drag.yaml 'drag.yaml: drag among bodies that move, expected no other force than push'
sed 's/rolling: 0.02/rolling: -1/' fall.yaml >rolling.yaml
refuse_simulate "a rolling friction below 0" rolling.yaml 'rolling.yaml:[0-9]+: rolling'
sed 's/mass: 1$/mass: -1/' aside.yaml >light.yaml
refuse_simulate "a mass below 0" light.yaml "light.yaml:[0-9]+: body 'cigar' moves with mass -1, expected a mass above 0"
run simulate "$data/donut.yaml" --bodies b2.csv
expect_refused "no body that moves" ".*no body moves, expected motion for --bodies"
tap_done
