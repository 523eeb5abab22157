# SPDX-License-Identifier: MIT
# skelfield validate: defects that were planted in meshes and skeletons are found, and nothing else.
. "$(dirname "$0")/harness.sh"

# An octahedron, with the faces (one a line) on stdin; extra vertices as arguments "x y z".
octahedron() {
  local faces extra=("$@")
  faces=$(cat)
  printf 'OFF\n%d %d 0\n' $((6 + ${#extra[@]})) "$(wc -l <<<"$faces")"
  printf '1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n'
  for p in "${extra[@]}"; do echo "$p"; done
  echo "$faces"
}
whole='3 0 2 4
3 2 1 4
3 1 3 4
3 3 0 4
3 2 0 5
3 1 2 5
3 3 1 5
3 0 3 5'
# defect NAME CHECK...: the last run failed just these checks.
defect() {
  local name=$1 want got
  shift
  want=$(printf '%s\n' "$@" | sort)
  got=$(sed -nE 's/^  FAIL  (.{22}).*/\1/p' "$kept/out" | sed 's/ *$//' | sort)
  expect "$name: status 1" [ "$ran_status" -eq 1 ]
  expect "$name: just $(echo $want)" [ "$got" = "$want" ]
}

octahedron <<<"$whole" >good.off
run validate good.off
expect_status "an octahedron is sound" 0
expect_out "its volume is known" 'volume +1\.33333333 '
expect_out "its genus is 0" 'genus +0$'

octahedron <<<"${whole%$'\n'*}" >hole.off
run validate hole.off
defect "a hole" closed outwards

octahedron <<<"${whole/3 0 3 5/3 3 0 5}" >flipped.off
run validate flipped.off
defect "a flipped face" oriented outwards

octahedron <<<"$whole"$'\n3 0 2 4' >duplicate.off
run validate duplicate.off
expect_status "a duplicate face" 1
expect_out "it is found" 'FAIL +no duplicates +1 '

octahedron "9 9 9" <<<"$whole" >unused.off
run validate unused.off
expect_status "an unused vertex is no defect" 0
expect_out "but noted" 'note +unused vertices +1 '

octahedron "2 2 0" <<<"$whole"$'\n3 0 2 6' >fin.off
run validate fin.off
expect_status "a fin on an edge" 1
expect_out "its edge is not manifold" 'FAIL +manifold +1 edges'
expect_out "it has a border" 'FAIL +closed +2 edges'

# Turned inside out.
octahedron <<<"$(awk '{ print $1, $2, $4, $3 }' <<<"$whole")" >inside.off
run validate inside.off
expect_status "inside out" 1
expect_out "it is found" 'FAIL +outwards .*clockwise'

# Two octahedra that pierce each other.
{
  printf 'OFF\n12 16 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n'
  printf '1.5 0.1 0.2\n-0.5 0.1 0.2\n0.5 1.1 0.2\n0.5 -0.9 0.2\n0.5 0.1 1.2\n0.5 0.1 -0.8\n'
  echo "$whole"
  awk '{ print $1, $2 + 6, $3 + 6, $4 + 6 }' <<<"$whole"
} >pierced.off
run validate pierced.off
defect "two that pierce each other" "no self-intersections"

# Two octahedra that share one vertex.
{
  printf 'OFF\n11 16 0\n1 0 0\n-1 0 0\n0 1 0\n0 -1 0\n0 0 1\n0 0 -1\n3 0 0\n2 1 0\n2 -1 0\n2 0 1\n2 0 -1\n'
  echo "$whole"
  awk 'function f(i) { return i == 0 ? 6 : i == 1 ? 0 : i + 5 } { print $1, f($2), f($3), f($4) }' <<<"$whole"
} >touch.off
run validate touch.off
expect_status "a vertex with two fans" 1
expect_out "it is found" 'FAIL +manifold .* 1 vertices with several fans'

octahedron "0.5 0.5 0" <<<"${whole/3 0 2 4/3 0 6 4}"$'\n3 6 2 4\n3 0 2 6' >degenerate.off
run validate degenerate.off
expect_status "a face without area" 1
expect_out "it is found" 'FAIL +no degenerate faces +1 '

run validate flipped.off --json
expect_status "JSON has the status too" 1
expect_out "it says so" '"ok": *false'

printf 'OFF\n3 1 0\n0 0 0\n1 0 0\n0 nan 0\n3 0 1 2\n' >nan.off
run validate nan.off
expect_refused "a mesh that is not finite" 'nan.off:5: .*finite'
printf 'OFF\n3 1 0\n0 0 0\n' >cut.off
run validate cut.off
expect_refused "a mesh that is cut short" 'cut.off:4: .*ends after 1 of 3 vertices'
run validate nothing.ply
expect_refused "a mesh that is not there" 'nothing.ply: cannot open'

write scene.yaml <<'END'
skelfield: 1
bodies:
  - name: cross
    iso: 0.35
    kernel: {type: cauchy, s: 2.5}
    skeleton:
      - segment: {from: [-2, 0, 0], to: [2, 0, 0]}
      - segment: {from: [0, -2, 0], to: [0, 2, 0]}
END
run validate scene.yaml --edge 0.1
expect_status "a cross is sound" 0
expect_out "rays agree, or there is no CGAL" '(ok +rays .* 0 disagree|note +no CGAL)'
expect_out "volumes agree" 'ok +volume '
expect_out "vertices are on the surface" 'ok +on the surface '

sed 's/from: \[0, -2, 0\], to: \[0, 2, 0\]/from: [2, 0, 0], to: [-2, 0, 0]/' scene.yaml >twice.yaml
run validate twice.yaml --edge 0.1
defect "a segment twice" "no duplicates"
expect_out "its lines are named" 'lines 7 and 8'
sed 's/from: \[0, -2, 0\], to: \[0, 2, 0\]/from: [1, 0, 0], to: [3, 0, 0]/' scene.yaml >shared.yaml
run validate shared.yaml --edge 0.1
defect "segments that share a length" "segments apart"
cat >plates.yaml <<'END'
skelfield: 1
bodies:
  - name: plates
    iso: 0.2
    kernel: {type: cauchy, s: 2}
    skeleton:
      - triangle: {vertices: [[0, 0, 0], [2, 0, 0], [0, 2, 0]]}
      - triangle: {vertices: [[0.25, 0.25, 0], [3, 0.25, 0], [0.25, 3, 0]]}
END
run validate plates.yaml --edge 0.3
expect_out "triangles overlap, or there is no CGAL" '(FAIL +triangles apart .*lines 7 and 8|note +no CGAL)'
sed 's/\[0.25, 0.25, 0\], \[3, 0.25, 0\], \[0.25, 3, 0\]/[2, 0, 0], [2, 2, 0], [0, 2, 0]/' plates.yaml >fine.yaml
run validate fine.yaml --edge 0.3
expect_status "triangles that share an edge are sound" 0

# Surfaces without a mesh fail their check; the others are reported, one JSON object or text.
write some.yaml <<'END'
skelfield: 1
bodies:
  - name: ball
    iso: 0.5
    kernel: {type: cauchy, s: 1}
    skeleton: [point: {at: [0, 0, 0]}]
  - name: ground
    iso: 1
    kernel: {type: cauchy, s: 1}
    skeleton: [plane: {through: [0, 0, 0], normal: [0, 1, 0]}]
  - name: high
    iso: 5
    kernel: {type: cauchy, s: 1}
    skeleton: [point: {at: [0, 0, 0]}]
  - name: hole
    iso: -1
    kernel: {type: cauchy, s: 1}
    skeleton: [point: {at: [0, 0, 0], strength: -2}]
END
run validate some.yaml --edge 0.1
expect_status "surfaces without a mesh" 1
expect_out "an endless one" 'FAIL +meshed +.*reaches to infinity'
expect_out "one that is not there" 'FAIL +meshed +there is no surface'
expect "and nothing else fails" [ "$(grep -c '^  FAIL' "$kept/out")" = 2 ]
expect_out "the others are reported" '^surface of hole, F = -1, '
expect_out "a body around its surface is turned over" 'note +turned over'
run validate some.yaml --edge 0.1 --json
expect_status "as JSON" 1
expect_no_err "without talk"
expect_out "it says so" '"ok": *false'
expect_out "the check is there" '"name": *"meshed"'
expect_out "and the others" '"title": *"surface of hole, F = -1, '

# A gap of 0.061 that the mesh bridges.
write gap.yaml <<'END'
skelfield: 1
bodies:
  - name: gap
    iso: 0.4
    kernel: {type: cauchy, s: 2}
    skeleton:
      - segment: {from: [-1, 0, 0], to: [1, 0, 0]}
      - point: {at: [0, 1, 0], strength: 0.6}
END
for edge in 0.2 0.15; do
  run validate gap.yaml --edge $edge
  expect_status "a gap that is bridged at $edge" 1
  expect_out "it is found" 'FAIL +faces follow it +[1-9]'
done
run validate gap.yaml --edge 0.1
expect_status "a gap that is resolved" 0
expect_out "there are two parts" 'components +2$'

# A quadrature over the whole box would tell nothing.
write far.yaml <<'END'
skelfield: 1
bodies:
  - name: two
    iso: 0.5
    kernel: {type: quartic, R: 1}
    skeleton: [point: {at: [0, 0, 0]}, point: {at: [1000, 0, 0]}]
END
run validate far.yaml
expect_status "parts far apart are sound by default" 0
expect_close "the volume is that of two balls" "$(sed -nE 's/^ +volume by quadrature +([0-9.]+) .*/\1/p' "$kept/out")" 1.327917 3e-3
run validate far.yaml --edge 0.83
expect_status "too coarse a mesh of them is not" 1
tap_done
