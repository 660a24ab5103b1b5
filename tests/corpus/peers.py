"""What a simulator makes of URDF files, each as it is.

Usage: python peers.py pybullet|mujoco|pinocchio < NAMES > LINES

One line of JSON per file, flushed: a simulator may take the whole process down with it, and then the next line is
missing. Counted by names where the simulator keeps them:

- `moving`: joints that move (not fixed ones: MuJoCo merges the links that they join)
- `colliders`: collision shapes
- `mass`: of all links together, kg
"""

import json
import sys


def pybullet():
    import pybullet as p
    p.connect(p.DIRECT)

    def load(urdf):
        p.resetSimulation()
        robot = p.loadURDF(urdf)
        count = p.getNumJoints(robot)
        moving = [p.getJointInfo(robot, j)[1].decode() for j in range(count)
                  if p.getJointInfo(robot, j)[2] != p.JOINT_FIXED]
        links = range(-1, count)
        shapes = sum(len(p.getCollisionShapeData(robot, k)) for k in links)
        return {"moving": moving, "colliders": shapes, "mass": sum(p.getDynamicsInfo(robot, k)[0] for k in links)}

    return load


def mujoco():
    import mujoco as m

    def load(urdf):
        model = m.MjModel.from_xml_path(urdf)
        moving = [model.joint(j).name for j in range(model.njnt)]
        return {"moving": moving, "colliders": int(model.ngeom), "mass": float(model.body_mass.sum())}

    return load


def pinocchio():
    import pinocchio as pin

    def load(urdf):
        model = pin.buildModelFromUrdf(urdf, pin.JointModelFreeFlyer())
        # Meshes are found by the folders above the file, as a ROS user would give them.
        folders = ["/".join(urdf.split("/")[:k]) for k in range(len(urdf.split("/")) - 1, 1, -1)]
        shapes = pin.buildGeomFromUrdf(model, urdf, pin.GeometryType.COLLISION, folders).ngeoms
        return {"moving": list(model.names)[2:], "colliders": shapes, "mass": sum(i.mass for i in model.inertias)}

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
            told = {"fate": "refused", "reason": str(error)[:200]}
        print(json.dumps(told), file=answers, flush=True)
