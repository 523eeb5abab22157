#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# The README's examples of the program run as they stand, and its pictures are there.
set -u
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../tap.sh"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
ln -s "$SKF_SOURCE_ROOT/data" data
export PATH=$SKF_BUILD_ROOT/tools:$PATH

runs() { bash -c "set -o pipefail; $1" >out 2>err </dev/null || { cat err; false; }; }
while IFS= read -r line; do
  check "$line" runs "$line"
done < <(awk -v language=sh -f "$here/readme.awk" "$SKF_SOURCE_ROOT/README.md")
for picture in $(grep -oE '!\[[^]]*\]\([^)]*\)' "$SKF_SOURCE_ROOT/README.md" | sed -E 's/.*\((.*)\)/\1/'); do
  check "$picture is there" [ -s "$SKF_SOURCE_ROOT/$picture" ]
done
check "nothing is quoted that is not there" sh -c "
  cd '$SKF_SOURCE_ROOT' && grep -oE '\`(data|tools|notebooks-c|lib)/[A-Za-z0-9/._-]*\`' README.md | tr -d '\`' | sort -u | xargs ls -d >/dev/null"
tap_done
