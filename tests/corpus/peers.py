"""What a simulator makes of URDF files, each as it is.

Usage: python peers.py pybullet|mujoco|pinocchio < NAMES > LINES

One line of JSON per file, flushed: a simulator may take the whole process down with it, and then the next line is
missing. Counted by names where the simulator keeps them:

- `links`: by name; of MuJoCo those that it does not merge with others, its world standing for the root link
- `moving`: joints that move (not fixed ones: MuJoCo merges the links that they join)
- `colliders`: collision shapes
- `mass`: of all links together, kg
- `inertias`: mass, centre of mass, inertia about it; PyBullet's by link in its axes, the others' by the joint that
  moves the body, in its frame, `""` for a root that flies
"""

import json
import sys


def pybullet():
    import numpy as np
    import pybullet as p
    p.connect(p.DIRECT)

    def load(urdf):
        p.resetSimulation()
        robot = p.loadURDF(urdf)
        count = p.getNumJoints(robot)
        infos = [p.getJointInfo(robot, j) for j in range(count)]
        moving = [info[1].decode() for info in infos if info[2] != p.JOINT_FIXED]
        links = [p.getBodyInfo(robot)[0].decode(), *(info[12].decode() for info in infos)]
        dynamics = [p.getDynamicsInfo(robot, k - 1) for k in range(count + 1)]
        shapes = sum(len(p.getCollisionShapeData(robot, k - 1)) for k in range(count + 1))
        inertias = {}
        for link, (mass, _, moments, place, turn, *_) in zip(links, dynamics):
            R = np.array(p.getMatrixFromQuaternion(turn)).reshape(3, 3)
            inertias[link] = (mass, place, (R @ np.diag(moments) @ R.T).tolist())
        return {"links": links, "moving": moving, "colliders": shapes, "mass": sum(d[0] for d in dynamics),
                "inertias": inertias}

    return load


def mujoco():
    import mujoco as m
    import numpy as np

    def load(urdf):
        model = m.MjModel.from_xml_path(urdf)
        inertias = {}
        for j in range(model.njnt):
            body = model.jnt_bodyid[j]
            R = np.zeros(9)
            m.mju_quat2Mat(R, model.body_iquat[body])
            R = R.reshape(3, 3)
            inertias[model.joint(j).name] = (model.body_mass[body], model.body_ipos[body].tolist(),
                                             (R @ np.diag(model.body_inertia[body]) @ R.T).tolist())
        return {"links": [model.body(b).name for b in range(model.nbody)],
                "moving": [model.joint(j).name for j in range(model.njnt)],
                "colliders": int(model.ngeom), "mass": float(model.body_mass.sum()), "inertias": inertias}

    return load


def pinocchio():
    import pinocchio as pin

    def load(urdf):
        model = pin.buildModelFromUrdf(urdf, pin.JointModelFreeFlyer())
        # Meshes are found by the folders above the file, as a ROS user would give them.
        folders = ["/".join(urdf.split("/")[:k]) for k in range(len(urdf.split("/")) - 1, 1, -1)]
        shapes = pin.buildGeomFromUrdf(model, urdf, pin.GeometryType.COLLISION, folders).ngeoms
        names = ["", *list(model.names)[2:]]
        return {"links": [f.name for f in model.frames if f.type == pin.FrameType.BODY],
                "moving": names[1:], "colliders": shapes, "mass": sum(i.mass for i in model.inertias),
                "inertias": {name: (i.mass, i.lever.tolist(), i.inertia.tolist())
                             for name, i in zip(names, list(model.inertias)[1:])}}

    return load


if __name__ == "__main__":
    judge = {"pybullet": pybullet, "mujoco": mujoco, "pinocchio": pinocchio}[sys.argv[1]]()
    # What the simulator prints goes elsewhere.
    import os
    answers = os.fdopen(os.dup(1), "w")
    os.dup2(2, 1)
    for name in sys.stdin.read().splitlines():
        try:
            told = judge(name) | {"fate": "loaded"}
        except Exception as error:  # whatever it refuses with
            told = {"fate": "refused", "reason": str(error)}
        print(json.dumps(told), file=answers, flush=True)
