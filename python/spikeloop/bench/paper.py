"""What the paper reached, and what Spikeloop is to reach: the marks in tables and pictures.

Only values that are known are here: nothing is read off the figures' curves. What the runs are made of
(a scan spread by uniform weights, rates of 1 to 2 Hz, 50,000 neurons at equal rates, ten seconds,
build time apart) is that of the authors' own scripts, github.com/weidel-p/ros_music_adapter,
branches measurements/latency and measurements/bandwidth, directory measurements.
"""

SOURCE = "Weidel, Djurfeldt, Duarte & Morrison 2016, Front. Neuroinform. 10:31, performance section"

# Neurons in real time, by encoder.
NEURONS = {"rate": 150_000, "poisson": 150_000, "nef": 20_000}
# Spikes a second of each of 50,000 neurons in real time.
RATE_HZ = 40
RATE_NEURONS = 50_000
# Neurons in real time at a tick of 1 ms.
FINE_TICK_MS = 1
FINE_TICK_NEURONS = 10_000

# Goals of this project on two cores: no simulator, uniform weights.
GOALS = {
    "fused": {"rate": 10_000_000, "poisson": 5_000_000, "nef": 1_000_000, "rate_hz": 800,
              "fine_tick": 1_000_000},
    "separate": {"rate": 1_000_000, "poisson": 1_000_000, "nef": 200_000, "rate_hz": 400,
                 "fine_tick": 20_000},
}
# NEST's repeaters in a job, over those that NEST alone has in real time.
NEST_SHARE = 0.9


def as_json():
    return {"paper": {"source": SOURCE, "neurons_in_real_time": NEURONS,
                      "rate_in_real_time_hz": RATE_HZ, "rate_neurons": RATE_NEURONS,
                      "neurons_in_real_time_at_1_ms": FINE_TICK_NEURONS},
            "goals": {**GOALS, "nest_share": NEST_SHARE}}
