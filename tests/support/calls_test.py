#!/usr/bin/python3
"""What `assert_says` takes for the same message."""

import unittest

from calls import assert_says

PRINTED = "x: started\nx.yaml:2:6: 'tau': -10 ms is below 0.5 ms; write 0.5 ms [SL0203]\n"


class SaysTest(unittest.TestCase):
    def test_place_values_and_code_of_a_line(self):
        assert_says(PRINTED, "x.yaml:2:6: 'tau': -10 ms ... 0.5 ms ... [SL0203]", "x: started", "below 0.5")

    def test_parts_of_words_and_numbers_and_other_lines(self):
        for wrong in ("10 ms", "'tau': -1", "5 ms", "below 0", "elow", "started ... 'tau'", "0.5 ms ... 'tau'",
                      "0.5 ... 0.5 ... 0.5"):
            with self.subTest(wrong), self.assertRaises(AssertionError):
                assert_says(PRINTED, wrong)


if __name__ == "__main__":
    unittest.main()
