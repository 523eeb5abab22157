#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""usage: convert.py IN.c OUT.ipynb

A line `// %%` starts a cell of C, `// %% [markdown]` a cell of text, which is a C comment block or lines after `// `.
`// %% tags=a,b` tags it (raises-exception: the cell is meant to fail). What precedes the first cell is left out."""

import re
import sys

from nbformat import write
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook

KERNEL = {'name': 'c-gcc', 'display_name': 'C (gcc)', 'language': 'c'}


def cell(number, head, body):
    body = body.strip('\n')
    if '[markdown]' in head:
        made = new_markdown_cell(re.sub(r'(?m)^// ?', '', body))
    else:
        made = new_code_cell(body)
    tags = re.search(r'tags=(\S+)', head)
    if tags:
        made.metadata['tags'] = tags[1].split(',')
    made['id'] = 'cell%d' % number
    return made


def convert(text):
    parts = re.split(r'(?m)^// %%(.*)\n', text)[1:]
    cells = [cell(i, parts[2 * i], parts[2 * i + 1]) for i in range(len(parts) // 2)]
    return new_notebook(cells=cells, metadata={'kernelspec': KERNEL, 'language_info': {'name': 'c'}})


if __name__ == '__main__':
    with open(sys.argv[1]) as file:
        write(convert(file.read()), sys.argv[2])
