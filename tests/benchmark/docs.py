#!/usr/bin/env python3
"""Puts what the benchmark has measured into docs/: tables into performance.md, and its picture.

    docs.py FOLDER         FOLDER: of bench.json, bench.png and, if there, methods.json, methods.png,
                           instructions.json

A table stands between the lines "<!-- bench: NAME -->" and "<!-- end -->"; what is between them is replaced.
"""

import json
import math
import pathlib
import re
import shutil
import sys

docs = pathlib.Path(__file__).resolve().parents[2] / "docs"


def table(head, rows):
    lines = [head, ["---"] * len(head), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def whole(number):
    return f"{number:,.0f}".replace(",", " ")


def short(number):
    return whole(number) if number >= 1000 else f"{number:.3g}"


def machine(report):
    about = report["machine"]
    text = (f"{about['processor']}, {about['cores']} cores, {about['instructions']}, L2 {about['cache_l2']}, "
            f"L3 {about['cache_l3']}; {about['compiler']}; revision {about['revision']}, "
            f"load at the start {' '.join(about['load_at_start'].split()[:3])}.\n\n")
    rows = [[str(r["threads"]), f"{r['triad_gb_per_s']:.1f}", f"{r['triad_cache_gb_per_s']:.1f}",
             f"{r['fma_gflop_per_s']:.0f}"] for r in report["rooflines"]]
    return text + table(["threads", "triad in memory [GB/s]", "triad in cache [GB/s]", "FMA [GFlop/s]"], rows)


def problems(report):
    by_name = {(e["name"], e["threads"]): e for e in report["entries"]}
    rows = []
    for e in report["entries"]:
        if e["kind"] != "problem":
            continue
        def stage(name):
            return by_name.get((f"{e['name']}: {name}", e["threads"]))
        def cost(name):
            s = stage(name)
            return f"{s['median'] * s['count'] / e['count']:.1f}" if s else "-"
        sizes = e["sizes"]
        rows.append([e["name"], str(e["threads"]), whole(e["count"]), f"{stage('force')['median']:.2f}",
                     *(cost(name) for name in ("force", "kick", "contact", "drift")), f"{e['median']:.1f}",
                     f"{50 * e['spread']:.0f} %", short(1e-6 * e["median"] * e["count"]),
                     f"{100 * e['roofline']:.0f} %", f"{100 * sizes['cpu_share']:.0f} %",
                     f"{1e-3 * e['bytes_per_particle']:.2f}" if "bytes_per_particle" in e else "-",
                     f"{sizes['speed_up']:.2f}" if "speed_up" in sizes else "-"])
    return table(["problem", "threads", "particles", "ns per bond", "force", "kick", "contact", "drift", "step",
                  "+-", "ms a step", "roof", "core", "kB a particle", "speed-up"], rows)


def kernels(report):
    rows = [[e["name"], e["unit"], whole(e["count"]), short(e["median"]), f"{50 * e['spread']:.0f} %",
             f"{e['bytes']:.1f}" if "bytes" in e else "-", f"{e['flops']:.0f}" if "flops" in e else "-",
             f"{100 * e['roofline']:.0f} %" if "roofline" in e else "-"]
            for e in report["entries"] if e["kind"] == "kernel"]
    return table(["kernel", "unit", "units a call", "ns", "+-", "bytes", "flops", "roof"], rows)


def instructions(report):
    rows = [[e["name"], e["unit"] + (" and step" if e["kind"] == "problem" else ""), whole(e["count"]),
             f"{e['median']:.1f}"] for e in report["entries"]]
    return table(["", "unit", "units", "instructions"], rows)


def slope(points):
    """Of log(time of a step) over log(grains), by least squares."""
    logs = [(math.log(n), math.log(t)) for n, t in points]
    x = sum(a for a, _ in logs) / len(logs)
    y = sum(b for _, b in logs) / len(logs)
    return sum((a - x) * (b - y) for a, b in logs) / sum((a - x) ** 2 for a, _ in logs)


def methods(report):
    entries = [e for e in report["entries"] if e["kind"] == "method"]
    grains = sorted({e["sizes"]["grains"] for e in entries})
    rows = []
    for name, moving in dict.fromkeys((e["name"], e["sizes"]["moving"]) for e in entries):
        own = {e["sizes"]["grains"]: e for e in entries if (e["name"], e["sizes"]["moving"]) == (name, moving)}
        cost = [f"{own[n]['median']:.1f}" if n in own else "-" for n in grains]
        rows.append([name, "moving" if moving else "at rest", *cost,
                     f"{slope([(n, e['median'] * e['count']) for n, e in own.items()]):.3f}"])
    return table(["contact by", "grains", *(whole(n) + " grains" for n in grains), "slope"], rows)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder, page = pathlib.Path(sys.argv[1]), docs / "performance.md"
    text = page.read_text(encoding="utf-8")
    makers = {"bench.json": (machine, problems, kernels), "methods.json": (methods,),
              "instructions.json": (instructions,)}
    for name, tables in makers.items():
        if not (folder / name).exists():
            print(f"{folder / name} is missing: its tables stay as they are")
            continue
        report = json.loads((folder / name).read_text(encoding="utf-8"))
        for make in tables:
            place = re.compile(rf"(<!-- bench: {make.__name__} -->\n).*?(<!-- end -->)", re.DOTALL)
            if not place.search(text):
                sys.exit(f"docs.py: error: {page} has no place for the table '{make.__name__}'")
            text = place.sub(lambda found: found[1] + "\n" + make(report) + "\n\n" + found[2], text)
    page.write_text(text, encoding="utf-8")
    for picture in ("bench.png", "methods.png"):
        if (folder / picture).exists():
            shutil.copy(folder / picture, docs / picture)
    print(f"{page} written")


if __name__ == "__main__":
    main()
