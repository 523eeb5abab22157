# SPDX-License-Identifier: MIT
# The program without a command, with a wrong one, and the help of every command in its table.
. "$(dirname "$0")/harness.sh"

run --version
expect_status "the version is asked" 0
expect_out "it is three numbers" '^skelfield [0-9]+\.[0-9]+\.[0-9]+$'

run --help
expect_status "the help is asked" 0
expect_out "it has a usage line" '^[Uu]sage: skelfield'
expect_no_err "help is data"

run
expect_refused "no command" 'no command'
run orbit
expect_refused "an unknown command" ".*'orbit'"
run --orbit
expect_refused "an unknown option" ".*'--orbit'"

run help help
expect_status "help on help" 0
expect_out "is the help" 'commands:'
for command in $("$SKF_PROGRAM" --help | awk '/^[Cc]ommands/ { on = 1; next } /^[^ ]/ { on = 0 } on && /^  [a-z]/ && $1 != "help" { print $1 }'); do
  run "$command" --help
  expect_status "$command --help" 0
  expect_out "it shows its usage" "^[Uu]sage: skelfield $command"
  run "$command" --no-such-option
  expect_refused "$command with an unknown option" ".*no-such-option"
  run "$command"
  expect_refused "$command without operands" '.*'
done
tap_done
