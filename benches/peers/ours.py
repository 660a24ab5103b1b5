"""Our side of a scene: the process of `benches/play.rs`."""

import json
import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

ROOT = Path(__file__).resolve().parents[2]


def build(bench="play"):
    """Compiles a bench; its path. `URDF2FMU_PLAY` names one that is compiled already."""
    if bench == "play" and "URDF2FMU_PLAY" in os.environ:
        return os.environ["URDF2FMU_PLAY"]
    command = ["cargo", "bench", "--package", "urdf2fmu-core", "--bench", bench, "--no-run",
               "--message-format=json-render-diagnostics"]
    done = subprocess.run(command, cwd=ROOT, stdout=subprocess.PIPE, text=True, check=True)
    artifacts = map(json.loads, done.stdout.splitlines())
    return next(a["executable"] for a in artifacts if a.get("target", {}).get("name") == bench and a.get("executable"))


def settings(scene):
    """The settings file of a scene."""
    def numbers(values):
        return "[" + ", ".join(repr(float(x)) for x in values) + "]"

    def table(values):
        return "{ " + ", ".join(f'"{name}" = {float(x)!r}' for name, x in values.items()) + " }"

    lines = ["[robot]", f'base = "{"floating" if scene.floating else "fixed"}"', "[world]",
             f"gravity = [0, 0, {-scene.gravity!r}]"]
    if scene.ground:
        lines.append(f'ground = {{ type = "plane", friction = {scene.friction!r}, restitution = {scene.restitution!r} }}')
    else:
        lines.append('ground = { type = "none" }')
    lines += ["[contact]", f"penetration = {scene.penetration!r}", "[initial]"]
    if scene.floating:
        lines += [f"xyz = {numbers(scene.position)}", f"rpy = {numbers(scene.rpy)}",
                  f"linear_velocity = {numbers(scene.velocity)}", f"angular_velocity = {numbers(scene.spin)}"]
    if scene.joints:
        lines.append(f"joints = {table(scene.joints)}")
    if scene.joint_velocities:
        lines.append(f"joint_velocities = {table(scene.joint_velocities)}")
    lines += ['[link."*"]', f"friction = {scene.friction!r}", f"restitution = {scene.restitution!r}"]
    if scene.joint_names():
        lines += ["[[actuator]]", 'joint = "*"', 'mode = "none"']
    for actuator in scene.actuators:
        lines += ["[[actuator]]", f'joint = "{actuator.joint}"', f'mode = "{actuator.kind}"',
                  f"max_effort = {actuator.limit!r}"]
        if actuator.kind == "pd":
            lines += [f"kp = {actuator.kp!r}", f"kd = {actuator.kd!r}"]
    return "\n".join(lines) + "\n"


class Ours:
    """A scene, loaded once, run as often as wanted."""

    def __init__(self, scene, binary):
        folder = tempfile.TemporaryDirectory()
        path = Path(folder.name)
        (path / "scene.urdf").write_text(scene.urdf)
        (path / "scene.toml").write_text(settings(scene))
        joints = scene.joint_names()
        self.folder, self.binary = folder, binary
        self.scene = {"urdf": str(path / "scene.urdf"), "settings": str(path / "scene.toml"), "joints": joints,
                      "commanded": [joints.index(a.joint) for a in scene.actuators], "rows": scene.rows().tolist(),
                      "rate": scene.rate}
        self.start()

    def start(self):
        """The process, with the scene."""
        self.process = subprocess.Popen([self.binary], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        self.send(self.scene)

    def send(self, message):
        """One line."""
        self.process.stdin.write(json.dumps(message) + "\n")
        self.process.stdin.flush()

    def run(self, step=0.0, tolerance=1e-3, per_row=1, repeat=1):
        """CPU seconds, samples, counters."""
        self.send({"step": step, "tolerance": tolerance, "per_row": per_row, "repeat": repeat})
        line = self.process.stdout.readline()
        if not line:
            self.close()
            self.start()  # for the next run
            raise RuntimeError("our process ended")
        answer = json.loads(line)
        return answer["seconds"], np.array(answer["samples"]), answer

    def close(self):
        """Ends the process."""
        self.process.stdin.close()
        self.process.wait()
