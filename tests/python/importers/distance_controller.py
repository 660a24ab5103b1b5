"""A controller to be exported by PythonFMU: drives to a distance, with a memory of its own."""

from pythonfmu import Fmi2Causality, Fmi2Slave, Real


class DistanceController(Fmi2Slave):
    """Speed of the wheels from where the robot is: proportional, with a rate limit."""

    author = "urdf2fmu"
    description = "Speed of the wheels from where the robot is"

    def __init__(self, **arguments):
        super().__init__(**arguments)
        self.position = 0.0
        self.speed = 0.0
        self.register_variable(Real("position", causality=Fmi2Causality.input, start=0.0))
        self.register_variable(Real("speed", causality=Fmi2Causality.output))

    def do_step(self, current_time, step_size):
        """At most 20 rad/s², at most 8 rad/s."""
        wanted = max(-8.0, min(8.0, 15.0 * (0.5 - self.position)))
        change = 20.0 * step_size
        self.speed += max(-change, min(change, wanted - self.speed))
        return True
