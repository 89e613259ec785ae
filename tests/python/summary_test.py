"""The table of a run's summary."""

import unittest

from spikeloop import summary


class TableTest(unittest.TestCase):
    def latency(self, **entries):
        return summary.table({"latency_median_ms": 2.0, **entries})[-1].split("median")[1].strip()

    def test_latencies_of_the_wall_clock(self):
        self.assertEqual(self.latency(latency_clock="wall", real_time_factor=0.1), "2.00 ms")

    def test_a_slow_run_takes_longer_than_its_simulated_latency(self):
        self.assertEqual(self.latency(latency_clock="simulated", real_time_factor=0.08),
                         "2.00 ms, simulated (25.0 ms of wall time)")

    def test_a_fast_run_has_simulated_latencies_alone(self):
        self.assertEqual(self.latency(latency_clock="simulated", real_time_factor=90.0), "2.00 ms, simulated")
        self.assertEqual(summary.table({"latency_median_ms": None, "latency_clock": "simulated"})[0].split()[-3:],
                         ["-", "ms,", "simulated"])


if __name__ == "__main__":
    unittest.main()
