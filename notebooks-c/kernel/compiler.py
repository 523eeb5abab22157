# SPDX-License-Identifier: MIT
"""Cells of C into shared objects.

A cell is compiled at file scope; when that fails, as the body of a function. The file-scope cells before it are put in
front of every new one, so nothing needs to be declared twice, and no C is parsed here:
- a variable has one copy: every object defines it, and the dynamic linker takes the first definition for all;
- a function has its newest text: each object calls its own copy (-Bsymbolic-functions);
- a name that is defined again becomes another symbol from there on, by a #define (gcc's messages tell which names).
File-scope `static` variables are therefore local to each cell, and a file-scope variable must not have the name of a
function of the C library (`error`, `index`): the library's is the first definition."""

import os
import re
import shlex
import subprocess

HERE = os.path.dirname(os.path.abspath(__file__))
STRICT = ['-std=gnu17', '-Werror=implicit-int', '-Werror=implicit-function-declaration']
COLOR = re.compile(r'\x1b\[[0-9;]*[mK]')
NESTED = 'A function and statements in one cell: put the function in a cell of its own.\n'
AGAIN = re.compile(r'error: (?:redefinition of|conflicting types for|redeclaration of [^\n‘]*?)\s*‘([^’]+)’')


class CompileError(Exception):
    pass


def environment(name, default):
    return shlex.split(os.environ.get(name, default))


class Compiler:
    def __init__(self, folder):
        self.folder = folder
        self.cc = environment('CKERNEL_CC', 'gcc')
        self.cflags = environment('CKERNEL_CFLAGS', '-O1 -g -Wall -Wno-unused')
        self.libs = environment('CKERNEL_LIBS', '') + ['-lm']
        self.scope = []  # the texts of the file-scope cells so far
        self.count = 0

    def runner(self):
        """Builds the process that runs cells; returns its path."""
        path = os.path.join(self.folder, 'runner')
        source = os.path.join(HERE, 'runner.c')
        subprocess.run([*self.cc, '-O1', '-g', '-rdynamic', '-D_GNU_SOURCE', source, '-o', path, '-ldl'], check=True)
        return path

    def cell(self, code, label):
        """Compiles one cell; returns (object, entry, warnings) or raises CompileError with gcc's messages."""
        self.count += 1
        entry = 'nb_cell_%d' % self.count
        text, errors = self.at_file_scope(code, label, entry)
        if text is not None:
            self.scope.append(text)
            return self.object(), entry, self.of_cell(errors, label)
        in_body = self.in_function(code, label, entry)
        if in_body is None:
            return self.object(), entry, ''
        if NESTED in in_body:
            raise CompileError(in_body)
        raise CompileError(max((in_body, errors), key=lambda e: self.first_error(e, label)))

    def at_file_scope(self, code, label, entry):
        renamed = set()
        while True:
            names = ''.join('#undef %s\n#define %s %s__%d\n' % (n, n, n, self.count) for n in sorted(renamed))
            text = names + self.line(label) + code + '\n'
            errors = self.compile(self.before() + text + 'void %s(void) {}\n' % entry)
            if self.compiled:
                return text, errors
            again = self.defined_again(errors, label) - renamed
            if not again:
                return None, errors
            renamed |= again

    def in_function(self, code, label, entry):
        """None when it compiled, else the messages."""
        lines = code.split('\n')
        directives = '\n'.join(l if l.startswith('#') else '' for l in lines)
        body = '\n'.join('' if l.startswith('#') else l for l in lines)
        errors = self.compile(self.before() + self.line(label) + directives + '\nvoid %s(void) {\n' % entry +
                              self.line(label) + body + '\n}\n')
        if not self.compiled:
            return errors
        return NESTED if 'ISO C forbids nested functions' in self.pedantic() else None

    def before(self):
        return '#include "nb.h"\n' + ''.join(self.scope)

    @staticmethod
    def line(label):
        return '#line 1 "%s"\n' % label

    def object(self):
        return os.path.join(self.folder, 'cell%d.so' % self.count)

    def source(self):
        return os.path.join(self.folder, 'cell%d.c' % self.count)

    def compile(self, text):
        with open(self.source(), 'w') as file:
            file.write(text)
        return self.gcc('-fPIC', '-shared', '-Wl,-Bsymbolic-functions', '-fdiagnostics-color=always', self.source(),
                        '-o', self.object(), *self.libs)

    def pedantic(self):
        return self.gcc('-fsyntax-only', '-Wpedantic', self.source())

    def gcc(self, *arguments):
        done = subprocess.run([*self.cc, *self.cflags, *STRICT, '-I', HERE, *arguments], capture_output=True, text=True,
                              env={**os.environ, 'LC_ALL': 'C.UTF-8'})
        self.compiled = done.returncode == 0
        return done.stderr

    @staticmethod
    def defined_again(errors, label):
        plain = COLOR.sub('', errors)
        return {m.split()[-1] for line in plain.split('\n') if line.startswith(label) for m in AGAIN.findall(line)}

    @staticmethod
    def first_error(errors, label):
        found = re.search(re.escape(label) + r':(\d+):\d+:.*error', COLOR.sub('', errors))
        return int(found[1]) if found else 1 << 30

    @staticmethod
    def of_cell(messages, label):
        return messages if label in COLOR.sub('', messages) else ''
