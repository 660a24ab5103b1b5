"""PyBullet's first example as one FMU: R2D2, the plane and the small cube, which R2D2 pushes ahead with a wheel."""

import csv
import json

import numpy as np

WHEELS = [f"{side}_{end}_wheel_joint" for side in ("right", "left") for end in ("front", "back")]


def test_r2d2_pushes_a_cube_over_the_plane_with_no_settings(command, pybullet_data, tmp_path):
    fmu, inputs, out = tmp_path / "world.fmu", tmp_path / "in.csv", tmp_path / "out.csv"
    world = ["--object", pybullet_data / "plane.urdf", "--object", f"{pybullet_data / 'cube_small.urdf'}@0.22,0.8"]
    done = command("export", "--no-documentation", pybullet_data / "r2d2.urdf", "-o", fmu, *world)
    assert done.returncode == 0, done.stderr
    told = json.loads(command("info", fmu, "--json", "--variables").stdout)
    start = {variable["name"]: variable.get("start") for variable in told["variables"]}
    assert start["world.ground.friction"] == 1  # that of plane.urdf
    # 10 rad/s from the start; R2D2 looks along y.
    given = ("velocity", -10), ("max_effort", 10)
    commands = {f"cmd.{wheel}.{kind}": value for wheel in WHEELS for kind, value in given}
    inputs.write_text(",".join(["time", *commands]) + "\n" + ",".join(map(str, [0, *commands.values()])) + "\n")
    # At 1e-3 the cube that a wheel meets makes R2D2 rock for a second, which docs/design.md tells.
    way = ["--input-file", inputs, "--stop-time", 4, "--tolerance", 1e-4, "--output-file", out]
    done = command("simulate", fmu, *way)
    assert done.returncode == 0, done.stderr
    with open(out, newline="") as file:
        names, *rows = csv.reader(file)
    run = dict(zip(names, np.array(rows, dtype=float).T))
    time = run["time"]

    def at(name, t):
        return run[name][int(np.searchsorted(time, t - 1e-9))]
    # Until it is reached, the cube stands still, a face on the ground.
    assert at("object.cube.position.y", 1.5) == at("object.cube.position.y", 0.5)
    assert abs(at("object.cube.position.z", 1.5) - 0.025) < 1e-4
    assert abs(at("object.cube.contact.baseLink.force.z", 1.5) - 0.1 * 9.81) < 1e-6
    # Wheels of 35 mm roll, and the cube goes ahead of one of them as fast.
    assert abs(at("base.position.y", 4) - at("base.position.y", 3) - 0.35) < 1e-3
    assert abs(at("object.cube.position.y", 4) - at("object.cube.position.y", 3) - 0.35) < 1e-3
    # The ground carries both, whatever they do to each other.
    loads = [name for name in run if name.endswith("force.z") and "contact." in name]
    mean = sum(np.mean(run[name][time > 3]) for name in loads)
    cube = 0.1  # kg, as its file has it
    assert abs(mean - (told["mass"] + cube) * 9.81) < 1e-4 * mean
