"""The largest number in real time of known functions."""

import random
import unittest

from spikeloop.bench import search


class Largest(unittest.TestCase):
    def found(self, factor, least=1000, most=16_000_000, precision=search.PRECISION):
        self.asked = []

        def asked(neurons, once):
            self.asked.append((neurons, once))
            return factor(neurons)
        return search.largest(asked, least, most, precision)

    def test_inverse_proportion(self):
        """factor = limit / n: in real time up to the limit exactly."""
        generator = random.Random(1)
        for _ in range(300):
            limit = round(10 ** generator.uniform(0, 7.2))
            found = self.found(lambda neurons: limit / neurons)
            with self.subTest(limit=limit, found=found):
                self.assertLessEqual(found.neurons, limit)
                self.assertGreater(found.next, limit)
                # Nothing of two digits lies between: 10 and 11 are as near as they come.
                self.assertLessEqual(found.next, max(1.101 * found.neurons, found.neurons + 1))
                self.assertLess(len(self.asked), 20)

    def test_what_is_found_has_all_trials(self):
        found = self.found(lambda neurons: 123_456 / neurons)
        self.assertEqual((found.neurons, found.next), (120_000, 130_000))
        self.assertIn((120_000, False), self.asked)
        self.assertEqual([neurons for neurons, once in self.asked if not once],
                         [1000, 10_000, 100_000, 1_000_000, 120_000])

    def test_all_in_real_time(self):
        self.assertEqual(self.found(lambda neurons: 2.0), search.Found(16_000_000, None))

    def test_none_in_real_time(self):
        self.assertEqual(self.found(lambda neurons: 0.9), search.Found(0, 1))

    def test_below_the_least(self):
        self.assertEqual(self.found(lambda neurons: 37.5 / neurons), search.Found(37, 38))

    def test_exactly_real_time_counts(self):
        found = self.found(lambda neurons: 1.0 if neurons <= 250_000 else 0.99)
        self.assertEqual((found.neurons, found.next), (250_000, 260_000))

    def test_a_lucky_single_trial_is_not_believed(self):
        """Single trials are twice as fast as the median of all: the median decides."""
        def factor(neurons, once):
            return (2 if once else 1) * 300_000 / neurons
        found = search.largest(factor, 1000, 16_000_000)
        self.assertLessEqual(found.neurons, 300_000)
        self.assertGreaterEqual(factor(found.neurons, False), 1)

    def test_a_coarse_search_asks_for_decades_alone(self):
        found = self.found(lambda neurons: 30_000 / neurons, 1000, 1_000_000, 10)
        self.assertEqual(found, search.Found(10_000, 100_000))
        self.assertEqual(self.asked, [(1000, False), (10_000, False), (100_000, False)])

    def test_numbers_to_read(self):
        for number, two_digits in ((1, 1), (9.7, 10), (37.4, 37), (123, 120), (98_765, 99_000),
                                   (999_999, 1_000_000), (0.2, 1)):
            self.assertEqual(search.rounded(number), two_digits)
        self.assertEqual(search.decades(1000, 16_000), [1000, 10_000, 16_000])
        self.assertEqual(search.decades(1000, 1000), [1000])


if __name__ == "__main__":
    unittest.main()
