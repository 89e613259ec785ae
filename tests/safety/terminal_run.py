"""A run that is started in a terminal, by a shell with job control."""

import fcntl
import os
import pty
import re
import shlex
import subprocess
import termios
import threading

from faulty_run import FaultyRun, jobs
from robots import ros


class TerminalRun(FaultyRun):
    """The keys are written to the terminal, so the kernel sends the signals."""

    def start(self):
        self._terminal, end = pty.openpty()
        self._code = None
        # PS1: prompts are not output of the run.
        self.process = subprocess.Popen(
            ["bash", "--norc", "--noprofile", "-i"], env={**self.environment, "PS1": "", "HISTFILE": ""}, stdin=end,
            stdout=end, stderr=end, start_new_session=True, preexec_fn=lambda: fcntl.ioctl(0, termios.TIOCSCTTY, 0))
        os.close(end)
        self.log.touch()
        threading.Thread(target=self._read, daemon=True).start()
        self._type(f"{shlex.join(self.words)}\n")
        ros.until(self._find_launcher, "the start of the launcher", 20)

    def _find_launcher(self):
        for pid, (words, _) in jobs.processes_of(self.process.pid).items():
            if words[-1] == "spikeloop" and jobs.parent(pid) == self.process.pid:
                self.launcher = pid
        return "launcher" in vars(self)

    def _read(self):
        with open(self.log, "ab", buffering=0) as log:
            while True:
                try:
                    log.write(os.read(self._terminal, 4096))
                except OSError:  # the shell has ended
                    break
        os.close(self._terminal)

    def _type(self, text):
        os.write(self._terminal, text.encode())

    def exit_code(self):
        """Asks the shell when the launcher has ended."""
        if self._code is None and not jobs.state(self.launcher):
            self._type('echo "code of the run: $?"\n')
            answer = re.compile(r"code of the run: (\d+)\s")
            ros.until(lambda: answer.search(self.printed()), "the exit code in the terminal", 20)
            self._code = int(answer.search(self.printed())[1])
            self._type("exit\n")
            self.process.wait(20)
        return self._code

    def send_ctrl_c(self):
        self._type("\x03")

    def send_ctrl_z(self):
        self._type("\x1a")

    def resume(self, pid):
        self._type("fg\n")
