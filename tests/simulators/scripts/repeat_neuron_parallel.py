#!/usr/bin/python3
"""Input, relay and output cells of a channel stand in different processes: each spike crosses twice."""
import spikeloop.neuron
from neuron import h

with spikeloop.neuron.music(spikes_in={"in": None}, spikes_out={"out": None},
                            processes=2, fail_in=-1, leave_in=-1, twice=False) as host:
    pc = h.ParallelContext()
    rank, processes, width = int(pc.id()), int(pc.nhost()), host.widths["in"]
    assert processes == host.parameters["processes"], processes
    cells, kept = {}, []
    for gid in range(rank, 3 * width, processes):
        cell = cells[gid] = h.IntFire1()
        cell.refrac = 0
        pc.set_gid2node(gid, rank)
        pc.cell(gid, h.NetCon(cell, None))
    # The width is even: a neighbour's relay is in the other process.
    relay = {c: width + (c + 1) % width for c in range(width)}
    last = {c: 2 * width + c for c in range(width)}
    for channel in range(width):
        if channel in cells:
            host.connect_input("in", channel, cells[channel], weight=2, delay_ms=0.5)
        for source, target in ((channel, relay[channel]), (relay[channel], last[channel])):
            if target in cells:
                connection = pc.gid_connect(source, cells[target])
                connection.weight[0], connection.delay = 2, 1.5
                kept.append(connection)
        if last[channel] in cells or host.parameters["twice"]:
            cell = cells.get(last[channel]) or next(iter(cells.values()))
            host.connect_output("out", channel, cell)
    if rank == host.parameters["fail_in"]:
        raise RuntimeError(f"nothing in process {rank}")
    h.finitialize()
    for tick in host:
        if rank == host.parameters["leave_in"] and tick.begin_s >= 0.1:
            break
        host.advance(tick)
