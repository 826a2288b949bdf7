#!/usr/bin/env python3
"""Two files of `make bench` or `make bench-instructions`, entry by entry.

    compare.py OLD NEW [--all]

An entry is slower or faster if its median has changed by more than the band: the one of the files (10 % of a
time, 1 % of a count of instructions), or the sum of both relative distances of quartiles if that is more.
Exit code 1 if anything is slower, 2 if a file cannot be used. Without --all only what has changed is printed.
"""

import argparse
import json
import statistics
import sys


class BadFile(Exception):
    pass


def read_report(path):
    try:
        with open(path, encoding="utf-8") as file:
            report = json.load(file)
        entries = {(e["name"], e["threads"], e["unit"]): (float(e["median"]), float(e["spread"]))
                   for e in report["entries"]}
        return report["measure"], float(report["band"]), entries
    except (OSError, ValueError, KeyError, TypeError) as error:
        raise BadFile(f"{path}: not a report of a benchmark ({error!r})") from error


def compare(old_path, new_path):
    """Rows (name, threads, unit, old, new, ratio, band, verdict) in the order of the new file; what only one has."""
    old_measure, old_band, old = read_report(old_path)
    new_measure, new_band, new = read_report(new_path)
    if old_measure != new_measure:
        raise BadFile(f"{old_path} holds {old_measure}, {new_path} {new_measure}")
    rows = []
    for key, (value, spread) in new.items():
        if key not in old:
            continue
        before, spread_before = old[key]
        if before <= 0.0 or value <= 0.0:
            raise BadFile(f"{key[0]}: a median that is not positive")
        ratio = value / before
        band = max(old_band, new_band, spread + spread_before)
        verdict = "SLOWER" if ratio > 1.0 + band else "faster" if ratio < 1.0 / (1.0 + band) else ""
        rows.append((*key, before, value, ratio, band, verdict))
    return new_measure, rows, sorted(old.keys() ^ new.keys())


def main(arguments=None):
    parser = argparse.ArgumentParser(description="Compares two reports of the benchmark")
    parser.add_argument("old")
    parser.add_argument("new")
    parser.add_argument("--all", action="store_true", help="print entries within the band, too")
    options = parser.parse_args(arguments)
    try:
        measure, rows, alone = compare(options.old, options.new)
        if not rows:
            raise BadFile(f"{options.old} and {options.new} have no entry in common")
    except BadFile as error:
        print(f"compare.py: error: {error}", file=sys.stderr)
        return 2
    print(f"{'':40}{'thr':>3} {'unit':9}{'old':>12}{'new':>12}{'ratio':>8}{'band':>7}   [{measure} a unit]")
    for name, threads, unit, old, new, ratio, band, verdict in rows:
        if verdict or options.all:
            print(f"{name:40}{threads:>3} {unit:9}{old:12.3f}{new:12.3f}{ratio:8.3f}{100 * band:6.1f}%  {verdict}")
    slower = sum(row[-1] == "SLOWER" for row in rows)
    faster = sum(row[-1] == "faster" for row in rows)
    middle = statistics.median(row[5] for row in rows)
    print(f"{len(rows)} entries: {slower} slower, {faster} faster; median of all ratios {middle:.3f}")
    if alone:
        print("in one file only: " + ", ".join(f"{name} ({threads})" for name, threads, _ in alone))
    return 1 if slower else 0


if __name__ == "__main__":
    sys.exit(main())
