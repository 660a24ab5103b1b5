"""A four-bar with a closed loop: ours beside MuJoCo's equality constraint; a table for docs/performance.md.

    peers/bin/python benches/peers/loops.py COMMAND

`COMMAND` is a release build of urdf2fmu. Crank, coupler and rocker of 1 m and 1 kg, 1.2 m between the bearings, whirl
for 2 s from 1 rad/s on. The truth is the same mechanism in three angles with exact rows, solved by DOP853 at 1e-12.
Error is that of the crank's tip, drift the gap of the loop, each the largest of 200 samples. Times are CPU times of
the thread that steps, without samples; the best of five rounds.
"""

import subprocess
import sys
import tempfile
import time
from pathlib import Path

import mujoco
import numpy as np
from fmpy import extract, read_model_description
from fmpy.fmi2 import FMU2Slave
from scipy.integrate import solve_ivp

G, SPAN, END, SAMPLES = 9.81, 1.2, 2.0, 200
# The loop is closed there: coupler and rocker as two circles about the ends of the crank and the bearing.
CRANK = 1.57


def closed():
    """Absolute angles of the three rods at the start."""
    elbow = np.array([np.cos(CRANK), np.sin(CRANK)])
    way = np.array([SPAN, 0]) - elbow
    half, along = np.linalg.norm(way) / 2, np.arctan2(way[1], way[0])
    coupler = along + np.arccos(half)
    tip = elbow + [np.cos(coupler), np.sin(coupler)]
    return np.array([CRANK, coupler, np.arctan2(tip[1], tip[0] - SPAN)])


def rows(q):
    return np.array([[-np.sin(q[0]), -np.sin(q[1]), np.sin(q[2])], [np.cos(q[0]), np.cos(q[1]), -np.cos(q[2])]])


def rates(_, y):
    """Exact rows with J̇v, in absolute angles."""
    q, v = y[:3], y[3:]
    cross = np.cos(q[0] - q[1]) / 2
    mass = np.array([[4 / 3, cross, 0], [cross, 1 / 3, 0], [0, 0, 1 / 3]])
    turn = np.sin(q[0] - q[1]) / 2
    bias = np.array([turn * v[1]**2 + 1.5 * G * np.cos(q[0]), -turn * v[0]**2 + G / 2 * np.cos(q[1]),
                     G / 2 * np.cos(q[2])])
    j = rows(q)
    jv = np.array([-np.cos(q[0]) * v[0]**2 - np.cos(q[1]) * v[1]**2 + np.cos(q[2]) * v[2]**2,
                   -np.sin(q[0]) * v[0]**2 - np.sin(q[1]) * v[1]**2 + np.sin(q[2]) * v[2]**2])
    whole = np.block([[mass, -j.T], [j, np.zeros((2, 2))]])
    return np.concatenate([v, np.linalg.solve(whole, np.concatenate([-bias, -jv]))[:3]])


def start():
    """Angles and speeds: the crank turns with -1 rad/s, the others follow."""
    q = closed()
    j = rows(q)
    return q, np.concatenate([[-1.0], np.linalg.solve(j[:, 1:], j[:, 0])])


def truth():
    q, v = start()
    times = np.linspace(0, END, SAMPLES + 1)
    found = solve_ivp(rates, [0, END], np.concatenate([q, v]), "DOP853", times, rtol=1e-12, atol=1e-13)
    return found.y[0]


def judged(angles, reference):
    """Largest distance of the crank's tip from where it is."""
    return np.abs(2 * np.sin((np.array(angles) - reference) / 2)).max()


def gap(q):
    """Of relative angles, as both programs have them."""
    a, b, c = q[0], q[0] + q[1], q[2]
    return np.hypot(np.cos(a) + np.cos(b) - SPAN - np.cos(c), np.sin(a) + np.sin(b) - np.sin(c))


def model(step, integrator, stiff):
    rod = '<inertial pos="0.5 0 0" mass="1" diaginertia="0.001 0.0833333333333333 0.0833333333333333"/>'
    hinge = '<joint name="{}" axis="0 -1 0"/>'
    solref = f'solref="{2 * step} 1" solimp="0.9999 0.9999 0.001"' if stiff else ""
    q = closed()
    # MuJoCo takes the second anchor from the pose of the file: that is the closed one.
    return mujoco.MjModel.from_xml_string(f"""<mujoco><option timestep="{step}" gravity="0 0 -{G}"
        integrator="{integrator}"/><compiler angle="radian" autolimits="false"/><worldbody>
        <body name="crank" euler="0 {-q[0]} 0">{hinge.format("a")}{rod}
        <body name="coupler" pos="1 0 0" euler="0 {q[0] - q[1]} 0">{hinge.format("b")}{rod}</body></body>
        <body name="rocker" pos="{SPAN} 0 0" euler="0 {-q[2]} 0">{hinge.format("c")}{rod}</body></worldbody>
        <equality><connect body1="coupler" body2="rocker" anchor="1 0 0" {solref}/></equality></mujoco>""")


def peer(reference, step, integrator, stiff):
    compiled = model(step, integrator, stiff)
    begin, speeds = start()
    offsets = np.array([begin[0], begin[1] - begin[0], begin[2]])
    best = np.inf
    for _ in range(5):
        data = mujoco.MjData(compiled)
        data.qvel[:] = [speeds[0], speeds[1] - speeds[0], speeds[2]]
        per, taken, angles, drift = round(END / SAMPLES / step), 0.0, [begin[0]], 0.0
        for _ in range(SAMPLES):
            clock = time.thread_time()
            mujoco.mj_step(compiled, data, per)
            taken += time.thread_time() - clock
            q = data.qpos + offsets
            angles.append(q[0])
            drift = max(drift, gap(q))
        best = min(best, taken)
    return END / step, best, judged(angles, reference), drift


def fmu(command, folder):
    rod = ('<inertial><origin xyz="0.5 0 0"/><mass value="1"/><inertia ixx="0.001" ixy="0" ixz="0" '
           'iyy="0.0833333333333333" iyz="0" izz="0.0833333333333333"/></inertial>')
    parts = ['<robot name="four_bar"><link name="base"/>']
    for name, joint, parent, x in (("crank", "a", "base", 0), ("coupler", "b", "crank", 1),
                                   ("rocker", "c", "base", SPAN)):
        parts.append(f'<link name="{name}">{rod}</link><joint name="{joint}" type="continuous">'
                     f'<parent link="{parent}"/><child link="{name}"/><origin xyz="{x} 0 0"/>'
                     '<axis xyz="0 -1 0"/></joint>')
    q = closed()
    (folder / "four_bar.urdf").write_text("".join([*parts, "</robot>"]))
    (folder / "four_bar.toml").write_text(
        'robot.base = "fixed"\nworld.ground = { type = "none" }\n'
        f'[initial]\njoints = {{ a = {float(q[0])!r}, b = {float(q[1] - q[0])!r}, c = {float(q[2])!r} }}\n'
        'joint_velocities = { a = -1.0 }\n[[actuator]]\njoint = "*"\nmode = "none"\n'
        '[[loop]]\ntype = "hinge"\nlinks = ["coupler", "rocker"]\norigins = [[1, 0, 0], [1, 0, 0]]\n'
        'axes = [[0, 1, 0], [0, 1, 0]]\n')
    files = [folder / "four_bar.urdf", "-c", folder / "four_bar.toml", "-o", folder / "four_bar.fmu"]
    subprocess.run([command, "export", *files], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    return extract(str(folder / "four_bar.fmu"))


def ours(reference, folder, tolerance):
    description = read_model_description(folder)
    ref = {v.name: v.valueReference for v in description.modelVariables}
    best = np.inf
    for _ in range(5):
        slave = FMU2Slave(guid=description.guid, modelIdentifier=description.coSimulation.modelIdentifier,
                          unzipDirectory=folder)
        slave.instantiate()
        slave.setReal([ref["solver.tolerance"]], [tolerance])
        slave.setupExperiment()
        slave.enterInitializationMode()
        slave.exitInitializationMode()
        places = [ref[f"joint.{name}.position"] for name in "abc"]
        taken, angles, drift, step = 0.0, [slave.getReal(places)[0]], 0.0, END / SAMPLES
        for i in range(SAMPLES):
            clock = time.thread_time()
            slave.dll.fmi2DoStep(slave.component, i * step, step, 1)
            taken += time.thread_time() - clock
            q = slave.getReal(places)
            angles.append(q[0])
            drift = max(drift, gap(q))
        steps = slave.getInteger([ref["solver.steps"]])[0]
        slave.terminate()
        slave.freeInstance()
        best = min(best, taken)
    return steps, best, judged(angles, reference), drift


def main():
    reference = truth()
    lines = ["| program | steps | CPU, µs per simulated second | error, m | drift, m |", "|---|---|---|---|---|"]

    def add(name, found):
        steps, taken, error, drift = found
        lines.append(f"| {name} | {steps:.0f} | {taken / END * 1e6:.0f} | {error:.1e} | {drift:.1e} |")
        print(lines[-1], flush=True)
    for integrator in ("implicitfast", "RK4"):
        for stiff in (False, True):
            for step in (1e-3, 1e-4, 1e-5):
                kind = "two steps" if stiff else "its default"
                add(f"MuJoCo, {integrator}, softness {kind}, {step:g} s", peer(reference, step, integrator, stiff))
    with tempfile.TemporaryDirectory() as folder:
        unpacked = fmu(sys.argv[1], Path(folder))
        for tolerance in (1e-3, 1e-4, 1e-5, 1e-6):
            add(f"ours, {tolerance:g}", ours(reference, unpacked, tolerance))
    print("\n".join(lines))


if __name__ == "__main__":
    main()
