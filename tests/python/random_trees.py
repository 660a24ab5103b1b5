"""Writes random robots as URDF, and what Pinocchio says about each in a random state.

Usage: python random_trees.py FOLDER OUT.json

Case A1: 100 trees of 2 to 60 degrees of freedom on a fixed or a floating base, with every kind of joint that a URDF knows.
Coordinates and velocities `u` are those of urdf2fmu: a floating base has `[ω_W, ṗ_W]`; a planar joint x, y, angle and
their rates, and a floating one position and quaternion, ṗ in the parent's axes and ω in the child's. Pinocchio has `v = H u`
with body axes throughout, so that `M_u = Hᵀ M H`, `k_u = Hᵀ rnea(q, H u, Ḣ u)` and `u̇ = H⁻¹ (v̇ − Ḣ u)`.
"""

import json
import sys
from pathlib import Path

import numpy as np
import pinocchio as pin

KINDS = {"fixed": 0, "revolute": 1, "continuous": 1, "prismatic": 1, "planar": 3, "floating": 6}


def text(values):
    """Numbers that read back as they are."""
    return " ".join(repr(float(value)) for value in values)


def inertial(random):
    """A box-like body anywhere in its link, of 0.1 to 10 kg."""
    mass = float(10 ** random.uniform(-1, 1))
    x, y, z = map(float, random.uniform(0.05, 0.4, 3) ** 2 * mass / 12)
    return (f'<inertial><origin xyz="{text(random.uniform(-0.2, 0.2, 3))}" rpy="{text(random.uniform(-3, 3, 3))}"/>'
            f'<mass value="{mass!r}"/><inertia ixx="{y + z!r}" iyy="{x + z!r}" izz="{x + y!r}" ixy="0" ixz="0" iyz="0"/>'
            f'</inertial>')


def tree(path, random, freedoms, floating):
    """Writes a robot; returns its moving joints as (name, kind)."""
    # The root of a fixed tree weighs something, lest it count as a frame of the world, but at height 0.
    root = inertial(random) if floating else ('<inertial><mass value="1"/>'
                                              '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>')
    links = [f'<link name="link0">{root}</link>']
    joints, left = [], freedoms - (6 if floating else 0)
    while left > 0:
        number = len(links)
        kind = random.choice([kind for kind, count in KINDS.items() if count <= left])
        axis = np.array([0, 0, 1]) if kind == "planar" else random.normal(size=3)
        axis = axis / np.linalg.norm(axis)
        # Often a chain, sometimes a branch.
        parent = number - 1 if random.uniform() < 0.6 else int(random.integers(number))
        limit = '<limit lower="-3" upper="3" effort="1" velocity="1"/>' if kind in ("revolute", "prismatic") else ""
        links.append(f'<joint name="joint{number}" type="{kind}"><parent link="link{parent}"/>'
                     f'<child link="link{number}"/><origin xyz="{text(random.uniform(-0.4, 0.4, 3))}" '
                     f'rpy="{text(random.uniform(-3, 3, 3))}"/><axis xyz="{text(axis)}"/>{limit}</joint>')
        links[-1] += f'<link name="link{number}">{inertial(random)}</link>'
        joints.append((f"joint{number}", str(kind)))
        left -= KINDS[kind]
    path.write_text('<robot name="tree">\n' + "\n".join(links) + "\n</robot>\n")
    return [(name, kind) for name, kind in joints if kind != "fixed"]


def rotation(quaternion_wxyz):
    w, x, y, z = quaternion_wxyz
    return pin.Quaternion(w, x, y, z).toRotationMatrix()


def answer(path, joints, floating, random):
    """Pinocchio's numbers for a random state."""
    model = pin.buildModelFromUrdf(str(path), *([pin.JointModelFreeFlyer()] if floating else []))
    model.gravity.linear = np.array([0, 0, -9.81])
    data = model.createData()
    q, H, c = pin.neutral(model), np.zeros((model.nv, model.nv)), np.zeros(model.nv)
    u, tau = random.uniform(-2, 2, model.nv), random.uniform(-20, 20, model.nv)
    position, place = [], 0

    def free(joint, angular_first):
        """A free joint: R Rᵀ = 1 turns ṗ into body axes; ω of a base is in the world's."""
        nonlocal place
        p = random.uniform(-1, 1, 3)
        w, x, y, z = quaternion = (lambda r: r / np.linalg.norm(r))(random.normal(size=4))
        R = rotation(quaternion)
        v = slice(joint.idx_v, joint.idx_v + 3)
        omega = slice(joint.idx_v + 3, joint.idx_v + 6)
        linear, angular = (place + 3, place) if angular_first else (place, place + 3)
        H[v, linear:linear + 3] = R.T
        H[omega, angular:angular + 3] = R.T if angular_first else np.eye(3)
        c[v] = -np.cross(H[omega] @ u, H[v] @ u)
        q[joint.idx_q:joint.idx_q + 7] = [*p, x, y, z, w]
        place += 6
        return [*p, *quaternion]

    if floating:
        position.append(free(model.joints[1], True))
    for name, kind in joints:
        joint = model.joints[model.getJointId(name)]
        if kind == "floating":
            position.append(free(joint, False))
        elif kind == "planar":
            x, y, angle = random.uniform(-1, 1, 3)
            R = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            v = slice(joint.idx_v, joint.idx_v + 2)
            H[v, place:place + 2] = R.T
            H[joint.idx_v + 2, place + 2] = 1
            vx, vy = H[v] @ u
            c[v] = np.array([vy, -vx]) * u[place + 2]
            q[joint.idx_q:joint.idx_q + 4] = [x, y, np.cos(angle), np.sin(angle)]
            position.append([x, y, angle])
            place += 3
        else:
            angle = random.uniform(-1, 1)
            H[joint.idx_v, place] = 1
            q[joint.idx_q:joint.idx_q + joint.nq] = [np.cos(angle), np.sin(angle)][:joint.nq] if joint.nq == 2 else angle
            position.append([angle])
            place += 1
    v = H @ u
    upper = np.triu(pin.crba(model, data, q))
    M = H.T @ (upper + np.triu(upper, 1).T) @ H
    bias = H.T @ pin.rnea(model, data, q, v, c)
    vdot = np.linalg.solve(H, pin.aba(model, data, q, v, np.linalg.solve(H.T, tau)) - c)
    return {"position": position, "v": list(u), "tau": list(tau), "M": [list(row) for row in M], "bias": list(bias),
            "vdot": list(vdot), "kinetic": pin.computeKineticEnergy(model, data, q, v),
            "potential": pin.computePotentialEnergy(model, data, q)}


if __name__ == "__main__":
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    trees = []
    for seed in range(100):
        generator = np.random.default_rng(seed)
        base = seed % 2 == 0
        file = folder / f"tree{seed}.urdf"
        moving = tree(file, generator, int(generator.integers(8 if base else 2, 61)), base)
        trees.append({"urdf": str(file), "floating": base, "joints": [name for name, _ in moving]}
                     | answer(file, moving, base, generator))
    Path(sys.argv[2]).write_text(json.dumps(trees))
