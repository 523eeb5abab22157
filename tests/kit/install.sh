#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: install.sh PREFIX. What `meson install` puts into place is complete, and the README's C program builds against it
# by pkg-config, with the shared and with the static library.
set -u
here=$(cd "$(dirname "$0")" && pwd)
. "$here/../tap.sh"
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
root=$scratch/root prefix=$scratch/root$1

installs() { meson install -C "$SKF_BUILD_ROOT" --no-rebuild --quiet --destdir "$root" >"$scratch/log" 2>&1 || { cat "$scratch/log"; false; }; }
check "meson install works" installs

one() { [ "$(find "$prefix" -path "$prefix/$1" | wc -l)" -ge 1 ]; }
for path in bin/skelfield 'lib*/libskelfield.so' 'lib*/libskelfield.a' 'lib*/skelfield.pc' share/man/man1/skelfield.1 \
  share/skelfield/data/donut.yaml; do
  check "$path is installed" one "$path"
done
for header in "$SKF_SOURCE_ROOT"/lib/skelfield/*.h; do
  check "$(basename "$header") is installed" one "include/skelfield/$(basename "$header")"
done
check "no other header is" [ "$(find "$prefix/include" -type f | wc -l)" = "$(ls "$SKF_SOURCE_ROOT"/lib/skelfield/*.h | wc -l)" ]

# The installed .pc file, moved to where this test has put everything.
sed "s|^prefix=.*|prefix=$prefix|" "$(find "$prefix" -name skelfield.pc)" >"$scratch/skelfield.pc"
package() { PKG_CONFIG_PATH=$scratch pkg-config "$@" skelfield; }
awk -v language=c -f "$here/readme.awk" "$SKF_SOURCE_ROOT/README.md" >"$scratch/client.c"
libraries=$(dirname "$(find "$prefix" -name libskelfield.so)")

shared() {
  $CC "$scratch/client.c" -o "$scratch/shared" $(package --cflags --libs) -lm &&
    LD_LIBRARY_PATH=$libraries "$scratch/shared" >"$scratch/shared.out"
}
static() {
  mkdir -p "$scratch/static-only" && cp "$libraries/libskelfield.a" "$scratch/static-only" &&
    $CC "$scratch/client.c" -o "$scratch/static" $(package --cflags) -L"$scratch/static-only" $(package --static --libs) &&
    "$scratch/static" >"$scratch/static.out"
}
cd "$scratch" || exit 1
check "the README's program runs with the shared library" shared
check "and with the static one" static
check "both say the same" cmp "$scratch/shared.out" "$scratch/static.out"
check "the version agrees" [ "skelfield $(package --modversion)" = "$("$prefix/bin/skelfield" --version)" ]
check "the installed program reads an installed scene" "$prefix/bin/skelfield" eval "$prefix/share/skelfield/data/donut.yaml" \
  - -o "$scratch/field.csv" < <(printf 'x,y,z\n0,0,0\n')
tap_done
