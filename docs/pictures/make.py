"""Takes the pictures of README.md, docs/gallery.md and the plot of docs/see.md: python make.py URDF2FMU EXAMPLE_ROBOT_DATA

URDF2FMU is the command, EXAMPLE_ROBOT_DATA the folder `share/example-robot-data/robots` of the package of that name.
"""
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
EXAMPLES = HERE.parents[1] / "examples"
ROBOTS = {
    "anymal_c": "anymal_c_simple_description/urdf/anymal.urdf",
    "baxter": "baxter_description/urdf/baxter.urdf",
    "g1": "g1_description/urdf/g1_29dof_rev_1_0.urdf",
    "hyq": "hyq_description/robots/hyq_no_sensors.urdf",
    "panda": "panda_description/urdf/panda.urdf",
    "so101": "so_arm_description/urdf/so101.urdf",
    "solo12": "solo_description/robots/solo12.urdf",
    "talos": "talos_data/robots/talos_full_v2.urdf",
    "tiago": "tiago_description/robots/tiago.urdf",
    "ur5": "ur_description/urdf/ur5_robot.urdf",
}
# Wheel speeds in rad/s: time, left, right. Ahead, a turn on the spot, ahead.
DRIVE = [(0, 0, 0), (0.4, 5, 5), (1.4, 5, 5), (1.6, -5, 5), (2.4, -5, 5), (2.6, 5, 5), (3.4, 5, 5)]
PLOTTED = ["base.position.x", "base.position.y", "base.rpy.yaw", "joint.*_wheel_joint.velocity", "contact.*_wheel.force.z"]


def take(command, robot, name, *arguments):
    subprocess.run([command, "picture", robot, "-o", HERE / f"{name}.png", *arguments], check=True,
                   stderr=subprocess.DEVNULL)


def main(command, robots):
    small = ["--theme", "light", "--size", "256x256"]
    for name in ("rover", "arm", "quadruped"):
        take(command, EXAMPLES / f"{name}.urdf", name, "-c", EXAMPLES / f"{name}.toml", *small)
    for name, urdf in ROBOTS.items():
        take(command, Path(robots) / urdf, name, "--package-path", Path(robots).parent, *small)
    with tempfile.TemporaryDirectory() as folder:
        drive, run = Path(folder, "drive.csv"), Path(folder, "run.csv")
        wheels = [f"cmd.{side}_{end}_wheel_joint.velocity" for side in ("left", "right") for end in ("front", "rear")]
        rows = [(time, left, left, right, right) for time, left, right in DRIVE]
        drive.write_text("\n".join(",".join(map(str, row)) for row in [("time", *wheels), *rows]) + "\n")
        subprocess.run([command, "simulate", EXAMPLES / "rover.urdf", "--input-file", drive, "--stop-time", "3.4",
                        "--output-interval", "0.02", "--output-file", run], check=True)
        subprocess.run([command, "simulate", EXAMPLES / "rover.urdf", "--input-file", drive, "--stop-time", "3.4",
                        "--output-interval", "0.02", "--plot", HERE / "rover_plot.svg", "--quiet",
                        *(part for name in PLOTTED for part in ("--output-variable", name))], check=True)
        take(command, EXAMPLES / "rover.urdf", "rover_drives", "--run", run, "--rate", "8", "--size", "256x160")


main(*sys.argv[1:])
