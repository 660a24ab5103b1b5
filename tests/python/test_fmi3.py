"""FMI 3.0: valid by FMPy and by the schemas, and the bits of FMI 2.0."""

import html
import io
import json
import zipfile
from contextlib import redirect_stdout
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy import fmi3, validation
from lxml import etree


def schema(name):
    folder = Path(fmpy.__file__).parent / "schema" / "fmi3"
    return etree.XMLSchema(etree.parse(str(folder / name)))


def valid(fmu):
    """FMPy finds no problem, and both files hold to the schemas of the standard."""
    assert validation.validate_fmu(str(fmu)) == []
    with zipfile.ZipFile(fmu) as archive:
        for name, file in (("fmi3ModelDescription.xsd", "modelDescription.xml"),
                           ("fmi3TerminalsAndIcons.xsd", "terminalsAndIcons/terminalsAndIcons.xml")):
            schema(name).assertValid(etree.fromstring(archive.read(file)))
    return fmpy.read_model_description(str(fmu))


def simulate(fmu, **options):
    """FMPy's results, without what the FMU says."""
    with redirect_stdout(io.StringIO()):
        return fmpy.simulate_fmu(str(fmu), **options)


def columns(result, description):
    """Every column of FMPy's results as scalars, in the order of the file."""
    order = {v.name: v.valueReference for v in description.modelVariables}
    names = sorted(result.dtype.names[1:], key=order.get)
    values = [np.asarray(result[name], dtype=float).reshape(len(result), -1) for name in names]
    return np.concatenate(values, axis=1)


def commanded(fmu, seed=3):
    """A table of inputs for FMPy: jumps of all commands at 0.15 s."""
    description = fmpy.read_model_description(str(fmu))
    names = [v.name for v in description.modelVariables if v.name.startswith("cmd.") and v.causality == "input"
             and not v.name.endswith("max_effort")]
    rng = np.random.default_rng(seed)
    rows = [(time, *row) for time, row in zip((0, 0.15, 0.15, 0.3), rng.uniform(-0.5, 0.5, (4, len(names))))]
    return np.array(rows, dtype=[(name, float) for name in ("time", *names)])


WORLD = """
[outputs]
contact_points = true
[[sensor]]
type = "ray"
name = "lidar"
link = "head"
rays = 9
fov = 3.0
range = 5
hits = true
[[world.object]]
name = "step"
shape = { box = [0.4, 0.4, 0.2] }
mass = 20
xyz = [0.6, 0.0]
[[world.object]]
name = "ball"
shape = { sphere = 0.1 }
mass = 1
xyz = [0.62, 0.0, 0.32]
[[outputs.pair]]
name = "stand"
first = "ball"
second = "step"
"""
ROBOTS = {"r2d2": ("r2d2.urdf", ""), "iiwa": ("kuka_iiwa/model.urdf", "[outputs]\nlinks = [\"*\"]\n"),
          "quadruped": ("quadruped.urdf", ""), "world": ("rover.urdf", WORLD)}
OWN = ("quadruped", "world")
"""Those of our examples; the others are PyBullet's."""


@pytest.mark.parametrize("name", ROBOTS)
def test_fmi_3_is_valid_and_gives_the_bits_of_fmi_2(name, pybullet_data, examples, export):
    file, settings = ROBOTS[name]
    urdf = (examples if name in OWN else pybullet_data) / file
    old, new = export(urdf, settings), export(urdf, settings, "--fmi", "3")
    description = valid(new)
    assert description.fmiVersion == "3.0"
    options = {"stop_time": 0.3, "output_interval": 1 / 240, "input": commanded(old)}
    expected = columns(simulate(old, **options), fmpy.read_model_description(str(old)))
    found = columns(simulate(new, **options), description)
    assert expected.shape == found.shape and len(found) > 60
    # Outputs of other types stand elsewhere among the columns of neither: all are in the table's order.
    assert np.array_equal(expected, found)


def test_a_world_with_sensors_is_valid_and_every_layout_gives_the_same_bits(examples, command, tmp_path):
    urdf = examples / "rover.urdf"
    config = examples / "worlds" / "lidar_maze.toml"
    told = {}
    for layout in "fmi2", "vectors", "none", "all":
        fmu = tmp_path / f"{layout}.fmu"
        arguments = [] if layout == "fmi2" else ["--fmi", 3, "--arrays", layout]
        done = command("export", "--no-documentation", urdf, "-o", fmu, "-c", config, *arguments)
        assert done.returncode == 0, done.stderr
        out = tmp_path / f"{layout}.csv"
        if layout != "fmi2":
            valid(fmu)
        done = command("simulate", fmu, "--stop-time", 0.3, "--output-file", out, "--start-value",
                       "cmd.left.velocity", 3)
        assert done.returncode == 0, done.stderr
        told[layout] = out.read_text()
    assert len(told["fmi2"]) > 10000
    assert told["vectors"] == told["fmi2"] and told["none"] == told["fmi2"] and told["all"] == told["fmi2"]

    def names(layout):
        return [v.name for v in fmpy.read_model_description(str(tmp_path / f"{layout}.fmu")).modelVariables]

    assert names("none")[1:] == names("fmi2")
    every = fmpy.read_model_description(str(tmp_path / "all.fmu")).modelVariables
    gathered = {v.name: v for v in every if v.name.startswith("robot.")}
    assert {"robot.joint.position", "robot.joint.velocity", "robot.joint.effort", "robot.cmd.velocity"} <= set(gathered)
    assert "left_front_wheel_joint" in gathered["robot.joint.position"].description
    assert not [v for v in every if v.name.startswith("cmd.")]
    assert [v.name for v in every][0] == "time"


def test_start_values_of_arrays_are_set_whole(pybullet_data, export):
    fmu = export(pybullet_data / "r2d2.urdf", "", "--fmi", "3")
    for start in ([1, 2, 0.9], "1 2 0.9"):
        result = simulate(fmu, stop_time=0.01, start_values={"initial.base.position": start})
        assert list(result["base.position"][0]) == [1, 2, 0.9]
    default = simulate(fmu, stop_time=0.1, apply_default_start_values=True)
    assert np.array_equal(default["base.position"], simulate(fmu, stop_time=0.1)["base.position"])


class Running:
    """An instance of FMI 3 in FMPy, initialised."""

    def __init__(self, fmu, tmp_path, required=(), update=None):
        self.description = fmpy.read_model_description(str(fmu))
        self.references = {v.name: v.valueReference for v in self.description.modelVariables}
        self.said = []
        self.slave = fmi3.FMU3Slave(
            guid=self.description.guid, unzipDirectory=fmpy.extract(str(fmu), unzipdir=str(tmp_path / "fmu")),
            modelIdentifier=self.description.coSimulation.modelIdentifier, instanceName="robot")
        options = {}
        if update is not None:
            options = {"earlyReturnAllowed": True, "intermediateUpdate": update,
                       "requiredIntermediateVariables": [self.references[name] for name in required]}
        self.slave.instantiate(logMessage=lambda _e, status, _c, text: self.said.append((status, text)), **options)
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def get(self, name, count):
        return self.slave.getFloat64([self.references[name]], nValues=count)

    def set(self, name, values):
        self.slave.setFloat64([self.references[name]], values)


def test_a_state_goes_on_in_another_instance(pybullet_data, export, tmp_path):
    fmu = export(pybullet_data / "r2d2.urdf", "", "--fmi", "3")
    first, second = (Running(fmu, tmp_path / str(number)) for number in (1, 2))
    first.set("cmd.right_front_wheel_joint.velocity", [-8.0])
    for step in range(20):
        first.slave.doStep(step * 0.02, 0.02)
    data = first.slave.serializeFMUState(first.slave.getFMUState())
    second.slave.setFMUState(second.slave.deserializeFMUState(data))
    for step in range(20, 40):
        for robot in first, second:
            robot.slave.doStep(step * 0.02, 0.02)
    assert list(first.get("base.position", 3)) == list(second.get("base.position", 3))
    assert not [message for message in first.said + second.said if message[0] >= 2]
    for robot in first, second:
        robot.slave.terminate()
        robot.slave.freeInstance()


def test_the_importer_is_called_within_a_step_and_ends_it(pybullet_data, export, tmp_path):
    fmu = export(pybullet_data / "r2d2.urdf", "", "--fmi", "3")
    called = []

    def update(_environment, time, _set, _get, finished, may_end, end, when):
        called.append((time, robot.get("base.position", 3)[2], finished, may_end))
        if time > 0.2:
            end[0], when[0] = True, 0.3

    robot = Running(fmu, tmp_path, ["base.position"], update)
    _event, _end, early, reached = robot.slave.doStep(0.0, 1.0)
    assert early and reached == 0.3
    times = [call[0] for call in called]
    assert times == sorted(set(times)) and times[-1] == 0.3 and all(call[2] and call[3] for call in called)
    robot.slave.terminate()
    robot.slave.freeInstance()


def test_terminals_name_variables_that_there_are(pybullet_data, export):
    for arguments in ([], ["--arrays", "all"], ["--naming", "flat"]):
        fmu = export(pybullet_data / "r2d2.urdf", "", "--fmi", "3", *arguments)
        names = {v.name for v in valid(fmu).modelVariables}
        with zipfile.ZipFile(fmu) as archive:
            root = etree.fromstring(archive.read("terminalsAndIcons/terminalsAndIcons.xml"))
        terminals = {t.get("name"): t for t in root.iter("Terminal")}
        members = {m.get("variableName") for m in root.iter("TerminalMemberVariable")}
        assert members <= names and len(members) > 20
        assert {"base", "joint.right_front_wheel_joint"} <= set(terminals)
        for terminal in terminals.values():
            own = [member.get("memberName") for member in terminal]
            assert len(own) == len(set(own)), terminal.get("name")


def test_simulate_and_report_take_an_fmu_of_either_version(command, export, examples, tmp_path):
    texts = []
    for number, arguments in enumerate(([], ["--fmi", "3"], ["--fmi", "3", "--naming", "flat"])):
        fmu = export(examples / "quadruped.urdf", "", *arguments)
        out, page = tmp_path / f"{number}.csv", tmp_path / f"{number}.html"
        done = command("simulate", fmu, "--stop-time", 0.2, "--output-file", out, "--report", page)
        assert done.returncode == 0, done.stderr
        assert page.stat().st_size > 100000
        texts.append(out.read_text().split("\n", 1))
        listing = command("info", fmu, "--variables")
        assert listing.returncode == 0, listing.stderr
        assert ("x86_64" in listing.stdout or "aarch64" in listing.stdout) == bool(arguments)
    assert texts[0] == texts[1] and texts[0][1] == texts[2][1]


@pytest.mark.parametrize("arrays", ("none", "vectors", "all"))
def test_info_and_the_page_inside_list_arrays_as_the_file_has_them(arrays, command, export, examples, tmp_path):
    fmu = export(examples / "rover.urdf", "", "--fmi", "3", "--arrays", arrays, documented=True)
    listed = json.loads(command("info", fmu, "--json", "--variables").stdout)["variables"]
    variables = [v for v in fmpy.read_model_description(str(fmu)).modelVariables if v.causality != "independent"]
    names = {v["name"]: v for v in listed}
    assert [v.name for v in variables] == list(names) and len(names) == len(listed)
    with zipfile.ZipFile(fmu) as archive:
        page = archive.read("documentation/index.html").decode()
        assert "terminalsAndIcons/icon.png" in archive.namelist()
    assert "FMI 3.0 FMU of a URDF robot for co-simulation" in page
    for variable in variables:
        own = names[variable.name]
        assert own["value_reference"] == variable.valueReference and own["causality"] == variable.causality
        shape = [int(dimension.start) for dimension in variable.dimensions]
        assert own.get("dimensions", []) == shape, variable.name
        assert len(own.get("elements", [0])) == np.prod(shape or [1])
        if variable.start is not None and shape:
            assert own["start"] == [float(x) for x in str(variable.start).split()], variable.name
        size = f" [{' × '.join(map(str, shape))}]" if shape else ""
        shown = html.escape(variable.name).replace("&#x27;", "'").replace(".", ".<wbr>")
        assert f"<code>{shown}</code>{size}</td>" in page, variable.name
    assert any("dimensions" in v for v in listed) == (arrays != "none")


def test_a_set_of_one_element_keeps_the_others(command, export, pybullet_data, tmp_path):
    fmu = export(pybullet_data / "r2d2.urdf", "", "--fmi", "3")
    out = tmp_path / "out.csv"
    done = command("simulate", fmu, "--stop-time", 0.01, "--output-file", out,
                   "--start-value", "initial.base.position.x", 2, "--output-variable", "base.position.*")
    assert done.returncode == 0, done.stderr
    first = out.read_text().splitlines()[1].split(",")
    # But for round-off: the solver's base stands in its centre of mass.
    assert abs(float(first[1]) - 2) < 1e-14 and float(first[3]) > 0.1


@pytest.mark.parametrize("arrays", ["vectors", "all", "none"])
def test_variables_hold_dimensions_alone_and_the_model_names_the_elements(arrays, command, examples, tmp_path):
    # FMILibrary 3.0 skips a <Dimension> that follows <Annotations>, as the schema wants them, and sees a scalar.
    fmu, flat = tmp_path / "three.fmu", tmp_path / "two.fmu"
    for place, options in ((fmu, ("--fmi", "3", "--arrays", arrays)), (flat, ())):
        command("export", examples / "quadruped.urdf", "-o", place, "--no-documentation", *options)
    with zipfile.ZipFile(fmu) as archive:
        root = etree.fromstring(archive.read("modelDescription.xml"))
    variables = {variable.get("valueReference"): [int(inner.get("start")) for inner in variable]
                 for variable in root.find("ModelVariables")}
    assert {inner.tag for variable in root.find("ModelVariables") for inner in variable} <= {"Dimension"}
    lines = [line.split() for annotation in root.findall("Annotations/Annotation") for line in annotation.text.splitlines()]
    assert {reference: [len(names)] for reference, *names in lines} == {
        reference: sizes for reference, sizes in variables.items() if sizes}
    assert (lines == []) == (arrays == "none")
    of_fmi_2 = {v.name for v in fmpy.read_model_description(str(flat)).modelVariables}
    assert {name for _, *names in lines for name in names} <= of_fmi_2
