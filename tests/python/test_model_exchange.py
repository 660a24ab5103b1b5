"""Model Exchange: what FMPy's CVODE makes of the derivatives is what co-simulation finds."""

import ctypes
import io
import json
import sys
from contextlib import redirect_stdout
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy import fmi2
from fmpy.util import read_csv
from scipy.integrate import solve_ivp

from robot import extracted
from test_fmi3 import valid
from test_view import WHEELS, Running


def commanded(description, pieces):
    """A table of wheel speeds that jump: of the left and of the right, rad/s, for pieces of time."""
    names = [v.name for v in description.modelVariables
             if v.causality == "input" and "wheel" in v.name and v.name.endswith("velocity")]
    rows = [(time, *[left if "left" in name else right for name in names])
            for begin, end, left, right in pieces for time in (begin, end)]
    return np.array(rows, dtype=[(name, float) for name in ("time", *names)])


def run(fmu, kind, tolerance=1e-4, **options):
    if kind == "CoSimulation":
        options["start_values"] = {**options.get("start_values", {}), "solver.tolerance": tolerance}
    with redirect_stdout(io.StringIO()):
        return fmpy.simulate_fmu(str(extracted(fmu)), fmi_type=kind, relative_tolerance=tolerance,
                                 output_interval=1 / 240, **options)


@pytest.fixture(scope="module")
def r2d2(pybullet_data, export):
    return {fmi: export(pybullet_data / "r2d2.urdf", "", "--interface", "both", "--fmi", str(fmi)) for fmi in (2, 3)}


def test_r2d2_drives_as_in_co_simulation(r2d2):
    """Within 1 mm and 2 mrad, at a tolerance of 1e-4 each."""
    description = fmpy.read_model_description(str(r2d2[2]))
    table = commanded(description, [(0, 1, 0, 0), (1, 3, 10, 10)])
    names = [f"base.position.{axis}" for axis in "xyz"] + [f"base.rpy.{axis}" for axis in ("roll", "pitch", "yaw")]
    ends = {}
    for kind in ("CoSimulation", "ModelExchange"):
        result = run(r2d2[2], kind, input=table, output=names, stop_time=3)
        ends[kind] = np.array([result[name][-1] for name in names])
    off = np.abs(ends["ModelExchange"] - ends["CoSimulation"])
    assert ends["CoSimulation"][1] > 0.2, "it drives"
    assert off[:3].max() < 1e-3 and off[3:].max() < 2e-3, off


def test_r2d2_drives_as_in_co_simulation_at_any_tolerance_near_by(r2d2):
    """Within 1 mm whatever the errors are by chance: six tolerances from 5e-5 to 2e-4. Where the nominal value of
    friction's displacement was that at its cap, the worst was 1.4 mm off, and 1.5 mm off Model Exchange at 1e-8."""
    table = commanded(fmpy.read_model_description(str(r2d2[2])), [(0, 1, 0, 0), (1, 3, 10.003, 10.003)])
    names = [f"base.position.{axis}" for axis in "xyz"]
    ends = {}
    for kind, tolerance in [("CoSimulation", 1e-4), *(("ModelExchange", k * 1e-5) for k in (5, 8, 10, 12, 16, 20))]:
        result = run(r2d2[2], kind, tolerance, input=table, output=names, stop_time=3)
        ends[tolerance, kind] = np.array([result[name][-1] for name in names])
    truth = ends.pop((1e-4, "CoSimulation"))
    off = [np.abs(end - truth).max() for end in ends.values()]
    assert max(off) < 1e-3, off


def test_integrators_come_to_an_end_at_the_tolerance_of_the_fmu(examples, export):
    """Who names no tolerance gets that of the default experiment. At 1e-3 CVODE gives up on the quadruped at 0.02 s."""
    settings = next(examples.rglob("quadruped.toml")).read_text()
    fmu = export(next(examples.rglob("quadruped.urdf")), settings, "--interface", "both")
    with redirect_stdout(io.StringIO()):
        result = fmpy.simulate_fmu(str(fmu), fmi_type="ModelExchange", stop_time=1, output_interval=0.01)
    assert abs(result["base.position.z"][-1] - 0.2916) < 1e-3


def test_integrators_get_over_a_light_joint_at_its_limit(pybullet_data, export):
    """R2D2's grippers have 5e-5 kg.m2 at 1,000 N.m, and servos hold them at their limits while the robot rocks.
    Where limits set in at once, CVODE gives up in three of these runs."""
    settings = '[world]\nground = { type = "plane", friction = 0.5 }\n[link."*"]\nfriction = 0.5\n'
    fmu = export(pybullet_data / "r2d2.urdf", settings, "--inertia", "collision", "--interface", "me")
    description = fmpy.read_model_description(str(fmu))
    for speed in (10, 10.001, 10.002, 10.003, 10.004, 10.005):
        table = commanded(description, [(0, 1, speed, speed), (1, 2, speed, -speed)])
        result = run(fmu, "ModelExchange", input=table, output=["base.position.y"], stop_time=2)
        assert result["base.position.y"][-1] < -0.3, "it drives"


FLOOR = """solid floor
facet normal 0 0 1
outer loop
vertex -3 -3 0
vertex 3 -3 0
vertex 3 3 0
endloop
endfacet
facet normal 0 0 1
outer loop
vertex -3 -3 0
vertex 3 3 0
vertex -3 3 0
endloop
endfacet
endsolid
"""


@pytest.mark.parametrize("world", [
    '[[world.terrain]]\nname = "floor"\ntype = "mesh"\nfile = "floor.stl"\n',
    '[world]\nground = { type = "none" }\n[[world.object]]\nname = "shelf"\nshape = { box = [2, 2, 0.02] }\n'
    'static = true\nxyz = [0, 0, -0.01]\n',
], ids=["mesh", "shelf"])
@pytest.mark.parametrize("interval", [1 / 240, 0.5])
def test_nothing_falls_through_a_mesh_or_a_shelf(world, interval, pybullet_data, command, tmp_path):
    """A ball that falls 2 m lies on them, whatever the output interval: 9 m below them before there were events."""
    (tmp_path / "floor.stl").write_text(FLOOR)
    settings = tmp_path / "world.toml"
    settings.write_text(f"[initial]\nxyz = [0.3, 0.1, 2]\n{world}")
    fmu = tmp_path / "ball.fmu"
    made = command("export", pybullet_data / "sphere_small.urdf", "-o", fmu, "-c", settings, "--interface", "both",
                   "--no-documentation")
    assert made.returncode == 0, made.stderr
    for kind in ("CoSimulation", "ModelExchange"):
        with redirect_stdout(io.StringIO()):
            result = fmpy.simulate_fmu(str(fmu), fmi_type=kind, output_interval=interval, stop_time=1.5,
                                       output=["base.position.z"])
        assert abs(result["base.position.z"][-1] - 0.03) < 1e-3, (kind, result["base.position.z"][-1])


@pytest.mark.parametrize("fmi", (2, 3))
def test_both_versions_are_valid_and_give_the_same(fmi, r2d2, pybullet_data, export):
    """The schemas hold; an arm falls onto its limits as in co-simulation, in both versions."""
    if fmi == 3:
        valid(r2d2[3])
    arm = export(pybullet_data / "kuka_iiwa/model.urdf", "[outputs]\nlinks = [\"*\"]\n",
                 "--interface", "me", "--fmi", str(fmi))
    assert fmpy.validation.validate_fmu(str(arm)) == []
    own = export(pybullet_data / "kuka_iiwa/model.urdf", "[outputs]\nlinks = [\"*\"]\n", "--fmi", str(fmi))
    name = "joint.lbr_iiwa_joint_4.position"
    starts = {"initial.joint.lbr_iiwa_joint_2.position": 0.7}
    with redirect_stdout(io.StringIO()):
        ends = [fmpy.simulate_fmu(str(fmu), stop_time=1, output=[name], relative_tolerance=1e-6,
                                  start_values=starts)[name][-1] for fmu in (arm, own)]
    assert abs(ends[0] - ends[1]) < 1e-3, ends


def instance(fmu, tmp_path):
    """A Model Exchange instance of FMI 2 in continuous-time mode, and what FMPy reads of it."""
    description = fmpy.read_model_description(str(fmu))
    folder = fmpy.extract(str(fmu), unzipdir=str(tmp_path))
    model = fmi2.FMU2Model(guid=description.guid, unzipDirectory=folder, instanceName="one",
                           modelIdentifier=description.modelExchange.modelIdentifier)
    model.instantiate()
    model.setupExperiment()
    model.enterInitializationMode()
    model.exitInitializationMode()
    model.newDiscreteStates()
    model.enterContinuousTimeMode()
    return model, description


class Field:
    """x' = f(t, x) of an instance, for SciPy and for differences."""

    def __init__(self, model, description):
        self.model, self.n = model, description.numberOfContinuousStates
        self.buffer = (ctypes.c_double * self.n)()

    def states(self):
        self.model.getContinuousStates(self.buffer, self.n)
        return np.array(self.buffer)

    def __call__(self, time, x):
        self.model.setTime(time)
        self.model.setContinuousStates((ctypes.c_double * self.n)(*x), self.n)
        self.model.getDerivatives(self.buffer, self.n)
        return np.array(self.buffer)


def test_directional_derivatives_are_those_of_differences(r2d2, tmp_path):
    """Of every derivative by every state, on R2D2 as it stands: beside differences that this test takes, with steps of
    several sizes and the best of them. Inputs, outputs and other robots: test_derivatives.py."""
    model, description = instance(r2d2[2], tmp_path)
    field = Field(model, description)
    x = field.states()
    rates = [d.variable.valueReference for d in description.derivatives]
    knowns = [d.variable.derivative for d in description.derivatives]
    found = np.array([model.getDirectionalDerivative(rates, [known.valueReference], [1.0]) for known in knowns]).T
    best = np.full(found.shape, np.inf)
    for column, known in enumerate(knowns):
        for size in (1e-6, 3e-7, 1e-7, 3e-8):
            h = size * float(known.nominal or 1)
            def at(k, h=h, column=column):
                y = x.copy()
                y[column] += k * h
                return field(0.0, y)
            by_hand = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h)
            best[:, column] = np.minimum(best[:, column], np.abs(found[:, column] - by_hand))
    field(0.0, x)
    # A millionth of the largest entry of the column, which is the answer along one direction; and what the last digits
    # of the states make of the derivatives, by the differences of 3e-7.
    random = np.random.default_rng(1)
    there = field(0.0, x)
    digit = 2.0**-52 * np.maximum(np.abs(x), [float(known.nominal or 1) for known in knowns])
    noise = [np.abs(field(0.0, x + digit * random.integers(-2, 3, len(x))) - there) for _ in range(30)]
    digits = 2 * np.max(noise, axis=0)[:, None] / 3e-7
    field(0.0, x)
    size = np.abs(found)
    allowed = 1e-6 * size.max(axis=0) + digits + 1e-15
    row, column = np.unravel_index((best / allowed).argmax(), best.shape)
    assert best[row, column] < allowed[row, column], (
        knowns[column].name, description.derivatives[row].variable.name, best[row, column], found[row, column])
    # Nothing has changed, bit for bit.
    assert np.array_equal(field.states(), x)
    model.terminate()
    model.freeInstance()


def test_saved_states_and_refusals(r2d2, tmp_path):
    model, description = instance(r2d2[2], tmp_path)
    field = Field(model, description)
    x = field.states()
    x[7:15] += 0.01
    before = field(0.5, x)
    saved = model.getFMUState()
    field(0.7, x * 1.001)
    model.setFMUState(saved)
    model.getDerivatives(field.buffer, field.n)
    assert np.array_equal(np.array(field.buffer), before)
    assert np.array_equal(field.states(), x)
    step = model.dll.fmi2DoStep
    step.argtypes, step.restype = [ctypes.c_void_p, ctypes.c_double, ctypes.c_double, ctypes.c_int], ctypes.c_int
    assert step(model.component, 0.0, 0.01, 0) == 3, "fmi2Error: the instance is for Model Exchange"
    with pytest.raises(Exception, match="(?i)error"):
        model.setContinuousStates((ctypes.c_double * field.n)(*(x * np.nan)), field.n)
    model.terminate()
    model.freeInstance()


def test_a_world_exchanges_states_of_pairs(examples, export):
    """A ball on a box: both end as in co-simulation."""
    settings = """
[[world.object]]
name = "step"
shape = { box = [0.4, 0.4, 0.2] }
mass = 20
xyz = [2.0, 0.0, 0.1]
[[world.object]]
name = "ball"
shape = { sphere = 0.1 }
mass = 1
xyz = [2.02, 0.0, 0.32]
"""
    robot = next(examples.rglob("rover.urdf"))
    fmu = export(robot, settings, "--interface", "both")
    description = fmpy.read_model_description(str(fmu))
    states = [d.variable.derivative.name for d in description.derivatives]
    assert any(name.startswith("object.ball.state.pair_contact") or "state.pair_contact" in name for name in states), states
    name = "object.ball.position.z"
    ends = [run(fmu, kind, output=[name], stop_time=0.5)[name][-1] for kind in ("CoSimulation", "ModelExchange")]
    assert abs(ends[0] - ends[1]) < 1e-4, ends


POSE = [f"base.position.{axis}" for axis in "xyz"] + [f"base.rpy.{axis}" for axis in ("roll", "pitch", "yaw")]


def own(command, fmu, folder, table=None, *more):
    """What `urdf2fmu simulate` makes of an FMU, and what it says."""
    arguments = ["simulate", fmu, "--output-file", folder / "out.csv", *more]
    if table is not None:
        file = folder / "in.csv"
        file.write_text("\n".join(",".join(map(str, row)) for row in (table.dtype.names, *table.tolist())) + "\n")
        arguments += ["--input-file", file]
    done = command(*arguments)
    assert done.returncode == 0, done.stderr
    return read_csv(folder / "out.csv"), done.stderr


@pytest.mark.parametrize("fmi", (2, 3))
def test_simulate_drives_as_cvode_does(fmi, r2d2, pybullet_data, export, command, tmp_path):
    """R2D2 as Model Exchange alone, driving from 1 s to 2 s, turning until 3 s: the command at 1e-4 comes as near to
    CVODE at 1e-6 as 0.1 mm and 0.1 mrad, and to co-simulation as near as the interfaces are to one another."""
    fmu = export(pybullet_data / "r2d2.urdf", "", "--interface", "me", "--fmi", str(fmi))
    table = commanded(fmpy.read_model_description(str(fmu)), [(0, 1, 0, 0), (1, 2, 10, 10), (2, 3, -5, 5)])
    found, said = own(command, fmu, tmp_path, table, "--stop-time", 3, "--tolerance", 1e-4)
    assert "in 720 communication steps" in said and "it ended early" not in said, said
    bounds = {"ModelExchange": {2.0: (1e-4, 1e-4), 3.0: (1e-4, 2e-4)},
              "CoSimulation": {2.0: (1e-3, 1e-3), 3.0: (2e-3, 5e-3)}}
    for kind, at in bounds.items():
        other = run(r2d2[2], kind, 1e-6, input=table, output=POSE, stop_time=3)
        for time, (metres, radians) in at.items():
            rows = (result[np.argmin(abs(result["time"] - time))] for result in (found, other))
            here, there = ([row[name] for name in POSE] for row in rows)
            off = np.abs(np.subtract(here, there))
            assert off[:3].max() < metres and off[3:].max() < radians, (kind, time, off)
    assert abs(found["base.rpy.yaw"][-1]) > 0.2 and found["base.position.y"][-1] > 0.1, "it drives and turns"


@pytest.mark.parametrize("fmi", (2, 3))
def test_a_try_that_a_shorter_step_replaces_is_no_error(fmi, export, command, tmp_path):
    """A double pendulum strikes a limit of 1 rad with 1e9 N.m. Steps that lead far beyond it have no finite derivatives,
    and shorter ones do: nothing failed, and nothing is said. The end is that of co-simulation, another method."""
    inertia = '<mass value="1"/><inertia ixx=".02" iyy=".02" izz=".001" ixy="0" ixz="0" iyz="0"/>'
    link = f'<inertial><origin xyz="0 0 -.25"/>{inertia}</inertial></link>'
    file = tmp_path / "double.urdf"
    file.write_text(f"""<robot name="r"><link name="world"/><link name="a">{link}<link name="b">{link}
        <joint name="j1" type="continuous"><parent link="world"/><child link="a"/><axis xyz="0 1 0"/></joint>
        <joint name="j2" type="revolute"><parent link="a"/><child link="b"/><origin xyz="0 0 -.5"/><axis xyz="0 1 0"/>
        <limit lower="-1" upper="1" effort="1e9" velocity="1e9"/></joint></robot>""")
    settings = """actuator = [{ joint = "*", mode = "none" }]
        initial = { joints = { j1 = 1.5 }, joint_velocities = { j2 = 5.0 } }"""
    names = ["joint.j1.position", "joint.j2.position"]
    ends = []
    for interface in ("me", "cs"):
        fmu = export(file, settings, "--interface", interface, "--fmi", str(fmi))
        found, said = own(command, fmu, tmp_path, None, "--stop-time", 2, "--tolerance", 1e-4)
        assert "error" not in said and "not finite" not in said, said
        assert np.max(found[names[1]]) > 0.999 and np.min(found[names[1]]) > -1.001, "it strikes"
        ends.append([found[name][-1] for name in names])
    assert np.abs(np.subtract(*ends)).max() < 1e-2, ends


@pytest.mark.parametrize("fmi", (2, 3))
def test_simulate_swings_a_pole_as_cvode_does(fmi, command, tmp_path):
    """A smooth system under a force that jumps: the command and CVODE at 1e-8, co-simulation at 1e-6. Under one that
    ramps, too, where FMPy holds the force from point to point: beside SciPy's DOP853, which asks for it anywhere."""
    sys.path.insert(0, str(Path(__file__).parents[2] / "examples/python"))
    import balance

    (tmp_path / "pole.urdf").write_text(balance.URDF)
    (tmp_path / "pole.toml").write_text(balance.SETTINGS)
    fmus = {}
    for interface in ("me", "cs"):
        fmus[interface] = tmp_path / f"{interface}.fmu"
        done = command("export", "--no-documentation", tmp_path / "pole.urdf", "-c", tmp_path / "pole.toml", "-o", fmus[interface],
                       "--interface", interface, "--fmi", fmi)
        assert done.returncode == 0, done.stderr
    names = [f"joint.{joint}.{what}" for what in ("position", "velocity") for joint in ("slide", "hinge")]
    start = {"initial.joint.hinge.position": 0.2}
    more = ["--stop-time", 2, "--tolerance", 1e-8, "--start-value", *next(iter(start.items()))]
    columns = [("time", float), (balance.FORCE, float)]
    jumps = np.array([(0, 4), (0.5, 4), (0.5, -3), (2, -3)], dtype=columns)
    found, _ = own(command, fmus["me"], tmp_path, jumps, *more)
    assert np.ptp(found["joint.hinge.position"]) > 1, "it falls"
    for kind, name, tolerance, bound in (("ModelExchange", "me", 1e-8, 2e-5), ("CoSimulation", "cs", 1e-6, 1e-4)):
        with redirect_stdout(io.StringIO()):
            other = fmpy.simulate_fmu(str(fmus[name]), fmi_type=kind, relative_tolerance=tolerance, stop_time=2,
                                      output_interval=1 / 240, input=jumps, output=names, start_values=start)
        off = [np.abs(found[column][-1] - other[column][-1]) for column in names]
        assert max(off) < bound, (kind, off)
    if fmi == 3:
        return
    ramps = np.array([(0, 0), (0.5, 4), (0.5, -3), (1, -3), (2, 1)], dtype=columns)
    found, _ = own(command, fmus["me"], tmp_path, ramps, *more)
    model, description = instance(fmus["me"], tmp_path / "exchange")
    force = next(v.valueReference for v in description.modelVariables if v.name == balance.FORCE)
    field = Field(model, description)
    x = np.array([0.0, 0.2, 0.0, 0.0])
    for begin, end, first, last in ((0, 0.5, 0, 4), (0.5, 1, -3, -3), (1, 2, -3, 1)):
        def driven(time, x, begin=begin, end=end, first=first, last=last):
            model.setReal([force], [first + (last - first) * (time - begin) / (end - begin)])
            return field(time, x)
        done = solve_ivp(driven, (begin, end), x, method="DOP853", rtol=1e-11, atol=1e-12)
        x = done.y[:, -1]
    off = [abs(found[name][-1] - value) for name, value in zip(names, x, strict=True)]
    assert max(off) < 1e-5, off
    model.freeInstance()


@pytest.mark.parametrize(("fmi", "interface"), [(2, "me"), (3, "me"), (3, "cs")])
def test_view_report_and_simulate_run_it(fmi, interface, pybullet_data, export, command, tmp_path):
    """The page of a run has it whole, and so has one that is made of its table; the view is driven by an input that a
    viewer sets, and back at the start after a reset; a start value that Model Exchange refuses is named."""
    fmu = export(pybullet_data / "r2d2.urdf", "", "--interface", interface, "--fmi", str(fmi))
    page, table, later, record = (tmp_path / name for name in ("run.html", "run.csv", "later.html", "record.csv"))
    done = command("simulate", fmu, "--stop-time", 0.1, "--report", page, "--output-file", table)
    assert done.returncode == 0 and page.stat().st_size > 1e5, done.stderr
    done = command("report", table, "--model", fmu, "-o", later)
    assert done.returncode == 0 and later.stat().st_size > 1e5, done.stderr
    running = Running(fmu, "--record", record)
    try:
        viewer = running.viewer()
        viewer.until(lambda: viewer.time > 0.2)
        viewer.send({"set": {name: 10.0 for name in WHEELS}})
        at = viewer.time
        viewer.until(lambda: viewer.time > at + 0.5)
        assert not viewer.failed
        viewer.send({"reset": True})
        viewer.until(lambda: viewer.time < at)
        viewer.close()
        said = running.end()
    finally:
        running.stop()
    assert "error" not in said, said
    driven = read_csv(record)
    assert driven["time"][-1] > 0.5 and abs(driven["base.position.y"][-1]) > 0.01, driven["base.position.y"]
    done = command("simulate", fmu, "--stop-time", 0.1, "--start-value", "world.ground.restitution", 0.5)
    if interface == "me":
        assert done.returncode == 3 and "world.ground.restitution" in done.stderr, done.stderr
    else:
        assert done.returncode == 0, done.stderr


@pytest.mark.parametrize("fmi", (2, 3))
@pytest.mark.parametrize(("interface", "words"), [
    ("cs", "co-simulation"), ("me", "Model Exchange"), ("both", "co-simulation and Model Exchange")])
def test_info_says_version_interface_and_guid(fmi, interface, words, examples, export, command):
    """As modelDescription.xml has them, by FMPy; of a URDF, what its FMU would have."""
    options = "--interface", interface, "--fmi", str(fmi)
    fmu = export(examples / "arm.urdf", "", *options)
    description = fmpy.read_model_description(str(fmu))
    elements = [name for name, there in (("CoSimulation", description.coSimulation),
                                         ("ModelExchange", description.modelExchange)) if there]
    version = f"{fmi}.0"
    assert description.fmiVersion == version
    told = json.loads(command("info", fmu, "--json").stdout)
    assert (told["fmi"], told["interfaces"], told["guid"]) == (version, elements, description.guid)
    named = {2: "guid", 3: "instantiation token"}[fmi]
    shown = f"\nInterface\n  FMI {version}, {words}"
    assert f"{shown}, {named} {description.guid}\n" in command("info", fmu).stdout
    urdf = examples / "arm.urdf"
    told = json.loads(command("info", urdf, "--json", *options).stdout)
    assert (told["fmi"], told["interfaces"], told["guid"]) == (version, elements, None)
    assert f"{shown}\n" in command("info", urdf, *options).stdout


def test_what_needs_events_is_refused_by_name(examples, command, tmp_path):
    robot = next(examples.rglob("rover.urdf"))
    settings = tmp_path / "bouncing.toml"
    settings.write_text("[world.ground]\nrestitution = 0.5\n")
    for interface in ("me", "both"):
        done = command("export", "--no-documentation", robot, "-c", settings, "-o", tmp_path / "x.fmu", "--interface", interface)
        assert done.returncode != 0 and "A142" in done.stderr and "--interface cs" in done.stderr, done.stderr


def test_a_pole_is_balanced_by_what_its_derivatives_say(tmp_path):
    """A and B beside the closed form of a thin rod on a cart, and the feedback that follows from them."""
    sys.path.insert(0, str(Path(__file__).parents[2] / "examples/python"))
    import balance

    fmu = balance.export(tmp_path)
    A, B, names = balance.linearise(fmu, tmp_path / "exchange")
    assert names == [f"joint.{joint}.{what}" for what in ("position", "velocity") for joint in ("slide", "hinge")]
    m, length, g = balance.POLE, balance.LENGTH / 2, 9.81
    # (M + m) x" + m l a" = u, m l x" + (I + m l^2) a" = m g l a with I = m l^2/3 about the rod's middle
    masses = np.array([[balance.CART + m, m * length], [m * length, 4 / 3 * m * length**2]])
    inverse = np.linalg.inv(masses)
    expected = np.zeros((4, 4))
    expected[:2, 2:] = np.eye(2)
    expected[2:, 1] = inverse @ [0, m * g * length]
    assert np.abs(A - expected).max() < 1e-7 * np.abs(expected).max()
    assert np.abs(B[2:, 0] - inverse[:, 0]).max() < 1e-7
    K = balance.gain(A, B, np.eye(4), np.array([[0.1]]))
    path = balance.balance(fmu, tmp_path / "steps", K, names)
    assert np.abs(path[-1]).max() < 0.01 and path[0, 1] == 0.2


def test_a_robot_on_two_wheels_is_balanced_by_what_its_derivatives_say(tmp_path):
    """A and B of what is left when the contacts have settled, beside the closed form of a body on wheels that roll, as
    near as a contact's stiffness lets it; and the feedback that follows gets the robot up."""
    sys.path.insert(0, str(Path(__file__).parents[2] / "examples/python"))
    import balance

    A, B, K, path = balance.ride(tmp_path)
    m, h, r, g = balance.BODY, balance.HEIGHT, balance.RADIUS, 9.81
    # (m + 2 w + 2 J/r^2) x" + m h a" = t/r, m h x" + (I + m h^2) a" = m g h a - t with the sum t of both torques
    rolling = m + 2 * balance.WHEEL + 2 * balance.WHEEL_INERTIA / r**2
    inverse = np.linalg.inv([[rolling, m * h], [m * h, balance.BODY_INERTIA + m * h**2]])
    expected = np.zeros((4, 4))
    expected[:2, 2:] = np.eye(2)
    expected[2:, 1] = inverse @ [0, m * g * h]
    assert np.abs(A - expected).max() < 1e-5 * np.abs(expected).max(), A - expected
    for column in B.T:
        expected = np.concatenate([[0, 0], inverse @ [1 / r, -1]])
        assert np.abs(column - expected).max() < 2e-5 * np.abs(expected).max(), column - expected
    assert np.linalg.eigvals(A - B @ K).real.max() < 0 < np.linalg.eigvals(A).real.max()
    assert path[0, 1] == pytest.approx(0.15) and np.abs(path[-1]).max() < 0.02, path[-1]


def test_stiff_integrators_of_scipy_find_the_same(r2d2, tmp_path):
    """R2D2 stands and is pushed off by its wheels: Radau's and BDF's ends."""
    ends = []
    for method in ("Radau", "BDF"):
        model, description = instance(r2d2[2], tmp_path / method)
        field = Field(model, description)
        wheels = [v.valueReference for v in description.modelVariables
                  if v.causality == "input" and "wheel" in v.name and v.name.endswith("velocity")]
        model.enterEventMode()
        model.setReal(wheels, [5.0] * len(wheels))
        model.newDiscreteStates()
        model.enterContinuousTimeMode()
        done = solve_ivp(field, (0, 0.3), field.states(), method=method, rtol=1e-6, atol=1e-8)
        assert done.success, done.message
        ends.append(done.y[:3, -1])
        model.freeInstance()
    assert np.abs(ends[0] - ends[1]).max() < 2e-5, ends
