"""Simulates an FMU with OSP's libcosim and prints every real output at the end as `name hexadecimal`.

Usage: python libcosim_run.py FMU STEPS STEP_SIZE [NAME VALUE]…

The values hold from initialisation on.
"""

import sys

from libcosimpy.CosimEnums import CosimVariableCausality, CosimVariableType
from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave

fmu, steps, step_size, *pairs = sys.argv[1:]
# libcosim counts nanoseconds.
execution = CosimExecution.from_step_size(step_size=round(float(step_size) * 1e9))
slave = execution.add_local_slave(CosimLocalSlave(fmu_path=fmu, instance_name="robot"))
observer = CosimObserver.create_last_value()
assert execution.add_observer(observer=observer)
variables = execution.slave_variables(slave)
reference = {variable.name.decode(): variable.reference for variable in variables}
for name, value in zip(pairs[::2], pairs[1::2]):
    assert execution.real_initial_value(slave, reference[name], float(value)), name
for _ in range(int(steps)):
    assert execution.step(1), "a step failed"
outputs = [v for v in variables if v.type == CosimVariableType.REAL.value and v.causality == CosimVariableCausality.OUTPUT.value]
values = observer.last_real_values(slave, [v.reference for v in outputs])
for variable, value in zip(outputs, values):
    print(variable.name.decode(), float(value).hex())
