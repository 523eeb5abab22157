# SPDX-License-Identifier: MIT
# The worlds in data/ are what their first lines say they are.
. "$(dirname "$0")/harness.sh"

# shape WORLD EDGE COMPONENTS GENUS VOLUME: of a coarse mesh, which lies inside by a few percent
shape() {
  run mesh "$data/$1.yaml" --edge "$2" -o "$1.ply"
  expect_status "$1 is meshed" 0
  expect_err "$1 has $3 pieces and $4 holes" "; $3 components?, genus $4"
  expect_close "volume of $1" "$(sed -nE 's/.*volume ([0-9.e+]+);.*/\1/p' "$kept/err")" "$5" 0.06
}
shape donut 6e5 1 1 8.72497e20
shape cigar 1e6 1 0 5.08938e21   # 4/3 pi 15e6 9e6^2
shape cross 6e5 1 0 6.548526e20
shape eros 900 1 0 2.503e12
shape kleopatra 6000 1 0 8.76798e14 # of a ball of 118.75 km
shape gaussian 0.1 1 0 2.41715   # of a ball of radius sqrt(ln 2)
shape icicle 0.12 2 0 2.24
shape starfish 0.15 1 0 5.5
shape horn 0.08 1 0 0.744944

# reaches WORLD DIRECTION DISTANCE TOLERANCE: where a ray from far away meets the ground
reaches() {
  awk -v d="$2" 'BEGIN { split(d, v, " "); print "ox,oy,oz,dx,dy,dz"
    printf "%.17g,%.17g,%.17g,%.17g,%.17g,%.17g\n", 1e9 * v[1], 1e9 * v[2], 1e9 * v[3], -v[1], -v[2], -v[3] }' >rays.csv
  run trace "$data/$1.yaml" rays.csv --first
  expect_close "$1 towards $2" "$(awk -F, 'NR == 2 { printf "%.17g", sqrt($3 ^ 2 + $4 ^ 2 + $5 ^ 2) }' "$kept/out")" "$3" "$4"
}
reaches donut "1 0 0" 11608440.42 1e-8
reaches cigar "1 0 0" 1.5e7 1e-12
reaches cigar "0 0.6 0.8" 9e6 1e-12
reaches cross "0 -1 0" 1.015e7 1e-6
reaches cross "0 0 1" 3.943202e6 1e-6
reaches cross "0.70710678118654752 0.70710678118654752 0" 5.235394e6 1e-6
reaches eros "1 0 0" 14330.643 1e-6
reaches eros "0 0 1" 6457.334 1e-6
reaches kleopatra "1 0 0" 110e3 2e-3

# flies WORLD CONTACTS: the orbits keep what they have to keep
flies() {
  run simulate "$data/$1.yaml" -o "$1.csv" --contacts "$1.contacts.csv" --json
  expect_status "$1 is flown" 0
  kept_to() { awk -F'[:,]' '/_drift/ && $2 !~ /null/ { n++; if (!($2 < 1e-12)) bad = 1 } END { exit bad || !n }' "$kept/out"; }
  expect "$1 keeps its invariants to 1e-12" kept_to
  local touched
  touched=$(awk -F, 'NR > 1 { printf "%s%s", (NR > 2 ? " " : ""), $2 }' "$1.contacts.csv")
  expect "$1 is touched by: ${2:-nobody}" [ "$touched" = "$2" ]
  local other
  for other in rkn12 dop853; do
    sed -E "s/^simulation: \\{(.*)tolerance: [^,]*/simulation: {integrator: $other, \\1tolerance: 1.0e-12/" "$data/$1.yaml" >"$1-$other.yaml"
    run simulate "$1-$other.yaml" -o "$1-$other.csv"
    expect "$1 ends where $other at 1e-12 ends, to 1e-10 of its distance" agree "$1.csv" "$1-$other.csv"
  done
}

# agree A B: the particles of two runs end at the same places
agree() {
  awk -F, '!/^[0-9]/ { next } FNR == NR { x[$2] = $3; y[$2] = $4; z[$2] = $5; next } { u[$2] = $3; v[$2] = $4; w[$2] = $5 }
    function norm(a, b, c) { return sqrt(a * a + b * b + c * c) }
    END { for (p in x) { n++; if (!(norm(x[p] - u[p], y[p] - v[p], z[p] - w[p]) <= 1e-10 * norm(x[p], y[p], z[p]))) bad = 1 }
      exit bad || !n }' "$1" "$2"
}
if has geographiclib; then # these launch a particle from the ground
  flies donut "stone jumper"
  flies cigar jumper
  flies eros boulder
fi
flies cross stone
flies kleopatra ""
flies gaussian ""
flies coil ""

if has geographiclib; then
  # The bow comes back to its start after half of the flight; the stone on the axis never leaves it.
  expect_close "the bow returns" "$(awk -F, '$2 == "bow" { d = $1 - 22156.628; if (d < 0) d = -d
    if (!n++ || d < best) { best = d; x = $3 } } END { print x }' donut.csv)" 1.8e7 2e-3
  expect "the fall stays on the axis" awk -F, '$2 == "faller" && ($3 != 0 || $4 != 0) { exit 1 }' donut.csv
fi
tap_done
