"""Writes what Pinocchio says about robots that nobody here wrote: mass matrix, bias forces, accelerations.

Usage: python pinocchio_reference.py PYBULLET_DATA OUT.json

For each robot a few random states (seeded). All in the convention of urdf2fmu:

- `v = [ω_W, ṗ_W, joint rates]`: angular and linear velocity of the base link origin in world axes, then one rate per
  moving joint that mimics nothing, in the order of `joints`. Pinocchio's free flyer has `[v_B, ω_B]`, body axes:
  `u = T v` with `T = [[0, R], [R, 0]]`, which is orthogonal, so `M_u = T M Tᵀ` and `u̇ = T v̇ + c` with
  `c = [0, R (ω_B × v_B)]`, and from `M v̇ + b = τ` follows `b_u = T b − M_u c`.
- A mimic joint follows exactly: `v = G u`, `M_u = Gᵀ M G`, `b_u = Gᵀ b`; the accelerations then follow from
  `M_u u̇ = τ − b_u` (no velocity product: G is constant).
- `M v̇ + bias = τ` with gravity (0, 0, −9.81) in `bias`.
"""

import json
import sys
import xml.etree.ElementTree as xml
from pathlib import Path

import numpy as np
import pinocchio as pin

from robots import example_robots

SAMPLES = 5


def mimics(urdf):
    """Joint -> (joint followed, multiplier, offset), for the mimic joints of the file."""
    found = {}
    for joint in xml.parse(urdf).getroot().findall("joint"):
        mimic = joint.find("mimic")
        if mimic is not None:
            found[joint.get("name")] = (mimic.get("joint"), float(mimic.get("multiplier", 1)),
                                        float(mimic.get("offset", 0)))
    return found


def samples(urdf, floating, random):
    """The robot's joints and its random states with Pinocchio's answers."""
    model = pin.buildModelFromUrdf(str(urdf), *([pin.JointModelFreeFlyer()] if floating else []))
    model.gravity.linear = np.array([0, 0, -9.81])
    data = model.createData()
    follows = mimics(urdf)
    base = 6 if floating else 0
    moving = {name: model.joints[index] for index, name in enumerate(model.names) if index > (1 if floating else 0)}
    joints = [name for name in moving if name not in follows]
    G = np.zeros((model.nv, base + len(joints)))
    G[:base, :base] = np.eye(base)
    for name, joint in moving.items():
        leader, ratio, _ = follows.get(name, (name, 1.0, 0.0))
        G[joint.idx_v, base + joints.index(leader)] = ratio

    states = []
    for _ in range(SAMPLES):
        position = dict(zip(joints, random.uniform(-1, 1, len(joints))))
        u = random.uniform(-2, 2, base + len(joints))
        tau = random.uniform(-20, 20, base + len(joints))
        q = pin.neutral(model)
        T, c, state = np.eye(base), np.zeros(base), {}
        if floating:
            p = random.uniform(-1, 1, 3)
            x, y, z, w = quaternion = (lambda r: r / np.linalg.norm(r))(random.normal(size=4))
            R = pin.Quaternion(w, x, y, z).toRotationMatrix()
            q[:7] = [*p, *quaternion]
            T = np.block([[np.zeros((3, 3)), R], [R, np.zeros((3, 3))]])
            c = np.concatenate([np.zeros(3), np.cross(u[:3], u[3:6])])  # R (ω_B × v_B) = ω_W × ṗ_W
            state = {"position": list(p), "quaternion_wxyz": [w, x, y, z]}
        for name, joint in moving.items():
            leader, ratio, offset = follows.get(name, (name, 1.0, 0.0))
            angle = ratio * position[leader] + offset
            if joint.nq == 2:  # continuous: cosine and sine
                q[joint.idx_q:joint.idx_q + 2] = [np.cos(angle), np.sin(angle)]
            else:
                q[joint.idx_q] = angle
        # Everything at once: v = H u with the base turned and the mimics following.
        H = G.copy()
        H[:base, :base] = T.T
        v = H @ u
        c_u = np.concatenate([c, np.zeros(len(joints))])
        upper = pin.crba(model, data, q)
        M = H.T @ (np.triu(upper) + np.triu(upper, 1).T) @ H
        bias = H.T @ pin.rnea(model, data, q, v, np.zeros(model.nv)) - M @ c_u
        if follows:
            vdot = np.linalg.solve(M, tau - bias)
        else:
            # τ_u = H^-T τ, and H is orthogonal.
            vdot = H.T @ pin.aba(model, data, q, v, H @ tau) + c_u
        state |= {"q": [position[name] for name in joints], "v": list(u), "tau": list(tau),
                  "M": [list(row) for row in M], "bias": list(bias), "vdot": list(vdot)}
        states.append(state)
    return {"joints": joints, "states": states}


if __name__ == "__main__":
    pybullet, out = Path(sys.argv[1]), Path(sys.argv[2])
    examples = example_robots()
    robots = {
        "iiwa": (pybullet / "kuka_iiwa/model.urdf", False),
        "panda": (pybullet / "franka_panda/panda.urdf", False),
        "anymal": (examples / "anymal_b_simple_description/robots/anymal.urdf", True),
        "anymal_c": (examples / "anymal_c_simple_description/urdf/anymal.urdf", True),
        "g1": (examples / "g1_description/urdf/g1_29dof_rev_1_0.urdf", True),
        "g1_with_hands": (examples / "g1_description/urdf/g1_29dof_with_hand_rev_1_0.urdf", True),
    }
    answer = {}
    for name, (urdf, floating) in robots.items():
        answer[name] = {"urdf": str(urdf), "floating": floating} | samples(urdf, floating, np.random.default_rng(7))
    out.write_text(json.dumps(answer))
