"""Fast motion along a polyline within a tolerance and the limits of each axis: direct optimal control, solved by IPOPT.

    python3 optimum.py TABLE.json CONTOUR.json ...      (needs casadi and numpy)

Each contour has points (mm), limits (v, a, j per axis, feed, tol) and a name; its time in seconds is added to the table,
unless it is there. The jerk is constant in each cell; the cells of a segment share a free duration. The Bézier points of a
cell stay in the strip around its segment, so the curve keeps the tolerance everywhere. What it
finds is the yardstick of the bench, not a bound: it is a local optimum (IPOPT starts from the polyline at a constant speed),
it may not swing beyond a strip's end, and it keeps the feed at the ends of the cells only.
"""

import json
import sys
import time

import casadi as ca
import numpy as np

TIME_UNIT = 0.01  # s: keeps the unknowns near 1
START_SPEED = 5.0  # mm/s


def mesh(length):
    """Parts of a segment: fraction of its length, number of cells."""
    if length > 3.0:
        return [(0.02, 6), (0.13, 8), (0.35, 6), (0.35, 6), (0.13, 8), (0.02, 6)]
    if length > 1.0:
        return [(0.1, 6), (0.4, 7), (0.4, 7), (0.1, 6)]
    if length > 0.3:
        return [(0.5, 3), (0.5, 3)]
    return [(1.0, 2)]


class Problem:
    """Unknowns and constraints with their bounds."""

    def __init__(self):
        self.x, self.lower, self.upper, self.start = [], [], [], []
        self.g, self.g_lower, self.g_upper = [], [], []

    def unknown(self, count, lower, upper, start):
        symbol = ca.SX.sym("x", count)
        self.x.append(symbol)
        for values, value in ((self.lower, lower), (self.upper, upper), (self.start, start)):
            values.extend(np.broadcast_to(value, count))
        return symbol

    def keep(self, expression, lower, upper):
        self.g.append(expression)
        self.g_lower.extend(np.broadcast_to(lower, expression.numel()))
        self.g_upper.extend(np.broadcast_to(upper, expression.numel()))


def fastest(points, limits):
    """Seconds, or None if IPOPT found none."""
    chords = np.diff(points, axis=0)
    lengths = np.linalg.norm(chords, axis=1)
    along = chords / lengths[:, None]
    across = np.column_stack([-along[:, 1], along[:, 0]])
    most = [np.array(limits[name]) * TIME_UNIT**power for name, power in (("v", 1), ("a", 2), ("j", 3))]
    feed = limits["feed"] * TIME_UNIT
    problem, total = Problem(), 0

    def in_strip(point, k):
        offset = point - ca.DM(points[k])
        problem.keep(100 * ca.dot(ca.DM(across[k]), offset), -100 * limits["tol"], 100 * limits["tol"])
        problem.keep(ca.dot(ca.DM(along[k]), offset), 0.0, lengths[k])

    def state(position, velocity):
        return (
            problem.unknown(2, -np.inf, np.inf, position),
            problem.unknown(2, -most[0], most[0], velocity),
            problem.unknown(2, -most[1], most[1], 0.0),
        )

    p, v, a = state(points[0], 0.0)
    for value, wanted in ((p, points[0]), (v, 0.0), (a, 0.0)):
        problem.keep(value, wanted, wanted)
    for k, length in enumerate(lengths):
        done = 0.0
        for part, cells in mesh(length):
            guess = max(length * part / cells / (START_SPEED * TIME_UNIT), 1e-3)
            dt = problem.unknown(1, 1e-5, np.inf, guess)
            total += dt * cells
            for cell in range(cells):
                jerk = problem.unknown(2, -most[2], most[2], 0.0)
                at = points[k] + chords[k] * (done + part * (cell + 1) / cells)
                q, w, b = state(at, along[k] * START_SPEED * TIME_UNIT)
                problem.keep(p + v * dt + a * dt**2 / 2 + jerk * dt**3 / 6 - q, 0.0, 0.0)
                problem.keep(v + a * dt + jerk * dt**2 / 2 - w, 0.0, 0.0)
                problem.keep(a + jerk * dt - b, 0.0, 0.0)
                problem.keep(ca.dot(w, w), 0.0, feed**2)
                problem.keep(v + a * dt / 2, -most[0], most[0])
                for control_point in (p + v * dt / 3, q - w * dt / 3, q):
                    in_strip(control_point, k)
                p, v, a = q, w, b
            done += part
        if k + 1 < len(lengths):
            in_strip(p, k + 1)
    for value, wanted in ((p, points[-1]), (v, 0.0), (a, 0.0)):
        problem.keep(value, wanted, wanted)
    options = {"ipopt": {"max_iter": 2000, "print_level": 0, "tol": 1e-7, "mu_strategy": "adaptive"}, "print_time": 0}
    nlp = {"x": ca.vertcat(*problem.x), "f": total, "g": ca.vertcat(*problem.g)}
    solver = ca.nlpsol("solver", "ipopt", nlp, options)
    result = solver(
        x0=problem.start, lbx=problem.lower, ubx=problem.upper, lbg=problem.g_lower, ubg=problem.g_upper
    )
    return float(result["f"]) * TIME_UNIT if solver.stats()["success"] else None


def main():
    table_file, *contour_files = sys.argv[1:]
    for file in contour_files:
        with open(file, encoding="utf-8") as text:
            contour = json.load(text)
        with open(table_file, encoding="utf-8") as text:
            if contour["name"] in json.load(text):
                continue
        began = time.time()
        seconds = fastest(np.array(contour["points"]), contour["limits"])
        print(contour["name"], seconds, f"{time.time() - began:.0f} s to solve", flush=True)
        if seconds is not None:
            with open(table_file, encoding="utf-8") as text:
                table = json.load(text)
            table[contour["name"]] = round(seconds, 4)
            with open(table_file, "w", encoding="utf-8") as text:
                json.dump(dict(sorted(table.items())), text, indent=1)
                text.write("\n")


if __name__ == "__main__":
    main()
