# SPDX-License-Identifier: MIT
# Shell tests source this file: one "ok" or "not ok" line per check, exit status 1 when one failed or none ran.
# tests/tally.awk counts the lines.

tap_passed=0 tap_failed=0

# check NAME COMMAND...: one check, passed when the command succeeds.
check() {
  local name=$1
  shift
  if "$@"; then pass "$name"; else fail "$name"; fi
}

pass() {
  tap_passed=$((tap_passed + 1))
  echo "ok - $1"
}

# fail NAME [DETAILS]
fail() {
  tap_failed=$((tap_failed + 1))
  echo "not ok - $1"
  [ $# -lt 2 ] || printf '%s\n' "$2" | sed 's/^/  # /'
}

# skip_all REASON: nothing here can run; 77 is what Meson counts as skipped.
skip_all() {
  echo "skipped: $1"
  trap - EXIT
  exit 77
}

# Ends a test: call it last.
tap_done() {
  [ "$tap_failed" -eq 0 ] && [ "$tap_passed" -gt 0 ]
}
