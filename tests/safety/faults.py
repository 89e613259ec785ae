"""The faults of docs/safety.md: signals to every process of a run, and what else stops a robot."""

import os
import signal
import time
import typing

import robots
from faulty_run import jobs
from loop import MARGIN_MS, SENSOR_TIMEOUT_MS, WATCHDOG_MS

SIGNALS = ("SIGSTOP", "SIGKILL", "SIGTERM", "SIGTSTP", "SIGHUP")


class Process(typing.NamedTuple):
    """A process of a run, and what must happen when it fails."""
    layouts: tuple
    bound_ms: typing.Optional[float]  # until the robot is at rest; None: it may be driven on
    warns: tuple = SIGNALS  # signals that require a warning if the robot may be driven on
    names: tuple = ()  # its names in jobs.roles, if it has others


SEVERAL = ("separate", "music")
EVERY = ("fused", *SEVERAL)
PROCESSES = {
    "launcher": Process(EVERY, WATCHDOG_MS + MARGIN_MS),
    "mpirun": Process(SEVERAL, WATCHDOG_MS + MARGIN_MS),
    "supervisor": Process(EVERY, WATCHDOG_MS + MARGIN_MS),
    "adapter": Process(EVERY, WATCHDOG_MS + MARGIN_MS, names=("wheels", "experiment")),
    "encoder": Process(SEVERAL, WATCHDOG_MS + MARGIN_MS),
    "simulator": Process(SEVERAL, WATCHDOG_MS + MARGIN_MS, names=("brain",)),
    "guard": Process(EVERY, None),
    # The cleaner only waits for the end of the run: a stopped one does no harm before.
    "cleaner": Process(EVERY, None, warns=("SIGKILL",)),
    "live server": Process(("fused", "separate"), None),
    "robot": Process(EVERY, SENSOR_TIMEOUT_MS + MARGIN_MS),
}


class Fault(typing.NamedTuple):
    """`make(run, roles)` causes the fault and returns its start time. `process`: key of PROCESSES, or empty."""
    name: str
    layouts: tuple
    bound_ms: typing.Optional[float]
    make: typing.Callable
    process: str = ""
    signal: str = ""  # empty in OTHERS
    governor: str = ""
    warns: bool = False
    when: typing.Callable = robots.Robot.is_driven
    undo: typing.Optional[typing.Callable] = None  # undoes a fault of the robot; the run continues
    terminal: bool = False
    suspends: bool = False  # the launcher


def _id_of(process, roles):
    names = PROCESSES[process].names or (process,)
    found = [pid for pid, role in roles.items() if role in names]
    assert found, f"the run has no {process}, only {sorted(roles.values())}"
    return found[0]


def target(fault, roles):
    """The id of the process that gets the signal; None if the fault is not a signal to one process."""
    return _id_of(fault.process, roles) if fault.process else None


def signal_to(process, name):
    def make(_, roles):
        pid = _id_of(process, roles)
        begin = time.monotonic()
        os.kill(pid, getattr(signal, name))
        return begin
    return make


def fault_of(process, name):
    row = PROCESSES[process]
    return Fault(f"{process} {name}", row.layouts, row.bound_ms, signal_to(process, name), process, name,
                 warns=row.bound_ms is None and name in row.warns, suspends=(process, name) == ("launcher", "SIGTSTP"))


def sensor_silent(run, _):
    run.robot.scans(False)
    time.sleep(0.03)  # the last message is still on its way
    return run.robot.sent_at


def sensor_back(robot):
    robot.scans(True)


def press_stop(run, _):
    begin = time.monotonic()
    run.robot.press_stop(True)
    return begin


def release_stop(robot):
    robot.press_stop(False)


def ctrl_c(run, _):
    begin = time.monotonic()
    run.send_ctrl_c()
    return begin


def ctrl_z(run, _):
    begin = time.monotonic()
    run.send_ctrl_z()
    return begin


def kill_behind_stopped_guard(run, roles):
    os.kill(_id_of("guard", roles), signal.SIGSTOP)
    time.sleep(2)  # the launcher has started another guard
    return signal_to("adapter", "SIGKILL")(run, roles)


OTHERS = [
    Fault("sensor silent", EVERY, SENSOR_TIMEOUT_MS + MARGIN_MS, sensor_silent, governor="`sensor_timeout`",
          undo=sensor_back),
    Fault("emergency stop pressed", EVERY, MARGIN_MS, press_stop, governor="message",
          when=robots.Robot.may_press_stop, undo=release_stop),
    Fault("adapter killed at its first command", EVERY, MARGIN_MS, signal_to("adapter", "SIGKILL"), governor="guard",
          when=robots.Robot.has_moved),
    Fault("Ctrl-C", EVERY, MARGIN_MS, ctrl_c, governor="signal"),
    Fault("Ctrl-Z in a terminal, then fg", EVERY, WATCHDOG_MS + MARGIN_MS, ctrl_z, governor="signal", terminal=True,
          suspends=True),
    Fault("guard stopped, adapter killed 2 s later", EVERY, MARGIN_MS, kill_behind_stopped_guard,
          governor="the next guard"),
]
FAULTS = [*(fault_of(process, name) for process in PROCESSES for name in SIGNALS), *OTHERS]

# One fault per mechanism, in the layouts that differ in it: every build tests them.
REPRESENTATIVE = {
    "launcher SIGSTOP": EVERY,
    "launcher SIGKILL": EVERY,
    "mpirun SIGSTOP": SEVERAL,
    "mpirun SIGKILL": ("separate",),
    "supervisor SIGSTOP": ("fused", "separate"),
    "supervisor SIGKILL": ("separate",),
    "adapter SIGSTOP": EVERY,
    "adapter SIGKILL": EVERY,
    "adapter killed at its first command": EVERY,
    "encoder SIGKILL": SEVERAL,
    "simulator SIGSTOP": ("separate",),
    "simulator SIGKILL": ("music",),
    "guard SIGSTOP": ("fused",),
    "guard SIGKILL": ("fused",),
    "guard stopped, adapter killed 2 s later": ("fused", "music"),
    "cleaner SIGKILL": ("fused",),
    "live server SIGKILL": ("fused",),
    "robot SIGKILL": ("fused",),
    "sensor silent": EVERY,
    "emergency stop pressed": EVERY,
    "Ctrl-C": EVERY,
    "Ctrl-Z in a terminal, then fg": ("fused", "music"),
}
assert REPRESENTATIVE.keys() <= {fault.name for fault in FAULTS}


def is_representative(fault, layout):
    return layout in REPRESENTATIVE.get(fault.name, ())
