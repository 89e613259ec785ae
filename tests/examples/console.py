"""What a README shows of a terminal: commands, and what they print.

    Text.                                  <!-- numbers within 5 % -->

        $ spikeloop check x.yaml           a command: `$ ` in an indented block
        x.yaml: nothing to ...             what it prints, to standard error, too

`...` in a line stands for anything, a line of its own for any lines. A comment before a block holds for
the block: `<!-- numbers within 5 % -->`, where numbers vary a little; `<!-- exit code 2 -->`, else 0.
Without such signs everything is compared to the letter, and what is not shown must not be printed.
"""

import dataclasses
import re

NUMBER = re.compile(r"(?<![\w.])-?\d[\d,]*(?:\.\d+)?(?:e-?\d+)?")
ANYTHING = re.compile(r" *\.\.\. *")  # numbers that are aligned on the right begin anywhere
COMMENT = re.compile(r"<!-- (?:numbers within (?P<percent>[\d.]+) %|exit code (?P<code>\d+)) -->")


@dataclasses.dataclass
class Command:
    """One command of a page."""

    line: int  # of the page, from 1
    text: str
    expected: list
    percent: float = 0.0
    exit_code: int = 0


class PageError(Exception):
    """The page is not written as this file says."""


def commands_of(page):
    """The commands of a Markdown text, in order."""
    commands, percent, code, inside = [], 0.0, 0, False
    for number, line in enumerate(page.splitlines(), 1):
        if line.startswith("    ") and (inside or line[4:].startswith("$ ")):
            _take(commands, inside, Command(number, line[4:], [], percent, code))
            inside = True
        elif line.strip():
            if inside:
                percent, code, inside = 0.0, 0, False
            comment = COMMENT.fullmatch(line.strip())
            if comment:
                percent = float(comment["percent"] or percent)
                code = int(comment["code"] or code)
            elif line.lstrip().startswith("<!--"):
                raise PageError(f"line {number}: '{line.strip()}' is not known; see {__file__}")
        elif inside:
            commands[-1].expected.append("")
    for command in commands:
        while command.expected and not command.expected[-1]:
            command.expected.pop()
    return commands


def _take(commands, inside, line):
    """A line of a block: a command, the rest of one, or what it prints."""
    if line.text.startswith("$ "):
        line.text = line.text[2:]
        commands.append(line)
    elif inside and commands[-1].text.endswith("\\") and not commands[-1].expected:
        commands[-1].text += "\n" + line.text
    else:
        commands[-1].expected.append(line.text)


def as_seen(output):
    """The lines that remain on a terminal: what is overwritten or erased is not among them."""
    lines = []
    for line in output.replace("\r\n", "\n").split("\n"):
        line = re.sub(r"\x1b\[[\d;]*m", "", line)
        shown = ""
        for part in line.split("\r"):
            erased = part.startswith("\x1b[K")
            part = part.removeprefix("\x1b[K")
            shown = part if erased else part + shown[len(part):]
        lines.append(shown.rstrip())
    while lines and not lines[-1]:
        lines.pop()
    return lines


def difference(expected, printed, percent=0.0):
    """None when they agree; else which line of the page's does not."""
    at = 0
    skip = False
    for position, line in enumerate(expected):
        if line.strip() == "...":
            skip = True
            continue
        while at < len(printed) and skip and not same(line, printed[at], percent):
            at += 1
        if at == len(printed) or not same(line, printed[at], percent):
            there = f"'{printed[at]}'" if at < len(printed) and not skip else "nothing like it"
            return f"line {position + 1} of its output is '{line}', printed was {there}"
        at, skip = at + 1, False
    if at < len(printed) and not skip:
        return f"'{printed[at]}' was printed, too"
    return None


def same(expected, printed, percent=0.0):
    """Whether a line is the one that the page shows."""
    if percent == 0:
        parts = [re.escape(part) for part in ANYTHING.split(expected.rstrip())]
        return re.fullmatch(".*".join(parts), printed) is not None
    parts = [".*".join(re.escape(word) for word in ANYTHING.split(between))
             for between in NUMBER.split(expected.rstrip())]
    match = re.fullmatch(f"({NUMBER.pattern})".join(parts), printed)
    if match is None:
        return False
    wanted = [value(text) for text in NUMBER.findall(expected)]
    found = [value(text) for text in match.groups()]
    return all(abs(a - b) <= percent / 100 * abs(a) for a, b in zip(wanted, found))


def value(text):
    return float(text.replace(",", ""))
