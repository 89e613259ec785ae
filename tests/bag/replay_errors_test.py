#!/usr/bin/python3
"""What spikeloop replay says of folders that it cannot replay, and of doubts."""

import json
import pathlib
import shutil
import sys
import tempfile

import bags
import runs

MUSIC = """stoptime=0.2
music_timestep=0.001
[playback]
  binary=spike_playback
  np=1
  file=run/encoder.h5
[brain]
  binary=spikeloop-network
  network=net.yaml
  np=1
  playback.out -> brain.in [12]
"""
NETWORK = """populations:
  i: {model: input, size: 12}
  r: {model: repeater, size: 12}
connections: [{from: i, to: r, rule: one_to_one, delay: 1 ms}]
output: [r]
"""


class Replays:
    def __init__(self, scratch):
        self.scratch = scratch

    def refused(self, folder, why, *more, code=2):
        printed = bags.spikeloop("replay", self.scratch / folder, *more, code=code)
        runs.assert_says(printed, f"spikeloop: {why}")
        assert not list(self.scratch.glob(f"{folder}-replay-*")), "a folder was made"

    def cannot(self, folder, why):
        self.refused(folder, f"'{self.scratch / folder}' cannot be replayed: {why}")

    def copy(self, name):
        shutil.copytree(self.scratch / "run", self.scratch / name)
        return self.scratch / name


def change(path, key, value):
    contents = json.loads(path.read_text())
    contents[key] = value
    path.write_text(json.dumps(contents))


def no_runs(replays):
    scratch = replays.scratch
    replays.refused("nowhere", f"cannot read '{scratch}/nowhere': ... [SL0109]", code=4)
    replays.refused("good.bag", f"cannot read '{scratch}/good.bag': ... [SL0109]", code=4)
    (scratch / "empty").mkdir()
    replays.cannot("empty", "it is not a run folder, there is no resolved.json in it; write the folder "
                            "that  spikeloop run FILE.yaml  has named")
    (scratch / "loop.music").write_text(MUSIC)
    (scratch / "net.yaml").write_text(NETWORK)
    bags.spikeloop("run", scratch / "loop.music", "--out", scratch / "music")
    replays.cannot("music", "it is the run of a .music file, whose messages are not recorded; its "
                            "recordings (record=true) are sources for spike_playback and "
                            "signal_playback")


def incomplete_runs(replays):
    scratch = replays.scratch
    bags.spikeloop("run", scratch / "x.yaml", "--no-record", "--out",
                   scratch / "unrecorded")
    replays.cannot("unrecorded", "it was run with --no-record; run it without")
    for name, why in (("messages.mcap", "the messages that its nodes took"),
                      ("experiment.yaml", "the copy of the experiment that was run")):
        folder = replays.copy("without-" + name)
        (folder / name).unlink()
        replays.cannot(folder.name, f"there is no {name} in it, {why}")
    folder = replays.copy("killed")
    (folder / "summary.json").unlink()
    replays.cannot("killed", "there is no summary.json in it: the run has not ended yet, or it was "
                             "killed; run it again")
    (replays.copy("emptied") / "summary.json").write_text("")
    replays.cannot("emptied", "its summary.json is damaged, or empty; run it again")
    (replays.copy("unheard") / "encoder.h5").unlink()
    replays.cannot("unheard", "there is no encoder.h5 in it, the recording of its node 'encoder'")
    change(replays.copy("early") / "summary.json", "simulated_s", 0.0)
    replays.cannot("early", "it was stopped before its first tick; run it again")
    change(replays.copy("odd") / "resolved.json", "settings", [["seed"]])
    replays.cannot("odd", "its resolved.json or summary.json does not say what a run writes there")
    folder = replays.copy("old")
    resolved = json.loads((folder / "resolved.json").read_text())
    del resolved["recorded"]
    (folder / "resolved.json").write_text(json.dumps(resolved))
    replays.cannot("old", "an earlier version ran it, which kept no messages; run it again")
    replays.refused("run", f"--out: '{scratch}/run' is the run itself, which a new run would empty; "
                           "write another folder, or leave it out [SL0109]", "--out", scratch / "run")
    assert (scratch / "run/messages.mcap").exists()


def doubts(replays):
    """The run can be replayed, but something speaks against the same spikes."""
    def told(name, text, code=0):
        printed = bags.spikeloop("replay", replays.scratch / name, code=code)
        runs.assert_says(printed, f"spikeloop: warning: {text}")

    change(replays.copy("dropped") / "summary.json", "messages_dropped", 3)
    told("dropped", "the run lost 3 messages, as the disk was too slow: spikes may differ")
    change(replays.copy("lost") / "summary.json", "records_dropped", 2)
    told("lost", "the run lost 2 recorded items, as the disk was too slow: spikes may differ")
    change(replays.copy("version") / "resolved.json", "version", "0.0.1")
    told("version", "Spikeloop 0.0.1 ran it, this is ")
    copy = replays.copy("edited") / "experiment.yaml"
    copy.write_text(copy.read_text().replace("200 Hz", "300 Hz"))
    told("edited", "node 'encoder': key 'rate_max' was 200.0, it is 300.0 now: spikes may differ",
         code=6)
    copy = replays.copy("renamed") / "experiment.yaml"
    copy.write_text(copy.read_text().replace("encoder:", "coder:").replace(" encoder", " coder"))
    told("renamed", "node 'encoder' is gone: spikes may differ", code=6)
    told("renamed", "node 'coder' is new: spikes may differ", code=6)


def main():
    with tempfile.TemporaryDirectory() as scratch:
        scratch = pathlib.Path(scratch)
        bags.write(scratch / "good.bag",
                   [(10**9 + i * 50_000_000, message) for i, message in enumerate(bags.arena(20))])
        bags.experiment(scratch / "x.yaml", "good.bag")
        bags.spikeloop("run", scratch / "x.yaml", "--out", scratch / "run")
        replays = Replays(scratch)
        no_runs(replays)
        incomplete_runs(replays)
        doubts(replays)
    print("folders without a run are refused, doubts are told")


if __name__ == "__main__":
    sys.exit(main())
