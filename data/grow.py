#!/usr/bin/env python3
# SPDX-License-Identifier: MIT
"""usage: grow.py NAME > SCENE.yaml
Writes the scenes of this folder that are grown, not typed: starfishes, t-shapes, coral, urchin, shell, wrinkles, and
sphereflakes of any size, flake91, flake820, flake7381. After figures of Sherstyuk's thesis (1999) and Haines's
sphereflake (1987); all numbers are ours."""
import math
import sys


def add(a, b, s=1.0):
    return [x + s * y for x, y in zip(a, b)]


def cross(a, b):
    return [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]


def unit(a):
    n = math.sqrt(sum(x * x for x in a))
    return [x / n for x in a]


def frame(d):
    u = unit(cross(d, [1, 0, 0] if abs(d[0]) < 0.8 else [0, 1, 0]))
    return u, cross(d, u)


def vec(a):
    return "[" + ", ".join("%.6g" % (0 if abs(x) < 1e-12 else x) for x in a) + "]"


def noise(k):
    """A number in [0, 1) that depends on k alone."""
    h = (k * 2654435761 + 12345) & 0xFFFFFFFF
    h = ((h ^ (h >> 15)) * 0x2C1B3C6D) & 0xFFFFFFFF
    h = ((h ^ (h >> 12)) * 0x297A2D39) & 0xFFFFFFFF
    return (h ^ (h >> 15)) / 4294967296.0


def start(comment, *lines):
    print("# %s Made by grow.py %s." % (comment, sys.argv[1]))
    print("skelfield: 1")
    for line in lines:
        print(line)


def body(name, *keys):
    print("  - name: " + name)
    for key in keys:
        print("    " + key)
    print("    skeleton:")


def row(kind, text):
    print("      - %s: {%s}" % (kind, text))


def starfishes():
    start("Starfishes with 5 to 9 arms, each an arc that leaves the centre and bends.",
          "camera: {from: [0, -9.5, 11], to: [0, -0.35, 0], fov: 32}", "bodies:")
    colors = ["[0.75, 0.25, 0.12]", "[0.70, 0.45, 0.10]", "[0.45, 0.15, 0.40]", "[0.15, 0.35, 0.50]"]
    for i, arms in enumerate((5, 6, 7, 9)):
        at = [2.15 * (2 * (i % 2) - 1), 2.1 * (1 - 2 * (i // 2)), 0]
        body("arms-%d" % arms, "iso: 0.2", "kernel: {type: cauchy, s: %g}" % (3.2 + 0.4 * i), "color: " + colors[i])
        for k in range(arms):
            a = 2 * math.pi * k / arms + 0.3
            side = [-math.sin(a), math.cos(a), 0]
            row("arc", "center: %s, normal: [0, 0, 1], start: %s, radius: 1.9, sweep: 58"
                % (vec(add(at, side, 1.9)), vec([-x for x in side])))


def t_shapes():
    start("Two segments in a T: radius grows upwards, blobbiness to the right (Sherstyuk 1999, section 3.3.2).",
          "camera: {from: [0, -16, 1.5], to: [0, 0, 0], fov: 27}",
          "lights: [{direction: [-1, -1.6, 1.5], intensity: 0.8}, {direction: [1, -1, 0.2], intensity: 0.25}]", "bodies:")
    for i, radius in enumerate((0.12, 0.25, 0.4)):
        for k, blobbiness in enumerate((-4, -1.5, -0.6, -0.25)):
            at = [2.6 * (k - 1.5), 0, 2.3 * (i - 1)]
            body("t-%d-%d" % (i, k), "iso: 1", "kernel: {type: gaussian}", "radius: %g" % radius,
                 "blobbiness: %g" % blobbiness,
                 "color: [%.2f, %.2f, %.2f]" % (0.75 - 0.18 * k, 0.30 + 0.05 * i, 0.12 + 0.17 * k))
            row("segment", "from: %s, to: %s" % (vec(add(at, [-0.7, 0, 0.6])), vec(add(at, [0.7, 0, 0.6]))))
            row("segment", "from: %s, to: %s" % (vec(add(at, [0, 0, 0.6])), vec(add(at, [0, 0, -0.7]))))


def coral():
    start("A tree of 31 branches, each with two more, and 300 spikes on them.",
          "camera: {from: [2.2, -9, 4.2], to: [0, 0, 2.45], fov: 33}", "bodies:")
    body("coral", "iso: 1", "kernel: {type: quartic}", "color: [0.80, 0.30, 0.22]")
    branches, waiting = [], [([0, 0, 0], [0, 0, 1], 1.5, 0.2)]
    while len(branches) < 31:
        p, d, length, r = waiting.pop(0)
        end = add(p, d, length)
        branches.append((p, end, r))
        u, v = frame(d)
        turn = 2.4 * len(branches)
        for k in range(2):
            a = turn + math.pi * k
            side = add([math.cos(a) * x for x in u], v, math.sin(a))
            waiting.append((end, unit(add(d, side, 0.62 + 0.2 * noise(len(branches) + 50 * k))), 0.8 * length, 0.78 * r))
    for p, end, r in branches:
        row("segment", "from: %s, to: %s, radius: %.4g, influence: %.4g" % (vec(p), vec(end), r, 2 * r))
    for k in range(300):
        p, end, r = branches[int(31 * noise(3 * k + 1000))]
        d = unit(add(end, p, -1))
        u, v = frame(d)
        a, t = 2 * math.pi * noise(3 * k + 1001), 0.05 + 0.95 * noise(3 * k + 1002)
        at = add(p, add(end, p, -1), t)
        out = unit(add(add([math.cos(a) * x for x in u], v, math.sin(a)), d, 0.5))
        row("segment", "from: %s, to: %s, radius: %.4g, influence: %.4g, color: [0.95, 0.75, 0.55]"
            % (vec(add(at, out, 0.8 * r)), vec(add(at, out, r + 0.12)), 0.2 * r + 0.012, 0.45 * r + 0.025))


def urchin():
    start("A sea urchin: a ball, and 110 spines that taper by a linear profile.", "bodies:")
    body("urchin", "iso: 1", "kernel: {type: quartic}", "color: [0.40, 0.16, 0.45]")
    row("point", "at: [0, 0, 0], radius: 0.85, influence: 1.5, color: [0.20, 0.07, 0.22]")
    for k in range(110):
        z = 1 - (2 * k + 1) / 110
        s, a = math.sqrt(1 - z * z), 2.399963229728653 * k
        d = [s * math.cos(a), s * math.sin(a), z]
        row("segment", "from: %s, to: %s, radius: 0.05, influence: 0.12, profile: {linear: [1.3, 0.6]}"
            % (vec([0.9 * x for x in d]), vec([(1.75 + 0.25 * noise(k)) * x for x in d])))


def shell():
    start("A seashell: 150 points on a conical spiral that grow with it, with ribs, and a profiled axis inside them.",
          "camera: {from: [-3.6, -6, 2.2], to: [0, 0, -0.75], fov: 31}",
          "materials:",
          "  - {name: nacre, color: [0.85, 0.62, 0.42], specular: 0.08, shine: 80, texture: {type: onion, at: [0, 0, 0.6],"
          " size: 0.5, turbulence: 0.25, colors: [[0.90, 0.75, 0.58], [0.60, 0.30, 0.14]]}}",
          "bodies:")
    body("shell", "iso: 1", "kernel: {type: quartic}", "material: nacre")
    n, turns = 150, 5.5
    for k in range(n):
        t = k / (n - 1)
        grown = math.exp(3.3 * (t - 1))
        a = 2 * math.pi * turns * t
        rib = 1 + 0.13 * math.sin(2 * math.pi * 11 * turns * t / 5.5) ** 2
        at = [1.05 * grown * math.cos(a), 1.05 * grown * math.sin(a), 0.9 - 2.6 * grown]
        row("point", "at: %s, radius: %.4g, influence: %.4g" % (vec(at), 0.62 * grown * rib, 1.05 * grown * rib))
    row("segment", "from: [0, 0, 0.85], to: [0, 0, -1.6], radius: 0.35, influence: 0.75, profile: {linear: [0.05, 2]}")


def wrinkles():
    start("A ball of 80 triangles, each by itself: the surface has hills over their middles and valleys along their edges,"
          "\n# after the wrinkled meshes of Sherstyuk's thesis (1999, 3.5.3.3).", "bodies:")
    body("wrinkles", "iso: 1", "kernel: {type: quartic}", "radius: 0.1", "influence: 0.17", "color: [0.45, 0.50, 0.30]")
    row("point", "at: [0, 0, 0], radius: 0.91, influence: 1.05, color: [0.30, 0.25, 0.15]")
    g = (1 + math.sqrt(5)) / 2
    v = [unit(p) for p in ([-1, g, 0], [1, g, 0], [-1, -g, 0], [1, -g, 0], [0, -1, g], [0, 1, g], [0, -1, -g],
                           [0, 1, -g], [g, 0, -1], [g, 0, 1], [-g, 0, -1], [-g, 0, 1])]
    faces = ((0, 11, 5), (0, 5, 1), (0, 1, 7), (0, 7, 10), (0, 10, 11), (1, 5, 9), (5, 11, 4), (11, 10, 2), (10, 7, 6),
             (7, 1, 8), (3, 9, 4), (3, 4, 2), (3, 2, 6), (3, 6, 8), (3, 8, 9), (4, 9, 5), (2, 4, 11), (6, 2, 10),
             (8, 6, 7), (9, 8, 1))
    for f in faces:
        a, b, c = (v[i] for i in f)
        ab, bc, ca = unit(add(a, b)), unit(add(b, c)), unit(add(c, a))
        for t in ((a, ab, ca), (b, bc, ab), (c, ca, bc), (ab, bc, ca)):
            m = [sum(x) / 3 for x in zip(*t)]
            row("triangle", "vertices: [%s]" % ", ".join(vec(add(m, add(p, m, -1), 0.74)) for p in t))


def flake(levels):
    start("A sphereflake: each ball carries nine of a third of its size, on stems that are arcs.",
          "camera: {from: [2.6, -5, 2.3], to: [0, 0, 0.1], fov: 44}", "bodies:")
    body("flake", "iso: 1", "kernel: {type: quartic}", "color: [0.30, 0.42, 0.60]")

    def grow(c, r, d, level):
        row("point", "at: %s, radius: %.5g, influence: %.5g" % (vec(c), r, 1.35 * r))
        if level == 0:
            return
        u, v = frame(d)
        for n, latitude, offset in ((6, 0.0, 0.0), (3, math.radians(54.7), math.radians(30))):
            for k in range(n):
                a = offset + 2 * math.pi * k / n
                w = add(add([math.cos(latitude) * math.cos(a) * x for x in u], v, math.cos(latitude) * math.sin(a)),
                        d, math.sin(latitude))
                child, side = add(c, w, 1.75 * r), unit(cross(w, add(d, u, 0.3)))
                root = add(c, w, 0.95 * r)  # the stem: a sixth of a circle from here to the child
                chord = 0.8 * r
                centre = add(add(c, w, 1.35 * r), side, chord * math.cos(math.pi / 6))
                normal = cross(add(root, centre, -1), add(child, centre, -1))
                row("arc", "center: %s, normal: %s, start: %s, radius: %.5g, sweep: 60, thickness: %.5g, influence: %.5g,"
                    " color: [0.80, 0.55, 0.20]" % (vec(centre), vec(unit(normal)), vec(unit(add(root, centre, -1))),
                                                    chord, 0.1 * r, 0.22 * r))
                grow(child, r / 3, w, level - 1)

    grow([0, 0, 0], 1.0, unit([0.2, 0.15, 1]), levels)


SCENES = {"starfishes": starfishes, "t-shapes": t_shapes, "coral": coral, "urchin": urchin, "shell": shell,
          "wrinkles": wrinkles, "flake91": lambda: flake(2), "flake820": lambda: flake(3), "flake7381": lambda: flake(4)}

if len(sys.argv) != 2 or sys.argv[1] not in SCENES:
    sys.exit("usage: grow.py NAME > SCENE.yaml\nexpected one of: " + ", ".join(SCENES))
SCENES[sys.argv[1]]()
