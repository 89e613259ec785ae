#!/usr/bin/python3
"""A folder in which somebody else has made links: every command that writes a file replaces the link, and leaves its
target as it is, or does not make it."""

import pathlib
import shutil
import sys
import tempfile

from hostile import ROBOT, Answer, programs

SPIKELOOP = programs() / "spikeloop"
SECRET = "of somebody else"
MUSIC = """stoptime=0.1
[a]
np=1
binary=spikeloop-network
network=net.yaml
[b]
np=1
binary=linear_readout_decoder
weights=uniform
a.out -> b.in [3]
"""
SOURCE = "populations: {p: {model: poisson, size: 3, parameters: {rate: 100 Hz}}}\noutput: [p]\n"


def names(folder):
    """Files below a folder."""
    return [path.relative_to(folder) for path in folder.rglob("*") if path.is_file()]


def linked(folder, files, secret):
    """A folder with links: `files`, and files that are renamed to them, lead to a file and to none."""
    shutil.rmtree(folder, ignore_errors=True)
    for number, file in enumerate(files):
        for name, target in ((file, secret), (f"{file}.new", secret.parent / f"none{number}")):
            if number % 2:
                target = secret if target != secret else secret.parent / f"none{number}"
            path = folder / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.symlink_to(target)


def commands(folder):
    """Words of each command that writes files, and the folder that it writes to."""
    film = folder / "film"
    return [
        (["run", "it.yaml", "--out", "run", "--force"], "run"),
        (["run", "it.yaml", "--no-record", "--out", "png", "--render", "film/end.png", "--force"], "film"),
        (["run", "it.music", "--record", "--out", "job-run", "--force"], "job-run"),
        (["plot", "good", "--out", "plots"], "plots"),
        (["graph", "it.yaml", "--out", "graphs/it.svg"], "graphs"),
        (["graph", "it.yaml", "--out", "graphs/it.dot"], "graphs"),
        (["export", "it.music", "--out", "exported", "--srun"], "exported"),
        (["import", "it.music", "--out", "imported/it.yaml"], "imported"),
        (["fit", "nef_encoder", "--neurons", "5", "--rates", "--out", "fit/w.json", "--picture", "fit/w.png"], "fit"),
        (["fit", "nef_encoder", "--neurons", "5", "--rates", "--out", "fit/w.npy"], "fit"),
    ] + ([(["run", "it.yaml", "--no-record", "--out", "mp4", "--render", f"{film}/it.mp4", "--force"], "film")]
         if shutil.which("ffmpeg") else [])


def main():
    with tempfile.TemporaryDirectory() as scratch:
        folder = pathlib.Path(scratch)
        (folder / "it.yaml").write_text(ROBOT.replace("FILE", "arena"))
        (folder / "it.music").write_text(MUSIC)
        (folder / "net.yaml").write_text(SOURCE)
        secret = folder / "others/secret"
        secret.parent.mkdir()
        secret.write_text(SECRET)
        good = Answer(SPIKELOOP, "run", "it.yaml", "--out", "good", cwd=folder)
        assert good.code == 0, good.text
        count = 0
        for words, out in commands(folder):
            shutil.rmtree(folder / out, ignore_errors=True)
            (folder / out).mkdir()
            clean = Answer(SPIKELOOP, *words, cwd=folder)
            assert clean.code == 0, f"{clean.command}: {clean.text}"
            files = names(folder / out)
            assert files, f"{clean.command} has written nothing"
            linked(folder / out, files, secret)
            answer = Answer(SPIKELOOP, *words, cwd=folder)
            assert answer.code == 0, f"{answer.command}: {answer.text}"
            assert secret.read_text() == SECRET, f"{answer.command} has written to the target of a link"
            assert names(secret.parent) == [pathlib.Path("secret")], f"{answer.command} has made the target of a link"
            for file in files:
                path = folder / out / file
                assert path.is_file() and not path.is_symlink(), f"{answer.command}: {file} is not a new file"
            count += len(files)
    print(f"{count} files were written in place of links, and not to their targets")


if __name__ == "__main__":
    sys.exit(main())
