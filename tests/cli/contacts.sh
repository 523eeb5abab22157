# SPDX-License-Identifier: MIT
# skelfield simulate --contacts: every kernel and primitive is touched on its surface, inwards, and by nobody who has been
# inside before; every kind of contact; scales and odd runs.
. "$(dirname "$0")/harness.sh"

# scene L DIMENSION ISO KERNEL PARAMETER OUTCOME PRIMITIVE...: a body in units of length L (and times T = L, so that speeds
# stay), whose F has the dimension L^DIMENSION, and twelve shots at it from a distance 3 L.
scene() {
  local L=$1 dimension=$2 iso=$3 kernel=$4 parameter=$5 outcome=$6
  shift 6
  awk -v L="$L" -v n="$dimension" -v iso="$iso" -v kernel="$kernel" -v parameter="$parameter" -v outcome="$outcome" \
    -v list="$*" 'BEGIN {
      split(parameter, p, "=")
      print "skelfield: 1\ngravity: {G: 1}\nbodies:\n  - name: it"
      printf "    iso: %.17g\n    density: %.17g\n", iso * L ^ n, 0.1 * L ^ -n
      printf "    kernel: {type: %s%s}\n    skeleton:\n", kernel, parameter == "" ? "" : ", " p[1] ": " sprintf("%.17g", p[2] * (p[1] == "R" ? L : 1 / L))
      count = split(list, primitive, "; *")
      for (i = 1; i <= count; i++) { # numbers after @ are lengths
        line = primitive[i]
        while (match(line, /@[-.0-9]+/)) line = substr(line, 1, RSTART - 1) sprintf("%.17g", substr(line, RSTART + 1, RLENGTH - 1) * L) substr(line, RSTART + RLENGTH)
        print "      - " line
      }
      print "particles:"
      for (i = 0; i < 12; i++) { # all around, aimed a bit off the middle
        z = -1 + (i + 0.5) / 6; phi = 2.399963 * i; r = sqrt(1 - z * z)
        x = 3 * r * cos(phi); y = 3 * r * sin(phi); z = 3 * z
        a = 0.7 * sin(5 * i) - x; b = 0.7 * sin(3 * i + 1) - y; c = 0.5 * sin(7 * i + 2) - z; v = 0.6 / sqrt(a * a + b * b + c * c)
        printf "  - {name: p%d, position: [%.17g, %.17g, %.17g], velocity: [%.17g, %.17g, %.17g]}\n", i, L * x, L * y, L * z, v * a, v * b, v * c
      }
      printf "simulation: {t_end: %.17g, output_every: %.17g, contact: %s, restitution: 0.7, friction: 0.1}\n", 8 * L, L / 25, outcome
    }'
}

# level TABLE COLUMN: F at the points in three columns, after x,y,z
level() {
  awk -F, -v k="$2" 'NR == 1 { print "x,y,z"; next } { print $k "," $(k + 1) "," $(k + 2) }' "$1" >points.csv
  run eval now.yaml points.csv -o level.csv
}

# holds NAME ISO LEAST: now.yaml runs; at least LEAST contacts, all at F = ISO to rounding and inwards; no row is inside
# (before the contact, where the particle passes).
holds() {
  local name=$1 iso=$2 least=$3
  run simulate now.yaml -o run.csv --contacts hits.csv
  expect_status "$name: flown" 0
  expect "$name: at least $least contacts" [ "$(rows hits.csv)" -ge "$least" ]
  level hits.csv 4
  expect "$name: contacts are on the surface, inwards" awk -F, -v iso="$iso" 'FNR == 1 { next }
    NR == FNR { F[FNR] = $4; next }
    { d = F[FNR] / iso - 1; if (d > 1e-13 || d < -1e-13 || !($7 * $10 + $8 * $11 + $9 * $12 < 0)) bad = 1 } END { exit bad }' level.csv hits.csv
  level run.csv 3
  expect "$name: nobody is inside" awk -F, -v iso="$iso" 'FNR == 1 { file++; next }
    file == 1 { if (!($2 in met)) met[$2] = $1; if ($13 == "pass") passes = 1; next }
    file == 2 { F[FNR] = $4; next }
    !(passes && $2 in met && $1 >= met[$2]) && F[FNR] > iso * (1 + 1e-12) { bad = 1 } END { exit bad }' hits.csv level.csv run.csv
}

# world NAME LEAST DIMENSION ISO KERNEL PARAMETER OUTCOME PRIMITIVE...: it holds, and the same at 1e7 and 1e-7 of the scale
world() {
  local name=$1 least=$2
  shift 2
  scene 1 "$@" >now.yaml
  holds "$name" "$2" "$least"
  cp hits.csv one.csv
  local L
  for L in 1e7 1e-7; do
    scene "$L" "$@" >now.yaml
    run simulate now.yaml -o run.csv --contacts hits.csv
    expect "$name: the same contacts at a scale of $L" awk -F, -v L="$L" 'function off(a, b) { d = a - b; return d < 0 ? -d : d }
      FNR == 1 { next } NR == FNR { n++; who[n] = $2 $13; t[n] = $1; x[n] = $4; y[n] = $5; z[n] = $6; next }
      { m++; if ($2 $13 != who[m] || off($1 / L, t[m]) > 1e-9 || off($4 / L, x[m]) + off($5 / L, y[m]) + off($6 / L, z[m]) > 1e-9) bad = 1 }
      END { exit bad || n != m }' one.csv hits.csv
  done
}

cross='segment: {from: [@-2, 0, 0], to: [@2, 0, 0]}; segment: {from: [0, @-1.5, 0], to: [0, @1.5, 0]}'
ring='circle: {center: [0, 0, 0], normal: [0, 0, 1], radius: @1}'
blobs='point: {at: [0, 0, 0]}; point: {at: [@1, 0, 0]}; point: {at: [0, @0.8, @0.5]}'
world "an inverse ring" 3 0 7 inverse "" stop "$ring"
world "an inverse-squared cross" 5 -1 2.5 inverse-squared "" stick "$cross"
world "a Cauchy cross" 5 1 0.3 cauchy s=2 absorb "$cross"
world "a Gaussian triangle" 2 2 0.3 gaussian a=1.5 stop \
  'triangle: {vertices: [[@-1, @-1, 0], [@1, @-1, 0], [0, @1, 0]]}'
world "Gaussian blobs" 5 0 0.6 gaussian a=1.3 pass "$blobs"
world "metaballs" 5 0 0.4 metaball R=1 bounce "$blobs"
world "soft objects" 5 0 0.4 soft-object R=1.2 stop "$blobs"
world "a quartic arc" 5 1 0.4 quartic R=1.2 stick \
  'arc: {center: [0, 0, 0], normal: [1, 1, 0], start: [0, 0, 1], radius: @1, sweep: 250}'
world "a Cauchy plane" 5 2 3 cauchy s=1 stop 'plane: {through: [0, 0, 0], normal: [1, 0, 1]}'

# Iso below zero: a body around a hole, where F > iso is outside of r = 2. From within and from without.
write now.yaml <<'END'
skelfield: 1
gravity: {G: 0}
bodies: [{name: shell, iso: -0.5, kernel: {type: inverse}, skeleton: [{point: {at: [0, 0, 0], strength: -1}}]}]
particles:
  - {name: captive, position: [0.5, 0, 0], velocity: [1, 0, 0]}
  - {name: guest, position: [5, 0, 0], velocity: [-1, 0, 0]}
simulation: {t_end: 10, output_every: 10}
END
run simulate now.yaml --contacts hits.csv -o run.csv
expect_err "who starts in the body is told" "'guest' starts inside of body 'shell'"
expect_close "the captive meets the shell from within" "$(field 2 1 hits.csv)" 1.5 1e-14
expect_close "its normal points to the hole" "$(field 2 7 hits.csv)" -1 1e-15
expect_close "the guest meets it at the far side of the hole" "$(field 3 1 hits.csv)" 7 1e-14

# On the surface: inwards, outwards, along it too slowly and too fast for it, at rest, and without gravity at rest.
write now.yaml <<'END'
skelfield: 1
gravity: {G: 1}
bodies: [{name: sun, iso: 1, kernel: {type: inverse}, skeleton: [{point: {at: [0, 0, 0]}}]}]
particles:
  - {name: in, position: [1, 0, 0], velocity: [-0.5, 0.1, 0]}
  - {name: out, position: [1, 0, 0], velocity: [0.5, 0.1, 0]}
  - {name: slow, position: [0, 1, 0], velocity: [0.9, 0, 0]}
  - {name: fast, position: [0, 1, 0], velocity: [1.1, 0, 0]}
  - {name: rest, position: [0, 0, -1], velocity: [0, 0, 0]}
  - {name: escapes, position: [0, 0, 1], velocity: [0, 0, 2]}
simulation: {t_end: 8, output_every: 50}
END
run simulate now.yaml --contacts hits.csv -o run.csv
expect "contacts at the start" [ "$(awk -F, '$1 == 0 { printf "%s ", $2 }' hits.csv)" = "in slow rest " ]
expect "and later" [ "$(awk -F, '$1 > 0 && NR > 1 { printf "%s ", $2 }' hits.csv)" = "out " ]
expect_close "rows at 0 and t_end though output_every is longer" "$(rows run.csv)" 12 0
sed 's/G: 1/G: 0/' now.yaml >free.yaml
run simulate free.yaml --contacts hits.csv -o run.csv
expect "without gravity nothing falls" [ "$(awk -F, 'NR > 1 { printf "%s ", $2 }' hits.csv)" = "in " ]
sed 's/t_end: 8/t_end: 0/' now.yaml >short.yaml
run simulate short.yaml -o run.csv
expect_status "a run of no time" 0
expect_close "one row a particle" "$(rows run.csv)" 6 0

tap_done
