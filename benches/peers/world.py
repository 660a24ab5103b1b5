"""Worlds: bodies of one shape each, what stands still, and slides that push. Every simulator gets the same ones.

Lengths in m, masses in kg. The frame of a body is that of its shape, whose middle is its centre of mass. Commands are
rows, held for 1/60 s; samples are taken after each row.
"""

from dataclasses import dataclass, field

import numpy as np

G = 9.81
RATE = 60


@dataclass
class Body:
    """A box (its sides), a sphere (radius) or a cylinder (radius, length along z); without mass it stands still."""

    name: str
    kind: str
    size: tuple
    xyz: tuple
    mass: float = 0.0
    rpy: tuple = (0.0, 0.0, 0.0)
    velocity: tuple = (0.0, 0.0, 0.0)
    spin: tuple = (0.0, 0.0, 0.0)
    smooth: bool = False  # whether nothing rubs on it

    def inertia(self):
        """Of a solid, about its axes, kg·m²."""
        m = self.mass
        if self.kind == "box":
            x, y, z = (side**2 for side in self.size)
            return np.array([y + z, x + z, x + y]) * m / 12
        if self.kind == "sphere":
            return np.full(3, 0.4 * m * self.size[0]**2)
        r, l = self.size
        across = m * (3 * r**2 + l**2) / 12
        return np.array([across, across, m * r**2 / 2])


@dataclass
class Slide:
    """A body that a motor moves along an axis, from where it is given; `parent` is another slide or the world."""

    body: Body
    axis: tuple
    parent: str = ""


@dataclass
class World:
    """What is simulated. `kp` 0: the slides are commanded by forces, else by positions with these gains."""

    name: str
    end: float
    bodies: list
    slides: list = field(default_factory=list)
    command: object = None  # time in s -> one number per slide
    friction: float = 0.5
    restitution: float = 0.0
    impact: float = 0.0  # m/s, of the first impact: what Drake has to know for a restitution
    kp: float = 0.0
    kd: float = 0.0
    limit: float = 1e3
    ground: bool = True

    def moving(self):
        """The bodies that are free."""
        return [b for b in self.bodies if b.mass > 0]

    def rows(self):
        """Commands, a row a period."""
        count = round(self.end * RATE)
        if not self.slides:
            return np.zeros((count, 0))
        return np.array([self.command(i / RATE) for i in range(count)], dtype=float)


@dataclass
class Samples:
    """Poses of the free bodies (x, y, z, then the quaternion w, x, y, z) and places of the slides, by rows."""

    poses: np.ndarray
    slides: np.ndarray

    def up(self):
        """Cosine of the angle that each body is tilted by."""
        return 1 - 2 * (self.poses[..., 4]**2 + self.poses[..., 5]**2)

    def tilt(self):
        """That angle, rad."""
        return 2 * np.arcsin(np.clip(np.hypot(self.poses[..., 4], self.poses[..., 5]), 0, 1))


def at(t):
    """The row of a time."""
    return round(t * RATE)


@dataclass
class Figure:
    """One number that a scene is judged by; `truth` None: that of our reference."""

    name: str
    unit: str
    value: object  # Samples -> number
    truth: float | None = 0.0


def cube(name, xyz, side=0.1, mass=1.0, **options):
    """Of 10 cm and a kilogram, unless said otherwise."""
    return Body(name, "box", (side, side, side), xyz, mass, **options)


def pushed():
    """Three cubes in a row stand for a second, are pushed by 5 cm within a second, and stand again."""
    cubes = [cube(f"c{i}", (0.1 * i, 0, 0.05)) for i in range(3)]
    pusher = Slide(Body("pusher", "box", (0.02, 0.06, 0.06), (-0.065, 0, 0.05), 1.0), (1, 0, 0))
    world = World("three cubes: at rest, pushed, at rest", 3.0, cubes, [pusher], kp=1e4, kd=400,
                  command=lambda t: [0.055 * min(max(t - 1, 0), 1)])
    return world, [
        Figure("moved in the first second", "mm",
               lambda s: 1e3 * np.abs(s.poses[at(1), :, :2] - s.poses[0, :, :2]).max()),
        Figure("way of the last cube", "mm", lambda s: 1e3 * (s.poses[-1, 2, 0] - 0.2), None),
        Figure("moved in the last half second", "mm",
               lambda s: 1e3 * np.abs(s.poses[-1, :, :3] - s.poses[at(2.5), :, :3]).max()),
    ]


def stack(count):
    """Cubes on each other, for a minute."""
    cubes = [cube(f"c{i}", (0, 0, 0.05 + 0.1 * i)) for i in range(count)]
    return World(f"stack of {count} cubes, 60 s", 60.0, cubes), [
        Figure("drift of the top", "mm", lambda s: 1e3 * np.hypot(*s.poses[-1, -1, :2])),
        Figure("lean", "mrad", lambda s: 1e3 * s.tilt()[-1].max()),
        Figure("height of the top", "mm", lambda s: 1e3 * s.poses[-1, -1, 2], 1e3 * (0.1 * count - 0.05)),
    ]


def wall():
    """Five rows of five cubes; a ball of 2 kg meets them at 5 m/s."""
    cubes = [cube(f"c{i}", (0, 0.1001 * (i % 5 - 2), 0.05 + 0.1 * (i // 5)), mass=0.5) for i in range(25)]
    ball = Body("ball", "sphere", (0.08,), (-0.5, 0, 0.25), 2.0, velocity=(5, 0, 0))
    return World("wall of 25 cubes hit by a ball", 2.0, [*cubes, ball]), [
        Figure("mean way of the cubes", "mm", lambda s: 1e3 * (s.poses[-1, :25, 0]).mean(), None),
    ]


def dominoes(gap):
    """Twenty of them, the first one begins to fall at 4 rad/s about its lower edge."""
    height, thickness, width = 0.048, 0.0075, 0.024
    pitch = gap * height + thickness
    row = [Body(f"d{i}", "box", (thickness, width, height), (i * pitch, 0, height / 2), 0.01) for i in range(20)]
    row[0].spin, row[0].velocity = (0, 4.0, 0), (4.0 * height / 2, 0, 4.0 * thickness / 2)

    def speed(s):
        tilt, level = s.tilt(), np.radians(5)

        def passed(i):
            k = int(np.argmax(tilt[:, i] > level))
            if k == 0:
                return np.nan
            return (k - 1 + (level - tilt[k - 1, i]) / (tilt[k, i] - tilt[k - 1, i])) / RATE
        return 8 * pitch / (passed(18) - passed(10)) / np.sqrt(G * height)
    return World(f"20 dominoes, {gap} of their height apart", 2.0, row, friction=0.3), [
        Figure("wave speed over √(g h)", "", speed, None),
        Figure("standing at the end", "", lambda s: float((s.tilt()[-1] < np.radians(45)).sum())),
    ]


def pinch():
    """A box of 0.5 kg between a pad and a finger that presses with 20 N is lifted by 10 cm and held for a minute."""
    carriage = Slide(Body("carriage", "box", (0.02, 0.02, 0.06), (0, -0.04, 0.1), 1.0), (0, 0, 1))
    finger = Slide(Body("finger", "box", (0.02, 0.02, 0.06), (0, 0.0401, 0.1), 0.2), (0, -1, 0), "carriage")
    box = Body("box", "box", (0.06, 0.06, 0.2), (0, 0, 0.1), 0.5)
    # The finger's target lies far inside of the box: it presses with all it has.
    world = World("pinch and lift, 60 s", 61.5, [box], [carriage, finger], kp=5e3, kd=150, limit=20.0,
                  command=lambda t: [0.1 * min(max(t - 0.5, 0), 1), 0.02])

    def creep(begin, end):
        return lambda s: 1e3 * ((s.poses[end, 0, 2] - s.slides[end, 0]) - (s.poses[begin, 0, 2] - s.slides[begin, 0]))
    return world, [Figure("sag while lifted", "mm", creep(at(0.5), at(1.75))),
                   Figure("creep in 59 s", "mm", creep(at(2.5), -1)),
                   Figure("tilt", "mrad", lambda s: 1e3 * s.tilt()[-1, 0])]


def breakaway():
    """A force that rises by 1 N/s pushes a kilogram with a friction coefficient of 0.5: it slips at 4.905 N."""
    box = cube("box", (0, 0, 0.05))
    pusher = Slide(Body("pusher", "box", (0.02, 0.06, 0.04), (-0.06, 0, 0.03), 0.1, smooth=True), (1, 0, 0))

    def force(s):
        speed = np.diff(s.poses[:, 0, 0]) * RATE
        return (int(np.flatnonzero(speed < 5e-3)[-1]) + 1) / RATE
    # Once it slips, 1.1 kg have the speed (F − μ m g)²/(2 · 1.1 · 1 N/s).
    return World("box under a force that rises slowly", 6.0, [box], [pusher], command=lambda t: [t]), [
        Figure("force at which it is at 5 mm/s", "N", force, 0.5 * G + np.sqrt(2 * 1.1 * 5e-3)),
        Figure("creep up to 90 % of it", "mm", lambda s: 1e3 * (s.poses[at(4.4), 0, 0] - s.poses[at(0.5), 0, 0])),
    ]


def crossed():
    """A cylinder rocks across a larger one that is fixed; the truth is our own at 1e-7."""
    half = np.pi / 2
    below = Body("below", "cylinder", (0.1, 0.4), (0, 0, 0.3), rpy=(0, half, 0))
    tilt = 0.05
    # It touches where it is tangent: rolled from the top by the angle, which does not move the point along it.
    x, z = 0.15 * np.sin(tilt) - 0.1 * tilt * np.cos(tilt), 0.15 * np.cos(tilt) + 0.1 * tilt * np.sin(tilt)
    above = Body("above", "cylinder", (0.05, 0.5), (0, -x, 0.3 + z), 1.0, rpy=(half + tilt, 0, 0))
    # Small rocking of a bar on a cylinder: ω² = g (R − r)/(r²/4 + l²/12 + r²).
    omega = np.sqrt(G * 0.05 / (0.05**2 / 4 + 0.5**2 / 12 + 0.05**2))

    def period(s):
        w, x = s.poses[:, 0, 3], s.poses[:, 0, 4]
        angle = 2 * np.arctan2(x, w) - half
        k = [i for i in range(1, len(angle)) if angle[i - 1] > 0 >= angle[i]]
        if len(k) < 2:
            return np.nan
        zero = [(i - 1 + angle[i - 1] / (angle[i - 1] - angle[i])) / RATE for i in k]
        return (zero[-1] - zero[0]) / (len(zero) - 1) * omega / (2 * np.pi)
    return World("cylinder rocks across a cylinder", 4.0, [below, above], ground=False), [
        Figure("period over that of small rocking", "", period, None),
        Figure("height at the end", "mm", lambda s: 1e3 * s.poses[-1, 0, 2], None),
    ]


def bowl():
    """A ball is let go beside the middle of a pyramid of four boxes, open to the top."""
    slope, planks = 0.6, []
    for i in range(4):
        a = i * np.pi / 2
        out = np.array([np.cos(a), np.sin(a), 0])
        # The upper faces meet in the origin's vertical at z = 0.1.
        along = out * np.cos(slope) + np.array([0, 0, np.sin(slope)])
        normal = -out * np.sin(slope) + np.array([0, 0, np.cos(slope)])
        middle = np.array([0, 0, 0.1]) + 0.15 * along - 0.01 * normal
        planks.append(Body(f"p{i}", "box", (0.3, 0.6, 0.02), tuple(middle), rpy=(0, -slope, a)))
    ball = Body("ball", "sphere", (0.05,), (0.05, 0.03, 0.3), 0.3)
    return World("ball in a bowl of boxes", 5.0, [*planks, ball], ground=False), [
        Figure("height at the end", "mm", lambda s: 1e3 * s.poses[-1, 0, 2], 1e3 * (0.1 + 0.05 / np.cos(slope))),
        Figure("off the middle at the end", "mm", lambda s: 1e3 * np.hypot(*s.poses[-1, 0, :2])),
        Figure("speed at the end", "mm/s",
               lambda s: 1e3 * np.linalg.norm(s.poses[-1, 0, :3] - s.poses[-2, 0, :3]) * RATE),
    ]


def peg():
    """A peg of 40 mm, a sixth of which is in a square hole with 0.5 mm of play, falls in, askew and with a spin."""
    side, play, deep = 0.04, 0.0005, 0.1
    walls = []
    for i in range(4):
        a = i * np.pi / 2
        off = side / 2 + play / 2 + 0.01
        walls.append(Body(f"w{i}", "box", (0.02, side + 0.06, deep), (off * np.cos(a), off * np.sin(a), deep / 2),
                          rpy=(0, 0, a)))
    body = Body("peg", "box", (side, side, 0.12), (0.0001, 0.0001, 0.14), 0.5, velocity=(0.1, 0.05, 0),
               spin=(0.2, -0.3, 0.5))

    def outside(s):
        off = np.abs(s.poses[at(1):, 0, :2]).max()
        return 1e3 * max(0.0, off - play / 2)
    return World("peg in a square hole with 0.5 mm of play", 2.0, [*walls, body], friction=0.2), [
        Figure("height at the end", "mm", lambda s: 1e3 * s.poses[-1, 0, 2], 60.0),
        Figure("tilt at the end", "mrad", lambda s: 1e3 * s.tilt()[-1, 0]),
        Figure("in the walls after 1 s", "mm", outside),
    ]


def can():
    """A can on a table gets a nudge that rocks it by a degree, and comes to rest."""
    table = Body("table", "box", (0.4, 0.4, 0.3), (0, 0, 0.15))
    body = Body("can", "cylinder", (0.035, 0.12), (0, 0, 0.36), 0.4, velocity=(0, -0.03, 0), spin=(0.5, 0, 0))

    def fastest(s):
        turn = np.linalg.norm(np.diff(s.poses[at(4):, 0, 3:], axis=0), axis=1) * 2 * RATE
        return 1e3 * turn.max()
    return World("can on a table, nudged", 5.0, [table, body]), [
        Figure("height at the end", "mm", lambda s: 1e3 * s.poses[-1, 0, 2], 360.0),
        Figure("rocking in the last second", "mrad/s", fastest),
    ]


def bounce():
    """A ball falls by half a metre onto a box that is fixed, with a restitution of 0.7."""
    box = Body("box", "box", (0.3, 0.3, 0.2), (0, 0, 0.1))
    ball = Body("ball", "sphere", (0.05,), (0.02, 0.03, 0.75), 1.0)
    t = np.sqrt(2 * 0.5 / G)
    return World("ball bounces on a box, restitution 0.7", 0.8, [box, ball], restitution=0.7, impact=G * t), [
        Figure("height of the rebound", "mm", lambda s: 1e3 * (s.poses[at(t + 0.05):, 0, 2].max() - 0.25),
               1e3 * 0.5 * 0.7**2),
    ]


SCENES = (pushed, lambda: stack(3), lambda: stack(10), wall, lambda: dominoes(0.2), lambda: dominoes(0.5), pinch,
          breakaway, crossed, bowl, peg, can, bounce)
