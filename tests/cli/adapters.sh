# SPDX-License-Identifier: MIT
# What CGAL, OpenCV, GeographicLib and HDF5 serve works where the program was built with them; where it was not, the
# command says so in one line, fails, and writes nothing.
. "$(dirname "$0")/harness.sh"

# serves ADAPTER NAME FILE ARGUMENTS...: the command makes the file, or refuses for want of the adapter
serves() {
  local adapter=$1 name=$2 file=$3
  shift 3
  run "$@"
  if has "$adapter"; then
    expect_status "$name" 0
    expect_file "$name leaves its file" "$file"
  else
    missing() { [ "$ran_status" -eq 1 ] && [ "$(wc -l <"$kept/err")" -eq 1 ] && grep -qiE "^skelfield: .*$adapter" "$kept/err"; }
    expect "$name: there is no $adapter" missing
    expect_nothing_written "$name writes nothing"
  fi
}

serves opencv "a map" map.png map "$data/gaussian.yaml" -o map.png --size 320x240
serves opencv "a snapshot in jpg" snapshot.jpg render "$data/gaussian.yaml" -o snapshot.jpg --size 60x40
serves geographiclib "a launch" launch.csv simulate "$data/cigar.yaml" -o launch.csv
serves hdf5 "a trajectory in HDF5" run.h5 simulate "$data/gaussian.yaml" -o run.h5

is_png() { [ "$(head -c 8 "$1" | od -An -tx1 | tr -d ' ')" = 89504e470d0a1a0a ]; }
! has opencv || expect "map.png is a PNG" is_png map.png
if has png; then
  SKELFIELD_MODULES=/nowhere run render "$data/gaussian.yaml" -o snapshot.png --size 60x40
  expect_status "a snapshot in png, with or without OpenCV" 0
else
  serves opencv "a snapshot in png" snapshot.png render "$data/gaussian.yaml" -o snapshot.png --size 60x40
fi
! has png && ! has opencv || expect "snapshot.png is a PNG" is_png snapshot.png
SKELFIELD_MODULES=/nowhere run render "$data/gaussian.yaml" -o plain.ppm --size 60x40
expect_status "a snapshot in ppm, with or without OpenCV" 0
expect "plain.ppm is a PPM of that size" [ "$(head -c 13 plain.ppm | tr '\n' ' ')$(wc -c <plain.ppm)" = 'P6 60 40 255 7213' ]

run validate "$data/gaussian.yaml"
expect_status "a checked surface, with or without CGAL" 0
if has cgal; then
  expect_out "CGAL was asked" 'no self-intersections .*\(CGAL, exact\)'
else
  expect_out "CGAL is missed" 'no CGAL'
fi

# Picture codecs and CGAL are not loaded with the program: it starts for every point that is evaluated.
libraries() { ldd "$SKF_PROGRAM" | grep -E 'opencv|gdal|CGAL|hdf5|libmpi'; }
expect "heavy libraries are not linked" eval '! libraries'
tap_done
