"""Any URDF robot in, a Functional Mock-up Unit out; and the robot as an object that steps.

```python
import urdf2fmu

fmu = urdf2fmu.export("rover.urdf")                      # rover.fmu, for any FMI 2.0 tool
table = urdf2fmu.simulate(fmu, stop_time=2.0)            # a numpy structured array
with urdf2fmu.Simulation(fmu) as robot:
    robot["cmd.*_wheel_joint.velocity"] = 5.0            # a glob sets all that match
    robot.step(1 / 240)
    print(robot["base.position"])                        # array([x, y, z])
```
"""

from ._command import Error, check, command, export, info
from ._fmu import Variable
from ._runs import Page, show, simulate
from ._simulation import Simulation, State

__all__ = ["Error", "Page", "Simulation", "State", "Variable", "check", "command", "export", "info", "show", "simulate"]
