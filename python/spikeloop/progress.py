"""What long work shows while it goes on, and how a signal ends it."""

import os
import signal
import subprocess
import sys


class Stopped(Exception):
    """By a signal."""

    def __init__(self, number):
        super().__init__(signal.Signals(number).name)
        self.number = number


SIGNALS = (signal.SIGINT, signal.SIGTERM, signal.SIGHUP)


def note_signals():
    """A list that gets SIGINT, SIGTERM and SIGHUP, for work that looks between its steps: an exception could
    come between the start of a process and the moment at which somebody knows it."""
    noted = []
    for number in SIGNALS:
        signal.signal(number, lambda number, _: noted.append(number))
    return noted


def take_signals():
    """The first SIGINT, SIGTERM or SIGHUP raises Stopped; later ones do nothing."""
    def stop(number, _):
        for each in SIGNALS:
            signal.signal(each, signal.SIG_IGN)  # what is under way ends by itself now
        raise Stopped(number)
    for number in SIGNALS:
        signal.signal(number, stop)


def end_process(process, patience_s):
    """Ctrl-C for a child in a session of its own, which is killed with all of its own when it does not end."""
    process.send_signal(signal.SIGINT)
    try:
        process.wait(patience_s)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
        process.wait()


class Progress:
    """The line that says what is going on: rewritten on a terminal, else one after the other."""

    def __init__(self, stream=sys.stderr):
        self._stream, self._shown = stream, False
        self.part = ""

    def say(self, text):
        if self._stream.isatty():
            self._stream.write(f"\r\x1b[K{self.part}: {text}")
            self._shown = True
        else:
            self._stream.write(f"spikeloop: {self.part}: {text}\n")
        self._stream.flush()

    def end(self):
        if self._shown:
            self._stream.write("\r\x1b[K")
        self._shown = False
