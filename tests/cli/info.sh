# SPDX-License-Identifier: MIT
# skelfield info: words and JSON.
. "$(dirname "$0")/harness.sh"

write scene.yaml <<'END'
skelfield: 1
gravity: {G: 2}
bodies:
  - name: "quoted \\ body"
    iso: 0.25
    kernel: {type: inverse}
    mass: 12
    spin: {axis: [0, 0, 1], rate: 0.5}
    skeleton:
      - segment: {from: [-1, 0, 0], to: [2, 0, 0], strength: 2}
      - point: {at: [0, 0, 0], kernel: {type: quartic, R: 3}}
  - name: floor
    iso: 1
    kernel: {type: cauchy, s: 1}
    mass: 1
    skeleton:
      - plane: {through: [0, 0, 0], normal: [0, 0, 1]}
particles:
  - {name: p, position: [1, 2, 3], velocity: [4, 5, 6]}
simulation: {t_end: 10, output_every: 1, contact: bounce, restitution: 0.5}
END
run info scene.yaml
expect_status "info works" 0
expect_out "bodies" '^body floor \(line 12\)$'
expect_out "primitives and measures" '1 point, 1 segment \(length 3\)'
expect_out "the sum of w mu" '^  measure +7 '
expect_out "mass, density, G M" '12 \(given\), density 1\.7142857.*G M = 24$'
expect_out "the surface is bounded" 'surface +F = 0.25: bounded, inside '
expect_out "or not" 'surface +F = 1: unbounded'
expect_out "the kernels" 'quartic, h\(r\) = .*R = 3'
expect_out "and how they are evaluated" 'on segment: closed form, relative error'
expect_out "spin" 'rate 0.5 about \[0, 0, 1\]'
expect_out "particles" '^particle p at \[1, 2, 3\] with velocity \[4, 5, 6\]'
expect_out "simulation" 'to t = 10, output every 1, .*contact bounce \(restitution 0.5'
expect_err "a mass on a plane is warned about" "scene.yaml:12: warning: body 'floor'"

run info scene.yaml --json
expect_status "JSON" 0
python=$(command -v python3) && "$python" -c pass 2>/dev/null || python=
if [ -n "$python" ]; then
  expect "it is JSON and says the same" "$python" - "$kept/out" <<'END'
import json, sys
s = json.load(open(sys.argv[1]))
a, b = s["bodies"]
assert s["G"] == 2 and a["name"] == "quoted \\ body" and a["GM"] == 24 and a["primitives"]["segment"]["measure"] == 3
assert a["surface_bounds"]["lo"][0] < -1 and a["surface_bounds"]["hi"][0] > 2
assert b["primitives"]["plane"]["measure"] is None and b["density"] == 0 and b["surface"] == "unbounded"
assert {(e["kernel"], e["primitive"]) for e in a["evaluation"]} == {("inverse", "segment"), ("quartic", "point")}
assert s["particles"][0]["velocity"] == [4, 5, 6] and s["simulation"]["contact"] == "bounce"
END
fi
expect_out "numbers carry 17 digits" '"density": 1.7142857142857142'
write ice.yaml <<'END'
skelfield: 1
materials:
  - {name: ice, kernel: {type: gaussian}, radius: 0.25, blobbiness: -0.3}
bodies:
  - name: icicle
    iso: 1
    material: ice
    skeleton:
      - point: {at: [0, 0, -0.85]}
      - segment: {from: [0, 0, 0], to: [0, 0, 4.5], kernel: {type: inverse}, blobbiness: -1}
END
run info ice.yaml
expect_refused "handles at odds" "ice.yaml:10: segment: this kernel has no parameter, expected radius alone"
sed -i 's/, kernel: {type: inverse}, blobbiness: -1//' ice.yaml
run info ice.yaml
expect_status "handles" 0
expect_out "what Blinn's handles give" 'handles +point \(line 9\): radius 0.25, blobbiness -0.3, influence .*: a = 2.19089.*, strength 1.349858808$'
expect_out "for each entry" '  segment \(line 10\): radius 0.25, '
run info ice.yaml --json
expect_out "in JSON, too" '"strength": 1.349858807576'

run info "$data/horn.yaml"
expect_out "profiles are counted" 'profiles +11 primitives'
expect_out "what is weighted weighs less" 'measure +15\.51023'
run simulate "$data/horn.yaml" -o horn.csv --contacts touch.csv
expect_status "a weighted body is flown to" 0
expect "and touched" eval '[ "$(wc -l <touch.csv)" = 2 ]'

write square.off <<'END'
OFF
4 1 0
0 0 0
1 0 0
1 1 0
0 1 0
4 0 1 2 3
END
write pieces.yaml <<'END'
skelfield: 1
bodies:
  - name: pieces
    iso: 1
    kernel: {type: cauchy, s: 1}
    skeleton:
      - circle: {center: [0, 0, 0], normal: [0, 0, 1], radius: 1}
      - polyline: {points: [[0, 0, 0], [1, 0, 0], [1, 2, 0]], closed: false}
      - polygon: {vertices: [[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 3, 0], [0, 3, 0]]}
      - mesh: {file: square.off}
END
run info pieces.yaml
expect_status "info of compounds" 0
expect_out "the pieces are counted" '2 segments \(length 3\), 1 arc \(length 6\.28318.*\), 6 triangles \(area 5\)'
mkdir below
mv pieces.yaml square.off below
run info below/pieces.yaml
expect_status "the mesh is beside the scene" 0
rm below/square.off
run info below/pieces.yaml
expect_refused "a mesh that is gone" 'below/pieces.yaml:10: mesh square.off: No such file'

run info scene.yaml --json -o info.json
expect_file "JSON in a file" info.json
run help scene
expect_out "the help knows the primitives" '^arc: circular'
expect_out "and what stands for several" '^polyline: segments'
expect_out "and the kernels" 'inverse-squared +1 / r\^2'
expect_out "solids" '^solid: homogeneous inside of a closed mesh'
run info "$data/pebble.yaml"
expect_out "solids are weighed" 'solid +642 vertices, 1280 faces, 1920 edges, 1 component; area 89287\.011, volume 1925580'
expect_out "their inertia" 'inertia about it: xx 5\.1535'
for name in "$data"/*.yaml; do
  run info "$name" --json
  expect_status "info ${name##*/}" 0
  expect_no_err "${name##*/} without a warning"
done
write none.yaml <<'END'
skelfield: 1
gravity: {G: 0}
bodies:
  - name: ground
    iso: 1
    kernel: {type: cauchy, s: 1}
    skeleton: [plane: {through: [0, 0, 0], normal: [0, 0, 1]}]
  - name: hole
    iso: -1
    kernel: {type: cauchy, s: 1}
    skeleton: [point: {at: [0, 0, 0], strength: -2}]
END
run info none.yaml
expect_status "a plane has no mass" 0
expect_out "it says so" '^  mass +no finite one, density 1$'
expect "and nothing that is no number" eval '! grep -qiE "nan" "$kept/out"'
expect_out "a body around its surface is bounded" 'F = -1: bounded, inside \[-0.64.*\], the body is around it$'
run info none.yaml --json
expect_out "in JSON, too" '"inside_unbounded": true'
tap_done
