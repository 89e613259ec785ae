"""One cell of the tables: a run with a fault, and its judgement."""

import dataclasses
import pathlib
import tempfile
import time
import typing

import faults
import loop
from faulty_run import ENDS_S, RESUMES_S, FaultyRun, jobs
from terminal_run import TerminalRun

NEVER = float("inf")
DRIVEN_ON = "driven on"
ROBOT_TOPIC = ["--ros-args", "-r", "/scan:=/vehicle/scan", "--"]  # where the observer does not publish


@dataclasses.dataclass
class Cell:
    """The observations of a cell, and the rules that they break."""
    fault: str
    layout: str
    ros: str
    rest_ms: float = NEVER  # until the zero command that only zeros follow
    effect: str = ""  # on the process: gone, stopped, none
    then: str = ""  # ended, continued, driven on, at rest
    exit_code: typing.Optional[int] = None
    lines: list = dataclasses.field(default_factory=list)  # printed after the fault
    printed_later: bool = False  # after SIGCONT
    left: list = dataclasses.field(default_factory=list)
    complaints: list = dataclasses.field(default_factory=list)

    @property
    def key(self):
        return (self.fault, self.layout, self.ros)


def measure(fault, layout, version, robot):
    """Runs once."""
    cell = Cell(fault.name, layout, version)
    with tempfile.TemporaryDirectory(prefix="faults-") as name:
        folder = pathlib.Path(name)
        words = _words(fault, layout, version, folder)
        robot.scans(fault.process != "robot")
        run = (TerminalRun if fault.terminal else FaultyRun)(robot, words, folder)
        try:
            run.await_driven(fault.when)
            _disturb(cell, fault, run)
            _finish(cell, run)
            cell.complaints = _complaints(cell, fault) + cell.complaints
        except AssertionError as error:
            cell.complaints.append(str(error))
            cell.lines = run.lines()
        finally:
            robot.press_stop(False)
            run.close()
    return cell


def that_counts(cells):
    """The run in the middle, those that break a rule last; but any run in which the robot was driven on."""
    in_order = sorted(cells, key=lambda cell: (bool(cell.complaints), cell.rest_ms))
    driven_on = [cell for cell in cells if DRIVEN_ON in cell.complaints]
    return (driven_on or in_order[len(cells) // 2:])[0]


def _words(fault, layout, version, folder):
    """The command of the run. Writes its files."""
    own_robot = fault.process == "robot"
    width = 100 if own_robot else 10  # readings per scan
    text = loop.experiment(layout != "fused", width)
    if own_robot and layout != "music":
        text += "robot: {simulator: mujoco}\n"
    words = loop.command(loop.write(folder, text, width), version, layout)
    if own_robot:
        words += [*(["--robot"] if layout == "music" else []), *ROBOT_TOPIC]
    if fault.process == "live server":
        words += ["--live", "--live-port", "0"]
    return words


def _disturb(cell, fault, run):
    """Makes the fault and waits for its effect; undoes the fault where it can be undone."""
    roles = run.find()
    pid = faults.target(fault, roles) or run.launcher
    run.mark()
    begin = fault.make(run, roles)
    printed_ms = run.observe(begin)
    cell.lines = run.lines()
    if run.robot.last() == 0:
        cell.rest_ms = run.robot.time_to_rest_ms(begin)
    elif run.robot.has_stopped_since(begin):
        cell.complaints.append("the robot was stopped and driven again")
    state = jobs.state(pid)
    # mpirun handles SIGTSTP by stopping the programs instead of itself.
    stopped = state == "T" or (state and fault.signal == "SIGTSTP" and cell.rest_ms != NEVER)
    cell.effect = "stopped" if stopped else "none" if state else "gone"
    if fault.warns and cell.effect != "none" and not (printed_ms and printed_ms < 1000):
        cell.complaints.append("no warning within 1 s")
    if fault.undo is not None:
        fault.undo(run.robot)
    elif cell.effect == "stopped":
        run.resume(pid)
    ended = run.await_end(RESUMES_S, or_driven=True)
    cell.printed_later = not cell.lines
    cell.lines = run.lines() if ended else cell.lines or run.lines()
    if ended or not run.robot.is_driven():
        cell.then = "ended" if ended else "at rest"
    else:
        cell.then = DRIVEN_ON if cell.rest_ms == NEVER else "continued"


def _finish(cell, run):
    """Ends the run by Ctrl-C if it has not ended, and looks at what is left."""
    if run.exit_code() is None:
        run.find()
        was_driven = run.robot.last() != 0
        begin = time.monotonic()
        run.send_ctrl_c()
        if not run.await_end(ENDS_S):
            cell.complaints.append(f"Ctrl-C does not end the run within {ENDS_S} s")
        rest_ms = run.robot.time_to_rest_ms(begin)
        if was_driven and rest_ms > loop.MARGIN_MS:
            cell.complaints.append(f"Ctrl-C stops the robot after {rest_ms:.0f} ms")
        if run.exit_code() != 130:
            cell.complaints.append(f"exit code {run.exit_code()} after Ctrl-C")
    cell.exit_code = run.exit_code()
    cell.left = run.left_behind()
    if run.robot.last() != 0:
        cell.complaints.append(f"the last command is {run.robot.last()}")


def _complaints(cell, fault):
    """The rules of the table."""
    unharmed = fault.process and cell.effect == "none" and cell.then == DRIVEN_ON
    found = {
        DRIVEN_ON if cell.rest_ms == NEVER else f"at rest only after {cell.rest_ms:.0f} ms":
            fault.bound_ms is not None and not unharmed and cell.rest_ms > fault.bound_ms,
        "the robot was stopped": fault.bound_ms is None and cell.rest_ms != NEVER,
        "the launcher is not suspended": fault.suspends and cell.effect != "stopped",
        "the run neither continues nor ends": cell.then == "at rest",
        "no reason is printed": cell.then == "ended" and fault.process != "launcher" and not any(
            line.startswith("spikeloop: ") for line in cell.lines),
        f"left behind: {', '.join(cell.left)}": cell.left}
    return [text for text, is_so in found.items() if is_so]
