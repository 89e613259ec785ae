#!/usr/bin/python3
"""`spikeloop run --hostfile`: a job on three machines, that is network namespaces with an ssh server each. A job
ends in time when one of them dies in it, and when one cannot be reached; nothing is left anywhere."""

import contextlib
import os
import pathlib
import re
import signal
import subprocess
import sys
import tempfile
import time

sys.path.insert(0, str(pathlib.Path(__file__).parent.parent / "ros2"))
import networks  # noqa: E402

SPIKELOOP = sys.argv[1]
ADDRESSES = [f"10.77.0.{i}" for i in (1, 2, 3)]
NOBODY = "10.77.0.9"
PATIENCE_S = 90

SCRIPT = """#!/usr/bin/python3
import socket
import spikeloop

with spikeloop.music(spikes_in={"in": 10}, spikes_out={"out": 10}) as host:
    print(f"{host.label} is on {socket.gethostname()}", flush=True)
    heard = 0
    for tick in host:
        heard += len(tick.spikes("in")[1])
        if host.label == "source":
            tick.send("out", tick.end_s, range(10))
        else:
            tick.send("out", *tick.spikes("in"))
    print(f"{host.label} has heard {heard} spikes", flush=True)
"""
MUSIC = """
stoptime={stoptime}
music_timestep=0.001
[source]
  np=1
  binary=./script.py
[relay]
  np=1
  binary=./script.py
[sink]
  np=1
  binary=./script.py
source.out -> relay.in [10]
relay.out -> sink.in [10]
"""


def let_in(folder):
    """Keys, and a home of root's whose owner may log in."""
    home = folder / "home"
    (home / ".ssh").mkdir(mode=0o700, parents=True)
    subprocess.run(["dropbearkey", "-t", "ed25519", "-f", folder / "host_key"], check=True, capture_output=True)
    subprocess.run(["ssh-keygen", "-q", "-t", "ed25519", "-N", "", "-f", folder / "user_key"], check=True)
    (folder / "user_key.pub").rename(home / ".ssh/authorized_keys")
    (folder / "ssh.conf").write_text(
        f"Host *\nUser root\nIdentityFile {folder}/user_key\nBatchMode yes\nStrictHostKeyChecking no\n"
        "UserKnownHostsFile /dev/null\nLogLevel ERROR\n")
    (folder / "passwd").write_text(f"root:x:0:0::{home}:/bin/sh\n")
    subprocess.run(["mount", "--bind", folder / "passwd", "/etc/passwd"], check=True)


@contextlib.contextmanager
def machines(folder):
    let_in(folder)
    with networks.switched(ADDRESSES) as found:
        for i, machine in enumerate(found, 1):
            log = folder / f"dropbear{i}.log"
            with open(log, "w") as out:
                subprocess.Popen([*machine.enter, "dropbear", "-F", "-E", "-r", folder / "host_key", "-P", ""],
                                 stderr=out)
            wait_for(lambda text=log.read_text: "Not backgrounding" in text(), "dropbear")
        yield found


def wait_for(condition, what):
    patience = time.monotonic() + PATIENCE_S
    while not condition():
        assert time.monotonic() < patience, f"no {what} within {PATIENCE_S} s"
        time.sleep(0.05)


def processes_of(machine):
    """Beside the one that is the machine."""
    own = os.stat(f"/proc/{machine.pid}/ns/net").st_ino
    found = {}
    for entry in pathlib.Path("/proc").glob("[0-9]*"):
        with contextlib.suppress(OSError):
            command = (entry / "cmdline").read_text().replace("\0", " ")
            if os.stat(entry / "ns/net").st_ino == own and int(entry.name) != machine.pid:
                found[int(entry.name)] = command
    return found


def programs_of(machine):
    return [command for command in processes_of(machine).values() if command and "dropbear" not in command]


class Job:
    """`spikeloop run` on the first machine."""

    def __init__(self, folder, machine, hosts, stoptime, *options):
        (folder / "script.py").write_text(SCRIPT)
        (folder / "script.py").chmod(0o755)
        (folder / "job.music").write_text(MUSIC.format(stoptime=stoptime))
        (folder / "hosts").write_text("".join(f"{host} slots=1\n" for host in hosts))
        self.out = folder / f"run{len(list(folder.glob('run*')))}"
        self._log = folder / f"{self.out.name}.txt"
        # Open MPI's own way; a user has this in ~/.ssh/config.
        environment = {**os.environ, "OMPI_MCA_plm_rsh_args": f"-F {folder}/ssh.conf"}
        self._began = time.monotonic()
        self._process = subprocess.Popen(
            [*machine.enter, SPIKELOOP, "run", folder / "job.music", "--hostfile", folder / "hosts",
             "--out", self.out, *options],
            env=environment, stdin=subprocess.DEVNULL, stdout=open(self._log, "w"), stderr=subprocess.STDOUT)

    def output(self):
        return self._log.read_text()

    def end(self):
        """Returns its exit code."""
        try:
            code = self._process.wait(PATIENCE_S)
        except subprocess.TimeoutExpired:
            self._process.kill()
            raise AssertionError(f"the job hangs:\n{self.output()}") from None
        print(f"exit code {code} after {time.monotonic() - self._began:.1f} s:\n{self.output()}", flush=True)
        return code


def good_job(folder, found):
    job = Job(folder, found[0], ADDRESSES, 2)
    assert job.end() == 0
    # Open MPI says who goes where.
    assert set(re.findall(r" is on (m\d)", job.output())) == {"m1", "m2", "m3"}
    # 2,000 ticks of 10 spikes; the last ones are still on their way.
    heard = int(job.output().split("sink has heard ")[1].split()[0])
    assert 19_900 <= heard <= 20_000, heard


def one_dies(folder, found):
    job = Job(folder, found[0], ADDRESSES, 600, "--stall-timeout", "5")
    wait_for(lambda: job.output().count(" is on ") == 3 and " of 600 s" in job.output(), "running job")
    networks.cut_off(3)
    for process in processes_of(found[2]):
        os.kill(process, signal.SIGKILL)
    assert job.end() == 3
    for i, machine in enumerate(found[:2], 1):
        wait_for(lambda m=machine: not programs_of(m), f"end of all programs on m{i}: {programs_of(machine)}")


def one_cannot_be_reached(folder, found):
    job = Job(folder, found[0], [*ADDRESSES[:2], NOBODY], 2, "--start-timeout", "20")
    assert job.end() == 3
    for machine in found[:2]:
        wait_for(lambda m=machine: not programs_of(m), "end of all programs")


networks.enter(as_root=True)
with tempfile.TemporaryDirectory() as scratch, machines(pathlib.Path(scratch)) as three:
    for judge in (good_job, one_cannot_be_reached, one_dies):
        print(f"== {judge.__name__}", flush=True)
        judge(pathlib.Path(scratch), three)
