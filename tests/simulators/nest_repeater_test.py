#!/usr/bin/python3
"""Neurons of NEST that repeat every spike: each comes back once, when the rules say so."""

import itertools
import shutil
import unittest

import numpy as np

import jobs
import nest_jobs

STEP = 100_000


def begins_of(times, tick_ns):
    """Of the ticks (begin, begin + tick] that the times lie in."""
    return -(-times // tick_ns) * tick_ns - tick_ns


def around_borders(tick_ns, duration_ns):
    """(times, channels): on every border of a tick, and a little after it; a channel an offset."""
    offsets = np.array([0, 1, 400, 600, 1000, tick_ns // 3])
    borders = np.arange(0, duration_ns, tick_ns)
    times = (borders[:, None] + offsets[None, :]).ravel()
    channels = np.tile(np.arange(len(offsets)), len(borders))
    return times[times > 0], channels[times > 0]


class Repeaters(unittest.TestCase):
    def test_a_thousand_neurons_repeat_every_spike_once(self):
        width, duration_s = 1000, 10
        for tick_s in (0.001, 0.01):
            with self.subTest(tick_s=tick_s), \
                    jobs.Job("repeat_nest.py", width, tick_s=tick_s, duration_s=duration_s) as job:
                job.run("--quiet")
                times, channels = job.sent()
                self.assertGreater(len(times), 0.9 * width * 20 * duration_s)
                tick = round(tick_s * 1e9)
                repeated, in_time = nest_jobs.expected(
                    times, begins_of(times, tick), step_ns=STEP, delay_ns=tick,
                    guarded=True, end_ns=duration_s * 10**9)
                got, got_channels, begins = job.received()
                jobs.assert_same((repeated[in_time], channels[in_time]), (got, got_channels), "NEST")
                jobs.assert_same((got, got_channels), job.recorded(), "NEST, recorded")
                self.assertTrue(np.all((got > begins) & (got <= begins + tick)))

    def test_no_spike_is_lost_around_the_borders_of_ticks(self):
        """In every order of the sections, with and without the sender's guard."""
        orders = (("sink", "brain", "play"), ("play", "brain", "sink"))
        for tick_s, step_ms, order, guarded in itertools.product((0.001, 0.01), (0.1, 1), orders,
                                                                 (True, False)):
            with self.subTest(tick_s=tick_s, step_ms=step_ms, order=order, guarded=guarded):
                self.check_borders(round(tick_s * 1e9), step_ms, order, guarded)

    def check_borders(self, tick, step_ms, order, guarded):
        end = 50 * tick
        times, channels = around_borders(tick, end)
        if not guarded:  # to NEST these would be at time 0, before which nothing begins
            channels, times = channels[times >= 500], times[times >= 500]
        with nest_jobs.NestJob(
                "repeat_nest.py", 6, (times, channels), tick_s=tick / 1e9, duration_s=end / 1e9,
                keys=f"resolution={step_ms}", order=order,
                play_keys=f"stamp_guard={str(guarded).lower()}") as job:
            job.run_by_music()
            repeated, in_time = nest_jobs.expected(
                times, begins_of(times, tick), step_ns=round(step_ms * 1e6), delay_ns=tick,
                guarded=guarded, end_ns=end)
            self.assertGreater(np.count_nonzero(in_time), 6 * 48)
            jobs.assert_same((repeated[in_time], channels[in_time]), job.received()[:2], "NEST")

    def test_delays_that_are_not_the_tick(self):
        """NEST then stops between the steps in which it hands on its own spikes."""
        times, channels = around_borders(1_000_000, 50_000_000)
        for delay_ms in (1.3, 5) if nest_jobs.WITH_MUSIC else (0.1, 0.3, 1.3, 5):
            with self.subTest(delay_ms=delay_ms), \
                    nest_jobs.NestJob("repeat_nest.py", 6, (times, channels), duration_s=0.05,
                                      keys=f"delay={delay_ms}") as job:
                job.run("--quiet")
                repeated, in_time = nest_jobs.expected(
                    times, begins_of(times, 1_000_000), step_ns=STEP,
                    delay_ns=round(delay_ms * 1e6), guarded=True, end_ns=50_000_000)
                jobs.assert_same((repeated[in_time], channels[in_time]), job.received()[:2], "NEST")

    def test_in_a_cycle(self):
        """A spike of 2.345 ms goes round between NEST (delays of 1 and 3 ms) and a script that sends
        back what it gets, a tick later at the earliest."""
        spike = np.array([2_345_000]), np.array([0])
        with nest_jobs.NestJob("cycle_nest.py", 1, spike, duration_s=0.02,
                               keys="accept_latency=0.001") as job:
            shutil.copy(jobs.HERE / "scripts/echo.py", job.folder)
            job.file.write_text(job.file.read_text() + "[echo]\nnp=1\nbinary=./echo.py\n"
                                "accept_latency=0.001\nbrain.out -> echo.in [1]\n"
                                "echo.out -> brain.back [1]\n")
            job.run("--quiet")
            # Own MUSIC: a spike that comes a tick late acts at its time, and echo adds the tick.
            # Without: it acts in the first step of the tick; 4.1 ms, echo at 5.001, NEST at 6.1 ms.
            own, other = [3.4, 7.1, 11.1, 15.1, 19.1], [4.1, 9.1, 14.1, 19.1]
            expected = np.rint(np.array(own if nest_jobs.WITH_MUSIC else other) * 1e6)
            np.testing.assert_array_equal(job.received()[0], expected)

    def test_several_spikes_of_a_channel_in_a_step_are_several(self):
        times = np.array([1_210_000, 1_250_000, 1_290_000, 1_310_000, 7_000_000])
        channels = np.array([0, 0, 0, 1, 1])
        with nest_jobs.NestJob("repeat_nest.py", 2, (times, channels), duration_s=0.02) as job:
            job.run("--quiet")
            repeated = np.array([2_300_000] * 3 + [2_400_000, 8_000_000])
            jobs.assert_same((repeated, channels), job.received()[:2], "NEST")


if __name__ == "__main__":
    nest_jobs.main()
