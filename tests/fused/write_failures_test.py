"""A run whose files can no longer be written: it warns at once, and stops or continues; in one
process and in several, with and without ROS."""

import json
import pathlib
import resource
import signal
import subprocess
import tempfile
import time

import ros
import runs

SEVERAL = "{first: [scan, sectors, encoder], second: [brain, decoder, wheels]}"
LAYOUTS = {
    "in-process": {},
    "over ROS 2": {"ros": "2"},
    "over MUSIC": {"ros": "2", "layout": SEVERAL},
}


def all_opened(folder):
    """True if every node's recording exists."""
    sizes = [file.stat().st_size for file in folder.glob("*.h5")]
    return len(sizes) == 6 and all(sizes)


def deleted(scratch, policy, keys):
    """Deletes the folder of a run. Returns its output, its exit code and the wall time until its
    end."""
    file = runs.new_experiment(scratch / "explorer.yaml", duration="6 s", on_write_failure=policy,
                               **keys)
    folder = scratch / "run"
    process = runs.started(file, folder)
    runs.wait(process, lambda: all_opened(folder))
    subprocess.run(["rm", "-rf", folder], check=True)
    begin = time.monotonic()
    _, said = process.communicate(timeout=120)
    return said, process.returncode, time.monotonic() - begin


def test_deleted_folder(scratch):
    for name, keys in LAYOUTS.items():
        for policy in "stop", "continue":
            said, code, took = deleted(scratch, policy, keys)
            print(f"{name}, {policy}: exit code {code} after {took:.1f} s\n{said}")
            assert code == 4, (name, policy, said)
            assert "it has been deleted during the run" in said, said
            assert ("the run continues" in said) == (policy == "continue"), said
            last = [line for line in said.splitlines() if line.startswith("spikeloop: ")][-1]
            assert "cannot write" in last and "[SL0109]" in last, said


def test_ctrl_c_names_incomplete_files(scratch):
    """In an experiment without an end, after all programs that write files have noticed."""
    for warnings, (name, keys) in enumerate(LAYOUTS.items(), 1):
        file = runs.new_experiment(scratch / "endless.yaml", duration="1 h", on_write_failure="continue", **keys)
        folder = scratch / "endless"
        process = runs.started(file, folder)
        runs.wait(process, lambda: all_opened(folder))
        subprocess.run(["rm", "-rf", folder], check=True)
        said = ""
        while said.count("the run continues") < warnings:
            line = process.stderr.readline()
            assert line, (name, said)
            said += line
        process.send_signal(signal.SIGINT)
        said += process.communicate(timeout=60)[1]
        assert process.returncode == 4, (name, said)
        last = [line for line in said.splitlines() if line.startswith("spikeloop: ")][-1]
        assert "; incomplete: " in last, (name, said)


def with_small_files(*arguments):
    """Runs spikeloop with files limited to 300 kB, as on a full disk."""
    return subprocess.run(
        [runs.SPIKELOOP, "run", *map(str, arguments)], capture_output=True, text=True,
        restore_signals=False,  # Python ignores SIGXFSZ
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (300_000, 300_000)))


def test_full_disk(scratch):
    for policy in "stop", "continue":
        file = runs.new_experiment(scratch / "full.yaml", duration="8 s", on_write_failure=policy)
        folder = scratch / f"full-{policy}"
        said = with_small_files(file, "--out", folder).stderr
        summary = json.loads((folder / "summary.json").read_text())
        assert summary["exit_code"] == 4, said
        assert summary["incomplete_files"], summary
        assert "File too large" in summary["exit_reason"], summary
        assert (summary["simulated_s"] == 8) == (policy == "continue"), summary


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as directory, ros.domain():
        test_deleted_folder(pathlib.Path(directory))
        test_ctrl_c_names_incomplete_files(pathlib.Path(directory))
        test_full_disk(pathlib.Path(directory))
