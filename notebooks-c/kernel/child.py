# SPDX-License-Identifier: MIT
"""The process that runs the cells (runner.c), seen from the kernel."""

import codecs
import os
import selectors
import signal
import subprocess


class Child:
    def __init__(self, runner):
        self.answers, end = os.pipe()
        self.process = subprocess.Popen([runner, str(end)], pass_fds=[end], stdin=subprocess.PIPE,
                                        stdout=subprocess.PIPE, stderr=subprocess.PIPE)
        os.close(end)
        new = codecs.getincrementaldecoder('utf-8')
        self.streams = {self.process.stdout.fileno(): ('stdout', new('replace')),
                        self.process.stderr.fileno(): ('stderr', new('replace'))}
        self.rest = b''

    def run(self, path, entry):
        """Yields ('stdout', text), ('stderr', text), ('show', path) and last ('done', message) or ('died', status)."""
        self.tell('%s %s\n' % (path, entry))
        with selectors.DefaultSelector() as waiting:
            for fd in (*self.streams, self.answers):
                waiting.register(fd, selectors.EVENT_READ)
            while True:
                try:
                    ready = {key.fd for key, _ in waiting.select()}
                except KeyboardInterrupt:
                    self.process.send_signal(signal.SIGINT)
                    continue
                if ready - {self.answers}:
                    for fd in ready - {self.answers}:
                        data = os.read(fd, 65536)
                        if not data:
                            waiting.unregister(fd)
                        yield self.decoded(fd, data)
                    continue  # what was printed comes before the answer that followed it
                data = os.read(self.answers, 65536)
                if not data:
                    yield 'died', self.process.wait()
                    return
                for word, text in self.lines(data):
                    yield word, text
                    if word == 'done':
                        return
                    self.tell('\n')

    def decoded(self, fd, data):
        name, decoder = self.streams[fd]
        return name, decoder.decode(data)

    def lines(self, data):
        *whole, self.rest = (self.rest + data).split(b'\n')
        for line in whole:
            yield line.decode().split(' ', 1)

    def tell(self, text):
        self.process.stdin.write(text.encode())
        self.process.stdin.flush()

    def end(self):
        self.process.kill()
        self.process.wait()
        os.close(self.answers)
