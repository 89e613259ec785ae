#!/usr/bin/python3
"""A file is read at each of its lengths while it grows."""

import unittest

import growing_file
from folder import FolderCase

TEXT = "t_s,v_m_s\r\n0.5,12.25\r\n1,-3\r\n"
ROWS = [{"t_s": "0.5", "v_m_s": "12.25"}, {"t_s": "1", "v_m_s": "-3"}]


class GrowingFileTest(FolderCase):
    def test_an_incomplete_last_line_is_ignored(self):
        path = self.folder / "rows.csv"
        self.assertEqual((growing_file.complete_text(path), growing_file.table(path)), ("", []))
        for length in range(len(TEXT) + 1):
            path.write_bytes(TEXT[:length].encode())
            ends = TEXT[:length].count("\n")
            with self.subTest(length):
                self.assertEqual(growing_file.complete_text(path), "".join(TEXT.splitlines(True)[:ends]))
                self.assertEqual(growing_file.table(path), ROWS[:max(ends - 1, 0)])


if __name__ == "__main__":
    unittest.main()
