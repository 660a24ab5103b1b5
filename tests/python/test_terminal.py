"""What `simulate` says and draws: progress at a terminal, a summary with events, chosen variables, plots."""

import csv
import fcntl
import os
import pty
import re
import select
import signal
import struct
import subprocess
import termios
import time
import xml.etree.ElementTree as ElementTree
import zipfile

import fmpy
import numpy as np
import pytest
from fmpy.util import read_csv

# Millions of solver steps.
SHORT = ["--start-value", "solver.step_size", "1e-6"]
# It takes seconds whatever the machine, because a wheel keeps the rover from resting.
SLOW = [*SHORT, "--start-value", "cmd.left_front_wheel_joint.velocity", "1"]


def body(name, mass, inertia, shape, origin="0 0 0"):
    geometry = f'<origin xyz="{origin}"/><geometry>{shape}</geometry>'
    x, y, z = inertia
    return (f'<link name="{name}"><inertial><origin xyz="{origin}"/><mass value="{mass}"/><inertia ixx="{x}" iyy="{y}" '
            f'izz="{z}" ixy="0" ixz="0" iyz="0"/></inertial><visual>{geometry}</visual><collision>{geometry}</collision></link>')


def robot(folder, *parts):
    file = folder / "robot.urdf"
    file.write_text(f'<robot name="subject">{"".join(parts)}</robot>')
    return file


@pytest.fixture
def simulate(command, tmp_path):
    """Simulates; gives the results and the lines of the summary."""

    def go(urdf, *arguments, settings="", code=0):
        # An FMU takes none.
        own = []
        if settings:
            (tmp_path / "s.toml").write_text(settings)
            own = ["-c", tmp_path / "s.toml"]
        done = command("simulate", urdf, *own, "--output-file", tmp_path / "out.csv", *arguments)
        assert done.returncode == code, done.stderr
        return read_csv(tmp_path / "out.csv"), done.stderr

    return go


def events(said):
    """The events, each as one line."""
    _, _, text = said.partition("  events\n")
    return [" ".join(event.split()) for event in re.split(r"\n?    - ", text)[1:]]


def only(said, words):
    """The one event with some words, and the numbers in it."""
    found = [event for event in events(said) if words in event]
    assert len(found) == 1, said
    return [float(number) for number in re.findall(r"(?<![\w.])-?\d+(?:\.\d+)?", found[0].replace("'", " "))]


def integrated(rate, state, done, step=1e-5):
    """The time at which `done(state)`, by the classical Runge-Kutta method."""
    time_, state = 0.0, np.array(state)
    while not done(state):
        a = rate(state)
        b = rate(state + step / 2 * a)
        c = rate(state + step / 2 * b)
        d = rate(state + step * c)
        state = state + step / 6 * (a + 2 * b + 2 * c + d)
        time_ += step
        assert time_ < 10, "it never happens"
    return time_


# A box of 0.4 x 0.4 x 0.6 m, 2 kg. About an edge below: m (w² + h²)/3.
WIDE, HIGH, MASS = 0.4, 0.6, 2.0
BOX = body("box", MASS, [MASS * (WIDE**2 + HIGH**2) / 12] * 2 + [MASS * WIDE**2 / 6],
           f'<box size="{WIDE} {WIDE} {HIGH}"/>')
ROUGH = "[world]\nground = { type = \"plane\", friction = 5 }\n[link.\"*\"]\nfriction = 5\n"


def pushed(speed):
    """Start values of a box that turns about its edge at y = w/2, whose centre goes with it."""
    velocity = {"y": speed * HIGH / 2, "z": speed * WIDE / 2}
    values = {"initial.base.angular_velocity.x": -speed}
    values |= {f"initial.base.linear_velocity.{axis}": value for axis, value in velocity.items()}
    return [str(part) for pair in values.items() for part in ("--start-value", *pair)]


def test_a_box_falls_over_its_edge_when_a_pendulum_would(simulate, tmp_path):
    urdf = robot(tmp_path, BOX)
    # At the default tolerance, what sets it turning at once may err by some milliseconds of the fall.
    fast = ["--output-interval", "0.001", "--stop-time", "1.5", "--tolerance", "1e-4"]
    _, said = simulate(urdf, *fast, *pushed(4.0), settings=ROUGH)
    # An inverted pendulum of length d about the edge, which balances at the angle alpha.
    d, alpha = np.hypot(WIDE, HIGH) / 2, np.arctan2(WIDE, HIGH)
    inertia = (WIDE**2 + HIGH**2) / 3

    def rate(state):
        return np.array([state[1], 9.81 * d / inertia * np.sin(state[0] - alpha)])

    expected = integrated(rate, [0.0, 4.0], lambda state: state[0] > np.pi / 3)
    fell, *_ = only(said, "Fell over")
    assert fell == pytest.approx(expected, abs=2e-3)
    # It comes to lie on its side; what it rocks beyond that is little.
    (most,) = re.findall(r"by (\d+)° at most", " ".join(events(said)))
    assert 90 <= int(most) <= 100
    # With too little energy to reach the balance it does not.
    least = np.sqrt(2 * 9.81 * (d - HIGH / 2) / inertia)
    _, said = simulate(urdf, *fast, *pushed(0.8 * least), settings=ROUGH)
    assert "Fell over" not in said and "events" in said


def test_a_ball_is_in_the_air_until_it_lands_and_sinks_as_deep_as_its_table_says(simulate, tmp_path):
    urdf = robot(tmp_path, body("ball", 1, [0.004] * 3, '<sphere radius="0.1"/>'))
    table, said = simulate(urdf, "--start-value", "initial.base.position.z", "1.1", "--stop-time", "1",
                           "--output-interval", "0.001")
    begin, end, high = only(said, "In the air")
    assert (begin, high) == (0.0, 1.0)
    # The last millimetre counts as landed.
    assert end == pytest.approx(np.sqrt(2 * (1 - 0.001) / 9.81), abs=1.1e-3)
    depth, when = only(said, "Deepest contact: link 'ball'")
    lowest = np.argmin(table["base.position.z"])
    assert depth == pytest.approx(1e3 * (0.1 - table["base.position.z"][lowest]), rel=1e-2)
    assert when == pytest.approx(table["time"][lowest], abs=1e-3)
    force = np.sqrt(sum(table[f"contact.ball.force.{axis}"]**2 for axis in "xyz"))
    newtons, when, weights = only(said, "Hardest contact")
    assert newtons == pytest.approx(force.max(), rel=1e-2) and weights == pytest.approx(force.max() / 9.81, rel=1e-2)
    assert when == pytest.approx(table["time"][np.argmax(force)], abs=1e-3)


CORNERS = np.array([[0.2, 0, -0.2], [-0.2, 0.2, -0.2], [-0.2, -0.2, -0.2], [0, 0, 0.3]])
SOLIDS = {
    "box": (f'<box size="{WIDE} {WIDE} {HIGH}"/>', lambda up: np.abs(up) @ np.array([WIDE, WIDE, HIGH]) / 2),
    "cylinder": ('<cylinder radius="0.1" length="0.6"/>',
                 lambda up: 0.1 * np.hypot(up[:, 0], up[:, 1]) + 0.3 * np.abs(up[:, 2])),
    "mesh": ('<mesh filename="corners.obj"/>', lambda up: -(up @ CORNERS.T).min(axis=1)),
}


@pytest.mark.parametrize("solid", SOLIDS)
def test_the_deepest_point_is_that_of_the_turned_shape(simulate, tmp_path, solid):
    vertices = "".join(f"v {x} {y} {z}\n" for x, y, z in CORNERS)
    (tmp_path / "corners.obj").write_text(vertices + "f 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n")
    shape, reach = SOLIDS[solid]
    tilted = [part for name, value in [("rpy.roll", 0.4), ("rpy.pitch", 0.3), ("position.z", 0.6)]
              for part in ("--start-value", f"initial.base.{name}", str(value))]
    table, said = simulate(robot(tmp_path, body("solid", MASS, [0.07, 0.07, 0.05], shape)), *tilted, "--stop-time", "1")
    x, y, z, w = (table[f"base.orientation.{axis}"] for axis in "xyzw")
    # The third row of the rotation matrix: the world's z in the axes of the link.
    up = np.array([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)]).T
    heights = table["base.position.z"] - reach(up)
    depth, when = only(said, "Deepest contact: link 'solid'")
    assert depth > 0.02 and depth == pytest.approx(-1e3 * heights.min(), rel=1e-2, abs=2e-2)
    assert when == pytest.approx(table["time"][np.argmin(heights)], abs=1e-3)
    _, end, _ = only(said, "In the air")
    assert end == pytest.approx(table["time"][np.argmax(heights < 1e-3)], abs=1e-3)


def hinge(limits, axis="0 0 1"):
    """A rod of 1 m along x on a hinge of the world."""
    return ('<link name="world"/>'
            + body("rod", 1, [0.001, 1 / 12, 1 / 12], '<box size="1 0.05 0.05"/>', "0.5 0 0")
            + f'<joint name="hinge" type="revolute"><parent link="world"/><child link="rod"/><origin xyz="0 0 3"/>'
              f'<axis xyz="{axis}"/><limit {limits} effort="3" velocity="100"/></joint>')


def test_a_rod_falls_to_its_limit_when_a_pendulum_would(simulate, tmp_path):
    urdf = robot(tmp_path, hinge('lower="-2" upper="1.2"', "0 1 0"))
    _, said = simulate(urdf, "--stop-time", "2", "--output-interval", "0.001",
                       settings="[[actuator]]\njoint = \"*\"\nmode = \"none\"\n")
    expected = integrated(lambda s: np.array([s[1], 9.81 * 0.5 / (1 / 3) * np.cos(s[0])]), [0.0, 0.0],
                          lambda s: s[0] > 1.2 - 1e-3)
    limit, when, spent = only(said, "Position limit reached: 'hinge', upper")
    assert limit == 1.2 and when == pytest.approx(expected, abs=2e-3)
    assert 0 < spent <= 2 - when + 2e-3
    # A base that is fixed does not fall and ends nowhere else.
    assert "Fell over" not in said and "ends at" not in said and "In the air" not in said


RAMP = "[[actuator]]\njoint = \"*\"\nmode = \"pd\"\nkp = 0\nkd = 0\n"


@pytest.mark.parametrize("limit, more", [(3, []), (5, ["--start-value", "cmd.hinge.max_effort", "5"])])
def test_a_motor_reaches_its_limit_when_its_ramp_does(simulate, command, tmp_path, limit, more):
    """The effort asked for rises by 10 N.m a second for one second, and falls again."""
    urdf = robot(tmp_path, hinge('lower="-1e6" upper="1e6"'))
    (tmp_path / "in.csv").write_text("time,cmd.hinge.effort\n0,0\n1,10\n2,0\n")
    _, said = simulate(urdf, "--input-file", tmp_path / "in.csv", "--stop-time", "2.5", "--output-interval", "0.002",
                       *more, settings=RAMP)
    newton_meters, when, spent = only(said, "Effort limit reached: 'hinge'")
    # An input counts from the beginning of a step, an output at its end.
    assert newton_meters == limit and when == pytest.approx(limit / 10, abs=5e-3)
    assert spent == pytest.approx(2 - 2 * limit / 10, abs=5e-3)


def test_a_limit_that_changes_during_the_run_is_the_limit_of_its_time(simulate, tmp_path):
    urdf = robot(tmp_path, hinge('lower="-1e6" upper="1e6"'))
    (tmp_path / "in.csv").write_text("time,cmd.hinge.effort,cmd.hinge.max_effort\n0,4,9\n1,4,1\n2,4,1\n")
    _, said = simulate(urdf, "--input-file", tmp_path / "in.csv", "--stop-time", "2", "--output-interval", "0.002",
                       settings=RAMP)
    # 9 - 8 t = 4.
    _, when, spent = only(said, "Effort limit reached: 'hinge'")
    assert when == pytest.approx(5 / 8, abs=5e-3) and spent == pytest.approx(2 - 5 / 8, abs=5e-3)


def test_the_page_and_the_terminal_say_the_same_whoever_wrote_the_table(simulate, command, export, tmp_path):
    fmu = export(robot(tmp_path, BOX), ROUGH)
    done = command("simulate", fmu, "--stop-time", "1.5", *pushed(4.0), "--output-file", tmp_path / "out.csv",
                   "--report", tmp_path / "r.html")
    assert done.returncode == 0 and only(done.stderr, "Fell over"), done.stderr
    told = events(done.stderr)
    # Unordered and flat, as other programs write.
    with open(tmp_path / "out.csv", newline="") as file:
        rows = [row[::-1] for row in csv.reader(file)]
    rows[0] = [name.replace(".", "_") for name in rows[0]]
    (tmp_path / "other.csv").write_text("\n".join(",".join(row) for row in rows))
    for results in "out.csv", "other.csv":
        again = command("report", tmp_path / results, "--model", fmu, "-o", tmp_path / "again.html")
        assert again.returncode == 0 and events(again.stderr) == told, again.stderr
    # Without the base's attitude there is no fall, and nothing else is invented.
    keep = [i for i, name in enumerate(rows[0]) if "orientation" not in name]
    (tmp_path / "less.csv").write_text("\n".join(",".join(row[i] for i in keep) for row in rows))
    less = command("report", tmp_path / "less.csv", "--model", fmu, "-o", tmp_path / "less.html")
    assert less.returncode == 0 and set(events(less.stderr)) < set(told) and "Fell" not in less.stderr, less.stderr


def test_the_summary_tells_length_steps_and_the_pose_and_no_clock_without_a_terminal(simulate, examples):
    table, said = simulate(examples / "rover.urdf", "--stop-time", "1", "--start-value", "initial.base.rpy.yaw", "0.5")
    first, second, *_ = said.splitlines()
    assert first == "rover  1 s in 240 communication steps"
    numbers = [float(x) for x in re.findall(r"-?\d+\.\d+", second)]
    names = [f"base.position.{a}" for a in "xyz"] + [f"base.rpy.{a}" for a in ("roll", "pitch", "yaw")]
    expected = [table[name][-1] for name in names]
    np.testing.assert_allclose(numbers[:3], expected[:3], atol=5.1e-4)
    np.testing.assert_allclose(numbers[3:], np.degrees(expected[3:]), atol=0.051)
    _, again = simulate(examples / "rover.urdf", "--stop-time", "1", "--start-value", "initial.base.rpy.yaw", "0.5")
    assert again == said
    _, quiet = simulate(examples / "rover.urdf", "--stop-time", "1", "--quiet")
    assert quiet == ""


def test_a_run_that_fails_half_way_says_how_far_it_came(simulate, export, examples, tmp_path):
    # One try of a step is too few.
    (tmp_path / "in.csv").write_text("time,solver.max_steps\n0,1e5\n0.5,1e5\n0.5,1\n")
    table, said = simulate(export(examples / "rover.urdf"), "--input-file", tmp_path / "in.csv", "--stop-time", "1",
                           "--output-interval", "0.25", "--start-value", "cmd.left_front_wheel_joint.velocity", "9",
                           code=3)
    assert table["time"][-1] == 0.5
    assert "rover  0.5 s of 1 s in 2 communication steps; it ended early" in said
    assert "error: the simulation stopped at 0.5" in said


@pytest.fixture
def rover(export, examples):
    return export(examples / "rover.urdf")


def test_chosen_variables_are_those_of_the_whole_table_and_of_fmpy(command, rover, tmp_path):
    def written(*arguments):
        done = command("simulate", rover, "--stop-time", "0.2", "--output-file", tmp_path / "out.csv", *arguments)
        assert done.returncode == 0, done.stderr
        return read_csv(tmp_path / "out.csv")

    whole = written()
    some = written("--output-variable", "joint.*.position", "--output-variable", "base.position.z",
                   "--output-variable", "base.position.z")
    names = [name for name in whole.dtype.names
             if name in ("time", "base.position.z") or re.fullmatch(r"joint\..*\.position", name)]
    assert list(some.dtype.names) == names and len(names) == 7
    for name in names:
        np.testing.assert_array_equal(some[name], whole[name])
    expected = fmpy.simulate_fmu(str(rover), stop_time=0.2, output_interval=1 / 240, output=names[1:])
    assert expected.dtype.names == some.dtype.names
    # Inputs, too.
    commands = written("--output-variable", "cmd.*.max_effort", "--start-value", "cmd.head_joint.max_effort", "7")
    assert set(commands["cmd.head_joint.max_effort"]) == {7.0}
    assert all(name == "time" or name.startswith("cmd.") for name in commands.dtype.names)


@pytest.mark.parametrize("name, words", [
    ("joint.*.positon", "no output or input matches 'joint.*.positon'; did you mean 'joint.*.position'?"),
    ("base.positoin.x", "did you mean 'base.position.x'"),
    ("link.*.friction", "no output or input matches 'link.*.friction'"),
    ("world.gravity.z", "'world.gravity.z' is neither an output nor an input, but a parameter"),
    ("", "no output or input ''"),
])
def test_a_name_that_matches_nothing_is_wrong_usage_and_the_nearest_are_named(command, rover, name, words):
    done = command("simulate", rover, "--output-variable", name)
    assert done.returncode == 2 and words in done.stderr and done.stdout == "", done.stderr


SVG = "{http://www.w3.org/2000/svg}"


def curves(file):
    """Coordinates of each curve of a plot, by the variable's name."""
    found = {}
    for path in ElementTree.parse(file).iter(f"{SVG}path"):
        title = path.find(f"{SVG}title")
        if title is not None:
            points = re.findall(r"[ML](-?[\d.]+) (-?[\d.]+)", path.get("d"))
            found[title.text] = np.array(points, dtype=float)
    return found


def test_curves_of_a_plot_are_the_values_of_the_table(command, rover, tmp_path):
    done = command("simulate", rover, "--stop-time", "1", "--output-interval", "0.02", "--plot", tmp_path / "p.svg",
                   "--output-file", tmp_path / "out.csv", "--start-value", "cmd.left_front_wheel_joint.velocity", "5",
                   "--output-variable", "joint.*.velocity", "--output-variable", "base.rpy.*")
    assert done.returncode == 0 and done.stdout == "", done.stderr
    table = read_csv(tmp_path / "out.csv")
    drawn = curves(tmp_path / "p.svg")
    assert set(drawn) == set(table.dtype.names) - {"time"}
    panels = [[n for n in drawn if n.startswith("joint")], [n for n in drawn if n.startswith("base")]]
    times = table["time"]
    for names in panels:
        pixels = []
        for x, y in (drawn[name].T for name in names):
            across = np.interp(times, times[[0, -1]], x[[0, -1]])
            assert np.all(np.abs(across[:, None] - x).min(axis=0) <= 0.11), "each point is a row"
            # Level pieces have their ends only.
            pixels.append(np.interp(across, x, y))
        values = [table[name] for name in names]
        slope, offset = np.polyfit(np.concatenate(values), np.concatenate(pixels), 1)
        assert slope < 0
        for drawn_values, data in zip(pixels, values):
            # A tenth of a pixel is kept, and neighbours on a slope are one apart.
            np.testing.assert_allclose(drawn_values, slope * data + offset, atol=0.3)
    text = (tmp_path / "p.svg").read_text()
    assert "rad/s" in text and "prefers-color-scheme:dark" in text
    again = command("simulate", rover, "--stop-time", "1", "--output-interval", "0.02", "--plot", tmp_path / "q.svg",
                    "--start-value", "cmd.left_front_wheel_joint.velocity", "5",
                    "--output-variable", "joint.*.velocity", "--output-variable", "base.rpy.*")
    assert again.returncode == 0 and again.stdout == "" and (tmp_path / "q.svg").read_text() == text


def test_a_plot_without_a_choice_shows_base_joints_contacts_and_energy(command, rover, tmp_path):
    done = command("simulate", rover, "--stop-time", "0.1", "--plot", tmp_path / "p.svg", "--report", tmp_path / "r.html",
                   "--output-variable", "base.position.z")
    assert done.returncode == 0 and set(curves(tmp_path / "p.svg")) == {"base.position.z"}, done.stderr
    # The page plays the whole robot whatever is chosen.
    assert "stays where it starts" not in done.stderr
    done = command("simulate", rover, "--stop-time", "0.1", "--plot", tmp_path / "p.svg", "--start-value",
                   "cmd.left_front_wheel_joint.velocity", "5")
    drawn = set(curves(tmp_path / "p.svg"))
    assert {"base.position.z", "joint.left_front_wheel_joint.velocity", "contact.left_front_wheel.force.z",
            "energy.kinetic"} <= drawn, drawn


def test_names_are_text_in_the_plot_and_in_the_summary(command, tmp_path):
    urdf = robot(tmp_path, hinge('lower="-2" upper="0.5"').replace('"hinge"', '"関節 &lt;script&gt; &quot;\'"'))
    urdf.write_text(urdf.read_text().replace('name="subject"', 'name="&lt;b&gt;&amp;"'))
    (tmp_path / "s.toml").write_text("[[actuator]]\njoint = \"*\"\nmode = \"none\"\n"
                                     "[initial.joint_velocities]\n\"*\" = 1\n")
    done = command("simulate", urdf, "-c", tmp_path / "s.toml", "--plot", tmp_path / "p.svg", "--stop-time", "2",
                   "--output-variable", "joint.*")
    assert done.returncode == 0 and done.stderr.startswith("<b>&  2 s"), done.stderr
    assert "Position limit reached: '関節 <script> \"'', upper, 0.5 rad" in " ".join(events(done.stderr)), done.stderr
    text = (tmp_path / "p.svg").read_text()
    assert "&lt;b&gt;&amp;" in text and "<script" not in text and len(curves(tmp_path / "p.svg")) == 4


def test_an_fmu_of_another_program_has_a_summary_without_events_and_a_plot_of_its_outputs(command, rover, tmp_path):
    foreign = tmp_path / "foreign.fmu"
    with zipfile.ZipFile(rover) as whole, zipfile.ZipFile(foreign, "w") as less:
        for name in whole.namelist():
            if not name.endswith("scene.bin"):
                less.writestr(name, whole.read(name))
    done = command("simulate", foreign, "--stop-time", "0.1", "--plot", tmp_path / "p.svg")
    assert done.returncode == 0, done.stderr
    lines = done.stderr.splitlines()
    assert lines[0] == "foreign  0.1 s in 24 communication steps" and lines[1].startswith("  ends at") and len(lines) == 2
    outputs = [v for v in fmpy.read_model_description(str(foreign)).modelVariables if v.causality == "output"]
    assert set(curves(tmp_path / "p.svg")) == {v.name for v in outputs}


class Terminal:
    """The command with standard error at a pseudo-terminal."""

    def __init__(self, *arguments, columns=80, **streams):
        ours, theirs = pty.openpty()
        fcntl.ioctl(theirs, termios.TIOCSWINSZ, struct.pack("HHHH", 24, columns, 0, 0))
        streams = {"stdout": subprocess.DEVNULL, **streams}
        self.process = subprocess.Popen([os.environ["URDF2FMU"], *map(str, arguments)], stderr=theirs, **streams)
        os.close(theirs)
        self.ours, self.said = ours, b""

    def read(self, enough=lambda said: False):
        """Reads until it has said enough, or all."""
        until = time.monotonic() + 100
        while not enough(self.said) and time.monotonic() < until:
            ready, _, _ = select.select([self.ours], [], [], 1)
            if ready:
                try:
                    piece = os.read(self.ours, 65536)
                except OSError:  # Linux says so where the other side is closed.
                    break
                if not piece:
                    break
                self.said += piece
        return self.said.decode()

    def end(self):
        said = self.read()
        os.close(self.ours)
        return self.process.wait(timeout=60), said


def left_over(said):
    """What stands on the screen: each line after its carriage returns."""
    lines = []
    for line in said.replace("\r\n", "\n").split("\n"):
        screen = []
        for part in line.split("\r"):
            screen[:len(part)] = part
        lines.append("".join(screen).rstrip())
    return lines


def test_progress_is_shown_at_a_terminal_and_taken_away_at_the_end(rover, tmp_path):
    code, said = Terminal("simulate", rover, *SLOW, "--stop-time", "0.3", "--plot", tmp_path / "p.svg").end()
    assert code == 0, said
    shown = re.findall(r"\r([\d.]+) of 0.3 s  (\d+) %  ([\d.]+) times real time", said)
    assert len(shown) >= 2, said
    seconds = [float(s) for s, _, _ in shown]
    assert seconds == sorted(seconds) and seconds[-1] <= 0.3
    for s, percent, _ in shown:
        assert abs(float(s) / 0.3 * 100 - int(percent)) <= 1
    # Its last line is overwritten by spaces, then comes the summary, with the clock's figures.
    screen = left_over(said)
    assert re.fullmatch(r"rover  0.3 s in 72 communication steps, [\d.]+ times real time", screen[0]), screen
    assert not any("%" in line for line in screen)


def test_a_hint_names_what_costs_and_which_setting_helps_once(examples, export):
    fmu = export(examples / "quadruped.urdf")
    code, said = Terminal("simulate", fmu, *SHORT, "--stop-time", "0.25").end()
    text = " ".join(" ".join(left_over(said)).split())
    assert code == 0 and text.count("hint") == 1, text
    assert "took 4167 solver steps, because solver.step_size is 1e-6 s" in text.replace("0.000001", "1e-6"), text
    code, said = Terminal("simulate", fmu, "--stop-time", "0.1", "--quiet").end()
    assert (code, said) == (0, "")


@pytest.mark.parametrize("columns", [30, 12, 2])
def test_progress_fits_into_a_narrow_terminal(rover, columns):
    code, said = Terminal("simulate", rover, *SLOW, "--stop-time", "0.2", columns=columns).end()
    assert code == 0
    progress = said[:said.index("rover  ")]
    assert "\n" not in progress and max(map(len, progress.split("\r"))) < columns
    assert ("%" in progress) == (columns > 5)


def test_progress_is_never_written_to_a_pipe_or_a_file(command, rover, tmp_path):
    done = command("simulate", rover, *SLOW, "--stop-time", "0.2", "--output-file", tmp_path / "out.csv")
    assert done.returncode == 0 and "\r" not in done.stderr and "%" not in done.stderr and "times" not in done.stderr
    with open(tmp_path / "err", "w") as file:
        subprocess.run([os.environ["URDF2FMU"], "simulate", rover, *SLOW, "--stop-time", "0.2"], stderr=file,
                       stdout=subprocess.DEVNULL, check=True)
    assert (tmp_path / "err").read_text() == done.stderr


def test_ctrl_c_ends_the_run_and_keeps_what_was_reached(rover, tmp_path):
    running = Terminal("simulate", rover, *SLOW, "--stop-time", "1000", "--output-file", tmp_path / "out.csv")
    running.read(lambda said: b"of 1000 s" in said)
    running.process.send_signal(signal.SIGINT)
    code, said = running.end()
    assert code == 130, said
    table = read_csv(tmp_path / "out.csv")
    reached = table["time"][-1]
    assert 0 < reached < 1000 and len(table) == round(reached * 240) + 1
    screen = left_over(said)
    (said_time, said_steps), = re.findall(r"rover  ([\d.]+) s of 1000 s in (\d+) communication step", "\n".join(screen))
    assert float(said_time) == pytest.approx(reached, abs=5.1e-4) and int(said_steps) == len(table) - 1
    assert screen[-2].startswith("error: ended by the user at ") and not any("%" in line for line in screen)


def test_a_terminal_that_goes_away_does_not_stop_the_run(rover, tmp_path):
    running = Terminal("simulate", rover, *SLOW, "--stop-time", "0.4", "--output-file", tmp_path / "out.csv",
                       start_new_session=True)
    running.read(lambda said: b"%" in said)
    os.close(running.ours)
    running.process.wait(timeout=100)
    assert len(read_csv(tmp_path / "out.csv")) == 97
