#!/usr/bin/env python3
"""Instructions of a fixed set of kernels and problems, counted by callgrind: the same on a busy machine.

    instructions.py PROGRAM [-o FOLDER]        PROGRAM: build/release/quern_count

Prints instructions per bond or per particle (problems: per particle and step) and writes
FOLDER/instructions.json, which compare.py reads. Exit code 2 if valgrind is missing or the program fails.
"""

import argparse
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile


def fail(text):
    print(f"instructions.py: error: {text}", file=sys.stderr)
    sys.exit(2)


def run_callgrind(program, folder):
    """What the program printed, and the instructions of each of its counted parts."""
    command = ["valgrind", "--tool=callgrind", "--toggle-collect=quern_counted", "--dump-after=quern_counted",
               f"--callgrind-out-file={folder}/out", program]
    done = subprocess.run(command, capture_output=True, text=True, env={**os.environ, "OMP_NUM_THREADS": "1"})
    if done.returncode != 0:
        fail(f"{' '.join(command)} ended with {done.returncode}:\n{done.stdout}{done.stderr}")
    counts = []
    while (dump := pathlib.Path(f"{folder}/out.{len(counts) + 1}")).exists():
        text = dump.read_text()
        if "Trigger: --dump-after=quern_counted" not in text:
            break  # the last dump is that of the end of the program
        counts.append(int(re.search(r"^(?:totals|summary): (\d+)", text, re.MULTILINE).group(1)))
    return done.stdout, counts


def main():
    parser = argparse.ArgumentParser(description="Instruction counts by callgrind")
    parser.add_argument("program")
    parser.add_argument("-o", "--output", default="out/bench", metavar="FOLDER")
    parser.add_argument("--revision", default="unknown", help="of the source, to be written into the file")
    arguments = parser.parse_args()
    if shutil.which("valgrind") is None:
        fail("valgrind is not installed; on Debian: apt-get install valgrind")
    with tempfile.TemporaryDirectory() as folder:
        printed, counts = run_callgrind(arguments.program, folder)
    lines = [line.split("|") for line in printed.splitlines()]
    if len(lines) != len(counts) or not counts:
        fail(f"{arguments.program} named {len(lines)} parts, callgrind counted {len(counts)}")

    entries = []
    print(f"{'':9}{'':36}{'units':>10}  instructions")
    for (kind, name, unit, units), count in zip(lines, counts):
        each = count / float(units)
        entries.append({"kind": kind, "name": name, "threads": 1, "unit": unit, "count": float(units),
                        "median": each, "spread": 0.0})
        print(f"{kind:9}{name:36}{units:>10}  {each:.2f} per {unit}")
    report = {"measure": "instructions", "band": 0.01, "machine": {"revision": arguments.revision},
              "entries": entries}
    os.makedirs(arguments.output, exist_ok=True)
    file = pathlib.Path(arguments.output, "instructions.json")
    file.write_text(json.dumps(report, indent=2) + "\n")
    print(f"\n{file}")


if __name__ == "__main__":
    main()
