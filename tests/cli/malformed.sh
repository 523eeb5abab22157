# SPDX-License-Identifier: MIT
# The program refuses every scene of tests/scene/malformed.txt: status 2, one line with file and line, nothing written.
. "$(dirname "$0")/harness.sh"

mkdir ../cases
awk -F ' [|] ' '
  /^== / { n++; file = sprintf("../cases/%03d.yaml", n); print file "\t" substr($1, 4) "\t" $2 "\t" $3 > "../list"; next }
  n { print > file }' "$SKF_SOURCE_ROOT/tests/scene/malformed.txt"
printf 'x,y,z\n1,2,3\n' >points.csv

# The checks of expect_refused, without its processes: there are many scenes.
while IFS=$'\t' read -r file name line part <&3; do
  [[ $name == *" without CGAL" ]] && has cgal && continue
  "$SKF_PROGRAM" eval "$file" points.csv -o out.csv </dev/null >"$kept/out" 2>"$kept/err"
  ran_status=$? ran="skelfield eval $file"
  mapfile -t said <"$kept/err"
  if [[ $ran_status == 2 && ${#said[@]} == 1 && ${said[0]} == "skelfield: $file:$line: "*"$part"* && ! -s $kept/out ]]; then
    pass "$name is refused"
  else
    fail "$name is refused" "$(last_run)"
  fi
done 3<../list
expect "nothing was written" [ "$(ls -A)" = points.csv ]

printf 'skelfield: 1\nbodies: \0\n' >nul.yaml
run info nul.yaml
expect_refused "a NUL" 'nul.yaml:2: '
printf 'skelfield: 1\rbodies: []\r' >mac.yaml
run info mac.yaml
expect_refused "an old line ending" 'mac.yaml:2: bodies is empty'
: >empty.yaml
run info empty.yaml --json
expect_refused "an empty file" 'empty.yaml:1: '
run info no-such-file.yaml
expect_refused "a missing file" 'no-such-file.yaml: No such file'
run info ../cases
expect_refused "a folder" '../cases: .*directory'
if [ "$(id -u)" != 0 ]; then
  write locked.yaml </dev/null
  chmod 0 locked.yaml
  run info locked.yaml
  expect_refused "a file that may not be read" 'locked.yaml: Permission denied'
fi
tap_done
