"""`--compat pybullet`: every convention that it takes on (docs/pybullet.md), held against PyBullet itself."""

import json
import math
from pathlib import Path

import pytest

pybullet = pytest.importorskip("pybullet", reason="PyBullet has no wheel for this Python and platform")

COMPAT = '[robot]\ncompat = "pybullet"\n'
H = 1 / 240
WRONG = '<inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
BOX = '<box size="0.2 0.4 0.6"/>'
BALL = '<sphere radius="0.1"/>'
CYLINDER = '<cylinder radius="0.1" length="0.5"/>'
CAPSULE = '<capsule radius="0.1" length="0.5"/>'
MESH = '<mesh filename="corner.obj"/>'


def collision(geometry, xyz="0 0 0", rpy="0 0 0"):
    return f'<collision><origin xyz="{xyz}" rpy="{rpy}"/><geometry>{geometry}</geometry></collision>'


def link(name, content, mass=2, xyz="0 0 0", rpy="0 0 0", inertia=WRONG):
    inertial = f'<inertial><origin xyz="{xyz}" rpy="{rpy}"/><mass value="{mass}"/>{inertia}</inertial>' if mass else ""
    return f'<link name="{name}">{inertial}{content}</link>'


def arm(kind="continuous", inertia=WRONG, limit=""):
    """A link that turns about, or slides along, a vertical axis through its centre of mass."""
    return (link("mount", "", 1) + link("arm", collision(BOX), 1, inertia=inertia)
            + f'<joint name="axle" type="{kind}"><parent link="mount"/><child link="arm"/><axis xyz="0 0 1"/>{limit}</joint>')


@pytest.fixture
def write(tmp_path):
    """Writes a URDF; the mesh of the tests lies beside it."""

    def run(content) -> Path:
        (tmp_path / "corner.obj").write_text("v 0 0 0\nv 0.3 0 0\nv 0 0.4 0\nv 0 0 0.5\n"
                                             "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n")
        urdf = tmp_path / "robot.urdf"
        urdf.write_text(f'<robot name="robot">{content}</robot>')
        return urdf

    return run


@pytest.fixture
def world():
    """An empty PyBullet."""
    client = pybullet.connect(pybullet.DIRECT)
    yield pybullet
    pybullet.disconnect(client)


@pytest.fixture
def info(command):
    """`urdf2fmu info --json` with PyBullet's conventions."""

    def run(urdf, *arguments):
        done = command("info", urdf, "--json", "--compat", "pybullet", *arguments)
        assert done.returncode == 0, done.stderr
        return json.loads(done.stdout)

    return run


@pytest.mark.parametrize("content", [
    link("a", collision(BOX)),
    link("a", collision(BOX, "0.1 0.2 0.3")),
    link("a", collision(BOX, "0.1 0.2 0.3"), xyz="0.1 0.2 0.3"),
    link("a", collision(BOX, rpy="0.3 0.2 0.5")),
    link("a", collision(BALL)),
    link("a", collision(BALL, "0.3 0 0")),
    link("a", collision(CYLINDER)),
    link("a", collision(CYLINDER, rpy="1.57 0.2 0.5")),
    link("a", collision(CAPSULE)),
    link("a", collision(CAPSULE, rpy="0.3 0.2 0.5")),
    link("a", collision(MESH)),
    link("a", collision(MESH, rpy="0.3 0.2 0.5")),
    link("a", collision(BOX) + collision(CAPSULE, "0.5 0 0", "0.4 0 0")),
    link("a", collision(BOX) + collision(MESH, "0.1 0.2 0.3", "0.3 0.2 0.5"), xyz="0.1 0 0.2"),
    link("a", ""),
    link("a", collision(BOX), mass=None),
    link("a", "", mass=None),
])
def test_masses_and_inertias_are_those_of_pybullet(content, write, world, info):
    urdf = write(content)
    mass, _, moments, *_ = world.getDynamicsInfo(world.loadURDF(str(urdf)), -1)
    ours = info(urdf)["links"][0]
    assert ours["mass"] == mass
    matrix = ours["inertia"]
    assert [matrix[i][i] for i in range(3)] == pytest.approx(moments, rel=1e-6)
    assert [matrix[0][1], matrix[0][2], matrix[1][2]] == pytest.approx([0, 0, 0], abs=1e-12)


def test_the_inertia_lies_in_the_axes_of_the_inertial_frame(write, world, info):
    # PyBullet gives moments in those axes and their orientation: turned back they are the link's tensor.
    urdf = write(link("a", collision(BOX), rpy="0.3 0.2 0.5"))
    _, _, moments, _, orientation, *_ = world.getDynamicsInfo(world.loadURDF(str(urdf)), -1)
    R = world.getMatrixFromQuaternion(orientation)
    expected = [sum(R[3 * i + k] * moments[k] * R[3 * j + k] for k in range(3)) for i in range(3) for j in range(3)]
    ours = info(urdf)["links"][0]["inertia"]
    assert [x for row in ours for x in row] == pytest.approx(expected, rel=1e-6, abs=1e-9)


def test_the_links_of_the_r2d2_weigh_and_turn_as_in_pybullet(pybullet_data, world, info):
    urdf = pybullet_data / "r2d2.urdf"
    robot = world.loadURDF(str(urdf))
    theirs = {world.getBodyInfo(robot)[0].decode(): world.getDynamicsInfo(robot, -1)}
    for joint in range(world.getNumJoints(robot)):
        theirs[world.getJointInfo(robot, joint)[12].decode()] = world.getDynamicsInfo(robot, joint)
    ours = {link["name"]: link for link in info(urdf)["links"]}
    assert ours.keys() == theirs.keys() and len(ours) > 10
    for name, (mass, friction, moments, *_) in theirs.items():
        assert ours[name]["mass"] == mass, name
        I = ours[name]["inertia"]
        # Collada meshes are left out: their hulls are not made alike, see docs/pybullet.md. A trace has no axes.
        if "gripper" not in name and "tip" not in name:
            assert I[0][0] + I[1][1] + I[2][2] == pytest.approx(sum(moments), rel=1e-6), name
        assert ours[name]["friction"] == friction, name


def test_the_inertia_of_the_file_stays_where_it_is_asked_for(write, world, info):
    urdf = write(link("a", collision(BOX)))
    flags = pybullet.URDF_USE_INERTIA_FROM_FILE
    moments = world.getDynamicsInfo(world.loadURDF(str(urdf), flags=flags), -1)[2]
    ours = info(urdf, "--inertia", "urdf")["links"][0]["inertia"]
    assert [ours[i][i] for i in range(3)] == pytest.approx(moments)


def test_a_link_named_world_stays_without_mass(write, world, info):
    urdf = write('<link name="world"/>' + link("a", collision(BOX), None)
                 + '<joint name="j" type="continuous"><parent link="world"/><child link="a"/></joint>')
    robot = world.loadURDF(str(urdf))
    ours = info(urdf)["links"]
    assert [link["mass"] for link in ours] == [world.getDynamicsInfo(robot, link)[0] for link in (-1, 0)] == [0, 1]


@pytest.mark.parametrize("friction, ground", [(None, None), (0.3, None), (0.3, 0.5)])
def test_a_box_slides_with_the_product_of_the_frictions(friction, ground, write, world, pybullet_data, export, load):
    contact = f'<contact><lateral_friction value="{friction}"/></contact>' if friction else ""
    urdf = write(link("a", contact + collision('<box size="0.4 0.4 0.1"/>')))
    world.setGravity(0, 0, -9.81)
    plane = world.loadURDF(str(pybullet_data / "plane.urdf"))
    box = world.loadURDF(str(urdf), basePosition=[0, 0, 0.05])
    if ground:
        world.changeDynamics(plane, -1, lateralFriction=ground)
    for _ in range(120):
        world.stepSimulation()
    world.resetBaseVelocity(box, [2, 0, 0])
    theirs = []
    for _ in range(60):
        world.stepSimulation()
        theirs.append(world.getBaseVelocity(box)[0][0])
    settings = COMPAT + (f"[world.ground]\nfriction = {ground}\n" if ground else "")
    robot = load(export(urdf, settings + "[initial]\nlinear_velocity = [2, 0, 0]\n"))
    ours = []
    for _ in range(60):
        robot.step(H)
        ours.append(robot["base.linear_velocity.x"])
    # The first steps differ: there ours takes up the weight that PyBullet's has settled under.
    assert ours[20] - ours[50] == pytest.approx(theirs[20] - theirs[50], rel=0.01)
    product = (friction or 0.5) * (ground or 1.0)
    v = (theirs[20] + theirs[50]) / 2
    assert theirs[20] - theirs[50] == pytest.approx(30 * H * (product * 9.81 + 0.04 * v * (1 + v)), rel=0.01)


def test_a_fall_is_slowed_by_the_drag(write, world, export, load):
    urdf = write(link("a", collision(BOX)))
    world.setGravity(0, 0, -9.81)
    box = world.loadURDF(str(urdf), basePosition=[0, 0, 100])
    world.resetBaseVelocity(box, [3, 0, 0], [0, 0, 5])
    for _ in range(480):
        world.stepSimulation()
    (x, _, z), (_, _, wz) = world.getBaseVelocity(box)
    robot = load(export(urdf, COMPAT + "[initial]\nxyz = [0, 0, 100]\nlinear_velocity = [3, 0, 0]\n"
                        "angular_velocity = [0, 0, 5]\n"))
    robot.run(2)
    # Without drag these are 3, −19.6 and 5.
    assert [robot["base.linear_velocity.x"], robot["base.linear_velocity.z"], robot["base.angular_velocity.z"]] == pytest.approx(
        [x, z, wz], rel=2e-3)
    assert z > -13.5 and wz < 3.7


@pytest.mark.parametrize("limit, kind, speed", [
    ("", "continuous", 50),
    ('<limit lower="-1000" upper="1000" effort="3" velocity="2"/>', "revolute", 50),
    ('<limit lower="-1000" upper="1000" effort="3" velocity="2"/>', "prismatic", 5),
])
def test_every_joint_has_a_motor_that_brakes_it_with_240(limit, kind, speed, write, world, export, load):
    ten = WRONG.replace('"1"', '"10"')
    urdf = write(arm(kind, ten, limit))
    flags = pybullet.URDF_USE_INERTIA_FROM_FILE
    robot = world.loadURDF(str(urdf), flags=flags, useFixedBase=True)
    world.resetJointState(robot, 0, 0, speed)
    theirs = []
    for _ in range(120):
        world.stepSimulation()
        theirs.append(world.getJointState(robot, 0)[1])
    settings = (COMPAT + f'base = "fixed"\ninertia = "urdf"\n[world]\ngravity = [0, 0, 0]\nground.type = "none"\n'
                f"[initial]\njoint_velocities = {{ axle = {speed} }}\n")
    ours_robot = load(export(urdf, settings))
    ours = []
    for _ in range(120):
        ours_robot.step(H)
        ours.append(ours_robot["joint.axle.velocity"])
    assert ours[2] == pytest.approx(theirs[2], abs=2e-3 * speed)
    assert ours[-1] == pytest.approx(theirs[-1], abs=2e-3 * speed)
    braking = 240 / (1 if kind == "prismatic" else 10)
    expected = max(0.0, speed - 3 * H * (braking + 0.04 * speed * (1 + speed)))
    assert theirs[2] == pytest.approx(expected, rel=0.02)


def test_a_light_joint_stands_still_at_once(write, world, export, load):
    urdf = write(arm())
    robot = world.loadURDF(str(urdf), useFixedBase=True)
    world.resetJointState(robot, 0, 0, 5)
    settings = COMPAT + 'base = "fixed"\n[world]\nground.type = "none"\n[initial]\njoint_velocities = { axle = 5 }\n'
    ours = load(export(urdf, settings))
    world.stepSimulation()
    ours.run(4 * H)
    assert world.getJointState(robot, 0)[1] == 0
    assert ours["joint.axle.velocity"] == pytest.approx(0, abs=0.05)


def test_no_joint_stays_faster_than_100(write, world, export, load):
    # The motor is off: the drag alone would need 3 s from 150 to 100.
    urdf = write(arm())
    robot = world.loadURDF(str(urdf), useFixedBase=True)
    world.setJointMotorControl2(robot, 0, pybullet.VELOCITY_CONTROL, force=0)
    world.resetJointState(robot, 0, 0, 150)
    settings = (COMPAT + 'base = "fixed"\n[world]\nground.type = "none"\n[[actuator]]\njoint = "axle"\nmode = "none"\n'
                "[initial]\njoint_velocities = { axle = 150 }\n")
    ours = load(export(urdf, settings))
    for _ in range(24):
        world.stepSimulation()
        ours.step(H)
    theirs = world.getJointState(robot, 0)[1]
    assert theirs < 100 and ours["joint.axle.velocity"] < 101
    # What is left is the drag.
    assert math.isclose(ours["joint.axle.velocity"], theirs, rel_tol=0.05)


def test_the_step_is_a_240th_of_a_second(write, world, export, load):
    theirs = world.getPhysicsEngineParameters()["fixedTimeStep"]
    robot = load(export(write(link("a", collision(BOX))), COMPAT))
    assert float(robot.variables["solver.step_size"].start) == pytest.approx(theirs, rel=1e-12)


def test_what_is_given_wins_over_the_conventions(write, info, command):
    urdf = write(arm())
    config = urdf.with_suffix(".toml")
    config.write_text('[solver]\nstep_size = 0\n[world.ground]\nfriction = 0.7\n[link."*"]\nfriction = 0.6\nmass = 3\n'
                      '[joint."*"]\nvelocity = 7\nenforce_velocity = false\n[[actuator]]\njoint = "*"\nmax_effort = 5\n')
    robot = info(urdf, "-c", config)
    assert {link["friction"] for link in robot["links"]} == {0.6}
    assert {link["mass"] for link in robot["links"]} == {3}


def test_settings_that_init_writes_keep_the_conventions(write, command):
    urdf = write(arm())
    asked = command("info", urdf, "--json", "--compat", "pybullet").stdout
    config = urdf.with_suffix(".toml")
    written = command("init", urdf, "--compat", "pybullet").stdout
    config.write_text(written)
    assert command("info", urdf, "--json", "-c", config).stdout == asked
    active = "\n".join(line[1:] if line.startswith("#") and not line.startswith("# ") else line
                       for line in written.splitlines())
    config.write_text(active)
    done = command("info", urdf, "--json", "-c", config)
    assert done.returncode == 0, done.stderr
    assert [l["inertia"] for l in json.loads(done.stdout)["links"]] == [l["inertia"] for l in json.loads(asked)["links"]]
