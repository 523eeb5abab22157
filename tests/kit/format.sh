#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Every C and C++ file is as clang-format 14 writes it. Skipped where that version is not installed.
set -u
. "$(dirname "$0")/../tap.sh"
tool=$(command -v clang-format-14 || command -v clang-format) || skip_all "clang-format is not installed"
"$tool" --version | grep -q 'version 14\.' || skip_all "clang-format is not version 14"
cd "$SKF_SOURCE_ROOT" || exit 1

for folder in lib tools tests notebooks-c; do
  [ -d "$folder" ] || continue
  files=$(find "$folder" -name '*.[ch]' -o -name '*.cpp')
  [ -n "$files" ] || continue
  check "$folder is formatted" "$tool" --dry-run -Werror --style=file $files
done
tap_done
