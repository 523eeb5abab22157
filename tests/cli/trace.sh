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
