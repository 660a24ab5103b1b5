"""Simulates an FMU with Ecos (fmi4c) and prints every real output at the end as `name hexadecimal`.

Usage: python ecos_run.py FMU STEPS STEP_SIZE [NAME VALUE]…

The values hold from initialisation on.
"""

import ctypes
import importlib.util
import stat
import sys
from pathlib import Path

# The wheel leaves out the execute bit of its programs, and expects TBB where the loader does not look.
for program in (Path(importlib.util.find_spec("ecospy").origin).parent / "binaries").iterdir():
    program.chmod(program.stat().st_mode | stat.S_IXUSR)
ctypes.CDLL(str(Path(sys.prefix) / "lib" / "libtbb.so.12"), mode=ctypes.RTLD_GLOBAL)

from ecospy import EcosSimulation, EcosSimulationStructure  # noqa: E402
from ecospy.EcosParameterSet import EcosParameterSet  # noqa: E402
from fmpy import read_model_description  # noqa: E402

fmu, steps, step_size, *pairs = sys.argv[1:]
values = {f"robot::{name}": float(value) for name, value in zip(pairs[::2], pairs[1::2])}
with EcosSimulationStructure() as structure:
    structure.add_model("robot", fmu)
    parameters = EcosParameterSet()
    for name, value in values.items():
        parameters.add_real(name, value)
    structure.add_parameter_set("start", parameters)
    with EcosSimulation(structure=structure, step_size=float(step_size)) as simulation:
        assert simulation.init(parameter_set="start"), "initialisation failed"
        for _ in range(int(steps)):
            simulation.step()
        for variable in read_model_description(fmu).modelVariables:
            if variable.causality == "output" and variable.type == "Real":
                print(variable.name, float(simulation.get_real(f"robot::{variable.name}")).hex())
