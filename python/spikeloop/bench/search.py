"""The largest number of neurons for which a run keeps real time."""

import dataclasses
import math

PRECISION = 1.06  # the number above the one that is found, over that one


@dataclasses.dataclass
class Found:
    neurons: int  # in real time in the median of all trials; 0: not even the least was
    next: int | None  # the smallest number that was too slow; None: all up to `most` kept up


def rounded(number):
    """Two significant digits, at least 1: numbers to read."""
    size = 10 ** max(0, math.floor(math.log10(max(1, number))) - 1)
    return max(1, round(number / size) * size)


def decades(least, most):
    """least, 10 least, ... and most."""
    numbers, number = [], least
    while number < most:
        numbers.append(number)
        number *= 10
    return [*numbers, most]


def largest(factor, least, most, precision=PRECISION):
    """Found, by halving on a logarithmic scale between a number in real time and one that is not.

    factor(neurons, once): the real-time factor, the median of all trials or, with `once`, of one
    trial, which is enough to go on; what is found is confirmed by all trials. It is asked for
    every decade up to the first that is too slow: these are the curve's points.
    """
    good, slow = 0, None
    for neurons in decades(least, most):
        if factor(neurons, False) < 1:
            slow = neurons
            break
        good = neurons
    if slow is None:
        return Found(good, None)
    confirmed, once = good, True
    while True:
        good, slow = _narrowed(factor, confirmed, slow, precision, once)
        if good == confirmed or not once or factor(good, False) >= 1:
            return Found(good, slow)
        # Luck: from here on, every number has all its trials.
        slow, once = good, False


def _narrowed(factor, good, slow, precision, once):
    """The same, nearer to each other."""
    while slow > 1 and slow > good * precision:
        middle = rounded(math.sqrt(max(good, slow / 100) * slow))
        if middle in (good, slow):
            break
        if factor(middle, once) >= 1:
            good = middle
        else:
            slow = middle
    return good, slow
