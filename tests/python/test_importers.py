"""Other importers load, initialise and run our FMUs, and get the bits of `urdf2fmu simulate` from the same steps."""

import importlib.util
import subprocess
import sys
from pathlib import Path

import fmpy
import pytest
from fmpy.util import read_csv

HERE = Path(__file__).resolve().parent
PACKAGES = {"libcosim_run.py": "libcosimpy", "ecos_run.py": "ecospy"}
STEPS, STEP = 64, 1 / 64  # s; exact in nanoseconds, which libcosim counts


@pytest.fixture(params=["r2d2", "iiwa", "quadruped"])
def fmu(request, export, pybullet_data, examples):
    """An FMU and values for its start: every command is off its start value."""
    urdf, settings = {
        "r2d2": (pybullet_data / "r2d2.urdf", ""),
        "iiwa": (pybullet_data / "kuka_iiwa/model.urdf", ""),
        "quadruped": (examples / "quadruped.urdf", (examples / "quadruped.toml").read_text()),
    }[request.param]
    path = export(urdf, settings)
    inputs = [v for v in fmpy.read_model_description(str(path)).modelVariables if v.causality == "input"]
    values = {v.name: float(v.start) + 0.4 for v in inputs if v.name.endswith((".velocity", ".position"))}
    return path, values


@pytest.mark.parametrize("program", PACKAGES)
def test_an_importer_gets_the_bits_of_simulate(fmu, program, command, tmp_path):
    if importlib.util.find_spec(PACKAGES[program]) is None:
        pytest.skip(f"{PACKAGES[program]} has no wheel for this Python or system")
    path, values = fmu
    pairs = [part for name, value in values.items() for part in (name, str(value))]
    done = subprocess.run([sys.executable, HERE / "importers" / program, path, str(STEPS), str(STEP), *pairs],
                          capture_output=True, text=True, timeout=120, check=False)
    assert done.returncode == 0, done.stdout[-2000:] + done.stderr[-2000:]
    # libcosim logs on standard output, in lines that begin with a bracket.
    found = dict(line.rsplit(" ", 1) for line in done.stdout.splitlines() if line and not line.startswith("["))

    start = [part for name, value in values.items() for part in ("--start-value", name, str(value))]
    done = command("simulate", path, "--stop-time", str(STEPS * STEP), "--output-interval", str(STEP),
                   "--output-file", tmp_path / "out.csv", *start)
    assert done.returncode == 0, done.stderr
    results = read_csv(tmp_path / "out.csv")
    assert len(results) == STEPS + 1
    reals = {v.name for v in fmpy.read_model_description(str(path)).modelVariables
             if v.causality == "output" and v.type == "Real"}
    assert set(found) == reals
    different = {name: (value, results[name][-1].hex()) for name, value in found.items()
                 if float.fromhex(value) != results[name][-1]}
    assert not different
