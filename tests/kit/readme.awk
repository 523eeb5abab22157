# SPDX-License-Identifier: MIT
# Prints the README's code blocks of one language: awk -v language=c -f readme.awk README.md

$0 == "```" language { on = 1; next }
/^```/               { on = 0 }
on
