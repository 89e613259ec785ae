#!/usr/bin/python3
"""A signal is the input of two rate neurons, whose rates are another signal."""
import spikeloop.nest
import nest

with spikeloop.nest.music(signals_in={"level": 2}, signals_out={"voltage": 2}) as host:
    neurons = nest.Create("lin_rate_ipn", 2, {"tau": 10.0, "sigma": 0.0})
    nest.Connect(host.rate_input("level"), neurons, "one_to_one",
                 {"synapse_model": "rate_connection_instantaneous", "weight": 1.0})
    host.rate_output("voltage", neurons)
    host.run()
