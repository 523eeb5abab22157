# SPDX-License-Identifier: MIT
# skelfield render: modes, qualities, materials, films; light as numbers; what is refused.
. "$(dirname "$0")/harness.sh"

write ball.yaml <<'END_OF_SCENE'
skelfield: 1
materials:
  - {name: glass, transparency: 0.8, ior: 1.5}
bodies:
  - name: ball
    iso: 2
    kernel: {type: inverse}
    spin: {axis: [0, 0, 1], rate: 0.5}
    skeleton: [{point: {at: [0, 0, 0.5], color: [1, 0, 0]}}]
camera: {from: [4, 0, 0.5], to: [0, 0, 0.5], projection: orthographic, height: 2}
lights: [{direction: [1, 0, 0], angle: 0}]
background: [0, 0, 1]
animate:
  - {path: bodies.ball.iso, keys: [[0, 2], [1, 4]]}
END_OF_SCENE

refused() { # name, expected message, arguments...
  local name=$1 message=$2
  shift 2
  run "$@"
  expect_refused "$name" "$message"
}
refused "an unknown quality" '--quality best: expected normal, draft or fine' render ball.yaml -o a.png --quality best
refused "an unknown mode" '--mode wire: expected surface, offset or cost' render ball.yaml -o a.png --mode wire
refused "12 bits" '--depth 12: expected 8 or 16' render ball.yaml -o a.png --depth 12
refused "16 bits in a jpg" '--depth 16: .jpg has none, expected png or tif' render ball.yaml -o a.jpg --depth 16
refused "16 bits and marks" '--depth 16: expected no --contacts with it' render ball.yaml -o a.png --depth 16 --contacts a.csv
refused "a cost as light" '--mode cost: .exr holds light' render ball.yaml -o a.exr --mode cost
refused "a film on stdout" '--frames: a film is not written to stdout' render ball.yaml --frames 3
refused "half a frame" '--frames 2.5: expected a whole number' render ball.yaml -o a.avi --frames 2.5
refused "no frames" '--frames 0: expected a whole number from 2 to 100000' render ball.yaml -o a.avi --frames 0
refused "a speed without a film" '--fps: expected --frames with it' render ball.yaml -o a.png --fps 3
refused "a skeleton in offsets" '--skeleton with --mode offset' render ball.yaml -o a.png --skeleton --mode offset
refused "an angle of parallel rays" "--fov 30: the scene's camera is orthographic" render ball.yaml -o a.png --fov 30
sed 's/^animate.*/x: 1/; /path:/d; s/x: 1//; s/rate: 0.5/rate: 0/' ball.yaml >still.yaml

if ! has opencv; then # the rest draws
  tap_done
  exit
fi

refused "a film backwards" '--until 1: expected a time after --time' render ball.yaml -o a.avi --frames 3 --time 2 --until 1
refused "a film of nothing" '--frames 3: nothing moves, expected' render still.yaml -o a.png --frames 3
write photo.yaml <<'END_OF_SCENE'
skelfield: 1
materials:
  - {name: m, texture: {type: image, file: none.png}}
bodies:
  - {name: a, iso: 1, kernel: {type: inverse}, material: m, skeleton: [{point: {at: [0, 0, 0]}}]}
END_OF_SCENE
refused "a picture that is not there" 'photo.yaml:3: ./none.png: No such file or directory, expected a picture' render photo.yaml -o a.png --size 20x20

mkfifo none.png
refused "a pipe as a picture" 'photo.yaml:3: ./none.png: not a regular file' render photo.yaml -o a.png --size 20x20
rm none.png
echo none >none.png
refused "text as a picture" 'photo.yaml:3: ./none.png: not a picture' render photo.yaml -o a.png --size 20x20

# numbers FILE.pfm: red and blue of each pixel, rows from the bottom as the format has them
numbers() { tail -c $((12 * $2)) "$1" | od -An -v -tf4 -w12 | awk '{ print $1, $3 }'; }
run render ball.yaml -o ball.pfm --size 100x100 --spp 1
expect_status "light as numbers" 0
expect_close "a ball of radius 1/2 in a picture of height 2 has pi 25^2 pixels" \
  "$(numbers ball.pfm 10000 | awk '$2 < 0.9 { n++ } END { print n }')" 1963.5 0.01
run render ball.yaml -o later.pfm --size 100x100 --spp 1 --time 0.5
expect_close "half way its iso is 3" "$(numbers later.pfm 10000 | awk '$2 < 0.9 { n++ } END { print n }')" 872.7 0.02
run render ball.yaml -o hard.pfm --size 100x100 --spp 1 --mode offset
expect_close "the offset of a point is the same ball" \
  "$(numbers hard.pfm 10000 | awk '$2 < 0.9 { n++ } END { print n }')" 1963.5 0.01
paste <(numbers ball.pfm 10000) <(numbers hard.pfm 10000) | awk '{ d = $1 - $3; if (d < 0) d = -d; if (d > most) most = d } END { exit !(most < 1e-4) }'
expect "with the same light on it" [ $? -eq 0 ]
run render ball.yaml -o draft.pfm --size 100x100 --quality draft
expect "a draft is lit from the front as brightly" awk -v a="$(numbers draft.pfm 10000 | sed -n 5050p | cut -d' ' -f1)" 'BEGIN { exit !(a > 0.9 && a < 1.4) }' </dev/null

run render ball.yaml -o deep.png --size 32x24 --depth 16
expect_status "16 bits" 0
expect "are 16" [ "$(od -An -tu1 -j24 -N1 deep.png | tr -d ' ')" = 16 ]
run render ball.yaml -o light.exr --size 32x24
expect "EXR is written" [ "$(od -An -tx1 -N4 light.exr | tr -d ' ')" = 762f3101 ]
run render ball.yaml -o cost.png --size 160x120 --mode cost
expect_status "the cost map" 0
run render ball.yaml -o skeleton.png --size 60x40 --skeleton
expect_status "the skeleton inside" 0

run render ball.yaml -o film.png --size 40x30 --frames 3 --turntable --threads 2
expect_status "a film in pictures" 0
expect "three of them" test -s film-0001.png -a -s film-0003.png -a ! -e film-0004.png
cmp -s film-0001.png film-0003.png
expect "which differ" [ $? -eq 1 ]
cp film-0003.png third.png
run render ball.yaml -o film.png --size 40x30 --frames 3 --turntable --threads 1
expect_same "the same with one thread" film-0003.png third.png
run render ball.yaml -o film.avi --size 40x30 --frames 4 --fps 10
expect_status "a film in one file" 0
expect "an AVI" [ "$(head -c 4 film.avi)$(dd if=film.avi bs=1 skip=8 count=3 2>/dev/null)" = RIFFAVI ]
expect "whose size is right" [ "$(od -An -tu4 -j4 -N4 film.avi | tr -d ' ')" -eq $(($(wc -c <film.avi) - 8)) ]
expect "of four pictures" [ "$(od -An -tu4 -j48 -N4 film.avi | tr -d ' ')" -eq 4 ]
jpeg=$(od -An -v -tx1 -w4 -j224 -N12 film.avi | tr -d ' \n')
expect "the first of them a JPEG" [ "${jpeg:0:8}${jpeg:16:4}" = 30306463ffd8 ]
printf 't,particle,x,y,z,vx,vy,vz\n0,a,0,2,0,0,0,0\n2,a,0,-2,0,0,-4,0\n' >run.csv
run render still.yaml -o fly.ppm --size 40x40 --frames 3 --orbits run.csv
expect_status "a film of particles" 0

# place FILE.pfm: the mean column, and row from below, of what is not background
place() { numbers "$1" 10000 | awk '$2 < 0.9 { n++; x += (NR - 1) % 100; y += int((NR - 1) / 100) } END { print x / n, y / n }'; }
moved() { # name, time, columns and rows that the ball has moved
  run render still.yaml -o moved.pfm --size 100x100 --quality draft --bodies bodies.csv --time "$2"
  expect_status "$1" 0
  expect "$1: where it is" awk -v a="$(place still.pfm)" -v b="$(place moved.pfm)" -v x="$3" -v y="$4" \
    'BEGIN { split(a, p); split(b, q); dx = q[1] - p[1] - x; dy = q[2] - p[2] - y; exit !(dx * dx + dy * dy < 0.01) }' </dev/null
}
header=t,body,x,y,z,qw,qx,qy,qz,vx,vy,vz,wx,wy,wz
run render still.yaml -o still.pfm --size 100x100 --quality draft
printf '%s\n0,ball,1,2,3,1,0,0,0,0,0.25,0,0,0,0\n2,ball,1,2.5,3,1,0,0,0,0,0.25,0,0,0,0\n' $header >bodies.csv
moved "a body that moves, half way" 1 12.5 0
moved "at its end" 9 25 0
printf '%s\n0,ball,0,0,0,1,0,0,0,0,0,0,0.7853981633974483,0,0\n2,ball,0,0,0,0.7071067811865476,0.7071067811865476,0,0,0,0,0,0.7853981633974483,0,0\n' $header >bodies.csv
moved "a body that turns" 2 -25 -25
moved "half way" 1 -17.6777 -7.3223
printf '%s\n0,ball,0,0,0,1,0,0,0,0,0,0,3.1415926535897931,0,0\n2,ball,0,0,0,1,0,1e-12,0,0,0,0,3.1415926535897931,0,0\n' $header >bodies.csv
moved "one whole turn from row to row, a quarter of the way" 0.5 -25 -25
printf '%s\n0,ball,0,0,0,1,0,0,0,0,0,0,3.9269908169872414,0,0\n2,ball,0,0,0,-0.7071067811865476,-0.7071067811865476,0,0,0,0,0,3.9269908169872414,0,0\n' $header >bodies.csv
moved "that turns more than once, after a whole turn" 1.6 0 0
run render still.yaml -o bodies.ppm --size 40x40 --frames 3 --quality draft --bodies bodies.csv
expect_status "a film of bodies" 0
cmp -s bodies-0001.ppm bodies-0002.ppm
expect "which moves" [ $? -eq 1 ]
printf '%s\n0,bell,0,0,0,1,0,0,0,0,0,0,0,0,0\n' $header >bodies.csv
refused "rows of another scene" 'bodies.csv:2: a body that the scene does not have, expected a run of this scene' render still.yaml -o a.png --bodies bodies.csv
printf '%s\n0,ball,0,0,0,1,1,0,0,0,0,0,0,0,0\n' $header >bodies.csv
refused "no attitude" 'bodies.csv:2: an attitude that is no unit quaternion' render still.yaml -o a.png --bodies bodies.csv
printf '%s\n1,ball,0,0,0,1,0,0,0,0,0,0,0,0,0\n1,ball,0,0,0,1,0,0,0,0,0,0,0,0,0\n' $header >bodies.csv
refused "a time twice" 'bodies.csv:3: a time that is not after' render still.yaml -o a.png --bodies bodies.csv
refused "rows of particles" 'run.csv:1: this is not its header' render still.yaml -o a.png --bodies run.csv
tap_done
