#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The harness of the command-line tests notices what it is there to notice: it runs made-up programs.
set -u
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../tap.sh"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# says STATUS: runs the test on stdin against the program in $scratch/program
says() {
  { echo ". '$here/../cli/harness.sh'"; cat; echo tap_done; } >"$scratch/test.sh"
  SKF_PROGRAM=$scratch/program bash "$scratch/test.sh" >"$scratch/said" 2>&1
  [ $? -eq "$1" ] || { cat "$scratch/said"; return 1; }
}
program() {
  { echo '#!/bin/sh'; cat; } >"$scratch/program"
  chmod +x "$scratch/program"
}

program <<<'echo t,x; echo 1,2.5; echo talk >&2; exit 1'
check "a run that does what is expected passes" says 0 <<'END'
run anything
expect_status s 1; expect_out o '^1,'; expect_err e talk; expect_close n "$(field 2 2)" 2.5 0; expect_close n "$(rows)" 1 0
END
check "a wrong status fails" says 1 <<<'run a; expect_status s 0'
check "a missing line fails" says 1 <<<'run a; expect_out o "^3,"'
check "a wrong number fails" says 1 <<<'run a; expect_close n "$(field 2 2)" 2.6 1e-3'
check "no number fails" says 1 <<<'run a; expect_close n "$(field 9 9)" 0 1'
check "nan fails" says 1 <<<'run a; expect_close n nan nan 1'
check "words on stdout are noticed" says 1 <<<'run a; expect_nothing_written w'
check "a test without a check fails" says 1 <<<'run a'

program <<<'echo "skelfield: $2:3: bad" >&2; exit 2'
check "a refusal passes" says 0 <<<'refuse r s.yaml 3 bad <<<x'
check "a refusal at another line fails" says 1 <<<'refuse r s.yaml 4 bad <<<x'
program <<<'echo "skelfield: $2:3: bad" >&2; echo; exit 2'
check "a refusal that prints fails" says 1 <<<'refuse r s.yaml 3 bad <<<x'
program <<<'echo "skelfield: $2:3: bad" >&2; touch new; exit 2'
check "a refusal that leaves a file fails" says 1 <<<'refuse r s.yaml 3 bad <<<x'
program <<<'echo "skelfield: $2:3: bad" >&2; echo again >&2; exit 2'
check "a refusal of two lines fails" says 1 <<<'refuse r s.yaml 3 bad <<<x'
tap_done
