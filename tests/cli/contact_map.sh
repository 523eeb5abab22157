# SPDX-License-Identifier: MIT
# skelfield simulate --contact-map and --contact-bins: where contacts lie in the frame of the body that turns.
. "$(dirname "$0")/harness.sh"

scene() { # ellipsoid
  cat <<END
skelfield: 1
gravity: {G: 1}
bodies:
  - name: sun
    iso: 2
    kernel: {type: inverse}
    spin: {axis: [0, 0, 1], rate: 0.5}
    $1
    skeleton: [{point: {at: [0, 0, 0]}}]
  - {name: far, iso: 1, kernel: {type: inverse}, density: 0, skeleton: [{point: {at: [0, 0, 90]}}]}
particles:
  - {name: stone, position: [1, 0, 0], velocity: [0, 0, 0]}
  - {name: north, position: [0, 0, 1], velocity: [0, 0, 0]}
  - {name: moon, position: [0, 1, 0], velocity: [-1, 0, 0]}
simulation: {t_end: 1.25, output_every: 0.5, tolerance: 1.0e-12}
END
}
scene "" >fall.yaml

if ! has geographiclib; then
  run simulate fall.yaml -o run.csv --contact-bins bins.csv
  expect_status "there is no GeographicLib" 1
  expect_err "which is told" 'this build has no GeographicLib'
  expect_nothing_written "and nothing is written"
  tap_done
  exit
fi

run simulate fall.yaml -o run.csv --contact-bins bins.csv
expect_status "a table of bins" 0
expect "its header" [ "$(head -n 1 bins.csv)" = lat_min,lat_max,lon_min,lon_max,count,speed ]
counted() { awk -F, 'NR > 1 { n += $5 } END { print n }' "$1"; }
expect_close "two contacts" "$(counted bins.csv)" 2 0
# bin FILE LATITUDE LONGITUDE: count and mean speed there
bin() { awk -F, -v p="$2" -v l="$3" 'NR > 1 && p >= $1 && p < $2 && l >= $3 && l < $4 { print $5, $6 }' "$1"; }
pi=3.141592653589793
# It falls (pi/4 + 1/2) / sqrt 2 on ground that turns by half of that meanwhile: to -26.04 degrees.
read -r n speed <<<"$(bin bins.csv 0 "$(awk -v pi=$pi 'BEGIN { print -0.5 * (pi / 4 + 0.5) / sqrt(2) * 180 / pi }')")"
expect_close "the stone's bin" "$n" 1 0
expect_close "it meets the ground at sqrt(2 + (0.5 0.5)^2)" "$speed" 1.4361406616345072 1e-12
expect_close "the pole has a bin" "$(awk -F, 'NR > 1 && $1 == 85 { n += $5 } END { print n }' bins.csv)" 1 0
expect "bins make the sphere, all about equally large" awk -F, -v pi=$pi 'NR > 1 {
  a = (sin($2 * pi / 180) - sin($1 * pi / 180)) * ($4 - $3) * pi / 180; sum += a
  if (n++ == 0 || a < low) low = a
  if (a > high) high = a
} END { exit !(sum > 12.56637 && sum < 12.566371 && high / low < 1.35) }' bins.csv

scene "ellipsoid: {equatorial: 0.5, polar: 0.5, meridian: [0, 1, 0]}" >turned.yaml
run simulate turned.yaml -o run.csv --contact-bins turned.csv --map-step 10
read -r n speed <<<"$(bin turned.csv 0 -116)"
expect_close "the meridian of an ellipsoid" "$n" 1 0
run simulate fall.yaml -o run.csv --contact-bins far.csv --map-body far
expect_close "another body has none" "$(counted far.csv)" 0 0
sed 's/tolerance/contact: bounce, restitution: 0.9, tolerance/' fall.yaml >bounce.yaml
run simulate bounce.yaml -o run.csv --contact-bins bounces.csv --contacts hits.csv
expect_close "each bounce counts" "$(counted bounces.csv)" "$(rows hits.csv)" 0
run simulate bounce.yaml -o run.csv --contact-bins body.csv --frame body
expect_same "whatever frame the rows have" bounces.csv body.csv
run simulate bounce.yaml -o run.csv --contact-bins kept.csv --checkpoint kept.ckpt
expect_same "and from a journal" bounces.csv kept.csv

if has opencv; then
  for quantity in density speed; do
    run simulate fall.yaml -o run.csv --contact-map map.png --map-quantity $quantity
    expect_status "a picture of $quantity" 0
    expect "is a PNG" [ "$(head -c 8 map.png | od -An -tx1 | tr -d ' ')" = 89504e470d0a1a0a ]
  done
  run simulate fall.yaml -o run.csv --contact-map map.gif
  expect_refused "an unknown kind of picture" 'map.gif: unknown kind of picture'
else
  run simulate fall.yaml -o run.csv --contact-map map.png
  expect_status "without OpenCV there is no picture" 1
fi
rm -f new.csv
run simulate fall.yaml -o new.csv --contact-bins no-folder/bins.csv
expect_status "a table that cannot be written" 1
expect_nothing_written "and nothing else is"
for bad in "--map-step 7" "--map-step 0.1" "--map-quantity mass" "--map-body moon"; do
  run simulate fall.yaml -o new.csv --contact-bins new-bins.csv $bad
  expect_refused "$bad" '(--map-[a-z]+ [a-z0-9.]+: expected|no body is called .moon)'
done
run simulate fall.yaml -o new.csv --contact-bins new.csv
expect_refused "one file for two tables" '--output and --contact-bins name the same file'
run simulate fall.yaml -o new.csv --map-step 10
expect_refused "bins of nothing" '--map-step needs --contact-map or --contact-bins'
tap_done
