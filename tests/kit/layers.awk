# SPDX-License-Identifier: MIT
# Reads C and C++ files under lib/ and tools/ and prints every include that breaks the layers:
# core <- num <- simd <- skeleton <- field <- ray <- {motion, surface} <- scene <- tools; adapt stands apart.

BEGIN {
  split("core num simd skeleton field ray motion surface scene", names, " ")
  split("1 2 3 4 5 6 7 7 8", ranks, " ")
  for (i in names) rank[names[i]] = ranks[i]
}

# The room of a path below lib/ or of an include: "field/kernel.h" and "skelfield/field.h" belong to field.
function room_of(path, part) {
  split(path, part, "/")
  if (part[1] != "skelfield") return part[1]
  sub(/\.h$/, "", part[2])
  return part[2] == "render" ? "ray" : part[2] == "handles" ? "field" : part[2] == "polygon" ? "skeleton" : part[2] == "rigid" ? "motion" : part[2] # these have headers of their own
}

function complain(why) {
  print FILENAME ":" FNR ": " why ": " $0
  broken++
}

FNR == 1 {
  file = FILENAME
  sub(/^.*\/lib\//, "lib/", file)
  in_lib = sub(/^lib\//, "", file)
  here = in_lib ? room_of(file) : "tools"
  umbrella = file == "skelfield/skelfield.h"
}

in_lib && !umbrella && /^[ \t]*#[ \t]*include[ \t]*"/ {
  split($0, quoted, "\"")
  there = room_of(quoted[2])
  if (quoted[2] !~ /\//) complain("a quoted include names no room")
  else if (here == "adapt") next
  else if (there == "adapt") complain("the library includes an adapter")
  else if (!(here in rank)) complain("a file outside the rooms")
  else if (!(there in rank)) complain("an include outside the rooms")
  else if (there != here && rank[there] >= rank[here]) complain(here " includes " there)
  else if (quoted[2] ~ /^skelfield\// || file !~ /^skelfield\//) next
  else complain("a public header includes a private one")
}

in_lib && here != "adapt" && /^[ \t]*#[ \t]*include[ \t]*<(CGAL|opencv2|GeographicLib|skelfield)\// {
  complain("only adapters know this library")
}

END { exit broken > 0 }
