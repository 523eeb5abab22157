# SPDX-License-Identifier: MIT
# skelfield mesh: every format, bodies, edges, refusals.
. "$(dirname "$0")/harness.sh"

write two.yaml <<'END'
skelfield: 1
bodies:
  - name: ball
    iso: 0.5
    kernel: {type: inverse}
    skeleton:
      - point: {at: [0, 0, 0]}
  - name: rod
    iso: 0.3
    kernel: {type: cauchy, s: 2}
    skeleton:
      - segment: {from: [6, 0, -1], to: [6, 0, 1]}
END

run mesh two.yaml -o /dev/null --edge 1
expect_status "a device needs no ending" 0

for ending in ply obj off stl; do
  run mesh two.yaml -o two.$ending --edge 0.3
  expect_status "a mesh as $ending" 0
  expect_file "it is there" two.$ending
  expect_no_out "stdout stays empty"
  expect_err "the figures are said" '^ball: [0-9]+ triangles, .* 1 component, genus 0'
  run validate two.$ending --json
  expect_status "it is sound" 0
  expect_out "it has both bodies" '"components": *2'
done

run mesh two.yaml --edge 0.3
expect_status "without -o" 0
expect_same "PLY goes to stdout" out two.ply
run mesh two.yaml -o two.vtk
expect_refused "an unknown ending" 'two.vtk: .*expected .ply'
run mesh two.yaml -o a.ply --edge 0
expect_refused "an edge of zero" '.*edge'
run mesh two.yaml -o a.ply --edge nan
expect_refused "an edge that is no number" '.*edge'
run mesh two.yaml -o a.ply --body moon
expect_refused "an unknown body" ".*'moon'"

run mesh two.yaml -o one.off --body ball --threads 1
expect_status "one body, one thread" 0
run mesh two.yaml -o other.off --body ball --threads 3
expect_same "threads do not change the mesh" one.off other.off
awk 'FNR == 3 { r = sqrt($1 * $1 + $2 * $2 + $3 * $3); exit !(r > 2 - 1e-14 && r < 2 + 1e-14) }' one.off
check "a vertex is on the sphere" [ $? = 0 ]

run mesh two.yaml -o a.ply --edge 1e-9
expect_status "too fine an edge fails" 1
expect_err "it says why" "body 'ball': an edge of 1e-09 makes more triangles"
expect_nothing_written "and writes nothing"

run mesh two.yaml -o a.ply --edge 1e9
expect_status "too coarse an edge fails" 1
expect_err "it blames the edge" "body 'ball': an edge of 1e.09 finds no surface"
sed 's/iso: 0.3$/iso: 100/' two.yaml >none.yaml
run mesh none.yaml -o a.ply --body rod
expect_status "no surface fails" 1
expect_err "it says why" "body 'rod': there is no surface"
write plane.yaml <<'END'
skelfield: 1
bodies:
  - name: ground
    iso: 0.5
    kernel: {type: gaussian, a: 1}
    skeleton:
      - plane: {through: [0, 0, 0], normal: [0, 0, 1]}
END
run mesh plane.yaml -o a.ply
expect_status "an endless surface fails" 1
expect_err "it says why" "body 'ground': .*reaches to infinity"
expect_nothing_written "and writes nothing"


# The surface is a sphere; it is the outside, F < iso, that it encloses.
write hole.yaml <<'END'
skelfield: 1
bodies:
  - name: hole
    iso: -1
    kernel: {type: cauchy, s: 1}
    skeleton: [point: {at: [0, 0, 0], strength: -2}]
END
run mesh hole.yaml -o hole.off
expect_status "a body around its surface" 0
expect_err "its mesh encloses the outside" 'area 5\.2.*, volume -1\.11'
sed 's/-2}/2}/' hole.yaml >above.yaml
run mesh above.yaml -o a.ply
expect_status "no surface below 0 fails" 1
expect_err "it says why" "body 'hole': there is no surface, F is above iso = -1 everywhere"
write far.yaml <<'END'
skelfield: 1
bodies:
  - name: two
    iso: 0.5
    kernel: {type: quartic, R: 1}
    skeleton:
      - point: {at: [0, 0, 0]}
      - point: {at: [100000, 0, 0]}
END
for edge in "" "--edge 0.05"; do
  run mesh far.yaml -o far.off $edge
  expect_status "parts far apart ${edge:-by default}" 0
  expect_err "both are there" '2 components, genus 0'
  expect_err "their volume is right" 'volume 1\.32'
done

mkdir below
cp one.off below/ball.off
write below/solid.yaml <<'END'
skelfield: 1
bodies:
  - name: solid
    iso: 1
    skeleton: [{solid: {file: ball.off}}]
END
run mesh below/solid.yaml -o below/ball.off
expect_refused "the mesh that a scene names" "--output below/ball.off is read, too, expected another file"
cmp -s one.off below/ball.off
check "it is as it was" [ $? = 0 ]
tap_done
