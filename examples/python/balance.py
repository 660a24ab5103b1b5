"""Controllers that balance a pole on a cart and a robot on two wheels, from the derivatives of a Model Exchange FMU.

The FMU is exported for both interfaces. As Model Exchange it says how the derivatives of its states follow states and
inputs about the upright position (`fmi2GetDirectionalDerivative`): the columns of A and B in x' = A x + B u. From them
follows the feedback u = -K x that costs least, and the same FMU as co-simulation shows that it holds.

The robot on two wheels stands on the ground, so that its states are also those of its contacts, which settle within
milliseconds. `slow` leaves them out: the position, the pitch and their velocities remain.

Needs FMPy, SciPy and the command `urdf2fmu`. `python balance.py`
"""

import os
import subprocess
import tempfile
from pathlib import Path

import fmpy
import numpy as np
from fmpy import fmi2
from scipy.linalg import schur, solve_sylvester

CART, POLE, LENGTH = 1.0, 0.2, 0.6
"""Masses of the cart and of the pole, kg, and the length of the pole, a thin rod, m."""

URDF = f"""<robot name="cart_pole">
  <link name="rail"/>
  <joint name="slide" type="prismatic">
    <parent link="rail"/><child link="cart"/><axis xyz="1 0 0"/><limit lower="-5" upper="5" effort="50" velocity="50"/>
  </joint>
  <link name="cart"><inertial><mass value="{CART}"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <joint name="hinge" type="continuous">
    <parent link="cart"/><child link="pole"/><axis xyz="0 1 0"/>
  </joint>
  <link name="pole"><inertial><origin xyz="0 0 {LENGTH / 2}"/><mass value="{POLE}"/>
    <inertia ixx="{POLE * LENGTH**2 / 12}" iyy="{POLE * LENGTH**2 / 12}" izz="1e-5" ixy="0" ixz="0" iyz="0"/>
  </inertial></link>
</robot>
"""

SETTINGS = """[robot]
base = "fixed"
[[actuator]]
joint = "slide"
mode = "effort"
[[actuator]]
joint = "hinge"
mode = "none"
[fmu]
interface = "both"
"""

FORCE = "cmd.slide.effort"

BODY, WHEEL, RADIUS, HEIGHT = 4.0, 0.5, 0.1, 0.25
"""Masses of the body and of a wheel, kg, radius of the wheels, and height of the body's centre of mass above them, m."""
BODY_INERTIA, WHEEL_INERTIA = 0.06, WHEEL * RADIUS**2 / 2
"""About the axle's direction, of the body about its centre of mass, kg.m^2."""

TWO_WHEELS = f"""<robot name="two_wheels">
  <link name="body"><inertial><origin xyz="0 0 {HEIGHT}"/><mass value="{BODY}"/>
    <inertia ixx="0.06" iyy="{BODY_INERTIA}" izz="0.02" ixy="0" ixz="0" iyz="0"/></inertial></link>
""" + "".join(f"""  <joint name="{side}" type="continuous">
    <parent link="body"/><child link="{side}_wheel"/><origin xyz="0 {y} 0"/><axis xyz="0 1 0"/>
  </joint>
  <link name="{side}_wheel"><inertial><mass value="{WHEEL}"/>
    <inertia ixx="{WHEEL_INERTIA}" iyy="{WHEEL_INERTIA}" izz="{WHEEL_INERTIA}" ixy="0" ixz="0" iyz="0"/></inertial>
    <collision><geometry><sphere radius="{RADIUS}"/></geometry></collision></link>
""" for side, y in (("left", 0.15), ("right", -0.15))) + "</robot>"

WHEEL_SETTINGS = """[[actuator]]
joint = "*"
mode = "effort"
[fmu]
interface = "both"
"""

TORQUES = ["cmd.left.effort", "cmd.right.effort"]

ROLLING = {"base.position.x": {"base.position.x": 1.0}, "base.rpy.pitch": {"base.orientation.y": 2.0},
           "base.linear_velocity.x": {"base.linear_velocity.x": 1.0},
           "base.angular_velocity.y": {"base.angular_velocity.y": 1.0}}
"""Outputs that the feedback of the robot on wheels is of, and what they are of the states, near the upright."""


def export(folder, name="cart_pole", urdf=URDF, text=SETTINGS):
    """A robot as an FMU."""
    robot, settings, fmu = (Path(folder) / f"{name}.{end}" for end in ("urdf", "toml", "fmu"))
    robot.write_text(urdf)
    settings.write_text(text)
    command = os.environ.get("URDF2FMU", "urdf2fmu")
    subprocess.run([command, "export", robot, "-c", settings, "-o", fmu], check=True, capture_output=True)
    return fmu


def linearise(fmu, folder, inputs=(FORCE,)):
    """A, B and the names of the states, about the initial state: what is to be held stands upright."""
    description = fmpy.read_model_description(str(fmu))
    rates = [derivative.variable for derivative in description.derivatives]
    states = [rate.derivative for rate in rates]
    forces = [v for v in description.modelVariables if v.name in inputs]
    model = fmi2.FMU2Model(guid=description.guid, unzipDirectory=fmpy.extract(str(fmu), unzipdir=str(folder)),
                           instanceName="linear", modelIdentifier=description.modelExchange.modelIdentifier)
    model.instantiate()
    model.setupExperiment()
    model.enterInitializationMode()
    model.exitInitializationMode()
    unknown = [rate.valueReference for rate in rates]
    columns = [model.getDirectionalDerivative(unknown, [known.valueReference], [1.0]) for known in (*states, *forces)]
    model.terminate()
    model.freeInstance()
    all_columns = np.array(columns).T
    n = len(states)
    return all_columns[:, :n], all_columns[:, n:], [state.name for state in states]


def slow(A, B, C, fastest=40.0):
    """A and B of the quantities C x alone, once all that settles faster than the rate `fastest`, 1/s, has settled."""
    T, Z, k = schur(A, sort=lambda re, im=0.0: abs(complex(re, im)) < fastest)
    coupling = solve_sylvester(T[:k, :k], -T[k:, k:], -T[:k, k:])
    V, W = Z[:, :k], np.hstack([np.eye(k), -coupling]) @ Z.T
    reduced = C @ A @ V @ np.linalg.pinv(C @ V)
    assert np.abs(C @ A @ V - reduced @ C @ V).max() < 1e-6 * np.abs(reduced).max(), "C x does not follow from C x alone"
    return reduced, C @ V @ W @ B


def gain(A, B, Q, R):
    """K of the feedback u = -K x that makes the integral of x'Qx + u'Ru least: Riccati's equation, solved by the stable
    half of the eigenvectors of the Hamiltonian matrix."""
    n = len(A)
    hamiltonian = np.block([[A, -B @ np.linalg.solve(R, B.T)], [-Q, -A.T]])
    values, vectors = np.linalg.eig(hamiltonian)
    stable = vectors[:, values.real < 0]
    P = np.real(stable[n:] @ np.linalg.inv(stable[:n]))
    return np.linalg.solve(R, B.T @ P)


def balance(fmu, folder, K, names, start=("initial.joint.hinge.position", 0.2), inputs=(FORCE,), seconds=6.0):
    """Lets go with a start value other than upright, with the feedback 240 times a second; what is fed back over time."""
    description = fmpy.read_model_description(str(fmu))
    reference = {v.name: v.valueReference for v in description.modelVariables}
    model = fmi2.FMU2Slave(guid=description.guid, unzipDirectory=fmpy.extract(str(fmu), unzipdir=str(folder)),
                           instanceName="held", modelIdentifier=description.coSimulation.modelIdentifier)
    model.instantiate()
    model.setReal([reference[start[0]]], [start[1]])
    model.setupExperiment()
    model.enterInitializationMode()
    model.exitInitializationMode()
    path, h = [], 1 / 240
    for step in range(round(seconds / h)):
        x = np.array(model.getReal([reference[name] for name in names]))
        path.append(x)
        model.setReal([reference[name] for name in inputs], list(-K @ x))
        model.doStep(step * h, h)
    model.terminate()
    model.freeInstance()
    return np.array(path)


def ride(folder, pitch=0.15):
    """The robot on two wheels: A and B of its rolling, the gain, and how it gets up from a pitch, rad."""
    fmu = export(folder, "two_wheels", TWO_WHEELS, WHEEL_SETTINGS)
    A, B, names = linearise(fmu, Path(folder) / "rolling", TORQUES)
    C = np.array([[of.get(name, 0.0) for name in names] for of in ROLLING.values()])
    A, B = slow(A, B, C)
    K = gain(A, B, np.eye(4), np.eye(2))
    start = ("initial.base.rpy.pitch", pitch)
    return A, B, K, balance(fmu, Path(folder) / "ride", K, list(ROLLING), start, TORQUES)


def main():
    with tempfile.TemporaryDirectory() as folder:
        fmu = export(folder)
        A, B, names = linearise(fmu, Path(folder) / "exchange")
        K = gain(A, B, np.eye(len(A)), np.array([[0.1]]))
        path = balance(fmu, Path(folder) / "steps", K, names)
        hinge = path[:, names.index("joint.hinge.position")]
        print(f"states: {', '.join(names)}")
        print(f"u = -K x with K = {np.round(K[0], 2).tolist()}")
        print(f"the pole is let go at {hinge[0]:.2f} rad and stands at {hinge[-1]:.4f} rad")

        path = ride(folder)[-1]
        print(f"the robot on two wheels is let go at {path[0, 1]:.2f} rad and stands at {path[-1, 1]:.4f} rad")


if __name__ == "__main__":
    main()
