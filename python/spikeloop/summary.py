"""`spikeloop summary RUN...`: the results of a run, or of several, a column each."""

import os
import pathlib
import signal
import sys

from .run_folder import RunFolder, RunFolderError

# key, label, unit, format
ROWS = (
    ("simulated_s", "simulated time", "s", "{:.1f}"),
    ("wall_s", "wall time", "s", "{:.1f}"),
    ("real_time_factor", "real-time factor", "", "{:.3f}"),
    ("collisions", "collisions", "", "{:d}"),
    ("distance_m", "distance driven", "m", "{:.1f}"),
    ("mean_speed_m_s", "mean speed", "m/s", "{:.2f}"),
    ("coverage", "free cells visited", "%", "{:.0f}"),
    ("visited_m2", "area visited", "m2", "{:.2f}"),
    ("episodes", "episodes", "", "{:d}"),
    ("successes", "successes", "", "{:d}"),
    ("median_return", "return, median", "", "{:.4g}"),
    ("mean_return", "return, mean", "", "{:.4g}"),
    ("spikes", "spikes of the network", "", "{:,d}"),
    ("scans", "laser scans", "", "{:,d}"),
    ("commands", "commands sent", "", "{:,d}"),
    ("stopped_s", "robot stopped by safety", "s", "{:.1f}"),
    ("latency_median_ms", "sensor to command, median", "ms", "{:.2f}"),
    ("latency_p99_ms", "sensor to command, p99", "ms", "{:.2f}"),
)


def value_text(key, value, pattern):
    """The value as the table shows it; '-' for what the run did not measure."""
    if value is None:
        return "-"
    if key == "coverage":
        value = 100 * value
    return pattern.format(int(value) if pattern.endswith("d}") else value)


def wall_text(simulated_ms, factor):
    """What a simulated latency takes where a run is slower than real time."""
    if simulated_ms is None or not factor or factor >= 1:
        return ""
    return f" ({simulated_ms / factor:.1f} ms of wall time)"


def table(summary):
    """The lines of the table: label, value, unit."""
    lines = []
    for key, label, unit, pattern in ROWS:
        if key in summary and not (key == "stopped_s" and summary[key] == 0):
            if key.startswith("latency_") and summary.get("latency_clock") == "simulated":
                unit = "ms, simulated" + wall_text(summary[key], summary.get("real_time_factor"))
            lines.append(f"  {label:<27}{value_text(key, summary[key], pattern):>10} {unit}".rstrip())
    return lines


def read_summary(folder):
    """The contents of FOLDER/summary.json. @raises RunFolderError"""
    run, results = RunFolder(folder), pathlib.Path(folder) / "results.csv"
    if os.path.exists(results) and not os.path.exists(run.path / "summary.json"):
        raise RunFolderError(f"'{folder}' is a sweep: its results are in {results}, and each of its folders is a run")
    return run.summary()


def settings_of(folder):
    """What was set in place of the experiment's keys."""
    try:
        return {key: value for key, value, _ in RunFolder(folder).resolved().get("settings", [])}
    except RunFolderError:
        return {}


def comparison(folders):
    """The lines of a table with a column for each run: settings that differ, then results."""
    summaries, settings = [read_summary(folder) for folder in folders], [settings_of(folder) for folder in folders]
    rows = [["", *(pathlib.Path(folder).resolve().name for folder in folders)]]
    for key in dict.fromkeys(key for setting in settings for key in setting):
        values = [setting.get(key, "-") for setting in settings]
        if len(set(values)) > 1:
            rows.append([key, *(value if len(value) <= 24 else value[:21] + "..." for value in values)])
    for key, label, unit, pattern in ROWS:
        if any(key in summary for summary in summaries):
            rows.append([f"{label}, {unit}" if unit else label,
                         *(value_text(key, summary.get(key), pattern) for summary in summaries)])
    if any(summary.get("exit_code") for summary in summaries):
        rows.append(["exit code", *(str(summary.get("exit_code", "-")) for summary in summaries)])
    widths = [max(10, *(len(row[column]) for row in rows)) for column in range(len(rows[0]))]
    return ["  ".join(["", row[0].ljust(widths[0]), *map(str.rjust, row[1:], widths[1:])]).rstrip() for row in rows]


def main(folders):
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)  # spikeloop summary RUN | head
    try:
        if len(folders) > 1:
            print("\n".join(comparison(folders)))
            return
        folder = pathlib.Path(folders[0])
        print("\n".join(table(read_summary(folder))))
    except RunFolderError as error:
        print(f"spikeloop: {error}", file=sys.stderr)
        sys.exit(error.exit_code)
    made = sorted(p.name for p in folder.iterdir() if p.suffix in (".png", ".json", ".h5", ".csv"))
    print(f"\nin {folder}/: {', '.join(made)}")


if __name__ == "__main__":
    main([argument for argument in sys.argv[1:] if argument != "--"])
