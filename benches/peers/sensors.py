"""Sensors of a moving arm and of a box at rest in MuJoCo, beside ours.

    python benches/peers/sensors.py URDF2FMU

needs mujoco (requirements.txt) and the command of a build. The arm has three joints with tilted axes
and is read at its start, where positions and velocities are given: its inertial unit, the loads in
two joints, one of them fixed, and a ray to the ground. The box of 3 kg has stood for 3 s on a plane:
its contact sensor.
"""

import csv
import subprocess
import sys
import tempfile
from pathlib import Path

import mujoco
import numpy as np

INERTIA = '<inertia ixx="{0}" ixy="0.001" ixz="-0.002" iyy="{1}" iyz="0.0015" izz="{2}"/>'


def link(name, mass, xyz):
    """A link with an uneven inertia."""
    inertia = INERTIA.format(0.02 * mass, 0.03 * mass, 0.04 * mass)
    return (f'<link name="{name}"><inertial><origin xyz="{xyz}"/><mass value="{mass}"/>{inertia}'
            f'</inertial></link>')


def joint(name, kind, parent, child, origin, axis):
    """A joint with an origin."""
    return (f'<joint name="{name}" type="{kind}"><parent link="{parent}"/><child link="{child}"/>'
            f'<origin {origin}/><axis xyz="{axis}"/></joint>')


ARM = "".join((
    '<robot name="arm">', '<link name="world"/>',
    link("upper", 2.0, "0.1 0.05 0.2"), link("fore", 1.5, "-0.1 0.1 0.15"), link("hand", 0.8, "0.05 -0.1 0.1"),
    link("tool", 0.4, "0.1 0 0.05"),
    joint("a", "continuous", "world", "upper", 'xyz="0 0 1.2" rpy="0.3 -0.2 0.5"', "0 0 1"),
    joint("b", "continuous", "upper", "fore", 'xyz="0.1 0.2 0.3" rpy="0.4 0.7 -0.3"', "0 0.6 0.8"),
    joint("c", "continuous", "fore", "hand", 'xyz="0.05 0.1 0.3" rpy="-0.2 0.1 0.6"', "1 0 0"),
    joint("d", "fixed", "hand", "tool", 'xyz="0.1 0.1 0.1" rpy="0.5 0.4 0.3"', "1 0 0"),
    "</robot>"))
POSITIONS, VELOCITIES = {"a": 0.5, "b": -0.4, "c": 0.9}, {"a": 1.5, "b": -2.0, "c": 3.0}
SETTINGS = f"""
world.ground.friction = 0.8
[initial]
joints = {{ {", ".join(f"{k} = {v}" for k, v in POSITIONS.items())} }}
joint_velocities = {{ {", ".join(f"{k} = {v}" for k, v in VELOCITIES.items())} }}
[[actuator]]
joint = "*"
mode = "none"
[[sensor]]
type = "imu"
link = "tool"
xyz = [0.05, 0.02, 0.1]
[[sensor]]
type = "ft"
joint = "b"
[[sensor]]
type = "ft"
joint = "d"
[[sensor]]
type = "ray"
name = "eye"
link = "tool"
xyz = [0.05, 0.02, 0.1]
rpy = [0, -1.5707963267948966, 0]
"""
BOX = ('<robot name="box"><link name="box"><inertial><mass value="3"/>'
       '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
       '<collision><geometry><box size="0.2 0.2 0.2"/></geometry></collision></link></robot>')
TOUCH = '[[sensor]]\ntype = "contact"\nlink = "box"\n'


def ours(command, urdf, settings, stop, row):
    """One row of the results of the command."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "r.urdf").write_text(urdf, encoding="utf-8")
        (folder / "r.toml").write_text(settings, encoding="utf-8")
        arguments = ["simulate", "r.urdf", "-c", "r.toml", "--stop-time", str(stop), "--output-file", "out.csv"]
        subprocess.run([command, *arguments], cwd=folder, check=True, capture_output=True)
        with open(folder / "out.csv", encoding="utf-8") as file:
            return {k: float(v) for k, v in list(csv.DictReader(file))[row].items()}


def of_arm():
    """Readings of MuJoCo's sensors on the arm."""
    spec = mujoco.MjSpec.from_string(ARM)
    spec.compiler.fusestatic = False
    spec.compiler.balanceinertia = False
    spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_PLANE, size=[50, 50, 1])
    tool, fore = spec.body("tool"), spec.body("fore")
    tool.add_site(name="imu", pos=[0.05, 0.02, 0.1])
    tool.add_site(name="d")
    fore.add_site(name="b")
    kinds = {"accelerometer": "imu", "gyro": "imu", "framequat": "imu", "rangefinder": "imu"}
    for kind, site in [*kinds.items(), *((k, s) for s in "bd" for k in ("force", "torque"))]:
        sensor = spec.add_sensor(name=f"{kind}_{site}", type=getattr(mujoco.mjtSensor, f"mjSENS_{kind.upper()}"),
                                 objtype=mujoco.mjtObj.mjOBJ_SITE, objname=site)
        if kind == "rangefinder":
            sensor.intprm[0] = 1  # the distance
    model = spec.compile()
    data = mujoco.MjData(model)
    for name in POSITIONS:
        data.joint(name).qpos[0], data.joint(name).qvel[0] = POSITIONS[name], VELOCITIES[name]
    mujoco.mj_forward(model, data)
    return {model.sensor(i).name: np.array(data.sensor(i).data) for i in range(model.nsensor)}


def of_box():
    """MuJoCo's touch sensor under a box."""
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><geom type="plane" size="5 5 1"/><body pos="0 0 0.1"><freejoint/>'
        '<inertial pos="0 0 0" mass="3" diaginertia="0.01 0.01 0.01"/><geom type="box" size="0.1 0.1 0.1"/>'
        '<site name="s" type="box" size="0.2 0.2 0.2"/></body></worldbody>'
        '<sensor><touch site="s"/></sensor></mujoco>')
    data = mujoco.MjData(model)
    while data.time < 3:
        mujoco.mj_step(model, data)
    return float(data.sensordata[0])


def main():
    command = sys.argv[1]
    row, theirs = ours(command, ARM, SETTINGS, 0.01, 0), of_arm()
    x, y, z, w = (row[f"sensor.tool.orientation.{axis}"] for axis in "xyzw")
    readings = {
        "accelerometer_imu": [row[f"sensor.tool.linear_acceleration.{axis}"] for axis in "xyz"],
        "gyro_imu": [row[f"sensor.tool.angular_velocity.{axis}"] for axis in "xyz"],
        "framequat_imu": [w, x, y, z],
        "rangefinder_imu": [row["sensor.eye.ray[1]"]],
    }
    for name in "bd":
        for kind in ("force", "torque"):
            readings[f"{kind}_{name}"] = [row[f"sensor.{name}.{kind}.{axis}"] for axis in "xyz"]
    print("| sensor of MuJoCo | size | largest difference |")
    print("|---|---|---|")
    for name, reading in readings.items():
        other = theirs[name]
        off = np.abs(np.array(reading) - other)
        if name.startswith("framequat"):
            off = np.minimum(off, np.abs(np.array(reading) + other))
        print(f"| {name.replace('_', ', ')} | {np.linalg.norm(other):.4g} | {off.max():.1e} |")
    touch = ours(command, BOX, TOUCH, 3, -1)["sensor.box.force"]
    box = of_box()
    weight = 3 * 9.81
    print(f"| touch, box of 3 kg | {box:.9g} | {abs(touch - box):.1e} (ours {touch - weight:.1e} off m g) |")


if __name__ == "__main__":
    main()
