"""A controller that balances a pole on a cart, from the derivatives of a Model Exchange FMU.

The FMU is exported for both interfaces. As Model Exchange it says how the derivatives of its states follow states and
inputs about the upright pole (`fmi2GetDirectionalDerivative`): the columns of A and B in x' = A x + B u. From them
follows the feedback u = -K x that costs least, and the same FMU as co-simulation shows that it holds the pole.

Needs FMPy and the command `urdf2fmu`. `python balance.py`
"""

import os
import subprocess
import tempfile
from pathlib import Path

import fmpy
import numpy as np
from fmpy import fmi2

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


def export(folder):
    """The cart with its pole as an FMU."""
    robot, settings, fmu = (Path(folder) / name for name in ("cart_pole.urdf", "cart_pole.toml", "cart_pole.fmu"))
    robot.write_text(URDF)
    settings.write_text(SETTINGS)
    command = os.environ.get("URDF2FMU", "urdf2fmu")
    subprocess.run([command, "export", robot, "-c", settings, "-o", fmu], check=True, capture_output=True)
    return fmu


def linearise(fmu, folder):
    """A, B and the names of the states, about the initial state: the pole stands upright."""
    description = fmpy.read_model_description(str(fmu))
    rates = [derivative.variable for derivative in description.derivatives]
    states = [rate.derivative for rate in rates]
    force = next(v for v in description.modelVariables if v.name == FORCE)
    model = fmi2.FMU2Model(guid=description.guid, unzipDirectory=fmpy.extract(str(fmu), unzipdir=str(folder)),
                           instanceName="linear", modelIdentifier=description.modelExchange.modelIdentifier)
    model.instantiate()
    model.setupExperiment()
    model.enterInitializationMode()
    model.exitInitializationMode()
    unknown = [rate.valueReference for rate in rates]
    columns = [model.getDirectionalDerivative(unknown, [known.valueReference], [1.0]) for known in (*states, force)]
    model.terminate()
    model.freeInstance()
    all_columns = np.array(columns).T
    return all_columns[:, :-1], all_columns[:, -1:], [state.name for state in states]


def gain(A, B, Q, R):
    """K of the feedback u = -K x that makes the integral of x'Qx + u'Ru least: Riccati's equation, solved by the stable
    half of the eigenvectors of the Hamiltonian matrix."""
    n = len(A)
    hamiltonian = np.block([[A, -B @ np.linalg.solve(R, B.T)], [-Q, -A.T]])
    values, vectors = np.linalg.eig(hamiltonian)
    stable = vectors[:, values.real < 0]
    P = np.real(stable[n:] @ np.linalg.inv(stable[:n]))
    return np.linalg.solve(R, B.T @ P)


def balance(fmu, folder, K, names, angle=0.2, seconds=6.0):
    """Lets the pole go at an angle, rad, with the feedback 240 times a second; the states over time."""
    description = fmpy.read_model_description(str(fmu))
    reference = {v.name: v.valueReference for v in description.modelVariables}
    model = fmi2.FMU2Slave(guid=description.guid, unzipDirectory=fmpy.extract(str(fmu), unzipdir=str(folder)),
                           instanceName="held", modelIdentifier=description.coSimulation.modelIdentifier)
    model.instantiate()
    model.setReal([reference["initial.joint.hinge.position"]], [angle])
    model.setupExperiment()
    model.enterInitializationMode()
    model.exitInitializationMode()
    path, h = [], 1 / 240
    for step in range(round(seconds / h)):
        x = np.array(model.getReal([reference[name] for name in names]))
        path.append(x)
        model.setReal([reference[FORCE]], list(-K @ x))
        model.doStep(step * h, h)
    model.terminate()
    model.freeInstance()
    return np.array(path)


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


if __name__ == "__main__":
    main()
