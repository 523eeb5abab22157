#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# usage: start.sh PROGRAM. What the program loads when it starts: libraries that cost milliseconds belong in modules.
set -u
. "$(dirname "$0")/../tap.sh"

needed=$(ldd "$1" | awk '$1 ~ /\.so/ { print $1 }' | grep -vE 'asan|ubsan|linux-vdso')
few() { [ "$(echo "$needed" | wc -l)" -le 14 ] || ! echo "$needed"; }
light() { ! echo "$needed" | grep -E 'hdf5|opencv|curl|ssl|freetype|mpi'; }
check "at most 14 libraries are loaded at the start" few
check "none of HDF5, OpenCV, FreeType or MPI is among them" light
tap_done
