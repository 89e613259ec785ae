"""One run with one fault: when the robot stops, what is printed, how the run ends, and what is left behind."""

import contextlib
import os
import pathlib
import re
import signal
import subprocess
import sys
import time

from robots import ros

sys.path.insert(0, str(pathlib.Path(__file__).parents[1] / "support"))
import jobs  # noqa: E402
from growing_file import complete_text  # noqa: E402

OBSERVED_S = 1.2  # after the fault: a warning is due within 1 s, and the robot must still be at rest
RESUMES_S = 5  # after SIGCONT the robot is driven again, or the run has ended
START_S = 40
ENDS_S = 15  # mpirun has 10 s to end
VANISH_S = 5  # after the end of the launcher, which may have been killed
PROGRESS = re.compile(r"(spikeloop: )?[\d.]+( of [\d.]+)? s\b")


class FaultyRun:
    """A run in its own process group, started like a shell starts it."""

    def __init__(self, robot, words, folder):
        self.robot, self.folder = robot, folder
        (folder / "tmp").mkdir()
        self.environment = dict(os.environ, SPIKELOOP_FAULTS=str(folder), TMPDIR=str(folder / "tmp"))
        self.words = [str(word) for word in (*words, "--out", folder / "run")]
        self.log = folder / "printed"
        self.seen = 0  # bytes of the log before the fault
        self.shared = set()
        robot.forget()
        self.start()

    def start(self):
        with open(self.log, "wb") as log:
            self.process = subprocess.Popen(self.words, env=self.environment, stdin=subprocess.DEVNULL, stdout=log,
                                            stderr=log, process_group=0)
        self.launcher = self.process.pid

    def exit_code(self):
        """Exit code as a shell shows it; None while the launcher runs."""
        code = self.process.poll()
        return code if code is None or code >= 0 else 128 - code

    def await_driven(self, condition):
        """Waits until the robot is driven and the condition, a method of the robot, is true."""
        ros.until(lambda: condition(self.robot) or self.exit_code() is not None, "a command", START_S)
        assert self.exit_code() is None, "the run ended before the fault"

    def find(self):
        """The roles of the run's processes by id. Remembers their shared memory."""
        roles = jobs.roles(self.launcher)
        self.shared |= jobs.shared_files(roles)
        return roles

    def mark(self):
        """Marks the begin of the fault: output from now on belongs to the fault."""
        self.seen = self.log.stat().st_size

    def lines(self):
        """Complete lines that were printed since the mark, without the progress."""
        text = complete_text(self.log, self.seen)
        lines = re.split(r"[\r\n]+", re.sub(r"\x1b\[\w*", "", text))
        return [line for line in lines if line and not PROGRESS.match(line) and not line.startswith(str(self.folder))]

    def printed(self):
        return self.log.read_text(errors="replace")

    def observe(self, begin):
        """Waits while the fault takes effect. Returns ms until the first line was printed, or None."""
        printed_ms = None
        while time.monotonic() < begin + OBSERVED_S:
            if printed_ms is None and self.lines():
                printed_ms = 1e3 * (time.monotonic() - begin)
            time.sleep(0.005)
        return printed_ms

    def await_end(self, patience_s, or_driven=False):
        """Returns True if the launcher has ended; a driven robot ends the wait, too, if `or_driven`."""
        deadline = time.monotonic() + patience_s
        while self.exit_code() is None and time.monotonic() < deadline:
            if or_driven and self.robot.is_driven():
                return False
            time.sleep(0.01)
        return self.exit_code() is not None

    def resume(self, pid):
        """Sends SIGCONT; to the launcher as a shell does for fg."""
        if pid == self.launcher:
            os.killpg(pid, signal.SIGCONT)
        else:
            jobs.send([pid], signal.SIGCONT)

    def processes(self):
        """Programs of the run's processes by id, including those whose parents have ended."""
        marked = jobs.with_environment(f"SPIKELOOP_FAULTS={self.folder}")
        return {pid: words[-1] for pid, words in marked.items() if jobs.state(pid)}

    def send_ctrl_c(self):
        os.killpg(self.launcher, signal.SIGINT)

    def left_behind(self):
        """Processes and files that are still there when the run has had time to remove them."""
        deadline = time.monotonic() + VANISH_S
        while (left := self._leftovers()) and time.monotonic() < deadline:
            time.sleep(0.02)
        return left

    def _leftovers(self):
        processes = [f"process {program}" for program in self.processes().values()]
        files = [path for path in self.shared if path.exists()]
        return [*processes, *(re.sub("-.{6}$", "-*", str(path)) for path in files),
                *(f"/tmp/{path.name}" for path in (self.folder / "tmp").iterdir())]

    def close(self):
        """Ends what is left, whatever happened: the launcher and its cleaner cannot remove their folders then."""
        self.find()
        jobs.send(self.processes(), signal.SIGKILL)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self.process.wait(10)
        for path in self.shared:
            subprocess.run(["rm", "-rf", path], check=False)
