"""Tests with a folder of their own."""

import pathlib
import tempfile
import unittest


class FolderCase(unittest.TestCase):
    """`self.folder` is there until the test has ended."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory(prefix="sl-")
        self.addCleanup(folder.cleanup)
        self.folder = pathlib.Path(folder.name)
