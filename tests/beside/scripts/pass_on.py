import spikeloop


@spikeloop.node(inputs={"in": "spikes"}, outputs={"out": spikeloop.Spikes(same_as="in")})
def pass_on(step):
    """Spikes as they come, so that a recording shows when they came"""
    step.emit("out", *step.spikes("in"))
