# SPDX-License-Identifier: MIT
# skelfield trace: columns, order, bodies, first hits, tables that are refused, threads.
. "$(dirname "$0")/harness.sh"

write two.yaml <<'END'
skelfield: 1
bodies:
  - {name: near, iso: 1, kernel: {type: inverse}, skeleton: [{point: {at: [0, 0, 0], strength: 2}}]}
  - {name: far, iso: 0.5, kernel: {type: inverse}, skeleton: [{point: {at: [7, 0, 0]}}]}
END
printf 'ox,oy,oz,dx,dy,dz\n-5,0,0,3,0,0\n0,9,0,1,0,0\n0,0,0,0,0,-0.5\n20,0,0,-1,0,0\n' >rays.csv

run trace two.yaml rays.csv
expect_status "trace works" 0
expect_no_err "it says nothing"
expect_out "its header" '^ray,t,x,y,z,nx,ny,nz,body$'
expect_close "every crossing" "$(rows)" 9 0
expect_close "t counts along the unit direction" "$(field 2 2)" 3 1e-15
expect_close "the normal points outwards" "$(field 2 6)" -1 1e-15
expect_out "bodies in order of t" '^0,10,5,0,0,-1,.*,far$'
expect_close "a start inside, where F is infinite" "$(field 6 2)" 2 1e-15
expect_out "rays count from 0" '^3,11,9,0,0,1,.*,far$'

run trace two.yaml rays.csv --first -o hits.csv
expect_status "first hits" 0
expect_close "one for each ray that hits" "$(($(wc -l <hits.csv) - 1))" 3 0
expect "the nearest body's" grep -q '^3,11,9,.*,far$' hits.csv
for file in two.yaml rays.csv; do
  run trace two.yaml rays.csv -o ./$file
  expect_refused "its own $file" "--output ./$file is read, too, expected another file"
done
run trace two.yaml rays.csv --report
expect_err "the report" 'trace: [0-9]+ cells, [0-9]+ subdivisions, [0-9]+ evaluations, 0 grazing'

awk 'BEGIN{srand(4);print "ox,oy,oz,dx,dy,dz";for(i=0;i<5000;i++)print 4*rand()-2","4*rand()-2",9,"rand()-.5","rand()-.5",-1"}' >many.csv
run trace "$data/donut.yaml" many.csv -o one.csv --threads 1
run trace "$data/starfish.yaml" many.csv -o one.csv --threads 1
run trace "$data/starfish.yaml" many.csv -o four.csv --threads 4
expect "threads change nothing" cmp -s one.csv four.csv

# lengths from 1e-110 to 1e150, and a start far away
one() { # NAME ISO KERNEL PRIMITIVE RAY
  write $1.yaml <<END
skelfield: 1
bodies:
  - {name: b, iso: $2, kernel: {$3}, skeleton: [{$4}]}
END
  printf 'ox,oy,oz,dx,dy,dz\n%s\n' "$5" >$1.csv
  run trace $1.yaml $1.csv
}
one tiny 2.5083232104033733e+110 'type: inverse-squared' 'segment: {from: [-1e-110, 0, 0], to: [1e-110, 0, 0]}' \
  3e-111,2e-111,5e-110,0,0,-1
expect_close "a tiny segment" "$(rows)" 2 0
expect_close "where it is hit" "$(field 2 2)" 4.3e-110 1e-12
one huge 1 'type: inverse' 'segment: {from: [0, 0, 0], to: [2e150, 0, 0]}' 1e150,5e150,0,0,-1,0
expect_close "a huge segment" "$(rows)" 2 0
expect_close "where that is hit" "$(field 2 4)" 1.9190347513349433e150 1e-14
expect_close "and how far" "$(field 2 2)" 3.0809652486650568e150 1e-14
one point 1e80 'type: inverse' 'point: {at: [0, 0, 0]}' 5e-81,0,5,0,0,-1
expect_close "a tiny sphere" "$(rows)" 2 0
expect_close "its height" "$(field 2 5)" 8.6602540378443865e-81 1e-12
one afar 0.25 'type: cauchy, s: 1' 'point: {at: [0, 0, 0]}' 1e15,0.5,0,-1,0,0
expect_close "a ray from afar" "$(rows)" 2 0
expect_no_err "it says nothing"
expect_close "at the right place" "$(field 2 3)" 0.86602540378443865 1e-14
one beyond 0.35 'type: cauchy, s: 2.5' 'point: {at: [0, 0, 1e160]}' 0,0,5,0,0,-1
expect_refused "lengths whose squares overflow" 'beyond.yaml:3: a length in the point is beyond 1e\+153, expected smaller'

printf 'ox,oy,oz,dx,dy,dz\n1,2,3,1,0,0\n-5,0,0,0,0,0\n' >zero.csv
run trace two.yaml zero.csv -o no.csv
expect_refused "a zero direction" 'zero.csv:3: .*zero, expected'
printf 'ox,oy,oz,dx,dy,dz\n\n1,2,3,1,0,0\n\n-5,0,0,0,0,0\n' >zero.csv
run trace two.yaml zero.csv
expect_refused "a zero direction behind blank lines" 'zero.csv:5: .*zero, expected'
printf 'x,y,z\n1,2,3\n' >header.csv
run trace two.yaml header.csv
expect_refused "another header" "header.csv:1: .*expected 'ox,oy,oz,dx,dy,dz'"
printf 'ox,oy,oz,dx,dy,dz\n1,2,3,1,0,nan\n' >nan.csv
run trace two.yaml nan.csv
expect_refused "a number that is not finite" 'nan.csv:2: '
tap_done
