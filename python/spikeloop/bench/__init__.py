"""`spikeloop bench`: the measurements of Weidel, Djurfeldt, Duarte & Morrison 2016.

    chain     what is run: scan -> connect -> encoder -> (simulator) -> readout -> low pass
    trial     one run of it, and what its speed was
    search    the largest number of neurons in real time
    sweeps    parts a, b and d; `latency`: part c
    results   results.json, which everything goes through
    paper     the paper's values, and the goals
    pictures, table    what has been measured, to look at
"""
