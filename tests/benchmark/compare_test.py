"""compare.py on reports whose answer is known."""

import contextlib
import io
import json
import os
import tempfile
import unittest

import compare


def entry(name, median, spread=0.0, threads=1):
    return {"name": name, "threads": threads, "unit": "particle", "median": median, "spread": spread}


class Compare(unittest.TestCase):
    def setUp(self):
        self.folder = tempfile.TemporaryDirectory()
        self.addCleanup(self.folder.cleanup)

    def report(self, name, entries, measure="ns", band=0.1):
        path = os.path.join(self.folder.name, name)
        with open(path, "w", encoding="utf-8") as file:
            json.dump({"measure": measure, "band": band, "entries": entries}, file)
        return path

    def run_main(self, old, new, *options, **kind):
        """Exit code, and what is printed on both streams."""
        text = io.StringIO()
        arguments = [self.report("old.json", old, **kind), self.report("new.json", new, **kind), *options]
        with contextlib.redirect_stdout(text), contextlib.redirect_stderr(text):
            code = compare.main(arguments)
        return code, text.getvalue()

    def test_equal_reports_differ_in_nothing(self):
        code, text = self.run_main([entry("a", 5.0)], [entry("a", 5.0)])
        self.assertEqual(code, 0)
        self.assertIn("0 slower, 0 faster", text)

    def test_slower_beyond_the_band_is_an_error(self):
        code, text = self.run_main([entry("a", 1.0), entry("b", 1.0)], [entry("a", 1.09), entry("b", 1.11)])
        self.assertEqual(code, 1)
        self.assertIn("1 slower, 0 faster", text)
        self.assertRegex(text, r"b .* 1\.110 .*SLOWER")
        self.assertNotRegex(text, r"\na ")

    def test_faster_is_no_error(self):
        code, text = self.run_main([entry("a", 1.0)], [entry("a", 0.5)])
        self.assertEqual(code, 0)
        self.assertIn("0 slower, 1 faster", text)

    def test_spread_widens_the_band(self):
        code, _ = self.run_main([entry("a", 1.0, 0.2)], [entry("a", 1.4, 0.3)])
        self.assertEqual(code, 0)
        code, _ = self.run_main([entry("a", 1.0, 0.2)], [entry("a", 1.6, 0.3)])
        self.assertEqual(code, 1)

    def test_instructions_have_the_narrow_band_of_their_file(self):
        kind = {"measure": "instructions", "band": 0.01}
        self.assertEqual(self.run_main([entry("a", 100.0)], [entry("a", 100.9)], **kind)[0], 0)
        self.assertEqual(self.run_main([entry("a", 100.0)], [entry("a", 101.1)], **kind)[0], 1)

    def test_threads_are_told_apart(self):
        old = [entry("a", 2.0, threads=1), entry("a", 1.0, threads=2)]
        self.assertEqual(self.run_main(old, list(reversed(old)))[0], 0)

    def test_entries_of_one_file_only_are_named(self):
        code, text = self.run_main([entry("a", 1.0), entry("gone", 1.0)], [entry("a", 1.0), entry("fresh", 1.0)])
        self.assertEqual(code, 0)
        self.assertIn("in one file only: fresh (1), gone (1)", text)

    def test_what_is_no_report_is_refused(self):
        self.assertEqual(self.run_main([entry("a", 1.0)], [entry("b", 1.0)])[0], 2)
        self.assertEqual(self.run_main([entry("a", 0.0)], [entry("a", 1.0)])[0], 2)
        good = self.report("good.json", [entry("a", 1.0)])
        for text in ("", "[]", '{"entries": []}'):
            bad = os.path.join(self.folder.name, "bad.json")
            with open(bad, "w", encoding="utf-8") as file:
                file.write(text)
            with contextlib.redirect_stderr(io.StringIO()) as message:
                self.assertEqual(compare.main([good, bad]), 2)
            self.assertIn("bad.json: not a report", message.getvalue())
        other = self.report("other.json", [entry("a", 1.0)], measure="instructions")
        with contextlib.redirect_stderr(io.StringIO()):
            self.assertEqual(compare.main([good, other]), 2)


if __name__ == "__main__":
    unittest.main()
