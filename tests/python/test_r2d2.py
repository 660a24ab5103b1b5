"""PyBullet's R2D2 drives: the wheels of r2d2.urdf turned by velocity motors on a plane.

The run follows PyBullet's tutorial: it settles for 1 s, turns on the spot for 1 s (right wheels −w, left +w,
50 N·m), then drives forward for 500/240 s (all −w, 10 N·m). Wheel inertia is recomputed from the shapes, as
PyBullet does; both surfaces have friction 0.5, and so has their pair (harmonic mean).
"""

import math
import random
import re
from types import SimpleNamespace

import pinocchio
import pytest

GRAVITY = 9.8
WHEEL_RADIUS = 0.035
RIGHT = ["right_front_wheel_joint", "right_back_wheel_joint"]
LEFT = ["left_front_wheel_joint", "left_back_wheel_joint"]


def settings(friction=0.5, more=""):
    return f"""
[robot]
inertia = "collision"
[world]
gravity = [0, 0, -{GRAVITY}]
ground = {{ type = "plane", friction = {friction} }}
[link."*"]
friction = {friction}
{more}
"""


def drive(robot, w, h=1 / 240):
    """The whole run with communication steps `h`; what came of it."""

    def command(joints, velocity, effort):
        for joint in joints:
            robot[f"cmd.{joint}.velocity"] = velocity
            robot[f"cmd.{joint}.max_effort"] = effort

    def phase(duration):
        # The heading, counted on beyond ±π; the run is cut into pieces in which it turns less than π.
        turned, before = 0.0, robot.yaw
        pieces = 40
        start = robot.time
        for piece in range(1, pieces + 1):
            robot.run(start + duration * piece / pieces - robot.time, h)
            turned += math.remainder(robot.yaw - before, 2 * math.pi)
            before = robot.yaw
            assert robot.finite()
        return turned

    phase(1)
    command(RIGHT, -w, 50)
    command(LEFT, w, 50)
    yaw = phase(1)
    before = robot.vector("base.position")
    command(RIGHT + LEFT, -w, 10)
    phase(500 / 240)
    after = robot.vector("base.position")
    return SimpleNamespace(yaw=yaw, forward=math.dist(before[:2], after[:2]), position=after, tilt=robot.tilt)


@pytest.fixture
def r2d2(pybullet_data, export, load):
    def make(*arguments, **options):
        return load(export(pybullet_data / "r2d2.urdf", settings(*arguments)), **options)

    return make


@pytest.fixture(scope="module")
def at_240_hz(pybullet_data, export):
    """The w = 10 run that the others are held against."""
    from robot import Robot

    robot = Robot(export(pybullet_data / "r2d2.urdf", settings())).initialize({})
    run = drive(robot, 10)
    robot.free()
    return run


def test_it_is_placed_with_its_wheels_on_the_ground(r2d2):
    assert r2d2()["base.position.z"] == pytest.approx(0.470, abs=1e-3)


def test_at_10_rad_per_s_it_turns_and_drives_as_physics_says(at_240_hz):
    # Planar Coulomb analysis of the turn: 1.07 to 1.12 rad; Drake's error-controlled integrator: 1.067 rad.
    # Forward: 0.35 m/s for 500/240 s less the slip at the start, 0.71 m.
    print(at_240_hz)
    assert at_240_hz.yaw == pytest.approx(1.10, abs=0.05)
    assert at_240_hz.forward == pytest.approx(0.71, abs=0.01)
    assert at_240_hz.tilt < 1e-3
    assert at_240_hz.position[2] == pytest.approx(0.470, abs=1e-3)


def random_steps():
    generator = random.Random(20240)
    return lambda: generator.uniform(1e-4, 0.05)


@pytest.mark.parametrize("h", [1 / 60, 1 / 1000, random_steps()], ids=["1/60 s", "1/1000 s", "random"])
def test_the_communication_step_does_not_matter(h, r2d2, at_240_hz):
    run = drive(r2d2(), 10, h)
    print(run, at_240_hz)
    # The tolerance is 1e-3 per step in m, and in rad at 1 m.
    assert run.yaw == pytest.approx(at_240_hz.yaw, abs=1e-3)
    assert run.forward == pytest.approx(at_240_hz.forward, abs=1e-3)
    assert math.dist(run.position, at_240_hz.position) < 2e-3
    assert run.tilt < 1e-3


def test_a_tighter_tolerance_gives_the_same_drive(r2d2, at_240_hz):
    run = drive(r2d2(tolerance=1e-5), 10)
    print(run, at_240_hz)
    assert run.yaw == pytest.approx(at_240_hz.yaw, abs=2e-3)
    assert run.forward == pytest.approx(at_240_hz.forward, abs=2e-3)


def test_the_fixed_step_meets_the_same_gate(r2d2):
    run = drive(r2d2(0.5, '[solver]\nstep_size = "1/240"'), 10)
    print(run)
    assert run.yaw == pytest.approx(1.10, abs=0.05)
    assert run.forward == pytest.approx(0.71, abs=0.01)
    assert run.tilt < 1e-3
    assert run.position[2] == pytest.approx(0.470, abs=1e-3)


def tipping_share(urdf):
    """Forward friction, as a share of the weight, above which the front wheels lift: lever to the rear wheels / height.

    By Pinocchio, standing; the robot drives towards +y.
    """
    model = pinocchio.buildModelFromUrdf(str(urdf), pinocchio.JointModelFreeFlyer())
    data = model.createData()
    q = pinocchio.neutral(model)
    pinocchio.framesForwardKinematics(model, data, q)
    rear = data.oMf[model.getFrameId("right_back_wheel")].translation
    centre = pinocchio.centerOfMass(model, data, q)
    return (centre[1] - rear[1]) / (centre[2] - rear[2] + WHEEL_RADIUS)


def drive_forward(robot, w):
    """The last phase alone; largest forward friction as a share of the weight while the robot stands, and the tilt."""
    weight = sum(float(variable.start) for name, variable in robot.variables.items()
                 if name.startswith("link.") and name.endswith(".mass")) * GRAVITY
    wheels = [joint.removesuffix("_joint") for joint in RIGHT + LEFT]
    for joint in RIGHT + LEFT:
        robot[f"cmd.{joint}.velocity"] = -w
        robot[f"cmd.{joint}.max_effort"] = 10
    share, window = 0.0, []
    for _ in range(500):
        robot.step(1 / 240)
        if robot.tilt < 0.02:
            x, y = (sum(robot[f"contact.{wheel}.force.{axis}"] for wheel in wheels) for axis in "xy")
            # Over 0.1 s: a shorter push cannot lift it.
            window = [*window[-23:], (y * math.cos(robot.yaw) - x * math.sin(robot.yaw)) / weight]
            if len(window) == 24:
                share = max(share, sum(window) / 24)
    assert robot.finite()
    return share, robot.tilt


@pytest.mark.parametrize("of_threshold", [0.9, 1.1])
def test_from_rest_it_tips_where_friction_lifts_its_front(of_threshold, r2d2, pybullet_data):
    # Wheels at 100 rad/s spin until the robot has 3.5 m/s: 10 N·m / 0.035 m is far above what friction holds. All of
    # the friction μ m g then pushes forward, and the front lifts where μ exceeds the share above.
    threshold = tipping_share(pybullet_data / "r2d2.urdf")
    robot = r2d2(round(of_threshold * threshold, 6))
    robot.run(1)
    share, tilt = drive_forward(robot, 100)
    print(f"threshold {threshold}, forward share {share}, tilt {tilt}")
    assert (tilt > 1.0) == (of_threshold > 1)


@pytest.mark.parametrize(("friction", "tips"), [(0.3, False), (0.4, False), (0.5, True), (0.6, True)])
def test_the_tutorials_100_rad_per_s_tips_it_over_where_enough_friction_points_forward(friction, tips, r2d2,
                                                                                       pybullet_data):
    # The tutorial's run has friction 0.5 and tips over on its back in the forward phase. It enters that phase spinning
    # at 11 rad/s, so a part of the friction brakes the spin, and only what points forward lifts the front. With 0.4
    # that stays below the threshold, although 0.4 itself is above it: from rest it would tip over.
    threshold = tipping_share(pybullet_data / "r2d2.urdf")
    robot = r2d2(friction)
    robot.run(1)
    for joints, w in ((RIGHT, -100), (LEFT, 100)):
        for joint in joints:
            robot[f"cmd.{joint}.velocity"] = w
            robot[f"cmd.{joint}.max_effort"] = 50
    robot.run(1)
    spin = robot["base.angular_velocity.z"]
    share, tilt = drive_forward(robot, 100)
    print(f"threshold {threshold}, spin {spin}, forward share {share}, tilt {tilt}")
    assert (tilt > 1.0) == tips
    assert (share > threshold) == tips


def test_the_tutorials_start_inside_the_ground_is_warned_about_and_left_gently(pybullet_data, command, load,
                                                                              tmp_path):
    # z = 0.1 is 0.37 m inside the ground; PyBullet throws the robot out of it at 7 m/s.
    config = tmp_path / "tutorial.toml"
    config.write_text(settings(0.5, "[initial]\nxyz = [0, 0, 0.1]"))
    fmu = tmp_path / "tutorial.fmu"
    done = command("export", "--no-documentation", pybullet_data / "r2d2.urdf", "-o", fmu, "-c", config)
    assert done.returncode == 0, done.stderr
    assert re.search(r"370(\.\d+)? mm|0\.37\d* m", done.stderr), done.stderr
    robot = load(fmu)
    highest, fastest = 0.0, 0.0
    for _ in range(3 * 240):
        robot.step(1 / 240)
        highest = max(highest, robot["base.position.z"])
        fastest = max(fastest, robot["base.linear_velocity.z"])
    print(f"up to z = {highest} m, {fastest} m/s")
    assert robot.finite()
    # It comes up and stops on its wheels: PyBullet's flies up to z = 2.43 m.
    assert highest < 0.471
    assert robot["base.position.z"] == pytest.approx(0.470, abs=1e-3)
    assert abs(robot["base.linear_velocity.z"]) < 1e-6
    assert robot.tilt < 1e-3
