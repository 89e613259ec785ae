#!/usr/bin/python3
"""What console.py takes for the same, and what it does not; which pages page_test.py refuses."""

import os
import pathlib
import subprocess
import sys
import tempfile
import time
import unittest
import unittest.mock

from console import PageError, as_seen, commands_of, difference

PAGE = """# Title

Text, `$ no command`.

    $ first one \\
        two
    shown

    after a blank line
    $ second

Text.
<!-- numbers within 5 % -->

    $ third
    12.5 of x

<!-- exit code 2 -->

    $ fourth

    no command
"""


class Pages(unittest.TestCase):
    def test_commands_and_what_they_print(self):
        commands = commands_of(PAGE)
        self.assertEqual([c.text for c in commands],
                         ["first one \\\n    two", "second", "third", "fourth"])
        self.assertEqual([c.expected for c in commands],
                         [["shown", "", "after a blank line"], [], ["12.5 of x"], ["", "no command"]])
        self.assertEqual([c.percent for c in commands], [0, 0, 5, 0])
        self.assertEqual([c.exit_code for c in commands], [0, 0, 0, 2])
        self.assertEqual([c.line for c in commands], [5, 10, 15, 20])

    def test_blocks_that_begin_without_a_command_are_not_run(self):
        self.assertEqual(commands_of("Text\n\n    x = 1\n"), [])

    def test_unknown_comments_are_no_silent_permission(self):
        with self.assertRaises(PageError):
            commands_of("<!-- numbers within a bit -->\n\n    $ x\n")


class Comparison(unittest.TestCase):
    def same(self, expected, printed, percent=0.0):
        self.assertIsNone(difference(expected.split("\n"), printed.split("\n"), percent))

    def differs(self, expected, printed, percent=0.0):
        expected = expected.split("\n") if expected else []
        printed = printed.split("\n") if printed else []
        self.assertIsNotNone(difference(expected, printed, percent))

    def test_to_the_letter(self):
        self.same("a 1.0 (b) *", "a 1.0 (b) *")
        self.differs("a 1.0", "a 1.1")
        self.differs("a 1.0", "a 1x0")
        self.differs("a", "ab")
        self.differs("a\nb", "a")
        self.differs("a", "a\nb")
        self.differs("", "a")
        self.differs("a", "")
        self.differs("a\nb", "b\na")

    def test_anything(self):
        self.same("a ... b", "a xyz b")
        self.differs("a ... b", "a xyz c")
        self.same("a\n...\nb", "a\nx\ny\nb")
        self.same("a\n...\nb", "a\nb")
        self.same("a\n...", "a\nx")
        self.same("...\nb", "x\nb")
        self.differs("a\n...\nb", "a\nx")
        self.differs("a\n...\nb", "a\nb\nc")

    def test_numbers_that_vary(self):
        self.same("1,000 spikes, 0.50 m", "1,040 spikes, 0.49 m", 5)
        self.differs("1,000 spikes", "1,060 spikes", 5)
        self.differs("1,000 spikes", "1,040 spikes")
        self.differs("1 spike", "1 spikes", 5)
        self.differs("1 spike", "no spike", 5)
        self.differs("x1 = 100", "x2 = 100", 5)
        self.differs("0 errors", "1 errors", 5)
        self.same("4 of ... s", "4.1 of 77 s", 5)

    def test_a_terminal_shows_what_was_printed_last(self):
        self.assertEqual(as_seen("1 of 5\r\x1b[K2 of 5\r\x1b[Kdone\r\nnext\r\n"), ["done", "next"])
        self.assertEqual(as_seen("abc\rx\n\x1b[32mgreen\x1b[0m\n"), ["xbc", "green"])


class WholePages(unittest.TestCase):
    def follow(self, page):
        """Exit code and error text of page_test.py for an example of this page."""
        with tempfile.TemporaryDirectory() as directory:
            source = pathlib.Path(directory)
            example = source / "examples/01_example"
            for folder in (example, source / "python"):
                folder.mkdir(parents=True)
            (example / "README.md").write_text(page)
            (example / "old.svg").write_text("<svg></svg>\n")
            (source / "examples/README.md").write_text("Text\n\n    export GREETING=hello\n")
            test = pathlib.Path(__file__).with_name("page_test.py")
            done = subprocess.run([sys.executable, str(test), "--example", str(example), "--source",
                                   directory, "--build", directory],
                                  capture_output=True, text=True, check=False)
            return done.returncode, done.stderr

    def refused(self, page, text):
        code, error = self.follow(page)
        self.assertEqual(code, 1)
        self.assertIn(text, error)

    def test_pages_that_are_true(self):
        self.assertEqual(self.follow("    $ echo $GREETING\n    hello\n    $ echo x >&2\n    x\n"), (0, ""))
        self.assertEqual(self.follow("![x](old.svg)\n\n    $ echo '<svg></svg>' > old.svg\n"), (0, ""))
        self.assertEqual(self.follow("<!-- exit code 1 -->\n\n    $ false\n"), (0, ""))

    def test_a_page_that_needs_nest_is_not_followed_without(self):
        with tempfile.TemporaryDirectory() as directory:
            (pathlib.Path(directory) / "nest.py").write_text("raise ImportError('broken')\n")
            with unittest.mock.patch.dict(os.environ, SPIKELOOP_NEST=directory):
                self.assertEqual(self.follow("<!-- needs NEST -->\n\n    $ false\n"), (77, ""))

    def test_pages_that_are_not(self):
        self.refused("    $ echo 41\n    42\n", "README.md:1: $ echo 41\n  line 1 of its output is '42'")
        self.refused("    $ echo 41\n", "'41' was printed, too")
        self.refused("    $ false\n", "ends with 1, not 0")
        self.refused("    $ kill -9 $$\n", "ends with -9, not 0")
        self.refused("![x](old.svg)\n\n    $ true\n", "shows old.svg, and none of its commands draws")
        self.refused("![x](old.svg)\n\n    $ echo > old.svg\n", "old.svg: None was drawn")
        self.refused("Text\n", "shows no command")

    def test_a_process_that_is_left_behind_is_told_and_ended(self):
        began = time.monotonic()
        self.refused("    $ sleep 1000 > /dev/null 2>&1 < /dev/null & disown\n", "leaves processes behind")
        self.assertLess(time.monotonic() - began, 900)


if __name__ == "__main__":
    unittest.main()
