# SPDX-License-Identifier: MIT
# Reads the testlog.txt files of `meson test` and prints "N passed, N failed": single checks of cmocka programs and of
# shell tests ("ok", "not ok"). A cmocka test that began and never ended has crashed: it failed. A program that failed
# without a failed check counts as one failure, one that succeeded without any check as one pass. With verbose=1,
# skipped checks are counted in a line before.

function close_program() {
  if (program == "") return
  bad = begun - closed + not_ok
  good = ok
  if (result ~ /exit status 77|SKIP/) skipped++
  else if (result !~ /^exit status 0/) bad += (bad == 0)
  else if (good + bad + omitted == 0) good = 1
  passed += good
  failed += bad
  skipped += omitted
  if (bad) failures = failures "  " program ": " bad " failed\n"
  program = ""
}

function open_program(name) {
  close_program()
  program = name
  result = ""
  begun = closed = ok = not_ok = omitted = 0
}

/^test: /                { open_program(substr($0, 15)) }
/^result: /              { result = substr($0, 15) }
/^\[ RUN      \]/        { begun++; current = $4 }
/^\[       OK \]/        { if ($4 == current) { closed++; ok++; current = "" } }
/^\[  SKIPPED \]/        { if ($4 == current) { closed++; omitted++; current = "" } }
/^ok( |$)/               { ok++ }
/^not ok( |$)/           { not_ok++ }
END {
  close_program()
  if (verbose && failures) printf "%s", failures
  if (verbose && skipped) printf "%d skipped\n", skipped
  printf "%d passed, %d failed\n", passed, failed
  exit failed > 0 || passed == 0
}
