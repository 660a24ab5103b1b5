"""Directional derivatives: of every output and derivative by every state and input, beside differences taken here.

Both versions of FMI; a robot on its wheels, a joint of each mode of motor, and a world.
"""

import ctypes
import io
import re
from contextlib import redirect_stdout
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy import fmi2, fmi3

LINKS = "[outputs]\nlinks = [\"*\"]\n"

MODES = """
[robot]
self_collision = false
[[actuator]]
joint = "left_front_wheel_joint"
mode = "velocity"
[[actuator]]
joint = "left_rear_wheel_joint"
mode = "position"
[[actuator]]
joint = "right_front_wheel_joint"
mode = "effort"
[[actuator]]
joint = "right_rear_wheel_joint"
mode = "pd"
kp = 5.0
kd = 0.3
[[actuator]]
joint = "head_joint"
mode = "none"
[joint.head_joint]
friction = 0.05
damping = 0.02
[[external_wrench]]
link = "base_link"
[[sensor]]
type = "imu"
link = "base_link"
[[sensor]]
type = "ft"
name = "neck"
joint = "head_joint"
[outputs]
links = ["*"]
contact_points = true
"""

WORLD = """
[[external_wrench]]
link = "base_link"
[[world.object]]
name = "step"
shape = { box = [0.4, 0.4, 0.2] }
mass = 20
xyz = [2.0, 0.0, 0.1]
[[world.object]]
name = "belt"
shape = { box = [4, 4, 0.1] }
static = true
conveyor = true
xyz = [0, 0, -0.05]
[[world.object]]
name = "ball"
shape = { sphere = 0.1 }
mass = 1
friction = 0.01
xyz = [2.02, 0.0, 0.2999]
[[outputs.pair]]
name = "stand"
first = "ball"
second = "step"
"""


class Exchange:
    """An instance for Model Exchange of either version in continuous-time mode, its variables by FMI 2's names."""

    def __init__(self, fmu, folder):
        self.description = fmpy.read_model_description(str(fmu))
        self.new = self.description.fmiVersion.startswith("3")
        options = {"guid": self.description.guid, "unzipDirectory": fmpy.extract(str(fmu), unzipdir=str(folder)),
                   "modelIdentifier": self.description.modelExchange.modelIdentifier, "instanceName": "one"}
        self.model = (fmi3.FMU3Model if self.new else fmi2.FMU2Model)(**options)
        self.model.instantiate()
        if self.new:
            self.model.enterInitializationMode()
        else:
            self.model.setupExperiment()
            self.model.enterInitializationMode()
        self.model.exitInitializationMode()
        if self.new:
            self.model.updateDiscreteStates()
        else:
            self.model.newDiscreteStates()
        self.model.enterContinuousTimeMode()
        text = Path(options["unzipDirectory"], "modelDescription.xml").read_text()
        lines = [line.split() for block in re.findall(r"<Annotation [^>]*>(.*?)</Annotation>", text, re.S)
                 for line in block.splitlines()]
        self.elements = {int(reference): names for reference, *names in lines}
        self.n = sum(self.size(d.variable) for d in self.description.derivatives)
        self.buffer = (ctypes.c_double * self.n)()
        self.rates = self.scalars(d.variable for d in self.description.derivatives)
        self.states = self.scalars(d.variable.derivative for d in self.description.derivatives)
        every = self.description.modelVariables
        self.inputs = self.scalars(v for v in every if v.causality == "input")
        self.outputs = self.scalars(v for v in every if v.causality == "output" and v.type in ("Real", "Float64"))

    @staticmethod
    def size(variable):
        return int(np.prod([int(dimension.start) for dimension in variable.dimensions or ()]))

    def scalars(self, variables):
        """(value reference, place in it, variable) of each element."""
        return [(v.valueReference, place, v) for v in variables for place in range(self.size(v))]

    def names(self, scalars):
        """FMI 2's names."""
        return [self.elements[reference][place] if reference in self.elements else v.name
                for reference, place, v in scalars]

    def get(self, wanted):
        """Values of scalars, read as whole arrays."""
        references = list(dict.fromkeys(reference for reference, _, _ in wanted))
        if not self.new:
            return np.array(self.model.getReal(references))
        sizes = {v.valueReference: self.size(v) for _, _, v in wanted}
        return np.array(self.model.getFloat64(references, nValues=sum(sizes[r] for r in references)))

    def set_input(self, index, value):
        reference, place, variable = self.inputs[index]
        assert self.size(variable) == 1 and place == 0, "inputs are scalars"
        (self.model.setFloat64 if self.new else self.model.setReal)([reference], [value])

    def state(self):
        self.model.getContinuousStates(self.buffer, self.n)
        return np.array(self.buffer)

    def at(self, x):
        """Derivatives, then outputs, at the states x."""
        self.model.setContinuousStates((ctypes.c_double * self.n)(*x), self.n)
        (self.model.getContinuousStateDerivatives if self.new else self.model.getDerivatives)(self.buffer, self.n)
        return np.concatenate([np.array(self.buffer), self.get(self.outputs)])

    def directional(self, unknowns, known):
        """Of all unknowns along one element of a known."""
        reference, place, variable = known
        seeds = [0.0] * self.size(variable)
        seeds[place] = 1.0
        references = list(dict.fromkeys(r for r, _, _ in unknowns))
        if self.new:
            return self.model.getDirectionalDerivative(references, [reference], seeds, nSensitivity=len(unknowns))
        return self.model.getDirectionalDerivative(references, [reference], seeds)

    def end(self):
        self.model.terminate()
        self.model.freeInstance()


MOVING = {"initial.object.ball.linear_velocity.x": 0.2, "initial.object.ball.linear_velocity.y": 0.1,
          "initial.object.ball.angular_velocity.z": 0.5}
"""Parameters of the world: the ball slides."""

CASES = {"r2d2": ("r2d2.urdf", LINKS), "modes": ("rover.urdf", MODES), "world": ("rover.urdf", WORLD)}


def made(name, fmi, pybullet_data, examples, export, *options):
    file, settings = CASES[name]
    urdf = pybullet_data / file if name == "r2d2" else examples / file
    return export(urdf, settings, "--interface", "both", "--fmi", str(fmi), *options)


@pytest.fixture(scope="module")
def driven(pybullet_data, examples, export):
    """Inputs by chance, and the states that they have led to after 0.2 s, by FMPy's CVODE: away from the kinks of the
    laws, at which robots start and rest."""
    found = {}

    def run(name):
        if name in found:
            return found[name]
        fmu = made(name, 2, pybullet_data, examples, export)
        description = fmpy.read_model_description(str(fmu))
        random = np.random.default_rng(1)
        inputs = {}
        for v in description.modelVariables:
            if v.causality != "input":
                continue
            start = float(v.start)
            if v.name.endswith("max_effort"):
                inputs[v.name] = 0.9 * start
            elif v.name.endswith("velocity") and v.name.startswith("cmd."):
                inputs[v.name] = random.uniform(1, 3)
            elif v.name.startswith("ext."):
                # Presses a side down: at a roll of 0 a wheel goes over from one edge to the other.
                inputs[v.name] = random.uniform(1, 3)
            else:
                inputs[v.name] = start + random.uniform(0.01, 0.05) * (-1 if v.max and start >= float(v.max) else 1)
        states = [d.variable.derivative.name for d in description.derivatives]
        with redirect_stdout(io.StringIO()):
            path = fmpy.simulate_fmu(str(fmu), fmi_type="ModelExchange", stop_time=0.2, relative_tolerance=1e-6,
                                     output=states, start_values=inputs | (MOVING if name == "world" else {}))
        found[name] = inputs, {state: path[state][-1] for state in states}
        return found[name]

    return run


def brought(exchange, inputs, states):
    """Sets the inputs; gives the states in the order of the file."""
    for index, name in enumerate(exchange.names(exchange.inputs)):
        exchange.set_input(index, inputs[name])
    return np.array([states[name] for name in exchange.names(exchange.states)])


@pytest.mark.parametrize("name", CASES)
def test_derivatives_are_those_of_differences(name, driven, pybullet_data, examples, export, tmp_path):
    """To a millionth of the largest one of the same unit along that direction, and to what the last digits of the
    states make of the values."""
    exchange = Exchange(made(name, 2, pybullet_data, examples, export), tmp_path / "2")
    unknowns = exchange.rates + exchange.outputs
    knowns = exchange.states + exchange.inputs
    x = brought(exchange, *driven(name))
    inputs = [driven(name)[0][known] for known in exchange.names(exchange.inputs)]
    there = exchange.at(x)
    kept = exchange.state()
    found = np.array([exchange.directional(unknowns, known) for known in knowns]).T
    assert np.array_equal(exchange.state(), kept), "nothing has changed"
    # Values of the same unit are compared with one another: metres do not hide behind newtons.
    units = np.array([(v.unit or "") + (" of a state" if row < exchange.n else "")
                      for row, (_, _, v) in enumerate(unknowns)])
    random = np.random.default_rng(2)

    scale = np.zeros(len(units))
    for unit in set(units):
        # Accelerations are what is left of others, gravity for one.
        usual = {"m/s2": 9.81, "rad/s2": 98.1}.get(unit.removesuffix(" of a state"), 0.0)
        scale[units == unit] = max(usual, np.abs(there[units == unit]).max())
    best = np.full(found.shape, np.inf)
    digits = np.zeros(found.shape)
    for column, (_, _, known) in enumerate(knowns):
        is_state = column < exchange.n
        reach = float(known.nominal or 1) if is_state else 1.0

        def moved(by, column=column, is_state=is_state):
            """All values where one of the knowns is elsewhere, and by how much it is, to the last digit."""
            old = x[column] if is_state else inputs[column - exchange.n]
            new = old + by
            if is_state:
                y = x.copy()
                y[column] = new
                return exchange.at(y), new - old
            exchange.set_input(column - exchange.n, new)
            return exchange.at(x), new - old

        for size in (3e-6, 1e-6, 3e-7, 1e-7):
            h = size * reach
            by_hand = (8 * (moved(h)[0] - moved(-h)[0]) - (moved(2 * h)[0] - moved(-2 * h)[0])) / (12 * h)
            best[:, column] = np.minimum(best[:, column], np.abs(found[:, column] - by_hand))
        # What the last digits make of values: how far they are from a parabola.
        h = 3e-7 * reach
        bend = (moved(h)[0] + moved(-h)[0] - 2 * there) / h**2
        for share in random.uniform(-1, 1, 16):
            values, by = moved(share * h)
            off = np.abs(values - there - found[:, column] * by - 0.5 * bend * by**2)
            digits[:, column] = np.maximum(digits[:, column], 2 * off / h)
        # And of those of the same unit.
        digits[:, column] = np.maximum(digits[:, column], 2.0**-52 * scale / h)
        if not is_state:
            exchange.set_input(column - exchange.n, inputs[column - exchange.n])
    largest = np.zeros_like(found)
    for unit in set(units):
        rows = units == unit
        largest[rows] = np.abs(found[rows]).max(axis=0)
    allowed = 1e-6 * largest + digits + 1e-15
    row, column = np.unravel_index((best / allowed).argmax(), best.shape)
    assert (best <= allowed).all(), (
        knowns[column][2].name, unknowns[row][2].name, best[row, column], found[row, column], allowed[row, column])
    # The digits hide little: three in four of those that are not zero are compared to a millionth.
    counted = np.abs(found) > np.maximum(1e-3 * largest, digits)
    share = np.mean(digits[counted] < 1e-6 * largest[counted])
    assert share > 0.7 and counted.sum() > 1000, (share, counted.sum())
    # Inputs do something, and outputs show it.
    moves = np.abs(found[:, exchange.n:])
    assert (moves[:exchange.n].max(axis=0) > 0).mean() > 0.4 and (moves[exchange.n:].max(axis=0) > 0).mean() > 0.4
    exchange.end()


@pytest.mark.parametrize("name", CASES)
@pytest.mark.parametrize("arrays", ["vectors", "none"])
def test_fmi_3_gives_the_bits_of_fmi_2(name, arrays, driven, pybullet_data, examples, export, tmp_path):
    found = []
    for fmi, options in ((2, ()), (3, ("--arrays", arrays))):
        exchange = Exchange(made(name, fmi, pybullet_data, examples, export, *options), tmp_path / str(fmi))
        exchange.at(brought(exchange, *driven(name)))
        unknowns, knowns = exchange.rates + exchange.outputs, exchange.states + exchange.inputs
        names = exchange.names(unknowns)
        found.append({(name, of): value for name, known in zip(exchange.names(knowns), knowns)
                      for of, value in zip(names, exchange.directional(unknowns, known), strict=True)})
        exchange.end()
    assert found[0] == found[1] and len(found[0]) > 5000


@pytest.mark.parametrize("fmi", (2, 3))
def test_along_several_knowns_the_derivative_is_their_sum(fmi, driven, pybullet_data, examples, export, tmp_path):
    """To a millionth, again: a derivative is linear in the direction."""
    exchange = Exchange(made("modes", fmi, pybullet_data, examples, export, *(("--arrays", "none") if fmi == 3 else ())),
                        tmp_path)
    exchange.at(brought(exchange, *driven("modes")))
    unknowns, knowns = exchange.rates + exchange.outputs, exchange.states + exchange.inputs
    matrix = np.array([exchange.directional(unknowns, known) for known in knowns]).T
    random = np.random.default_rng(4)
    seeds = random.normal(size=len(knowns)) * [float(v.nominal or 1) if i < exchange.n else 1
                                               for i, (_, _, v) in enumerate(knowns)]
    found = np.array(exchange.model.getDirectionalDerivative([u[0] for u in unknowns], [k[0] for k in knowns], list(seeds)))
    expected = matrix @ seeds
    # Of the sum's largest part in each row.
    size = np.abs(matrix * seeds).max(axis=1)
    assert (np.abs(found - expected) <= 1e-6 * size.max() * 1e-3 + 2e-6 * size + 1e-12).all(), np.max(
        np.abs(found - expected) / (size + 1e-12))
    exchange.end()


@pytest.mark.parametrize("fmi", (2, 3))
def test_a_co_simulation_has_none_and_says_so(fmi, pybullet_data, examples, export, tmp_path):
    """Its outputs do not depend on its inputs at a communication point: the description promises none, and a call is
    an error."""
    fmu = made("modes", fmi, pybullet_data, examples, export)
    description = fmpy.read_model_description(str(fmu))
    flag = "providesDirectionalDerivative" if fmi == 2 else "providesDirectionalDerivatives"
    text = Path(fmpy.extract(str(fmu), unzipdir=str(tmp_path)), "modelDescription.xml").read_text()
    of = {kind: text.split(f"<{kind}")[1].split(">")[0] for kind in ("ModelExchange", "CoSimulation")}
    assert f'{flag}="true"' in of["ModelExchange"]
    assert f'{flag}="true"' not in of["CoSimulation"]
    said = []
    options = {"guid": description.guid, "unzipDirectory": str(tmp_path), "instanceName": "one",
               "modelIdentifier": description.coSimulation.modelIdentifier}
    if fmi == 2:
        slave = fmi2.FMU2Slave(**options)
        slave.instantiate()
        slave.setupExperiment()
    else:
        slave = fmi3.FMU3Slave(**options)
        slave.instantiate(logMessage=lambda _e, _s, _c, text: said.append(text))
    slave.enterInitializationMode()
    slave.exitInitializationMode()
    names = {v.name: v for v in description.modelVariables}
    output, known = names["energy.kinetic"], names["cmd.right_front_wheel_joint.effort"]
    with pytest.raises(Exception, match="(?i)error"):
        slave.getDirectionalDerivative([output.valueReference], [known.valueReference], [1.0])
    slave.freeInstance()


@pytest.mark.parametrize("mass", (0.01, 5.0, 50e3))
def test_derivatives_by_efforts_have_their_digits_whatever_the_weight(mass, export, tmp_path):
    """Of a swinging double arm whose links have this mass, kg. Accelerations are linear in efforts, so a difference
    over efforts as large as the weight is right to round-off. With an increment of 3e-7 N m, whatever the weight,
    arms of tonnes were off by 1e-3."""
    inertia = mass * 0.03
    link = "".join(f'''<link name="l{i}"><inertial><origin xyz="0 0 -0.3"/><mass value="{mass}"/>
        <inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial></link>
        <joint name="j{i}" type="continuous"><parent link="{'base' if i == 0 else f'l{i - 1}'}"/><child link="l{i}"/>
        <origin xyz="0 0 -{0.6 * i}"/><axis xyz="0 1 0"/></joint>''' for i in range(2))
    file = tmp_path / "arm.urdf"
    file.write_text(f'<robot name="arm"><link name="base"/>{link}</robot>')
    fmu = export(file, "", "--interface", "me", "--mode", "effort", "--fixed-base")
    exchange = Exchange(fmu, tmp_path / "fmu")
    rates, count = exchange.rates, len(exchange.rates)
    x = np.random.default_rng(3).uniform(-1, 1, exchange.n)
    exchange.at(x)
    weight = 9.81 * mass
    for index, known in enumerate(exchange.inputs):
        found = np.array(exchange.directional(rates, known))
        ends = []
        for effort in (weight, -weight):
            exchange.set_input(index, effort)
            ends.append(exchange.at(x)[:count])
        exchange.set_input(index, 0.0)
        exchange.at(x)
        expected = (ends[0] - ends[1]) / (2 * weight)
        assert np.abs(found - expected).max() < 1e-6 * np.abs(expected).max(), (known[2].name, found, expected)
    exchange.end()
