"""Which runs a sweep has: the values of its keys, and their combinations."""

import dataclasses
import itertools
import random
import re


MOST = 1_000_000  # runs of a sweep


class DesignError(Exception):
    """A setting of the command line that is no value, range or list."""


@dataclasses.dataclass(frozen=True)
class Range:
    """From one number to another, both included, of one unit ("" for none)."""

    first: float  # int if `whole`
    last: float
    unit: str
    whole: bool

    def text(self, number):
        """As it would stand in the file: "0.25 nA"."""
        shown = str(number) if self.whole else f"{number:.12g}"
        return f"{shown} {self.unit}".rstrip()


_NUMBER = r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?"
_QUANTITY = rf"\s*({_NUMBER})\s*([A-Za-z/]*)\s*"
_RANGE = re.compile(rf"{_QUANTITY}\.\.{_QUANTITY}(?:\bby\b{_QUANTITY})?")


def entries(text):
    """Of "[a, [b, c], d]" its entries as they were written."""
    inner, depth, quote, begin, found = text.strip()[1:-1], 0, "", 0, []
    for at, character in enumerate(inner):
        if quote:
            quote = "" if character == quote else quote
            continue
        quote = character if character in "\"'" else ""
        depth += (character in "[{") - (character in "]}")
        if character == "," and depth == 0:
            found.append(inner[begin:at].strip())
            begin = at + 1
    found.append(inner[begin:].strip())
    if depth != 0 or "" in found or not text.strip().endswith("]"):
        raise DesignError(f"'{text}' is not a list; write for example [10 pA, 20 pA]")
    return found


def parse(setting):
    """Key and values of "KEY=VALUES": a list of texts, or a Range that is still to be drawn from.

    VALUES: "[10 pA, 20 pA]" (a list), "1..100" (whole numbers), "50 Hz..200 Hz by 50 Hz",
    "0.1..0.5" (a Range, for random designs), else a single value.
    """
    key, equals, text = setting.partition("=")
    if not key or not equals or not text.strip():
        raise DesignError(f"--set {setting}: expected KEY=VALUES; write for example --set seed=1..100")
    if text.strip().startswith("["):
        return key, entries(text)
    matched = _RANGE.fullmatch(text)
    if matched is None:
        return key, [text]
    first, unit_first, last, unit, step, unit_step = matched.groups()
    if (unit_first or unit) != unit or (step is not None and unit_step != unit):
        raise DesignError(f"--set {setting}: the numbers of the range have different units; write for example "
                          f"{key}=\"50 Hz..200 Hz by 50 Hz\"")
    whole = not unit and all(re.fullmatch(r"[-+]?\d+", number) for number in (first, last, step or "1"))
    number = int if whole else float
    found = Range(number(first), number(last), unit, whole)
    if found.last < found.first or (step is not None and number(step) <= 0):
        raise DesignError(f"--set {setting}: the range is empty; write its smaller end first")
    if step is None:
        return key, found
    width = number(step)
    count = (found.last - found.first) // width + 1 if whole else int((found.last - found.first) / width + 1e-9) + 1
    if count > MOST:
        raise DesignError(f"--set {setting}: the range has {count} values, more than {MOST}; write a larger step")
    return key, [found.text(found.first + i * width) for i in range(count)]


def design(settings, samples=None):
    """The runs: a dictionary of keys and values each.

    Without `samples` every combination, the last key changing first. With it, that many
    runs with values drawn at random, the same ones every time.
    """
    values = dict(parse(setting) for setting in settings)
    if samples is not None:
        draw = random.Random(1)
        return [{key: _drawn(given, draw) for key, given in values.items()} for _ in range(samples)]
    size = 1
    for key, given in values.items():
        if isinstance(given, Range):
            if not given.whole:
                raise DesignError(f"--set {key}: the range needs a step, as in \"50 Hz..200 Hz by 50 Hz\"; or write "
                                  "--samples 20 to draw from it")
            size *= given.last - given.first + 1
        else:
            size *= len(given)
    if size > MOST:
        raise DesignError(f"these settings have {size} combinations, more than {MOST}; write --samples")
    choices = [[given.text(number) for number in range(given.first, given.last + 1)]
               if isinstance(given, Range) else given for given in values.values()]
    return [dict(zip(values, chosen)) for chosen in itertools.product(*choices)]


def _drawn(given, draw):
    if not isinstance(given, Range):
        return draw.choice(given)
    if given.whole:
        return given.text(draw.randint(given.first, given.last))
    return given.text(draw.uniform(given.first, given.last))
