"""A lidar of 360 rays among 100 shapes in MuJoCo and PyBullet, beside ours: distances and time.

    cargo bench -p urdf2fmu-core --bench lidar -- --dump=lidar.json
    python benches/peers/lidar.py lidar.json

needs mujoco and pybullet (requirements.txt). Shapes, poses and rays are those of the file, and so
are our distances. Each program gets the shapes as its own primitives and hulls as meshes of their
corners. The times are those of one call for all rays in an unchanged world, the fastest of some;
ours includes the poses of all shapes. PyBullet counts from points, so its rays end at the range.
"""

import json
import sys
import time

import mujoco
import numpy as np
import pybullet

ROUNDS = 200


def fastest(call):
    """Microseconds of a call."""
    times = []
    for _ in range(ROUNDS):
        start = time.perf_counter()
        call()
        times.append(time.perf_counter() - start)
    return min(times) * 1e6


def of_mujoco(world, directions):
    """Distances, and the time of `mj_multiRay`."""
    meshes, geoms = [], ['<geom type="plane" size="50 50 1"/>']
    text = " ".join
    for i, shape in enumerate(world["shapes"]):
        kind, size = shape["kind"], [repr(x) for x in shape["size"]]
        pose = f'pos="{text(map(repr, shape["xyz"]))}" quat="{text(map(repr, shape["wxyz"]))}"'
        if kind == "hull":
            meshes.append(f'<mesh name="m{i}" vertex="{text(size)}"/>')
            geoms.append(f'<geom name="g{i}" type="mesh" mesh="m{i}" {pose}/>')
        else:
            geoms.append(f'<geom name="g{i}" type="{kind}" size="{text(size)}" {pose}/>')
    model = mujoco.MjModel.from_xml_string(
        f"<mujoco><asset>{''.join(meshes)}</asset><worldbody>{''.join(geoms)}</worldbody></mujoco>"
    )
    data = mujoco.MjData(model)
    mujoco.mj_forward(model, data)
    count = len(directions)
    origin = np.array(world["origin"], dtype=float)
    found, ids = np.zeros(count), np.zeros(count, dtype=np.int32)
    vectors = directions.ravel().copy()

    def cast():
        mujoco.mj_multiRay(
            model, data, origin, vectors, None, 1, -1, ids, found, None, count, world["range"]
        )

    cast()
    distances = np.where((found < 0) | (found > world["range"]), world["range"], found)
    return distances, fastest(cast)


def of_pybullet(world, directions):
    """Distances, and the time of `rayTestBatch`."""
    client = pybullet.connect(pybullet.DIRECT)
    plane = pybullet.createCollisionShape(pybullet.GEOM_PLANE)
    pybullet.createMultiBody(0, plane)
    for shape in world["shapes"]:
        size = shape["size"]
        options = {
            "sphere": lambda s: {"shapeType": pybullet.GEOM_SPHERE, "radius": s[0]},
            "capsule": lambda s: {"shapeType": pybullet.GEOM_CAPSULE, "radius": s[0], "height": 2 * s[1]},
            "cylinder": lambda s: {"shapeType": pybullet.GEOM_CYLINDER, "radius": s[0], "height": 2 * s[1]},
            "box": lambda s: {"shapeType": pybullet.GEOM_BOX, "halfExtents": s},
            "hull": lambda s: {
                "shapeType": pybullet.GEOM_MESH,
                "vertices": np.array(s).reshape(-1, 3).tolist(),
            },
        }[shape["kind"]](size)
        collision = pybullet.createCollisionShape(**options)
        w, x, y, z = shape["wxyz"]
        pybullet.createMultiBody(0, collision, -1, shape["xyz"], [x, y, z, w])
    origin = np.array(world["origin"], dtype=float)
    begin = [origin.tolist()] * len(directions)
    end = (origin + directions * world["range"]).tolist()

    def cast():
        return pybullet.rayTestBatch(begin, end, numThreads=1)

    distances = np.array([hit[2] for hit in cast()]) * world["range"]
    needed = fastest(cast)
    pybullet.disconnect(client)
    return distances, needed


def main():
    with open(sys.argv[1], encoding="utf-8") as file:
        world = json.load(file)
    directions = np.array(world["rays"]).reshape(-1, 3)
    ours = np.array(world["distances"])
    hits = int((ours < world["range"]).sum())
    print(f"{len(directions)} rays, {len(world['shapes'])} shapes, {hits} rays hit something\n")
    print("| program | µs | rays off by more than 1 mm | median of the others, m | their largest, m |")
    print("|---|---|---|---|---|")
    print(f"| ours | {world['microseconds']:.1f} | – | – | – |")
    programs = (("MuJoCo", of_mujoco, mujoco), ("PyBullet", of_pybullet, None))
    for name, program, _ in programs:
        distances, needed = program(world, directions)
        off = np.abs(distances - ours)
        far = off > 1e-3
        rest = off[~far & (ours < world["range"])]
        print(f"| {name} | {needed:.1f} | {int(far.sum())} | {np.median(rest):.1e} | {rest.max():.1e} |")
        for ray in np.flatnonzero(far):
            print(f"  ray {ray}: ours {ours[ray]:.6f}, {name} {distances[ray]:.6f}", file=sys.stderr)


if __name__ == "__main__":
    main()
