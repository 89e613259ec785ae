"""The tables of docs/safety.md from measured cells."""

import collections
import re

import faults
from loop import LAYOUTS

BEGIN = "<!-- written by scripts/bench safety -->"
END = "<!-- end of what scripts/bench safety writes -->"


def short_time(cell):
    """The time until the robot is at rest, or what happens instead."""
    if cell.effect == "none" and cell.then == "driven on":
        return "no effect"
    return "driven on" if cell.rest_ms == float("inf") else f"{cell.rest_ms:.0f} ms"


def outcome(cell):
    """How the run goes on; its exit code if it ends by itself."""
    if cell.then == "ended":
        return f"ends: {cell.exit_code}"
    return {"continued": "continues", "driven on": "goes on"}.get(cell.then, cell.then)


def _general(text):
    """The text without what differs between layouts and runs: names of processes, their numbers."""
    text = re.sub(r"(\bprocess|\bpid|-CONT) \d+", r"\1 N", text.replace("|", "/"))
    text = re.sub(r"(spikeloop-scratch-)\w{6}", r"\1*", text)
    text = re.sub(r"^\w+: warning: (node '\w+': )?", "warning: ", text)
    return re.sub(r"^('\w+' \([\w.-]+\)|spikeloop-fused)(?= (was|ended))", "PROCESS", text)


def decisive_line(cell):
    """The reason if the run has ended, else the first line after the fault."""
    own = [line for line in cell.lines if line.startswith("spikeloop: ")] or [
        line for line in cell.lines if ": " in line]
    if not own:
        return "nothing"
    line = (own[-1] if cell.then == "ended" else own[0]).split("; its last line: ")[0]
    text = _general(line.removeprefix("spikeloop: "))
    return f"after SIGCONT: {text}" if cell.printed_later and cell.effect == "stopped" else text


def line(cell):
    """One line about the cell."""
    complaints = "".join(f"  <-- {text}" for text in cell.complaints)
    return f"{short_time(cell)}, {outcome(cell)}: {decisive_line(cell)}{complaints}"


def _distinct(values):
    """Values that differ, the most frequent one first."""
    return "; ".join(value for value, _ in collections.Counter(values).most_common())


def _times(cells, fault):
    """A column per layout: over ROS 1 and over ROS 2."""
    def column(layout):
        both = [short_time(cells[key]) for ros in "12" if (key := (fault.name, layout, ros)) in cells]
        if len(both) == 2 and all(text.endswith(" ms") for text in both):
            return f"{both[0].removesuffix(' ms')}, {both[1]}"
        return ", ".join(dict.fromkeys(both)) or "-"
    return [column(layout) for layout in LAYOUTS]


def _cells_of(cells, fault):
    return [cell for cell in cells.values() if cell.fault == fault.name]


def _row(*columns):
    return f"| {' | '.join(columns)} |"


def signal_table(cells):
    lines = ["| process | signal | fused | separate | `.music` | the run | printed | left behind |", "|---" * 8 + "|"]
    for fault in faults.FAULTS:
        measured = _cells_of(cells, fault)
        if fault.process and fault.signal and measured:
            left = [text for cell in measured for text in cell.left]
            lines.append(_row(fault.process, fault.signal, *_times(cells, fault),
                              _distinct(map(outcome, measured)), _distinct(map(decisive_line, measured)),
                              _distinct(left) or "nothing"))
    return lines


def other_table(cells):
    lines = ["| fault | governed by | at most | fused | separate | `.music` | the run |", "|---" * 7 + "|"]
    for fault in faults.OTHERS:
        if measured := _cells_of(cells, fault):
            lines.append(_row(fault.name, fault.governor, f"{fault.bound_ms} ms", *_times(cells, fault),
                              _distinct(map(outcome, measured))))
    return lines


def tables(cells):
    return "\n".join([*other_table(cells), "", *signal_table(cells)])


def write(path, cells):
    """Replaces the tables of the page. They must be complete."""
    missing = [(fault.name, layout, ros) for fault in faults.FAULTS for layout in fault.layouts for ros in "12"
               if (fault.name, layout, ros) not in cells]
    if missing:
        print(f"{path} is not changed, because {len(missing)} faults were not measured")
        return
    before, rest = path.read_text(encoding="utf-8").split(BEGIN)
    path.write_text(f"{before}{BEGIN}\n\n{tables(cells)}\n\n{END}{rest.split(END)[1]}", encoding="utf-8")
