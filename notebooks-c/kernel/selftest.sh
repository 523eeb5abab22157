#!/usr/bin/env bash
# SPDX-License-Identifier: MIT
# Executes selftest.c and reads in the notebook's HTML that the kernel did what it promises.
set -u
. "$SKF_SOURCE_ROOT/tests/tap.sh"
out=$SKF_BUILD_ROOT/notebooks
"$SKF_SOURCE_ROOT/notebooks-c/run" "$SKF_SOURCE_ROOT/notebooks-c/kernel/selftest.c" "$out" "$SKF_BUILD_ROOT"
status=$?
[ $status != 77 ] || skip_all "Jupyter is not installed"
check "the notebook runs" [ $status = 0 ]

# The text of the page, without marks.
sed -E 's/<[^>]*>//g; s/&gt;/>/g; s/&lt;/</g; s/&#39;/'"'"'/g' "$out/selftest.html" >"$out/selftest.txt"
says() { grep -qF -- "$1" "$out/selftest.txt"; }
check "variables are shared" says 'variables are shared: 12'
check "the newest function is called" says 'the newest function: -6'
check "a struct can be defined again" says 'the newest struct: 2'
check "a crash is caught" says 'In[8]: Segmentation fault'
check "a false requirement fails" says 'In[9]: not true: 1 > 2'
check "gcc's message names the cell and line" says 'In[10]:1:1'
check "a function among statements is explained" says 'put the function in a cell of its own'
check "a failed command fails" says 'In[12]: false: exit status 1'
check "variables outlive a crash" says 'scale is still 3'
check "a picture comes in its place" sh -c "
  tr '\n' ' ' <'$out/selftest.html' | grep -qE '<pre>before the picture.*src=.data:image/png;base64.*<pre>after the picture'"
check "a death is told" says 'ended with status 5'
check "definitions outlive a death" says 'after the death: 1'

cat >"$out/failing.c" <<'END'
// %%
nb_require(0);
END
fails() { ! "$SKF_SOURCE_ROOT/notebooks-c/run" "$out/failing.c" "$out" "$SKF_BUILD_ROOT" >/dev/null 2>&1; }
check "a notebook with a failing cell fails" fails
tap_done
