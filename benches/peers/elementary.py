"""Scenes whose answer is known: from a formula, or from the equations of motion integrated to 1e-12.

Each has a reference: samples as `Scene` describes them; an error: one number out of samples and reference.
"""

from dataclasses import dataclass

import numpy as np
from scipy.integrate import solve_ivp

from scene import G, Actuator, Scene


@dataclass
class Case:
    """A scene, what it is compared with (none: every simulator's own converged solution), and by which measure."""

    scene: Scene
    error: object
    reference: object = None
    truth: str = ""
    measure: str = ""
    finest: float = 1e-8  # our tolerance for the reference, where it is our own solution


def times(scene):
    """Of the samples, s."""
    return np.arange(scene.count + 1) / scene.rate


def solve(rates, start, scene):
    """Equations of motion by DOP853, far more accurate than anything that is compared with it."""
    t = times(scene)
    return solve_ivp(rates, (0, t[-1]), start, method="DOP853", t_eval=t, rtol=1e-13, atol=1e-13).y.T


def half_turn(a, b):
    """Half the angle between rotations given by quaternions, rad; from the chord: the cosine has no digits near zero."""
    dot = np.sum(a * b, axis=-1, keepdims=True)
    return 2 * np.arcsin(np.clip(0.5 * np.linalg.norm(a - np.sign(dot) * b, axis=-1), 0, 1))


def pose_error(floating):
    """The largest difference over time: m of the base, rad of the base and of joints (m of sliding ones)."""
    def error(samples, reference):
        n = 7 if floating else 0
        parts = [np.abs(samples[:, n:] - reference[:, n:]).max(initial=0.0)]
        if floating:
            parts += [np.linalg.norm(samples[:, :3] - reference[:, :3], axis=1).max(),
                      2 * half_turn(samples[:, 3:7], reference[:, 3:7]).max()]
        return max(parts)
    return error


def plane_error(samples, reference):
    """The largest distance between where the body is and where it should be, in the plane, m."""
    return np.linalg.norm(samples[:, :2] - reference[:, :2], axis=1).max()


def inertial(mass, inertia, xyz="0 0 0"):
    """URDF text."""
    x, y, z = inertia
    return (f'<inertial><origin xyz="{xyz}" rpy="0 0 0"/><mass value="{mass}"/>'
            f'<inertia ixx="{x}" iyy="{y}" izz="{z}" ixy="0" ixz="0" iyz="0"/></inertial>')


def body(name, mass, inertia, shape=""):
    """A robot of one link."""
    collision = f'<collision><origin xyz="0 0 0" rpy="0 0 0"/><geometry>{shape}</geometry></collision>' if shape else ""
    return f'<robot name="{name}"><link name="body">{inertial(mass, inertia)}{collision}</link></robot>'


def tumbling():
    """A body with three different inertias, turning about no principal axis, in free fall."""
    inertia, spin = np.array([0.01, 0.02, 0.025]), (3.0, 4.0, 2.0)
    scene = Scene("tumbling body", body("body", 1.0, inertia), 3.0, ground=False, position=(0, 0, 50.0), spin=spin)

    def rates(t, y):
        w, q = y[:3], y[3:]
        x, v = q[0], q[1:]
        return np.concatenate([np.cross(inertia * w, w) / inertia, [-0.5 * v @ w], 0.5 * (x * w + np.cross(v, w))])
    y = solve(rates, [*spin, 1, 0, 0, 0], scene)
    t = times(scene)
    zero = np.zeros_like(t)
    reference = np.column_stack([zero, zero, 50 - 0.5 * G * t**2, y[:, 3:]])
    return Case(scene, pose_error(True), reference, "Euler's equations by DOP853 at 1e-13, free fall",
                "largest error of the pose in 3 s, m and rad")


def double_pendulum():
    """Two uniform rods of 1 m, both horizontal and folded straight at the start."""
    rod = inertial(1.0, (1 / 12, 1 / 12, 1e-4), "0 0 -0.5")
    urdf = f"""<robot name="double_pendulum"><link name="world"/><link name="upper">{rod}</link><link name="lower">{rod}</link>
<joint name="shoulder" type="continuous"><parent link="world"/><child link="upper"/><origin xyz="0 0 0"/><axis xyz="0 1 0"/></joint>
<joint name="elbow" type="continuous"><parent link="upper"/><child link="lower"/><origin xyz="0 0 -1"/><axis xyz="0 1 0"/></joint>
</robot>"""
    scene = Scene("double pendulum", urdf, 2.0, floating=False, ground=False, joints={"shoulder": np.pi / 2, "elbow": 0.5})

    def rates(t, y):
        # Lagrange's equations in absolute angles a, b of the rods: (4/3) a¨ + ½ cos(a−b) b¨ + ½ sin(a−b) ḃ² = −3/2 g sin a, …
        a, b, u, w = y
        c, s = np.cos(a - b), np.sin(a - b)
        m = np.array([[4 / 3, 0.5 * c], [0.5 * c, 1 / 3]])
        f = np.array([-1.5 * G * np.sin(a) - 0.5 * s * w * w, -0.5 * G * np.sin(b) + 0.5 * s * u * u])
        return np.concatenate([[u, w], np.linalg.solve(m, f)])
    y = solve(rates, [np.pi / 2, np.pi / 2 + 0.5, 0, 0], scene)
    return Case(scene, pose_error(False), np.column_stack([y[:, 0], y[:, 1] - y[:, 0]]),
                "Lagrange's equations by DOP853 at 1e-13", "largest error of an angle in 2 s, rad")


def sliding_block():
    """A cube slides to a stop."""
    mu, v = 0.5, 1.0
    inertia = np.full(3, 0.2**2 / 6)
    scene = Scene("sliding block", body("block", 1.0, inertia, '<box size="0.2 0.2 0.2"/>'), 0.5, friction=mu,
                  position=(0, 0, 0.1), velocity=(v, 0, 0), penetration=1e-6)
    t = np.minimum(times(scene), v / (mu * G))
    zero = np.zeros_like(t)
    return Case(scene, plane_error, np.column_stack([v * t - 0.5 * mu * G * t**2, zero, zero]),
                "Coulomb: deceleration μ g to a stop after v²/2μg = 101.94 mm", "largest error of the position in 0.5 s, m")


def rolling(name, shape, ratio, rpy):
    """Slides with v = 1 m/s, no spin; rolls with v / (1 + ratio) from v ratio / ((1 + ratio) μ g) on."""
    mu, v, radius, mass = 0.3, 1.0, 0.1, 1.0
    across = {"ball": ratio * mass * radius**2}.get(name, mass * (3 * radius**2 + 0.05**2) / 12)
    inertia = (across, across, ratio * mass * radius**2)
    scene = Scene(f"rolling {name}", body(name, mass, inertia, shape), 1.0, friction=mu, position=(0, 0, radius),
                  rpy=rpy, velocity=(v, 0, 0), penetration=1e-6)
    slip = v * ratio / ((1 + ratio) * mu * G)
    t = times(scene)
    x = np.where(t < slip, v * t - 0.5 * mu * G * t**2, v * slip - 0.5 * mu * G * slip**2 + v / (1 + ratio) * (t - slip))
    zero = np.zeros_like(t)
    return Case(scene, plane_error, np.column_stack([x, zero, zero]),
                f"Coulomb: slides for {slip * 1e3:.2f} ms, then rolls at {v / (1 + ratio):.4f} m/s",
                "largest error of the position in 1 s, m")


def ball():
    """Two fifths m r²."""
    return rolling("ball", '<sphere radius="0.1"/>', 0.4, (0, 0, 0))


def wheel():
    """Half m r², axis across."""
    return rolling("wheel", '<cylinder radius="0.1" length="0.05"/>', 0.5, (np.pi / 2, 0, 0))


def bounce():
    """A ball falls 0.5 m, restitution 0.7; what is compared is how high it flies after the first and the second impact."""
    e, drop, radius = 0.7, 0.5, 0.05
    inertia = np.full(3, 0.4 * radius**2)
    scene = Scene("bounce", body("ball", 1.0, inertia, f'<sphere radius="{radius}"/>'), 1.0, restitution=e,
                  position=(0, 0, radius + drop), rate=240, penetration=1e-6)
    scene.impact = np.sqrt(2 * G * drop)
    first = scene.impact / G
    flights = [2 * scene.impact * e**n / G for n in (1, 2)]
    middles = first + 0.5 * flights[0], first + flights[0] + 0.5 * flights[1]
    heights = np.array([drop * e**2, drop * e**4])

    def error(samples, _):
        # In flight z + ż²/2g − r is the height that it reaches; ż from the samples around, exact on a parabola.
        worst = 0.0
        for middle, height in zip(middles, heights):
            i = round(middle * scene.rate)
            rate = (samples[i + 1, 2] - samples[i - 1, 2]) * scene.rate / 2
            worst = max(worst, abs(samples[i, 2] + rate**2 / (2 * G) - radius - height))
        return worst
    return Case(scene, error, np.zeros((scene.count + 1, 7)), "Newton: 0.5 m · 0.7², 0.5 m · 0.7⁴",
                "larger error of the two heights, m")


def motor_ramp():
    """A rotor of 0.02 kg·m² on a velocity motor of 0.5 N·m: to 10 rad/s, after 0.6 s to −5 rad/s."""
    urdf = f"""<robot name="rotor"><link name="world"/><link name="rotor">{inertial(1.0, (0.02, 0.02, 0.02))}</link>
<joint name="motor" type="continuous"><parent link="world"/><child link="rotor"/><origin xyz="0 0 0"/><axis xyz="0 0 1"/>
<limit effort="0.5" velocity="100"/></joint></robot>"""
    scene = Scene("motor ramp", urdf, 1.5, floating=False, ground=False,
                  actuators=[Actuator("motor", "velocity", 0.5)], saturates=True,
                  command=lambda t: [10.0 if t < 0.6 - 1e-9 else -5.0])
    a = 25.0

    def angle(t):
        up, down = min(t, 0.4), np.clip(t - 0.6, 0.0, 0.6)
        return (0.5 * a * up**2 + 10 * np.clip(t - 0.4, 0.0, 0.2) + 10 * down - 0.5 * a * down**2
                - 5 * max(t - 1.2, 0.0))
    return Case(scene, pose_error(False), np.array([[angle(t)] for t in times(scene)]),
                "25 rad/s² until the speed is reached, and back", "largest error of the angle in 1.5 s, rad")


def springs():
    """Blocks of 1 kg on slides under pd laws: 0.5, 2 and 10 Hz without damping, 2 Hz with a damping ratio of 0.02."""
    laws, amplitude = ((0.5, 0.0), (2.0, 0.0), (10.0, 0.0), (2.0, 0.02)), 0.05
    parts, actuators = ['<link name="world"/>'], []
    for i, (frequency, ratio) in enumerate(laws):
        omega = 2 * np.pi * frequency
        parts.append(f'''<link name="block{i}">{inertial(1.0, (1e-3,) * 3)}</link><joint name="slide{i}" type="prismatic">
<parent link="world"/><child link="block{i}"/><origin xyz="0 {i} 0"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" effort="1e6" velocity="1e3"/></joint>''')
        actuators.append(Actuator(f"slide{i}", "pd", 1e6, kp=omega**2, kd=2 * ratio * omega))
    scene = Scene("springs", f'<robot name="springs">{"".join(parts)}</robot>', 10.0, floating=False, ground=False,
                  gravity=0.0, joints={a.joint: amplitude for a in actuators}, actuators=actuators,
                  command=lambda t: [0.0] * len(laws))
    t = times(scene)
    ways = []
    for frequency, ratio in laws:
        omega = 2 * np.pi * frequency
        damped = omega * np.sqrt(1 - ratio**2)
        swing = np.cos(damped * t) + ratio * omega / damped * np.sin(damped * t)
        ways.append(amplitude * np.exp(-ratio * omega * t) * swing)
    return Case(scene, pose_error(False), np.column_stack(ways), "x = A e^(−ζωt) (cos ω't + ζω/ω' sin ω't)",
                "largest error of a position in 10 s, m")


CASES = (tumbling, double_pendulum, sliding_block, ball, wheel, bounce, motor_ramp, springs)
