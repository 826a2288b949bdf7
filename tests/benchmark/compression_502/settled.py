#!/usr/bin/env python3
"""Where the grains of a run came to rest, as rows of a deck: settled.py RUN [START] > packed.csv

START is the table that the run began with; left out: start.csv. Corners that have sunk into a neighbour by more than 0.02 mm are drawn out of it first.
"""

import csv
import math
import pathlib
import sys

RADIUS, DEPTH = 1e-3, 2e-5  # of a grain of scale 1, of corners that may stay [m]


def corners(grain):
    n = 6 if grain["shape"] == "hexagon" else 60
    size = RADIUS * grain["scale"]
    return [(grain["x"] + size * math.cos(grain["angle"] + 2.0 * math.pi * k / n),
             grain["y"] + size * math.sin(grain["angle"] + 2.0 * math.pi * k / n)) for k in range(n)]


def least_overlap(a, b):
    """Depth of two convex polygons in each other, and the direction from a to b in which it is least."""
    best = (math.inf, 0.0, 0.0)
    for near, far, sign in ((a, b, 1.0), (b, a, -1.0)):
        for (x, y), (x_next, y_next) in zip(near, near[1:] + near[:1]):
            length = math.hypot(x_next - x, y_next - y)
            nx, ny = (y_next - y) / length, (x - x_next) / length
            depth = -min((p - x) * nx + (q - y) * ny for p, q in far)
            best = min(best, (depth, sign * nx, sign * ny))
    return best


def draw_apart(grains):
    """True if a pair of grains was too deep in each other."""
    moved = False
    outlines = [corners(grain) for grain in grains]
    for i, a in enumerate(grains):
        for j in range(i):
            b = grains[j]
            if math.hypot(a["x"] - b["x"], a["y"] - b["y"]) > RADIUS * (a["scale"] + b["scale"]):
                continue
            depth, nx, ny = least_overlap(outlines[i], outlines[j])
            if depth <= DEPTH:
                continue
            moved = True
            for grain, sign in ((a, -0.25), (b, 0.25)):
                grain["x"] += sign * (depth - 0.5 * DEPTH) * nx
                grain["y"] += sign * (depth - 0.5 * DEPTH) * ny
    return moved


def main():
    table = pathlib.Path(sys.argv[2]) if len(sys.argv) > 2 else pathlib.Path(__file__).parent / "start.csv"
    with open(table, encoding="utf-8") as file:
        start = list(csv.DictReader(line for line in file if not line.startswith("#")))
    with open(pathlib.Path(sys.argv[1]) / "grains.csv", encoding="utf-8") as file:
        last = list(csv.DictReader(file))[-len(start):]
    grains = [{"shape": row["shape"], "scale": float(row["scale"]), "x": float(end["x"]), "y": float(end["y"]),
               "angle": float(end["angle"]) % (2.0 * math.pi)} for row, end in zip(start, last)]
    while draw_apart(grains):
        pass
    print(f"# {table.name} after a fall, see README.md")
    print("shape,material,x,y,scale,angle")
    for g in grains:
        print(f"{g['shape']},{g['shape']},{g['x']:.7f},{g['y']:.7f},{g['scale']:.3f},{g['angle']:.6f}")


if __name__ == "__main__":
    main()
