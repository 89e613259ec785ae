"""Values of a sweep, and their combinations."""

import unittest

from spikeloop.design import DesignError, design, entries


class DesignTest(unittest.TestCase):
    def test_values(self):
        for text, values in (("1..4", ["1", "2", "3", "4"]), ("-1..1", ["-1", "0", "1"]),
                             ("[10 pA, 20 pA]", ["10 pA", "20 pA"]), ("[[1, 2], {a: 3, b: 4}]", ["[1, 2]", "{a: 3, b: 4}"]),
                             ("50 Hz..200 Hz by 50 Hz", ["50 Hz", "100 Hz", "150 Hz", "200 Hz"]),
                             ("0..1 by 0.25", ["0", "0.25", "0.5", "0.75", "1"]), ("1..10 by 4", ["1", "5", "9"]),
                             ("0.1 m/s..0.3 m/s by 0.1 m/s", ["0.1 m/s", "0.2 m/s", "0.3 m/s"]),
                             ("a/b..c.json", ["a/b..c.json"]), ("5 ms", ["5 ms"])):
            self.assertEqual([run["k"] for run in design([f"k={text}"])], values, text)

    def test_the_last_key_changes_first(self):
        self.assertEqual(design(["a=1..2", "b=[x, y]"]),
                         [{"a": "1", "b": "x"}, {"a": "1", "b": "y"}, {"a": "2", "b": "x"}, {"a": "2", "b": "y"}])

    def test_samples_cover_their_ranges(self):
        runs = design(["r=0 Hz..1 Hz", "n=1..3", "c=[x, y]", "one=5"], 300)
        numbers = [float(run["r"].removesuffix(" Hz")) for run in runs]
        self.assertAlmostEqual(sum(numbers) / 300, 0.5, delta=4 * (1 / 12 / 300) ** 0.5)
        self.assertEqual({run["n"] for run in runs}, {"1", "2", "3"})
        self.assertEqual({run["c"] for run in runs}, {"x", "y"})
        self.assertEqual({run["one"] for run in runs}, {"5"})
        self.assertEqual(runs[:7], design(["r=0 Hz..1 Hz", "n=1..3", "c=[x, y]", "one=5"], 7))

    def test_mistakes(self):
        for text in ("k", "=1", "k=", "k=2..1", "k=1 Hz..2 kHz", "k=0.1..0.5", "k=[1", "k=[]", "k=[1, , 2]",
                     "k=0..1 by 0", "k=0..1e9 by 1", "k=1..2000000"):
            with self.assertRaises(DesignError, msg=text):
                design([text])
        with self.assertRaises(DesignError):
            entries("[a, [b]")


if __name__ == "__main__":
    unittest.main()
