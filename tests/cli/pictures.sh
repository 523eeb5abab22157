# SPDX-License-Identifier: MIT
# skelfield map and render: samples against eval, what is refused, sizes, the same picture for any number of threads.
. "$(dirname "$0")/harness.sh"

write ball.yaml <<'END'
skelfield: 1
gravity: {G: 2}
bodies:
  - {name: ball, iso: 2, kernel: {type: inverse}, skeleton: [{point: {at: [0, 0, 0.5]}}]}
END

# Numbers need no drawing module.
run map ball.yaml --csv grid.csv --plane x=0.25 --size 40x30 --extent=-1,3,0,3
expect_status "samples alone" 0
expect_no_out "no picture is made then"
expect "their header" grep -qx 'x,y,z,F' grid.csv
expect_close "one for each pixel" "$(rows grid.csv)" 1200 0
expect_close "rows start at the upper left" "$(field 2 2 grid.csv)" -0.95 1e-14
expect_close "with the highest" "$(field 2 3 grid.csv)" 2.95 1e-14
cut -d, -f1-3 grid.csv >points.csv
run eval ball.yaml points.csv
cut -d, -f4 "$kept/out" >want.csv
cut -d, -f4 grid.csv | cmp -s - want.csv
expect "they are what eval gives" [ $? -eq 0 ]
run map ball.yaml --csv u.csv --quantity potential --size 40x30 --extent=-1,3,0,3 --plane x=0.25
expect_close "the potential is -G rho F" "$(field 100 4 u.csv)" "$(awk -v F="$(field 100 4 grid.csv)" 'BEGIN { printf "%.17g", -2 * F }')" 1e-15
run map ball.yaml --csv a.csv --quantity acceleration --size 40x30 --extent=-1,3,0,3 --plane x=0.25
expect_close "the acceleration is G rho |grad F|" "$(field 100 4 a.csv)" "$(awk -v F="$(field 100 4 grid.csv)" 'BEGIN { printf "%.17g", 2 * F * F }')" 1e-14

refused() { # name, expected message, arguments...
  local name=$1 message=$2
  shift 2
  run "$@"
  expect_refused "$name" "$message"
}
refused "an unknown kind of picture" 'map.gif: unknown kind of picture, expected a name that ends in .png' map ball.yaml -o map.gif
refused "one file for picture and samples" "--output and --csv name the same file" map ball.yaml -o map.png --csv ./map.png
printf 't,particle,x,y,z,vx,vy,vz\n0,a,1,0,0,0,0,0\n' >path.csv
refused "samples in the place of the paths" "--csv path.csv is read, too, expected another file" map ball.yaml --csv path.csv --orbits path.csv
refused "a picture without an ending" 'map: unknown kind' render ball.yaml -o map
refused "a map as light" 'map.exr: this format holds light' map ball.yaml -o map.exr
refused "a slanted plane" '--plane w=0: expected' map ball.yaml -o a.png --plane w=0
refused "a plane at NaN" '--plane z=nan: expected' map ball.yaml -o a.png --plane z=nan
refused "another quantity" '--quantity mass: expected F, potential or acceleration' map ball.yaml -o a.png --quantity mass
refused "an extent inside out" '--extent 1,0,0,1: expected X0,X1,Y0,Y1' map ball.yaml -o a.png --extent 1,0,0,1
refused "half an extent" '--extent 1,2: expected 4 finite numbers' map ball.yaml -o a.png --extent 1,2
refused "a range inside out" '--range 2,1: expected LO,HI' map ball.yaml -o a.png --range 2,1
refused "a logarithm of 0" '--range 0,1: expected LO,HI with 0 < LO' map ball.yaml -o a.png --log --range 0,1
refused "half a pixel" '--every 0.5: expected' map ball.yaml -o a.png --every 0.5
refused "too many levels" '--levels 1000: expected a whole number from 0 to 60' map ball.yaml -o a.png --levels 1000
for size in 10x10 800 800x x600 800x600x2 1e3x1e3 -800x600 99999x99999 ''; do
  refused "the size '$size'" "--size $size: expected WIDTHxHEIGHT" render ball.yaml -o a.png --size "$size"
done
refused "levels below 0" '--levels -3: expected a whole number from 0 to 60' map ball.yaml -o a.png --levels -3
refused "no rays" '--spp 0: expected a whole number from 1 to 4096' render ball.yaml -o a.png --spp 0
refused "half a ray" '--spp 1.5: expected a whole number' render ball.yaml -o a.png --spp 1.5
refused "too wide a view" '--fov 180: expected degrees' render ball.yaml -o a.png --fov 180
refused "a camera at what it looks at" 'the camera looks nowhere' render ball.yaml -o a.png --from 1,2,3 --to 1,2,3
refused "a missing run" 'none.csv: No such file' map ball.yaml -o a.png --orbits none.csv
printf 't,particle,x,y,z,vx,vy,vz\n0,a,0,0,1,0,0,0\n1,a,0,0\n' >short.csv
refused "a short row" 'short.csv:3: too few columns, expected' map ball.yaml -o a.png --orbits short.csv
printf 't,particle,x,y,z,vx,vy,vz\n0,a,0,0,inf,0,0,0\n' >inf.csv
refused "an infinite place" 'inf.csv:2: malformed, missing or non-finite number' render ball.yaml -o a.png --orbits inf.csv
printf 'x,y,z\n1,2,3\n' >other.csv
refused "another table" 'other.csv:1: this is not its header, expected' render ball.yaml -o a.png --orbits other.csv

run map ball.yaml -o probe.png --size 160x120
[ "$ran_status" -eq 1 ] && grep -q 'has no OpenCV' "$kept/err" && tap_done && exit 0 # the rest draws

png_size() { od -An -tu1 -j16 -N8 "$1" | awk '{ print $1 * 16777216 + $2 * 65536 + $3 * 256 + $4 "x" $5 * 16777216 + $6 * 65536 + $7 * 256 + $8 }'; }
printf 't,particle,x,y,z,vx,vy,vz\n0,"a, b",2,0,0,0,1,0\n2,"a, b",0,2,0,-1,0,0\n' >run.csv
printf 't,particle,body,x,y,z,nx,ny,nz,vx,vy,vz,outcome\n1,"a, b",ball,1.5,1.5,0,1,0,0,0,0,0,bounce\n' >contacts.csv
run map ball.yaml -o map.png --size 320x240 --arrows --orbits run.csv --contacts contacts.csv --colormap magma
expect_status "a map" 0
expect_no_err "says nothing"
expect "has the size asked for" [ "$(png_size map.png)" = 320x240 ]
run map ball.yaml --size 320x240 --threads 1 --arrows --orbits run.csv --contacts contacts.csv --colormap magma
expect_same "the same on stdout, with one thread" out map.png
run map ball.yaml -o a.png --size 100x100 --colormap rainbow
expect_refused "a misleading colour map" '--colormap rainbow: expected one of viridis'
run map ball.yaml -o a.png --size 100x100 --font none.ttf
expect_refused "a missing font" 'the font none.ttf cannot be read'

run render ball.yaml -o two.png --size 90x70 --spp 4 --threads 2 --ground --orbits run.csv --contacts contacts.csv
expect_status "a picture" 0
expect "has the size asked for" [ "$(png_size two.png)" = 90x70 ]
run render ball.yaml --size 90x70 --spp 4 --threads 1 --ground --orbits run.csv --contacts contacts.csv
expect_same "the same on stdout, with one thread" out two.png

# The analytic silhouette: radius 0.5 at distance 4, on 100 pixels that span 60 degrees.
run render ball.yaml -o ball.pfm --size 100x100 --spp 1 --from 4,0,0.5 --to 0,0,0.5 --fov 60
expect_status "light as numbers" 0
expect "all of them" [ "$(wc -c <ball.pfm)" -ge 120000 ]
run render ball.yaml -o a.ppm --size 100x100 --spp 1 --from 4,0,0.5 --to 0,0,0.5 --fov 60
tail -c 30000 a.ppm | od -An -v -tu1 -w3 | awk '{ lit += $1 > 100 } END { exit !(lit > 350 && lit < 380) }'
expect "the ball covers pi (50 tan a / tan 30)^2 = 374 pixels, less its dark rim" [ $? -eq 0 ]
tap_done
