"""Nodes and MUSIC programs in Python, and readers and pictures of what a run of Spikeloop leaves on
disk.

    import spikeloop

    @spikeloop.node(inputs={"in": "signal"}, outputs={"out": "signal"}, gain=2.0)
    def gain(step, gain):
        \"\"\"Multiplies its input\"\"\"
        if step.changed("in"):
            step.write("out", gain * step.inputs["in"])

`node`, `Signal`, `Spikes`, `Parameter` and `Weights` declare a node; `spikeloop.steps.Step` is what
it sees; `spikeloop.testing` runs one without the C++ programs.

`load` reads an experiment, which can be changed and run (`spikeloop.experiment`); `open_run` reads a run
(`spikeloop.run_folder`), `read_messages` the messages of any recording (`spikeloop.messages`); `gymnasium_env` makes
an experiment an environment for agents
(`spikeloop.environment`). `spikeloop.plots`, which draws it, is imported by name, because matplotlib is slow.

`music` makes a script a MUSIC program (`spikeloop.music_host`); `spikeloop.neuron`,
`spikeloop.brian` and `spikeloop.nest` do so with NEURON, Brian2 and NEST in it.
"""

from .declare import NodeError, Parameter, SECOND, Signal, Spikes, Weights, node
from .home import provide_home

provide_home()

__all__ = ["NodeError", "Parameter", "SECOND", "Signal", "Spikes", "SpikeloopError", "Weights", "gymnasium_env",
           "load", "music", "node", "open_run", "read_messages", "read_topics"]


def __getattr__(name):
    # Later, because NumPy is slow, and nodes are found without it.
    if name == "music":
        from .music_host import music
        return music
    if name == "gymnasium_env":
        from .environment import Environment
        return Environment
    if name in ("read_messages", "read_topics"):
        from . import messages
        return getattr(messages, name)
    if name in ("load", "open_run", "SpikeloopError"):
        from . import experiment
        return getattr(experiment, name)
    raise AttributeError(f"module 'spikeloop' has no attribute '{name}'")
