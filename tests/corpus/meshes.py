"""Meshes against an independent reader: how far they reach in 206 directions, which is what their hulls are.

Usage: python meshes.py DRIVER FOLDER...
       python meshes.py --reference COUNT MADE FOLDER...

DRIVER is `target/debug/examples/mesh_corners`. Every STL, OBJ, PLY, COLLADA and binary glTF file below the folders, and
scenes made here (COLLADA and, written by trimesh, PLY and glTF: units, up-axis, nested and repeated nodes, mirrored
ones), is read by our reader and by trimesh (COLLADA through pycollada); both must agree to 1e-6 of the size. Ends with
exit code 1 if they do not. Needs trimesh, pycollada.

With `--reference` the other reader's numbers are printed for COUNT files of each kind and the scenes, which are
written to the folder MADE: `meshes.rs` compares them in the test run. First a line with the directions, then one per
file.

`<up_axis>` turns nothing in either: pycollada gives the file's axes, as RViz, Gazebo and Pinocchio take them. Nor does
glTF's y axis upwards.
"""

import json
import subprocess
import sys
import tempfile
from pathlib import Path

import collada
import numpy as np
import trimesh

TOLERANCE = 1e-6
KINDS = (".stl", ".obj", ".dae", ".ply", ".glb")
# Files of the sample are smaller than this, in bytes: larger ones take the other reader seconds.
LARGEST = 2_000_000

# The axes and a spiral of even density over the sphere (Fibonacci's).
_k = np.arange(200) + 0.5
_turn, _z = np.pi * (1 + 5**0.5) * _k, 1 - 2 * _k / 200
_r = np.sqrt(1 - _z**2)
DIRECTIONS = np.concatenate([np.eye(3), -np.eye(3), np.stack([_r * np.cos(_turn), _r * np.sin(_turn), _z], axis=1)])

# A tetrahedron with nothing symmetric about it, placed by nodes.
SCENE = """<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit name="u" meter="{unit}"/><up_axis>{up}</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="s"><float_array id="a" count="12">0 0 0 1 0 0 0 2 0 0.25 0.5 3</float_array><technique_common>
<accessor source="#a" count="4" stride="3"><param name="X" type="float"/><param name="Y" type="float"/><param name="Z"
 type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>
<triangles count="4"><input semantic="VERTEX" source="#v" offset="0"/><p>0 2 1 0 1 3 1 2 3 2 0 3</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="w">{nodes}</visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#w"/></scene></COLLADA>"""
HERE = '<instance_geometry url="#g"/>'
NODES = {
    "plain": f"<node>{HERE}</node>",
    "nested": "<node><translate>1 2 3</translate><rotate>0 0 1 30</rotate><node><scale>2 1 0.5</scale>"
              f"<rotate>1 0 0 75</rotate>{HERE}</node></node>",
    "matrix": f"<node><matrix>0 -1 0 4 1 0 0 5 0 0 1 6 0 0 0 1</matrix><node><translate>0 0 1</translate>{HERE}</node></node>",
    "repeated": "".join(f"<node><translate>{k} {k * k} 0</translate><rotate>0 1 0 {40 * k}</rotate>{HERE}</node>"
                        for k in range(5)),
    "mirrored": f"<node><scale>-1 1 2</scale><translate>3 0 0</translate>{HERE}</node>",
}


def independent(path):
    """Corners of the faces, m, by trimesh; COLLADA by pycollada, whose nodes place the triangles themselves."""
    if path.suffix.lower() == ".dae":
        mesh = collada.Collada(str(path), ignore=[collada.common.DaeUnsupportedError, collada.common.DaeBrokenRefError])
        corners = [face.vertices for geometry in mesh.scene.objects("geometry") for primitive in geometry.primitives()
                   if hasattr(primitive, "triangleset") or isinstance(primitive, collada.triangleset.BoundTriangleSet)
                   for face in primitive]
        points = np.concatenate([np.asarray(c) for c in corners])
        return points * (mesh.assetInfo.unitmeter or 1.0)
    loaded = trimesh.load(path, process=False, skip_materials=True)
    if path.suffix.lower() == ".glb":
        loaded = loaded.to_geometry()
    # Groups of an OBJ file lie in its own frame.
    meshes = loaded.geometry.values() if isinstance(loaded, trimesh.Scene) else [loaded]
    return np.concatenate([np.asarray(mesh.vertices)[np.unique(mesh.faces)] for mesh in meshes])


def supports(points):
    """How far the points reach in each direction, m."""
    return (points @ DIRECTIONS.T).max(axis=0)


def found(folders):
    """Mesh files below the folders."""
    return sorted(file for folder in folders for file in Path(folder).rglob("*") if file.suffix.lower() in KINDS)


def scenes(folder):
    """Writes the scenes."""
    files = []
    for unit in ("1", "0.01", "0.0254"):
        for up in ("X_UP", "Y_UP", "Z_UP"):
            for name, nodes in NODES.items():
                file = Path(folder) / f"{name}_{unit}_{up}.dae"
                file.write_text(SCENE.format(unit=unit, up=up, nodes=nodes))
                files.append(file)
    return files + of_trimesh(Path(folder))


def of_trimesh(folder):
    """Writes the tetrahedron as PLY, and as glTF with the nodes of the scenes."""
    corners = [[0, 0, 0], [1, 0, 0], [0, 2, 0], [0.25, 0.5, 3]]
    body = trimesh.Trimesh(corners, [[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], process=False)
    files = []
    for encoding in ("ascii", "binary"):
        files.append(folder / f"{encoding}.ply")
        files[-1].write_bytes(body.export(file_type="ply", encoding=encoding))
    turned = trimesh.transformations.rotation_matrix
    moved = trimesh.transformations.translation_matrix
    stretched = np.diag([2, 1, 0.5, 1])
    nodes = {
        "plain": [(None, np.eye(4))],
        "nested": [("above", moved([1, 2, 3]) @ turned(0.5, [0, 0, 1])), (None, stretched @ turned(1.3, [1, 0, 0]))],
        "mirrored": [(None, np.diag([-1, 1, 2, 1]) @ moved([3, 0, 0]))],
    }
    for name, chain in nodes.items():
        scene = trimesh.Scene()
        parent = None
        for node, matrix in chain:
            if node is None:
                scene.add_geometry(body, parent_node_name=parent, transform=matrix)
            else:
                scene.graph.update(frame_to=node, frame_from=scene.graph.base_frame, matrix=matrix)
                parent = node
        for k in range(3 if name == "plain" else 0):
            scene.add_geometry(body, transform=moved([k, k * k, 0]) @ turned(0.7 * k, [0, 1, 0]))
        files.append(folder / f"{name}.glb")
        files[-1].write_bytes(scene.export(file_type="glb"))
    return files


def reference(count, made, folders):
    """Prints what the other reader makes of a sample."""
    files = [file for file in found(folders) if file.stat().st_size < LARGEST]
    sample = []
    for kind in KINDS:
        same = [file for file in files if file.suffix.lower() == kind]
        sample += [same[k * len(same) // count] for k in range(count if same else 0)]
    print(json.dumps({"directions": DIRECTIONS.tolist()}))
    for file in [*sample, *scenes(made)]:
        points = independent(file)
        size = float(np.linalg.norm(np.ptp(points, axis=0)))
        print(json.dumps({"file": str(file), "size": size, "supports": supports(points).tolist()}))
    return 0


def compare(driver, folders):
    """Reads everything with both."""
    files = found(folders)
    with tempfile.TemporaryDirectory() as made:
        files += scenes(made)
        listing = Path(made) / "names"
        listing.write_text("".join(f"{file}\n" for file in files))
        worst, agree, bad, unread = 0.0, 0, [], []
        with listing.open() as names, subprocess.Popen([driver], stdin=names, stdout=subprocess.PIPE, text=True) as run:
            for file, line in zip(files, run.stdout, strict=True):
                told = json.loads(line)
                try:
                    theirs, reason = independent(file), None
                except Exception as error:  # whatever it refuses with
                    theirs, reason = None, f"{type(error).__name__}: {error}"
                if "error" in told or theirs is None:
                    unread.append(f"{file}: we: {told.get('error', 'read')}; they: {reason or 'read'}")
                    continue
                size = np.linalg.norm(np.ptp(theirs, axis=0))
                off = abs(supports(np.array(told["corners"])) - supports(theirs)).max() / size
                worst = max(worst, off)
                agree += off <= TOLERANCE
                if not off <= TOLERANCE:
                    bad.append(f"{file}: {off:.1e}")
    print(f"{len(files)} files, {agree} agree (worst {worst:.1e} of the size), {len(bad)} differ, "
          f"{len(unread)} not read by one of the two")
    print("\n".join(["differ:", *bad, "not read:", *unread]))
    return 1 if bad else 0


def main():
    if sys.argv[1] == "--reference":
        return reference(int(sys.argv[2]), sys.argv[3], sys.argv[4:])
    return compare(sys.argv[1], sys.argv[2:])


if __name__ == "__main__":
    sys.exit(main())
