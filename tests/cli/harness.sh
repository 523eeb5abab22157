# SPDX-License-Identifier: MIT
# Tests of the program: a test is a shell script tests/cli/NAME.sh, listed in tests/cli/meson.build, that sources this
# file, runs the program and says what it expects. It works in an empty folder of its own. For example:
#
#   . "$(dirname "$0")/harness.sh"
#   write one.yaml <<'END'
#   ...
#   END
#   run info one.yaml --json            # the program's status, stdout and stderr are kept, and what files it made
#   expect_status "info works" 0
#   expect_out "it names the body" '"name": *"ball"'        # extended regular expression, any line
#   expect_close "the volume" "$(field 2 3 out)" 4.18 1e-2   # relative
#   refuse "an unknown key" one.yaml 7 'wieght.*expected' <<'END'
#   ...
#   END
#   tap_done
#
# The program is $SKF_PROGRAM; data files are in $SKF_SOURCE_ROOT/data.
. "$(dirname "${BASH_SOURCE[0]}")/../tap.sh"

: "${SKF_PROGRAM:?names the program to test}"
data=${SKF_SOURCE_ROOT:?}/data
kept=$(mktemp -d)
trap 'rm -rf "$kept"' EXIT
mkdir "$kept/work"
cd "$kept/work" || exit 1

# has ADAPTER: whether the program was built with cgal, opencv, png, geographiclib, hdf5, mpi or hdf5-mpi (tested in adapters.sh).
has() { case " ${SKF_ADAPTERS-cgal opencv png geographiclib hdf5 mpi hdf5-mpi} " in *" $1 "*) true ;; *) false ;; esac; }

# write FILE: makes a file of what is on stdin.
write() { cat >"$1"; }

# run ARGUMENTS...: runs the program, without a terminal and with nothing on stdin unless it is redirected.
run() {
  find . -type f -exec cksum {} + | sort >"$kept/before"
  if [ -t 0 ]; then "$SKF_PROGRAM" "$@" </dev/null; else "$SKF_PROGRAM" "$@"; fi >"$kept/out" 2>"$kept/err"
  ran_status=$?
  ran="skelfield $*"
  find . -type f -exec cksum {} + | sort >"$kept/after"
}

# What the last run said, for a failed check.
last_run() {
  echo "$ran"
  echo "status $ran_status"
  head -n 5 "$kept/out" | sed 's/^/stdout: /'
  head -n 10 "$kept/err" | sed 's/^/stderr: /'
}

expect() { # name, command...
  local name=$1
  shift
  if "$@"; then pass "$name"; else fail "$name" "$(last_run)"; fi
}

expect_status() { expect "$1" [ "$ran_status" -eq "$2" ]; }
expect_out() { expect "$1" grep -qE -e "$2" "$kept/out"; }
expect_err() { expect "$1" grep -qE -e "$2" "$kept/err"; }
expect_no_out() { expect "$1" [ ! -s "$kept/out" ]; }
expect_no_err() { expect "$1" [ ! -s "$kept/err" ]; }
# The last run neither made, changed nor removed a file, and left stdout alone.
nothing_written() { cmp -s "$kept/before" "$kept/after" && [ ! -s "$kept/out" ]; }
expect_nothing_written() { expect "$1" nothing_written; }
expect_file() { expect "$1" [ -s "$2" ]; }
# Two files (or "out", what the last run printed) are the same to the last byte.
expect_same() { expect "$1" cmp "$(path_of "$2")" "$(path_of "$3")"; }

path_of() { if [ "$1" = out ]; then echo "$kept/out"; else echo "$1"; fi; }

# field ROW COLUMN [FILE]: a number of a CSV; row 1 is the header; "out" (default) is what the last run printed.
field() { awk -F, -v row="$1" -v column="$2" 'NR == row { print $column }' "$(path_of "${3:-out}")"; }
# rows [FILE]: how many rows follow the header.
rows() { awk 'END { print NR - 1 }' "$(path_of "${1:-out}")"; }

# expect_close NAME GOT WANT TOLERANCE [SCALE]: |got - want| <= tolerance * scale; the scale is |want| unless given.
expect_close() {
  expect "$1: $2 is $3" awk -v got="$2" -v want="$3" -v tolerance="$4" -v scale="${5:-}" 'BEGIN {
    number = "^[-+]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][-+]?[0-9]+)?$"
    if (got !~ number || want !~ number) exit 1
    if (scale == "") scale = want < 0 ? -want : want
    off = got - want
    exit !((off < 0 ? -off : off) <= tolerance * scale)
  }'
}

# The last run was refused as bad input: status 2, one line on stderr that matches, nothing written.
expect_refused() { # name, regular expression
  is_refused() {
    [ "$ran_status" -eq 2 ] && [ "$(wc -l <"$kept/err")" -eq 1 ] &&
      grep -qE -e "^skelfield: $1" "$kept/err" && nothing_written
  }
  expect "$1 is refused" is_refused "$2"
}

# refuse NAME FILE LINE REGEX: the scene on stdin, saved as FILE, is refused at that line with that message.
refuse() {
  write "$2"
  run info "$2" </dev/null
  expect_refused "$1" "$2:$3: .*$4"
}
