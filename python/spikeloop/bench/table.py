"""The results as text: what was reached, the goal, the paper's value."""

from . import chain, figures, paper, simulators, sweeps

HEAD = ("", "measured", "goal", "paper")


def lines(document):
    """The table, and a line for everything that was not measured."""
    rows = [*_neurons(document), *_rates(document), *_ticks(document), *_nest(document)]
    yield from _aligned([HEAD, *rows]) if rows else ()
    yield from _latencies(document)
    for entry in document["not_measured"]:
        yield f"not measured: {_name(entry)}: {entry['reason']}"


def _name(entry):
    if "encoder" not in entry:
        return f"latency, {entry['layout']}, tick {entry['tick_ms']:g} ms"
    rate = f", {entry['rate_max_hz']:g} Hz" if entry["rate_min_hz"] == entry["rate_max_hz"] else ""
    return (f"{entry['encoder']}, {simulators.NAMES[entry['simulator']]}, {entry['layout']}, "
            f"tick {entry['tick_ms']:g} ms{rate}")


def reached(entry):
    """"120,000", or "4,000,000 or more" when nothing larger was tried."""
    return f"{entry['neurons']:,}" + (" or more" if entry["next"] is None else "")


def _neurons(document):
    tick_ms = sweeps.COARSE_TICK_MS
    for encoder in chain.ENCODERS:
        for simulator in simulators.NAMES:
            for layout in ("fused", "separate"):
                entry = figures.largest(document, layout, encoder, simulator, tick_ms)
                if entry is not None:
                    yield (f"{encoder} neurons in real time, {simulators.NAMES[simulator]}, {layout}",
                           reached(entry), _text(figures.goal(layout, encoder, simulator)),
                           _text(paper.NEURONS[encoder] if simulator == "none" else None))


def _rates(document):
    for layout in ("fused", "separate"):
        found = figures.by_rate(document, layout)
        if found:
            same = found[0]["neurons"] == paper.RATE_NEURONS
            rate = figures.highest_rate(document, layout)
            more = " or more" if rate == found[-1]["rate_max_hz"] else ""
            yield (f"rate of {found[0]['neurons']:,} neurons in real time, {layout}",
                   f"{rate:g} Hz{more}", _text(figures.goal(layout, "rate_hz") if same else None, " Hz"),
                   _text(paper.RATE_HZ if same else None, " Hz"))


def _ticks(document):
    ticks = sorted({entry["tick_ms"] for entry in document["largest"]} - {sweeps.COARSE_TICK_MS})
    for tick_ms in ticks:
        for layout in ("fused", "separate"):
            entry = figures.largest(document, layout, "rate", "none", tick_ms)
            if entry is not None:
                fine = tick_ms == paper.FINE_TICK_MS
                yield (f"rate neurons in real time at a tick of {tick_ms:g} ms, {layout}",
                       reached(entry), _text(figures.goal(layout, "fine_tick") if fine else None),
                       _text(paper.FINE_TICK_NEURONS if fine else None))


def _nest(document):
    alone = figures.largest(document, "alone", "rate", "nest", sweeps.COARSE_TICK_MS)
    if alone is not None:
        yield ("parrot neurons in real time, NEST alone", reached(alone), "", "")
    for layout in ("fused", "separate"):
        coupled = figures.largest(document, layout, "rate", "nest", sweeps.COARSE_TICK_MS)
        if alone and coupled and alone["neurons"]:
            yield (f"NEST in a job over NEST alone, {layout}", _share(coupled, alone),
                   f"{paper.NEST_SHARE:g}", "")


def _share(coupled, alone):
    """"0.95"; of a number above which nothing was tried, the ratio is a bound, and of two of them none."""
    if coupled["next"] is None and alone["next"] is None:
        return "not known"
    bound = " or more" if coupled["next"] is None else " or less" if alone["next"] is None else ""
    return f"{coupled['neurons'] / alone['neurons']:.2f}{bound}"


def _latencies(document):
    for row in sorted(document["latencies"], key=lambda row: (row["layout"], row["tick_ms"])):
        yield (f"latency, {row['layout']}, tick {row['tick_ms']:g} ms: median {row['median_ms']:.2f} "
               f"ms, 99 % {row['p99_ms']:.2f} ms, {row['answered']} of {row['trials']} answered")


def _text(number, unit=""):
    return "" if number is None else f"{number:,}{unit}"


def _aligned(rows):
    widths = [max(len(row[column]) for row in rows) for column in range(len(rows[0]))]
    for row in rows:
        yield "  ".join([row[0].ljust(widths[0])]
                        + [text.rjust(width) for text, width in zip(row[1:], widths[1:])]).rstrip()
