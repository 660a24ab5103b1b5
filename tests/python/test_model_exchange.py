"""Model Exchange: what FMPy's CVODE makes of the derivatives is what co-simulation finds."""

import ctypes
import io
from contextlib import redirect_stdout

import fmpy
import numpy as np
import pytest
from fmpy import fmi2, fmi3

from test_fmi3 import valid


def commanded(description, pieces):
    """A table of wheel speeds that jump: of the left and of the right, rad/s, for pieces of time."""
    names = [v.name for v in description.modelVariables
             if v.causality == "input" and "wheel" in v.name and v.name.endswith("velocity")]
    rows = [(time, *[left if "left" in name else right for name in names])
            for begin, end, left, right in pieces for time in (begin, end)]
    return np.array(rows, dtype=[(name, float) for name in ("time", *names)])


def run(fmu, kind, tolerance=1e-4, **options):
    if kind == "CoSimulation":
        options["start_values"] = {"solver.tolerance": tolerance}
    with redirect_stdout(io.StringIO()):
        return fmpy.simulate_fmu(str(fmu), fmi_type=kind, relative_tolerance=tolerance,
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
    """Of every derivative by every state and by every input, on R2D2 as it stands: beside
    differences that this test takes, with steps of several sizes and the best of them."""
    model, description = instance(r2d2[2], tmp_path)
    field = Field(model, description)
    x = field.states()
    rates = [d.variable.valueReference for d in description.derivatives]
    knowns = [d.variable.derivative for d in description.derivatives]
    for column, known in enumerate(knowns):
        found = np.array(model.getDirectionalDerivative(rates, [known.valueReference], [1.0]))
        best = np.full(len(rates), np.inf)
        for size in (1e-5, 3e-6, 1e-6, 3e-7, 1e-7, 1e-8):
            h = size * float(known.nominal or 1)
            def at(k, h=h):
                y = x.copy()
                y[column] += k * h
                return field(0.0, y)
            by_hand = (8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h)
            best = np.minimum(best, np.abs(found - by_hand))
        field(0.0, x)
        # The digits of the accelerations are shared by all entries of a column.
        scale = np.maximum(np.abs(found), 1e-3 * np.abs(found).max() + 1e-9)
        worst = (best / scale).argmax()
        assert best[worst] < 1e-6 * scale[worst], (
            known.name, description.derivatives[worst].variable.name, best[worst], found[worst], np.abs(found).max())
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
    with pytest.raises(Exception, match="(?i)error"):
        model.doStep(0.0, 0.01) if hasattr(model, "doStep") else model.fmi2DoStep(model.component, 0.0, 0.01, 0)
    with pytest.raises(Exception, match="(?i)error"):
        model.setContinuousStates((ctypes.c_double * field.n)(*(x * np.nan)), field.n)
    model.terminate()
    model.freeInstance()


def test_a_world_exchanges_states_of_pairs(examples, export):
    """A ball on a box: both end as in co-simulation."""
    settings = """
[[world.object]]
box = [0.4, 0.4, 0.2]
name = "step"
mass = 20
[[world.object]]
sphere = 0.1
name = "ball"
mass = 1
pose = [0.02, 0.0, 0.32, 0, 0, 0]
"""
    robot = next(examples.rglob("rover.urdf"))
    fmu = export(robot, settings, "--interface", "both")
    description = fmpy.read_model_description(str(fmu))
    states = [d.variable.derivative.name for d in description.derivatives]
    assert any(name.startswith("object.ball.state.pair_contact") or "state.pair_contact" in name for name in states), states
    name = "object.ball.position.z"
    ends = [run(fmu, kind, output=[name], stop_time=0.5)[name][-1] for kind in ("CoSimulation", "ModelExchange")]
    assert abs(ends[0] - ends[1]) < 1e-4, ends


def test_what_needs_events_is_refused_by_name(examples, command, tmp_path):
    robot = next(examples.rglob("rover.urdf"))
    settings = tmp_path / "bouncing.toml"
    settings.write_text("[world.ground]\nrestitution = 0.5\n")
    for interface in ("me", "both"):
        done = command("export", robot, "-c", settings, "-o", tmp_path / "x.fmu", "--interface", interface)
        assert done.returncode != 0 and "A142" in done.stderr and "--interface cs" in done.stderr, done.stderr
