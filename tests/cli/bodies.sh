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

run simulate aside.yaml --bodies a.csv --contacts ./a.csv
expect_refused "one file for two tables" "--bodies and --contacts name the same file"
refuse_simulate() { run simulate "$2" && :; expect_refused "$1" "$3"; }
sed 's/^simulation/particles: [{name: p, position: [9, 9, 9], velocity: [0, 0, 0]}]\nsimulation/' aside.yaml >both.yaml
refuse_simulate "particles among bodies that move" both.yaml 'both.yaml: particles among bodies that move'
sed 's/motion: {velocity: \[0, 0, 0\]}/spin: {axis: [0, 0, 1], rate: 1}/' aside.yaml >spin.yaml
refuse_simulate "a spin beside a motion" spin.yaml "spin.yaml:[0-9]+: body 'donut' has a spin"
sed 's/mass: 1$/mass: -1/' aside.yaml >light.yaml
refuse_simulate "a mass below 0" light.yaml "light.yaml:[0-9]+: body 'cigar' moves with mass -1, expected a mass above 0"
run simulate "$data/donut.yaml" --bodies b2.csv
expect_refused "no body that moves" ".*no body moves, expected motion for --bodies"
tap_done
