#!/usr/bin/env python3
"""Computes the length of the smoothed cube's section with the plane x = y, a closed geodesic
through four vertices of valence 3. The control mesh is the cube [-1,1]^3. The program implements
Catmull and Clark's rules itself and uses no code of the engine or of another library.

usage: tests/oracle/mirror.py [--digits N]

Three sectors meet in the vertex (-1,-1,1). For each sector the program keeps the refined control
points (i,j), 0 <= i, j <= 3, which are i and j edges away from the vertex. They determine the
bicubic patches between one and two edges from the vertex, on the diagonal of a face and along an
edge. The program integrates |S'| over these patches, refines, and continues with the next patches,
which are half as far from the vertex. The section consists of four half diagonals and four half
edges. With --digits the program computes with that many digits (mpmath) and prints the length.
Otherwise it computes in doubles and compares the length with the one that the tests trace.
"""
import argparse
import math
import sys

TRACED = 5.384418260817481  # tests/unit/subdiv/test_limit_trace.c, tests/api/subdivisions.py
CUBE = ([[x, y, z] for z in (-1, 1) for y in (-1, 1) for x in (-1, 1)],
        [[4, 5, 7, 6], [0, 2, 3, 1], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]])
# index of the extraordinary vertex, and number of control points in a row of a sector
TIP, REACH = 4, 4


def combine(terms):
    return [sum(weight * point[k] for weight, point in terms) for k in range(3)]


def mean(points):
    return [sum(point[k] for point in points) / len(points) for k in range(3)]


def refine_mesh(points, faces):
    """Refines a closed mesh of quads once. Points keep their numbers."""
    middles = [mean([points[v] for v in face]) for face in faces]
    beside, around = {}, {}
    for n, face in enumerate(faces):
        for a, b in zip(face, face[1:] + face[:1]):
            beside.setdefault(frozenset((a, b)), []).append(n)
            around.setdefault(a, []).append(n)
    number = {edge: len(points) + n for n, edge in enumerate(beside)}
    edges = [mean([points[v] for v in edge] + [middles[n] for n in sides]) for edge, sides in beside.items()]
    moved = []
    for v, point in enumerate(points):
        n = len(around[v])
        halves = mean([mean([points[w] for w in edge]) for edge in beside if v in edge])
        moved.append([(q + 2 * r + (n - 3) * p) / n for p, q, r in zip(point, mean([middles[f] for f in around[v]]), halves)])
    first = len(points) + len(edges)
    quads = [[v, number[frozenset((v, face[(k + 1) % 4]))], first + n, number[frozenset((v, face[k - 1]))]]
             for n, face in enumerate(faces) for k, v in enumerate(face)]
    return moved + edges + middles, quads


def sectors_of(points, faces):
    """Returns three dictionaries {(i, j): point}. Sector k is between spokes k (j = 0) and k + 1
    (i = 0)."""
    left = {(a, b): (face, k) for face in faces for k, (a, b) in enumerate(zip(face, face[1:] + face[:1]))}
    spokes = [next(b for a, b in left if a == TIP)]
    for _ in range(2):
        face, k = left[TIP, spokes[-1]]
        spokes.append(face[k - 1])
    sectors = []
    for spoke in spokes:
        sector, begin = {}, (TIP, spoke)
        for j in range(REACH - 1):
            side = begin
            for i in range(REACH - 1):
                face, k = left[side]
                a, b, c, d = (face[(k + n) % 4] for n in range(4))
                sector.update({(i, j): points[a], (i + 1, j): points[b], (i + 1, j + 1): points[c], (i, j + 1): points[d]})
                if i == 0:
                    begin = (d, c)
                # finds the next face in the row; its side that continues (a, b) begins at b
                face, k = left[c, b]
                side = (b, face[(k + 2) % 4])
        sectors.append(sector)
    return sectors


def at(sectors, k, i, j):
    """Returns a point of sector k, or of a neighbour if (i, j) is beyond its spokes."""
    if j < 0:
        return sectors[k - 1][-j, i]
    return sectors[(k + 1) % 3][j, -i] if i < 0 else sectors[k][i, j]


def refine(sectors, one):
    def rule(k, i, j):
        def p(x, y):
            return at(sectors, k, i // 2 + x, j // 2 + y)
        # a vertex of three faces has the weights 5/12 for itself, 1/6 for each neighbour, and 1/36
        # for each opposite corner
        if (i, j) == (0, 0):
            ring = [(one / 6, s[1, 0]) for s in sectors] + [(one / 36, s[1, 1]) for s in sectors]
            return combine([(5 * one / 12, p(0, 0))] + ring)
        if i % 2 and j % 2:
            return combine([(one / 4, p(x, y)) for x in (0, 1) for y in (0, 1)])
        if i % 2:
            return combine([(6 * one / 16, p(x, 0)) for x in (0, 1)] + [(one / 16, p(x, y)) for x in (0, 1) for y in (-1, 1)])
        if j % 2:
            return combine([(6 * one / 16, p(0, y)) for y in (0, 1)] + [(one / 16, p(x, y)) for x in (-1, 1) for y in (0, 1)])
        cross = [(6 * one / 64, p(x, y)) for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))]
        return combine([(36 * one / 64, p(0, 0))] + cross + [(one / 64, p(x, y)) for x in (-1, 1) for y in (-1, 1)])
    return [{(i, j): rule(k, i, j) for i in range(REACH) for j in range(REACH)} for k in range(3)]


def basis(t):
    r = 1 - t
    return [r**3 / 6, (3 * t**3 - 6 * t * t + 4) / 6, (3 * r**3 - 6 * r * r + 4) / 6, t**3 / 6]


def slopes(t):
    r = 1 - t
    return [-r * r / 2, (3 * t * t - 4 * t) / 2, (4 * r - 3 * r * r) / 2, t * t / 2]


def speed(patch, weights, sqrt):
    vector = combine([(weights(i, j), patch[i][j]) for i in range(4) for j in range(4)])
    return sqrt(sum(x * x for x in vector))


def on_diagonal(patch, t, sqrt):
    b, d = basis(t), slopes(t)
    return speed(patch, lambda i, j: d[i] * b[j] + b[i] * d[j], sqrt)


def on_edge(patch, t, sqrt):
    b, d = basis(0 * t), slopes(t)
    return speed(patch, lambda i, j: d[i] * b[j], sqrt)


def section(one, quad, sqrt, end):
    points, faces = CUBE
    points = [[one * x for x in p] for p in points]
    for _ in range(2):
        points, faces = refine_mesh(points, faces)
    sectors = sectors_of(points, faces)
    # finds the sector whose diagonal lies in the plane, and the spoke that lies in the plane
    diagonal = next(k for k in range(3) if all(abs(sectors[k][n, n][0] - sectors[k][n, n][1]) < 1e-9 for n in range(REACH)))
    spoke = next(k for k in range(3) if all(abs(sectors[k][n, 0][0] - sectors[k][n, 0][1]) < 1e-9 for n in range(REACH)))
    total = 0 * one
    while True:
        face = [[sectors[diagonal][i, j] for j in range(4)] for i in range(4)]
        edge = [[at(sectors, spoke, i, j) for j in range(-1, 3)] for i in range(4)]
        piece = quad(lambda t: on_diagonal(face, t, sqrt)) + quad(lambda t: on_edge(edge, t, sqrt))
        total += piece
        if piece < end:
            return 4 * total
        sectors = refine(sectors, one)


def gauss(f, n=20):
    """Returns the integral over [0,1] by Gauss-Legendre quadrature."""
    total = 0.0
    for i in range(n):
        x = math.cos(math.pi * (i + 0.75) / (n + 0.5))
        for _ in range(100):
            p, q = 1.0, 0.0
            for k in range(n):
                p, q = ((2 * k + 1) * x * p - k * q) / (k + 1), p
            slope = n * (x * p - q) / (x * x - 1)
            x -= p / slope
        total += f((1 + x) / 2) / ((1 - x * x) * slope * slope)
    return total


def main():
    arguments = argparse.ArgumentParser()
    arguments.add_argument("--digits", type=int)
    digits = arguments.parse_args().digits
    if digits:
        from mpmath import mp
        mp.dps = digits + 20
        length = section(mp.mpf(1), lambda f: mp.quad(f, [0, 1], maxdegree=8), mp.sqrt, mp.mpf(10)**-digits)
        print(mp.nstr(length, digits))
        return 0
    length = section(1.0, gauss, math.sqrt, 1e-14)  # rounding of the points is about 1e-16
    ok = abs(length - TRACED) < 1e-12
    print(f"# the smoothed cube's section with x = y is {length:.15f} long")
    print("ok" if ok else "not ok", "length of the section in the mirror plane")
    return 0 if ok else 1


if __name__ == "__main__":
    sys.exit(main())
