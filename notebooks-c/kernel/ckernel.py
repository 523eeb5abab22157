#!/usr/bin/python3
# SPDX-License-Identifier: MIT
"""A Jupyter kernel for C with gcc: each cell becomes a shared object that one child process loads and calls.

A cell that crashes fails with the signal's name and the variables stay; should the child die, the definitions stay.
Lines "%cflags ...", "%libs ..." add to the compiler's arguments, "%reset" forgets everything."""

import base64
import os
import re
import shlex
import shutil
import tempfile

from ipykernel.kernelapp import IPKernelApp
from ipykernel.kernelbase import Kernel

from child import Child
from compiler import CompileError, Compiler

MIME = {'.png': 'image/png', '.html': 'text/html', '.md': 'text/markdown'}
MAGIC = re.compile(r'^%(cflags|libs|reset)\b[ \t]*(.*)$', re.M)


class CKernel(Kernel):
    implementation = 'c-gcc'
    implementation_version = '1'
    banner = 'C (gcc)'
    language_info = {'name': 'c', 'mimetype': 'text/x-csrc', 'file_extension': '.c', 'pygments_lexer': 'c'}

    def __init__(self, **options):
        super().__init__(**options)
        self.folder = tempfile.mkdtemp(prefix='ckernel-')
        self.child = None
        self.forget()

    def forget(self):
        self.end_child()
        self.compiler = Compiler(tempfile.mkdtemp(dir=self.folder))
        self.runner = self.compiler.runner()

    def end_child(self):
        if self.child:
            self.child.end()
        self.child = None

    def do_execute(self, code, silent, store_history=True, user_expressions=None, allow_stdin=False):
        for word, rest in MAGIC.findall(code):
            if word == 'reset':
                self.forget()
            else:
                getattr(self.compiler, word).extend(shlex.split(rest))
        code = MAGIC.sub('', code)
        if not code.strip():
            return self.succeed()
        label = 'In[%d]' % self.execution_count
        try:
            path, entry, warnings = self.compiler.cell(code, label)
        except CompileError as error:
            return self.fail('CompileError', label, str(error))
        self.say('stderr', warnings)
        return self.run(path, entry, label)

    def run(self, path, entry, label):
        self.child = self.child or Child(self.runner)
        for word, text in self.child.run(path, entry):
            if word == 'show':
                self.show(text)
            elif word == 'died':
                self.end_child()
                return self.fail('Died', label, 'the process ended with status %s; variables are lost' % text)
            elif word == 'done':
                return self.succeed() if text == 'ok' else self.fail('Failed', label, text)
            else:
                self.say(word, text)

    def say(self, stream, text):
        if text:
            self.send_response(self.iopub_socket, 'stream', {'name': stream, 'text': text})

    def show(self, path):
        mime = MIME.get(os.path.splitext(path)[1], 'text/plain')
        try:
            with open(path, 'rb') as file:
                data = file.read()
        except OSError as error:
            return self.say('stderr', 'nb_show: %s\n' % error)
        data = base64.b64encode(data).decode() if mime == 'image/png' else data.decode()
        content = {'data': {mime: data, 'text/plain': '<%s>' % path}, 'metadata': {}}
        self.send_response(self.iopub_socket, 'display_data', content)

    def succeed(self):
        return {'status': 'ok', 'execution_count': self.execution_count, 'payload': [], 'user_expressions': {}}

    def fail(self, kind, label, text):
        error = {'ename': kind, 'evalue': label, 'traceback': ['%s: %s' % (label, text)]}
        self.send_response(self.iopub_socket, 'error', error)
        return {'status': 'error', 'execution_count': self.execution_count, **error}

    def do_shutdown(self, restart):
        self.end_child()
        shutil.rmtree(self.folder, ignore_errors=True)
        return {'status': 'ok', 'restart': restart}


if __name__ == '__main__':
    IPKernelApp.launch_instance(kernel_class=CKernel)
