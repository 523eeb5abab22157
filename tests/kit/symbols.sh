#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: symbols.sh SHARED STATIC. The libraries define only skf_ symbols, and the shared one exports what the public
# headers declare, no less and no more.
set -u
. "$(dirname "$0")/../tap.sh"
shared=$1 static=$2
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT

# AddressSanitizer adds a symbol of its own to each global variable.
names() { awk '$NF !~ /^__odr_asan/ && NF >= 3 { print $NF }' | sort -u; }
nm -D --defined-only "$shared" | names >"$scratch/exported"
nm -g --defined-only "$static" | names >"$scratch/global"
cat "$SKF_SOURCE_ROOT"/lib/skelfield/*.h | grep -v '^#' | tr '\n' ' ' | grep -oE 'SKF_API [^;]*;' |
  sed -E 's/\(.*//; s/.*[ *]//' | sort -u >"$scratch/declared"

only_ours() { [ -s "$1" ] && ! grep -v '^skf_' "$1"; }
same() { [ -s "$1" ] && diff "$1" "$2"; }
check "the shared library exports only skf_ symbols" only_ours "$scratch/exported"
check "the static library defines only skf_ symbols" only_ours "$scratch/global"
check "what is exported is what the public headers declare" same "$scratch/exported" "$scratch/declared"
tap_done
