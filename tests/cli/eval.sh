# SPDX-License-Identifier: MIT
# skelfield eval: columns, sums over bodies, tables that are refused, outputs that appear whole or not at all.
. "$(dirname "$0")/harness.sh"

write two.yaml <<'END'
skelfield: 1
bodies:
  - {name: near, iso: 1, kernel: {type: inverse}, skeleton: [{point: {at: [0, 0, 0], strength: 2}}]}
  - {name: far, iso: 1, kernel: {type: gaussian, a: 0.5}, skeleton: [{point: {at: [3, 0, 0]}}]}
END
printf 'x,y,z\n2,0,0\n0,0,0\n1,2,-2\n' >points.csv

run eval two.yaml points.csv
expect_status "eval works" 0
expect_no_err "it says nothing"
expect_out "its header" '^x,y,z,F,gx,gy,gz$'
expect_close "one row for each point" "$(rows)" 3 0
expect_close "F sums the bodies" "$(field 2 4)" 1.7788007830714048 1e-15
expect_close "so does its gradient" "$(field 2 5)" -0.11059960846429756 1e-14
expect "the infinite value is inf" [ "$(field 3 4)" = inf ]
expect_close "order is kept" "$(field 4 3)" -2 0

run eval two.yaml points.csv --body far
expect_close "one body alone" "$(field 2 4)" 0.77880078307140488 1e-15
run eval two.yaml points.csv --body other
expect_refused "an unknown body" "no body is called 'other', expected one of near, far"
run eval two.yaml points.csv --tensor --body=near
expect_out "second derivatives" '^x,y,z,F,gx,gy,gz,hxx,hxy,hxz,hyy,hyz,hzz$'
expect_close "hxx of 2 / r" "$(field 2 8)" 0.5 1e-15
expect_close "hyy of 2 / r" "$(field 2 11)" -0.25 1e-15
expect_close "hxy off the axis" "$(field 4 9)" "$(awk 'BEGIN { printf "%.17g", 2 * 3 * 1 * 2 / 243 }')" 1e-14

# Expansions: the same to the accuracy, and only where there are many primitives.
awk 'BEGIN { print "skelfield: 1\nbodies:\n  - name: a\n    iso: 1\n    kernel: {type: inverse}\n    skeleton:";
  for (i = 0; i < 4100; i++) printf "      - point: {at: [%.6f, %.6f, %.6f]}\n", sin(i), sin(1.7 * i), cos(2.3 * i * i) }' >crowd.yaml
printf 'x,y,z\n0.11,0.2,0.3\n5,0,0\n' >some.csv
run eval crowd.yaml some.csv
near=$(field 2 4) far=$(field 3 4)
run eval crowd.yaml some.csv --accuracy 1e-4
expect_status "eval with expansions" 0
expect_close "F inside to the accuracy" "$(field 2 4)" "$near" 1e-4
expect_close "F outside to the accuracy" "$(field 3 4)" "$far" 1e-4
expect "they are no direct sums" [ "$(field 2 4)" != "$near" ]
run eval two.yaml points.csv
cp "$kept/out" want.csv
run eval two.yaml points.csv --accuracy 1e-4
expect_same "few primitives are added up" out want.csv
run eval two.yaml points.csv --accuracy 0.1
expect_refused "an accuracy out of range" "--accuracy 0.1: expected a number from 1e-12 to 0.01, or exact"
run eval crowd.yaml some.csv --accuracy exact
expect_status "eval without expansions" 0
expect "they are direct sums" [ "$(field 2 4)" = "$near" ]
run eval crowd.yaml some.csv --accuracy 0
expect "so they are with 0" [ "$(field 2 4)" = "$near" ]

# A large body at many points: expansions by themselves, to 1e-12.
awk 'BEGIN { print "skelfield: 1\nbodies:\n  - name: a\n    iso: 1\n    kernel: {type: cauchy, s: 9}\n    skeleton:";
  for (i = 0; i < 50000; i++) printf "      - point: {at: [%.6f, %.6f, %.6f]}\n", sin(i), sin(1.7 * i), cos(2.3 * i * i) }' >huge.yaml
awk 'BEGIN { print "x,y,z\n0.11,0.2,0.3\n5,0,0"; for (i = 2; i < 100000; i++) print "-0.99,-0.98,-0.99" }' >many.csv
run eval huge.yaml some.csv
near=$(field 2 4) far=$(field 3 4)
run eval huge.yaml many.csv
expect_status "eval of a large body at many points" 0
expect_close "F inside to 1e-12" "$(field 2 4)" "$near" 1e-12
expect_close "F outside to 1e-12" "$(field 3 4)" "$far" 1e-12

# Tables as other programs write them, and from a pipe.
printf '\xef\xbb\xbfx,y,z\r\n 2 ,\t0,+.0e0 \r\n\r\n0,0,0\r\n1,2,-2' >dos.csv
run eval two.yaml points.csv
cp "$kept/out" want.csv
run eval two.yaml dos.csv
expect_same "CRLF, spaces, blank lines, no last line feed" out want.csv
run eval two.yaml - <points.csv
expect_same "points from stdin" out want.csv
run eval two.yaml points.csv --output=- --threads 1
expect_same "one thread" out want.csv
awk -v OFS=, 'BEGIN { print "x,y,z"; for (i = 0; i < 40000; i++) print i / 7, i % 11 / 3, i % 13 }' >many.csv
run eval two.yaml many.csv --threads 1 -o one.csv
run eval two.yaml many.csv --threads 3 --output three.csv
expect_same "threads change nothing" one.csv three.csv
expect_close "every row is there" "$(rows three.csv)" 40000 0

printf 'x,y,z\n' >none.csv
run eval two.yaml none.csv
expect_status "no points" 0
expect_close "give no rows" "$(rows)" 0 0

# A bar on a terminal only.
expect_no_err "no bar elsewhere"
if script -qec true /dev/null >"$kept/out" 2>&1 </dev/null; then # where there are terminals
  awk -v OFS=, 'BEGIN { print "x,y,z"; for (i = 0; i < 400000; i++) print i, 1, 2 }' >more.csv
  awk 'BEGIN { print "skelfield: 1\nbodies:\n  - name: a\n    iso: 1\n    kernel: {type: cauchy, s: 1}\n    skeleton:";
    for (i = 0; i < 150; i++) print "      - arc: {center: [" i ", 0, 0], normal: [0, 1, 1], start: [1, 0, 0], radius: 1, sweep: 90}" }' >arcs.yaml
  script -qec "'$SKF_PROGRAM' eval arcs.yaml more.csv -o more.out --threads 1" /dev/null >"$kept/out" 2>&1 </dev/null
  ran="eval on a terminal"
  expect_out "a bar on a terminal" 'eval \[#*\.*\] +[0-9]+%, [0-9:]+ left'
  rm more.csv more.out
fi

# Tables that are refused.
table() { # name, line, regular expression; the table is on stdin
  write bad.csv
  run eval two.yaml bad.csv -o out.csv </dev/null
  expect_refused "$1" "bad.csv:$2: .*$3"
}
table "an empty table" 1 "expected 'x,y,z'" </dev/null
table "another header" 1 "header is 'a,b,c', expected 'x,y,z'" <<<'a,b,c'
table "a longer header" 1 "expected 'x,y,z'" <<<'x,y,z,w'
table "too few numbers" 3 "too few" <<<$'x,y,z\n1,2,3\n1,2'
table "too many numbers" 2 "too many" <<<$'x,y,z\n1,2,3,4'
table "a word" 4 "malformed, missing or non-finite" <<<$'x,y,z\n\n1,2,3\n1,two,3'
table "an empty cell" 2 "malformed, missing or non-finite" <<<$'x,y,z\n1,,3'
table "nan" 2 "malformed, missing or non-finite" <<<$'x,y,z\n1,nan,3'
table "inf" 2 "malformed, missing or non-finite" <<<$'x,y,z\n1,2,-inf'
table "a number that overflows" 2 "too large" <<<$'x,y,z\n1,2,1e999'
table "letters behind a number" 2 "expected 3 numbers a row" <<<$'x,y,z\n1,2,3abc'
table "a hexadecimal number" 2 "expected 3 numbers a row" <<<$'x,y,z\n1,0x10,3'
printf 'x,y,z\n1,2,3\0\n' >nul.csv
run eval two.yaml nul.csv
expect_refused "a NUL" "nul.csv:2: "
run eval two.yaml nowhere.csv
expect_refused "a missing table" "nowhere.csv: No such file"
run eval two.yaml .
expect_refused "a folder for a table" ".*directory"
run eval two.yaml points.csv --threads 0
expect_refused "no threads" "--threads 0: expected a whole number"
run eval two.yaml points.csv --threads 2x
expect_refused "threads in words" "--threads 2x: expected"
run eval two.yaml points.csv --body
expect_refused "an option without its value" ".*'--body'"
run eval two.yaml points.csv --tensor=1
expect_refused "a flag with a value" ".*'--tensor=1'"
run eval two.yaml points.csv extra
expect_refused "one operand too many" ".*'extra'"
run eval -- two.yaml -points.csv
expect_refused "-- ends the options" "-points.csv: No such file"

# Outputs.
run eval two.yaml points.csv -ofield.csv
expect_status "-oFILE" 0
expect_same "the file is what stdout would be" field.csv want.csv
expect_no_out "and stdout is empty"
expect "no temporary file stays" [ "$(ls -A | grep -c '^\.')" = 0 ]
ln -s field.csv link.csv
chmod 640 field.csv
run eval two.yaml points.csv --body far -o link.csv
expect "a link stays a link" [ -L link.csv ]
expect "its target is rewritten" [ "$(rows field.csv)" = 3 ]
expect "with the mode it had" [ "$(stat -c %a field.csv)" = 640 ]
run eval two.yaml points.csv -o /dev/null
expect_status "a device is written to" 0
expect "and stays a device" [ -c /dev/null ]
run eval two.yaml points.csv -o no/such/folder.csv
expect_status "a folder that is missing" 1
expect_err "is told" '^skelfield: no/such/folder.csv: No such file'
run eval two.yaml points.csv -o .
expect_status "a folder is no output" 1
if [ -w /dev/full ]; then
  run eval two.yaml many.csv -o /dev/full
  expect_status "a full disk" 1
  expect_err "is told" '^skelfield: /dev/full: No space left'
  "$SKF_PROGRAM" eval two.yaml many.csv >/dev/full 2>"$kept/err"
  ran_status=$?
  expect_status "a full disk behind stdout" 1
  expect_err "is told" '^skelfield: stdout: '
fi
"$SKF_PROGRAM" eval two.yaml many.csv 2>"$kept/err" | head -n 1 >/dev/null
ran_status=${PIPESTATUS[0]}
expect_status "a closed pipe" 1
expect_err "is told" '^skelfield: stdout: Broken pipe'
"$SKF_PROGRAM" eval two.yaml points.csv 2>"$kept/err" >&-
ran_status=$?
expect_status "a closed stdout" 1

# Interrupted while it waits for its table, and while it works.
mkfifo pipe.csv
catches() { # process: whether it has a handler for SIGTERM by now (a sanitized program on a busy machine starts slowly)
  local mask
  mask=$(awk '$1 == "SigCgt:" { print $2 }' "/proc/$1/status" 2>/dev/null) && [ $((0x${mask:-0} & 1 << 14)) != 0 ]
}
interrupt() { # signal, seconds of work, command...
  local signal=$1 seconds=$2
  shift 2
  bash -c 'exec "$@"' - "$@" >"$kept/out" 2>"$kept/err" &
  local child=$! program=${1##*/}
  for _ in $(seq 400); do
    [ "$(cat "/proc/$child/comm" 2>/dev/null)" != "$program" ] || ! catches "$child" || break
    sleep 0.05
  done
  sleep "$seconds"
  kill -s "$signal" "$child"
  wait "$child"
  ran_status=$?
}
interrupt TERM 0.3 "$SKF_PROGRAM" eval two.yaml pipe.csv -o late.csv
expect_status "terminated" 143
awk 'BEGIN { print "skelfield: 1\nbodies:\n  - name: a\n    iso: 1\n    kernel: {type: cauchy, s: 1}\n    skeleton:";
  for (i = 0; i < 4000; i++) print "      - arc: {center: [" i ", 0, 0], normal: [0, 1, 1], start: [1, 0, 0], radius: 1, sweep: 90}" }' >long.yaml
interrupt TERM 1 "$SKF_PROGRAM" eval long.yaml many.csv -o late.csv
expect_status "terminated at work" 143
expect_err "it says so" 'interrupted, nothing written'
expect "nothing is left" [ "$(ls -A | grep -c late)" = 0 ]

# A homogeneous cube, in its centre, on a corner and far away.
write cube.off <<'END'
OFF
8 6 0
-0.5 -0.5 -0.5
0.5 -0.5 -0.5
-0.5 0.5 -0.5
0.5 0.5 -0.5
-0.5 -0.5 0.5
0.5 -0.5 0.5
-0.5 0.5 0.5
0.5 0.5 0.5
4 0 2 3 1
4 4 5 7 6
4 0 1 5 4
4 2 6 7 3
4 0 4 6 2
4 1 3 7 5
END
write solid.yaml <<'END'
skelfield: 1
bodies:
  - {name: cube, iso: 1, skeleton: [{solid: {file: cube.off}}]}
END
printf 'x,y,z\n0,0,0\n0.5,0.5,0.5\n1e6,0,0\n' >points.csv
run eval solid.yaml points.csv --tensor
expect_status "a solid is evaluated" 0
expect_close "F in its centre" "$(field 2 4)" 2.3800773639795504 4e-15
expect_close "hxx there" "$(field 2 8)" -4.1887902047863905 1e-14
expect_close "F on a corner" "$(field 3 4)" 1.1900386819897768 4e-15
expect_close "gx on a corner" "$(field 3 5)" -0.96938805271256823 1e-14
expect_close "F far away" "$(field 4 4)" 1e-6 4e-15
sed -i 's/^4 1 3 7 5$/4 5 7 3 1/' cube.off
run eval solid.yaml points.csv
expect_refused "a solid with a face inside out" "solid.yaml:3: mesh cube.off: has faces of inconsistent orientation"
tap_done
