# SPDX-License-Identifier: MIT
# skelfield simulate: columns, rows, contacts, launches, ground tracks, scenes that are refused, interrupts.
. "$(dirname "$0")/harness.sh"

write fall.yaml <<'END'
skelfield: 1
gravity: {G: 1}
bodies:
  - name: sun
    iso: 2
    kernel: {type: inverse}
    ellipsoid: {equatorial: 0.5, polar: 0.5}
    spin: {axis: [0, 0, 1], rate: 0.5}
    skeleton: [{point: {at: [0, 0, 0]}}]
particles:
  - {name: stone, position: [1, 0, 0], velocity: [0, 0, 0]}
  - {name: moon, position: [0, 1, 0], velocity: [-1, 0, 0]}
simulation: {t_end: 1.25, output_every: 0.5, tolerance: 1.0e-12}
END

run simulate fall.yaml --contacts hits.csv -o run.csv
expect_status "simulate works" 0
cp run.csv "$kept/out"
expect_out "its header" '^t,particle,x,y,z,vx,vy,vz$'
expect_close "rows at 0, 0.5, 1, 1.25 of two particles" "$(rows)" 8 0
expect_close "the last row is t_end" "$(field 8 1)" 1.25 0
expect "particles in the scene's order" [ "$(field 2 2)" = stone ]
expect_close "the stone stays where it touched" "$(field 8 3)" 0.5 1e-14
cp hits.csv "$kept/out"
expect_out "the log's header" '^t,particle,body,x,y,z,nx,ny,nz,vx,vy,vz,outcome$'
expect_close "one contact" "$(rows)" 1 0
expect_close "when: pi/4 + 1/2 over sqrt 2" "$(field 2 1)" "$(awk 'BEGIN { printf "%.17g", (atan2(1, 1) + 0.5) * sqrt(0.5) }')" 1e-13
expect_close "how fast: sqrt 2" "$(field 2 10)" -1.4142135623730951 1e-12
expect_out "what follows" ',stop$'

run simulate fall.yaml
expect_same "stdout is the same table" out run.csv
run simulate fall.yaml --threads 1
expect_same "one thread gives the same bytes" out run.csv

sed 's/tolerance:/contact: absorb, tolerance:/' fall.yaml >absorb.yaml
run simulate absorb.yaml --contacts hits.csv
expect_close "rows of the absorbed end" "$(rows)" 6 0
expect "the others' go on" [ "$(field 7 2)" = moon ]
expect "the log tells" grep -q ',absorb$' hits.csv

if has geographiclib; then
  run simulate fall.yaml --ground-track sun
  expect_out "a ground track" '^t,particle,x,y,z,vx,vy,vz,lat,lon,height$'
  expect_close "its height" "$(field 2 11)" 0.5 1e-14
  expect_close "its longitude, over ground that turns" "$(field 8 10)" "$(awk 'BEGIN { printf "%.17g", -0.625 * 180 / atan2(0, -1) }')" 1e-13
fi

if has hdf5; then
  run simulate fall.yaml -o run.h5 --json
  expect_status "HDF5 and a summary" 0
  expect_out "the summary counts the contact" '"contacts": 1,'
  expect_out "a fall from rest keeps its angular momentum" '"axial_momentum_drift": ([0.]+$|[0-9.]+e-1[5-9]$)'
  expect "the file is there" [ -s run.h5 ]
  sleep 1.1 # HDF5 keeps times in seconds
  run simulate fall.yaml -o again.h5 --threads 1
  expect_same "the same run gives the same bytes" run.h5 again.h5
fi
run simulate fall.yaml --contacts no-such-folder/hits.csv
expect_status "a log that cannot be written fails" 1
expect_nothing_written "and nothing is written"

run simulate fall.yaml -o run.txt
expect_refused "an unknown ending" "run.txt: unknown ending of a trajectory, expected .csv or .h5"
run simulate fall.yaml -o /dev/null
expect_status "a device needs no ending" 0
run simulate fall.yaml --ground-track moon
expect_refused "an unknown body" "no body is called 'moon', expected one of sun"
run simulate fall.yaml -o RUN.CSV
expect_status "an ending in capitals" 0
expect "writes the same" cmp -s run.csv RUN.CSV
run simulate fall.yaml -o same.csv --contacts same.csv
expect_refused "one file for two tables" "--output and --contacts name the same file"
grep -v simulation fall.yaml >none.yaml
run simulate none.yaml
expect_refused "no simulation" "none.yaml:1: no simulation, expected one with t_end and output_every"
sed '/- {name: /d; s/^particles:/particles: []/' fall.yaml >nobody.yaml
run simulate nobody.yaml
expect_refused "no particles" "nobody.yaml:1: no particles, expected at least one"
sed 's/position: \[1, 0, 0\]/position: [0, 0, 0]/' fall.yaml >inside.yaml
run simulate inside.yaml
expect_refused "a start in a singularity" "inside.yaml:11: particle 'stone' starts where the force is not finite"
sed 's/tolerance:/integrator: euler, tolerance:/' fall.yaml >euler.yaml
run simulate euler.yaml
expect_refused "an unknown integrator" "euler.yaml:13: integrator is .euler., expected one of gauss-radau, dop853"
sed 's/tolerance: [^,}]*/integrator: yoshida8, step: 0.01/' fall.yaml >fixed.yaml
run simulate fixed.yaml -o fixed.csv
expect_status "a fixed step" 0
expect_err "and the summary tells it" "yoshida8, step 0.01"
sed -e 's/{type: inverse}/{type: quartic, R: 0.9}/' -e '/spin\|ellipsoid/d' -e 's/G: 1/G: 0.01/' \
  -e 's/iso: 2/iso: 0.5/' -e '/moon/d' \
  -e 's/position: .*velocity: .*/position: [0.8, 0, 0], velocity: [1, 0, 0]}/' fixed.yaml >join.yaml
run simulate join.yaml -o join.csv
expect_err "the one join that it passes is told" "warning: 1 step of one length passes over joins"
sed 's/tolerance:/integrator: leapfrog, tolerance:/' fall.yaml >stepless.yaml
run simulate stepless.yaml
expect_refused "a fixed step that is not given" "stepless.yaml:13: leapfrog takes steps of one length, expected step"
sed 's/tolerance:/step: 0.1, tolerance:/' fall.yaml >steps.yaml
run simulate steps.yaml
expect_refused "a step that nobody takes" "steps.yaml:13: step given, but gauss-radau chooses its own"

# Without gravity: v = exp(-k t) after drag, v = a t after a push.
sed -e 's/G: 1}/G: 0}/' -e 's/position: \[1, 0, 0\], velocity: \[0, 0, 0\]/position: [1, 0, 0], velocity: [1, 0, 0]/' \
  -e 's/t_end: 1.25/t_end: 1/' fall.yaml >free.yaml
(cat free.yaml; echo 'forces: [{type: drag, k: 2}]') >drag.yaml
run simulate drag.yaml -o drag.csv
expect_status "drag in a scene" 0
expect_close "slows down" "$(awk -F, '$1 == 1 && $2 == "stone" { print $6 }' drag.csv)" 0.1353352832366127 1e-12
(cat free.yaml; echo 'forces: [{type: push, acceleration: [0, 0, 0.5]}]') >push.yaml
run simulate push.yaml -o push.csv
expect_close "a push" "$(awk -F, '$1 == 1 && $2 == "stone" { print $5 }' push.csv)" 0.25 1e-12
sed 's/k: 2/k: 2, body: moon/' drag.yaml >medium.yaml
run simulate medium.yaml
expect_refused "a medium of nobody" "medium.yaml:14: no body is called 'moon'"
sed 's/, k: 2//' drag.yaml >weak.yaml
run simulate weak.yaml
expect_refused "drag without k" "weak.yaml:14: missing 'k' in force, expected a finite number >= 0"
sed 's/tolerance: [^,}]*/integrator: rkn12/' drag.yaml >rkn12.yaml
run simulate rkn12.yaml
expect_refused "drag with another integrator" "rkn12.yaml:14: integrator rkn12 takes no drag, expected gauss-radau"
sed 's/k: 2/k: 2, acceleration: [1, 0, 0]/' drag.yaml >both.yaml
run simulate both.yaml
expect_refused "a drag that pushes" "both.yaml:14: unexpected 'acceleration' in a drag, expected k"

# Constants of the motion as columns, and the frame that turns with the body.
sed -e 's/contact: [a-z]*//' -e 's/tolerance:/contact: none, tolerance:/' -e 's/velocity: \[0, 0, 0\]/velocity: [0.1, 0.9, 0.3]/' \
  fall.yaml >turn.yaml
run simulate turn.yaml --invariants -o turn.csv
cp turn.csv "$kept/out"
expect_out "columns of invariants" '^t,particle,x,y,z,vx,vy,vz,energy,jacobi,lx,ly,lz,l_axis$'
expect_close "energy at the start" "$(field 2 9)" -0.545 1e-15
expect_close "and at the end" "$(field 8 9)" -0.545 1e-14
expect_close "Jacobi's constant" "$(field 2 10)" -0.995 1e-15
expect_close "angular momentum" "$(field 2 12)" -0.3 1e-15
expect_close "about the axis" "$(field 2 14)" 0.9 1e-15
cut -d, -f1-8 turn.csv >first.csv
run simulate turn.yaml
expect_same "the other columns are the same" out first.csv
run simulate turn.yaml --frame body --invariants -o body.csv
cp body.csv "$kept/out"
expect_close "the velocity relative to the frame" "$(field 2 7)" 0.4 1e-15
cut -d, -f1,2,9- turn.csv >left.csv
cut -d, -f1,2,9- body.csv >right.csv
expect_same "invariants do not depend on the frame of the rows" left.csv right.csv
awk -F, 'NR == FNR { x[FNR] = $3; y[FNR] = $4; u[FNR] = $6; v[FNR] = $7; next }
  FNR > 1 { c = cos(0.5 * $1); s = sin(0.5 * $1); a = $6 - 0.5 * $4; b = $7 + 0.5 * $3
    print c * $3 - s * $4 - x[FNR], s * $3 + c * $4 - y[FNR], c * a - s * b - u[FNR], s * a + c * b - v[FNR] }' \
  turn.csv body.csv | tr ' ' '\n' | awk '{ d = $1 < 0 ? -$1 : $1; if (d > most) most = d } END { exit !(NR == 32 && most < 1e-14) }'
expect_close "turned back they are the rows of the inertial frame" $? 0 0
sed 's/tolerance:/frame: body, tolerance:/; s/velocity: \[0.1, 0.9, 0.3\]/velocity: [0.1, 0.4, 0.3], frame: body/' turn.yaml >key.yaml
run simulate key.yaml --invariants
expect_same "frames in the scene say the same" out body.csv
run simulate key.yaml --invariants --frame inertial
expect_same "the option overrides them" out turn.csv
run simulate fall.yaml --frame body --contacts hits.csv -o run.csv
cp hits.csv "$kept/out"
expect_close "contacts are in the frame, too" "$(field 2 4)" "$(awk 'BEGIN { t = (atan2(0, -1) / 4 + 0.5) * sqrt(0.5); printf "%.17g", 0.5 * cos(0.5 * t) }')" 1e-12
run simulate turn.yaml --frame turning
expect_refused "an unknown frame" "--frame turning, expected inertial or body"
if has hdf5; then
  run simulate turn.yaml --invariants --frame body -o turn.h5
  expect_status "both in HDF5" 0
fi

# Particles that attract each other: a pair of equal masses on a circle of radius 1/2 turns with omega = sqrt(G M / r^3).
cat >pair.yaml <<'END'
skelfield: 1
gravity: {G: 2}
bodies: [{name: marker, iso: 1000, density: 0, kernel: {type: inverse}, skeleton: [{point: {at: [0, 0, 5]}}]}]
particles:
  - {name: a, mass: 0.25, position: [0.5, 0, 0], velocity: [0, 0.5, 0]}
  - {name: b, mass: 0.25, position: [-0.5, 0, 0], velocity: [0, -0.5, 0]}
  - {name: light, position: [0, 0, 1], velocity: [0, 0, 0]}
simulation: {t_end: 3.1415926535897931, output_every: 10, tolerance: 1.0e-12}
END
run simulate pair.yaml -o pair.csv
expect_status "particles with a mass" 0
expect_err "their energy is told" "energy of all particles with a mass together kept to ([0-9.]+e-1[5-9]|0)"
cp pair.csv "$kept/out"
expect_close "half a turn later" "$(field 5 3)" -0.5 1e-13
expect_close "the other one" "$(field 6 3)" 0.5 1e-13
expect_close "one without mass feels both" "$(awk -F, '$1 > 0 && $2 == "light" { print ($5 < -0.5 && $3 * $3 + $4 * $4 < 1e-24) }' pair.csv)" 1 0
# Softened: v^2 / (1/2) = G m r / (r^2 + softening^2)^(3/2) = 0.256 at r = 1.
sed 's/tolerance:/softening: 0.75, tolerance:/; s/\[0, 0.5, 0\]/[0, 0.35777087639996635, 0]/; s/\[0, -0.5, 0\]/[0, -0.35777087639996635, 0]/
  s/t_end: [0-9.]*/t_end: 4.390509206900454/' pair.yaml >soft.yaml
run simulate soft.yaml
expect_close "softened" "$(field 5 3)" -0.5 1e-13
sed 's/tolerance:/integrator: rkn12, tolerance:/' pair.yaml >alone.yaml
run simulate alone.yaml
expect_refused "a mass with another integrator" "alone.yaml:5: particles with a mass, but rkn12 flies them one by one, expected integrator gauss-radau"
sed 's/mass: 0.25/mass: -1/' pair.yaml >negative.yaml
run simulate negative.yaml
expect_refused "a negative mass" "negative.yaml:5: mass is -1, expected a finite number >= 0"
sed 's/mass: 0.25, //; s/tolerance:/softening: 0.1, tolerance:/' pair.yaml >massless.yaml
run simulate massless.yaml
expect_refused "a softening of nobody" "massless.yaml:8: softening, but no particle has a mass"
sed 's/tolerance:/softening: -1, tolerance:/' pair.yaml >hard.yaml
run simulate hard.yaml
expect_refused "a negative softening" "hard.yaml:8: softening is -1, expected a finite number >= 0"

# Closest approaches: straight past at a distance of 1 from r = 1/2, not yet there at t_end, and with a contact.
cat >past.yaml <<'END'
skelfield: 1
gravity: {G: 0}
bodies:
  - {name: ball, iso: 2, kernel: {type: inverse}, skeleton: [{point: {at: [0, 0, 0]}}], spin: {axis: [0, 0, 1], rate: 0.5}}
  - {name: other, iso: 2, kernel: {type: inverse}, skeleton: [{point: {at: [9, 0, 0]}}], spin: {axis: [0, 0, 1], rate: 0.5}}
particles:
  - {name: past, position: [-2, 1, 0], velocity: [1, 0, 0]}
  - {name: coming, position: [-6, 0, 1], velocity: [1, 0, 0]}
  - {name: touching, position: [0, 3, 0], velocity: [0, -1, 0]}
simulation: {t_end: 4, output_every: 4}
END
run simulate past.yaml -o run.csv --approach near.csv
expect_status "approaches are written" 0
cp near.csv "$kept/out"
expect_out "their header" '^particle,body,t,x,y,z,distance,level$'
expect_close "a row for each particle and body" "$(rows)" 6 0
expect_close "when it passes" "$(field 2 3)" 2 1e-14
expect_close "where" "$(field 2 5)" 1 1e-15
expect_close "how far, to first order" "$(field 2 7)" 1 1e-14
expect_close "at which level" "$(field 2 8)" -1 1e-14
expect_close "never later than t_end" "$(field 4 3)" 4 0
expect_close "nor further" "$(field 4 4)" -2 1e-15
expect_close "a contact is the closest" "$(field 6 3)" 2.5 1e-15
expect_close "at no distance" "$(field 6 7)" 0 0
run simulate past.yaml -o no-such-folder/run.csv --approach new.csv
expect_status "nothing is written where the rows cannot be" 1
expect_nothing_written "and no approaches"
run simulate past.yaml -o run.csv --approach turned.csv --frame body
cp turned.csv "$kept/out"
expect_close "in the frame of the body that turns" "$(field 2 4)" 0.84147098480789651 1e-13
run simulate past.yaml -o run.csv --approach again.csv --threads 1 --checkpoint past.kept
expect_same "one thread and a checkpoint change nothing" near.csv again.csv
run simulate past.yaml -o run.csv --approach run.csv
expect_refused "one file for rows and approaches" "--output and --approach name the same file"
for option in contacts approach; do
  run simulate past.yaml -o run.csv --$option ./past.yaml
  expect_refused "the scene as --$option" "--$option ./past.yaml is read, too, expected another file"
done
run simulate pair.yaml -o run.csv --approach near.csv
expect_refused "approaches of what has a mass" "pair.yaml:5: particle 'a' has a mass, expected none for --approach"

tap_done
