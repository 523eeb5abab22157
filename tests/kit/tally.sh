#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The tally counts what ran, and what failed or crashed.
set -u
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../tap.sh"

# tallies EXPECTED STATUS: the log is on stdin
tallies() {
  local said status
  said=$(awk -f "$here/../tally.awk")
  status=$?
  [ "$said" = "$1" ] && [ "$status" = "$2" ] || { echo "said '$said', status $status"; return 1; }
}
program() { printf 'test:         skelfield:%s / %s\nresult:       %s\n' "$1" "$1" "$2"; }
good() { printf '[ RUN      ] %s\n[       OK ] %s\n' "$1" "$1"; }
bad() { printf '[ RUN      ] %s\n[  FAILED  ] %s\n' "$1" "$1"; }

check "cmocka tests count one by one" tallies "3 passed, 0 failed" 0 < <(
  program a "exit status 0"; good x; good y; program b "exit status 0"; good x)
check "failures count" tallies "1 passed, 2 failed" 1 < <(program a "exit status 2"; good x; bad y; bad z)
check "a crash is a failure" tallies "1 passed, 1 failed" 1 < <(
  program a "killed by signal 11 SIGSEGV"; good x; echo '[ RUN      ] y')
check "a crash after the last test is a failure" tallies "1 passed, 1 failed" 1 < <(
  program a "killed by signal 6 SIGABRT"; good x)
check "shell checks count" tallies "2 passed, 1 failed" 1 < <(
  program a "exit status 1"; printf 'ok - p\nnot ok - q\nok - r\n')
check "a plain program counts as one" tallies "1 passed, 1 failed" 1 < <(
  program a "exit status 0"; program b "exit status 1")
check "a skipped check is neither" tallies "1 passed, 0 failed" 0 < <(
  program a "exit status 0"; good x; printf '[ RUN      ] y\n[  SKIPPED ] y\n')
check "nothing at all is not a success" tallies "0 passed, 0 failed" 1 </dev/null
tap_done
