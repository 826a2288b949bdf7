#!/usr/bin/env python3
"""Puts a comparison into docs/comparison, and its main table and picture into README.md.

    docs.py FOLDER         what comparison_report has written

The table stands in README.md between the lines "<!-- comparison -->" and "<!-- end -->".
"""

import pathlib
import re
import shutil
import sys

root = pathlib.Path(__file__).resolve().parents[2]


def main():
    folder = pathlib.Path(sys.argv[1])
    docs = root / "docs" / "comparison"
    docs.mkdir(parents=True, exist_ok=True)
    shutil.copy(folder / "summary.png", docs / "summary.png")
    for report in sorted(folder.glob("*/comparison.md")):
        case = report.parent.name
        text = re.sub(r"\]\(([^)/]*\.png)\)", rf"]({case}_\1)", report.read_text())
        (docs / f"{case}.md").write_text(text)
        for picture in report.parent.glob("*.png"):
            if picture.name in text:
                shutil.copy(picture, docs / f"{case}_{picture.name}")
    readme = root / "README.md"
    table = (folder / "summary.md").read_text()
    text, n = re.subn(r"(<!-- comparison -->\n).*?(<!-- end -->)", lambda m: m[1] + table + m[2],
                      readme.read_text(), flags=re.DOTALL)
    if n != 1:
        sys.exit("README.md has no place for the table")
    readme.write_text(text)


if __name__ == "__main__":
    main()
