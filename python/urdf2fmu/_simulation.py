"""An FMU that is stepped from Python, through the C functions of its own library."""

from __future__ import annotations

import ctypes
import math
import tempfile
import threading
import weakref
from collections.abc import Iterator, Mapping
from pathlib import Path
from types import TracebackType
from types import MappingProxyType
from typing import Any, NamedTuple, SupportsFloat

import numpy as np
import numpy.typing as npt

from . import _functions
from ._command import Error, Option, PathLike, Settings, export, warn
from ._fmu import Fmu, Variable, is_fmu, load
from ._values import by_name, matches, meant, number, one_each, start_names, text

_CAUSALITIES = "input", "output", "parameter", "calculatedParameter", "structuralParameter", "local", "independent"
_WARNING = 1
_PATIENCE = 1.0
"""s, for which the end of Python waits for a call that is under way in another thread"""


class State(NamedTuple):
    """A saved state: it can be restored any number of times, and pickled."""

    time: float
    """s"""
    data: bytes
    """What the FMU wrote."""


class _Place(NamedTuple):
    """What a name means."""

    names: list[str]
    parts: list[_functions.Part]
    single: bool
    """Whether it is the name of one variable."""


class Simulation:
    """A robot that is simulated step by step.

    A name is that of a variable, the stem of a vector (`base.position` is x, y, z; `base.orientation` x, y, z, w;
    `base.rpy` roll, pitch, yaw; `sensor.lidar.ray` all rays), or a glob (`joint.*.position`) for all that match, in
    the order of `names()`. Reading gives a number for the first and arrays for the others; setting takes a number for
    all, or one for each.

    ```python
    with urdf2fmu.Simulation("rover.urdf") as robot:
        robot["cmd.*_wheel_joint.velocity"] = 5.0
        robot.step(1 / 240)
        print(robot["base.position"])
    ```

    Simulations of one FMU share its library. Each may run in a thread of its own: the library works without Python's
    lock.
    """

    def __init__(self, robot: PathLike, *, start_values: Mapping[str, npt.ArrayLike] | None = None,
                 start_time: float = 0.0, tolerance: float | None = None, config: Settings | None = None,
                 **options: Option) -> None:
        """Loads and initialises.

        Args:
            robot: an FMU, or a robot that is exported for the time being.
            start_values: parameters and inputs by name, stem or glob; they hold again after `reset`.
            start_time: s.
            tolerance: relative; without it the FMU's.
            config, options: as of `export`, if `robot` is no FMU.

        Raises:
            Error: if the robot is refused, or a start value.
        """
        self._instance: ctypes.c_void_p | None = None
        # Two threads at one simulation wait for each other, and none finds it closed in the middle of a call.
        self._lock = threading.RLock()
        self._messages: list[tuple[int, str]] = []
        self._places: dict[str, _Place] = {}
        if is_fmu(robot):
            if config is not None or options:
                raise Error("an FMU has its settings inside; options are for a URDF")
            self._fmu: Fmu = load(robot)
        else:
            with tempfile.TemporaryDirectory(prefix="urdf2fmu-") as folder:
                self._fmu = load(export(robot, Path(folder, "robot.fmu"), config=config,
                                         **{"no_documentation": True, **options}))
        self._start_values = by_name("start values", start_values)
        self._start_time = number("the start time", start_time)
        self._tolerance = None if tolerance is None else number("the tolerance", tolerance)
        self._time = self._start_time
        self._begin()

    def _begin(self) -> None:
        messages = self._messages
        self._functions = _functions.of(self._fmu, lambda status, text: messages.append((status, text)))
        made = self._functions.instantiate()
        if not made:
            raise Error(self._told("instantiation"))
        self._instance = ctypes.c_void_p(made)
        # Holds the library until the instance is freed, also at the end of Python.
        self._free = weakref.finalize(self, _free, self._functions, self._instance, self._lock)
        self._fmu.instances.add(made)
        try:
            self._initialize()
        except BaseException:
            self.close()
            raise

    def _initialize(self) -> None:
        self._functions.initialize(self._call, self._tolerance, self._start_time, self._set_start_values)
        self._time = self._start_time

    def _set_start_values(self) -> None:
        causalities = {name: v.causality for name, v in self._fmu.variables.items()}
        for name, value in self._start_values.items():
            names = start_names(causalities, name)
            self._set(name, self._place_of(names, names == [name]), value)

    def _told(self, function: str) -> str:
        """What the FMU has said, as one text."""
        return "; ".join(text for _, text in self._messages) or f"{function} failed"

    def _call(self, function: str, *arguments: Any) -> None:
        name = self._functions.prefix + function
        with self._lock:
            # The end of Python frees it while threads go on.
            if self._instance is None or not self._free.alive:
                raise Error("the simulation is closed")
            self._messages.clear()
            status = getattr(self._fmu.functions, name)(self._instance, *arguments)
            failed = self._told(name) if status > _WARNING else ""
            # What the FMU warns of is no failure: most functions return OK with it.
            warned = [told for said, told in self._messages if said == _WARNING]
            if status == _WARNING and not warned:
                warned = [self._told(name)]
        if failed:
            raise Error(failed)
        for told in warned:
            warn(told)

    @property
    def time(self) -> float:
        """s; the time that the simulation has come to"""
        return self._time

    @property
    def variables(self) -> Mapping[str, Variable]:
        """All variables by their names; they are those of all simulations of the FMU, and cannot be changed."""
        return MappingProxyType(self._fmu.variables)

    def names(self, pattern: str = "*", *, causality: str | None = None) -> list[str]:
        """Names of variables, in the order of the FMU.

        Args:
            pattern: a glob: `*` any characters, `?` one; brackets are those of names.
            causality: "input", "output", "parameter" or another of FMI's; without it all.

        Raises:
            Error: if there is no such causality. A pattern that nothing matches gives an empty list.
        """
        if causality is not None and causality not in _CAUSALITIES:
            raise Error(f"there is no causality {causality!r}; there are {', '.join(_CAUSALITIES)}")
        pattern = text("a pattern", pattern)
        return [v.name for v in self._fmu.variables.values()
                if matches(pattern, v.name) and causality in (None, v.causality)]

    def __contains__(self, name: object) -> bool:
        """Whether a name, stem or glob means something."""
        try:
            return isinstance(name, str) and bool(self._place(name).names)
        except Error:
            return False

    def __iter__(self) -> Iterator[str]:
        """Names of all variables."""
        return iter(self.names())

    def _place(self, name: str) -> _Place:
        known = self._places.get(text("a variable's name", name))
        if known is not None:
            return known
        names = meant(self._fmu.variables, name)
        self._places[name] = place = self._place_of(names, names == [name])
        return place

    def _place_of(self, names: list[str], single: bool) -> _Place:
        return _Place(names, _functions.parts([self._fmu.variables[name] for name in names]), single)

    def __getitem__(self, name: str) -> Any:
        """The value of one variable, or an array of those behind a stem or glob."""
        place = self._place(name)
        values: npt.NDArray[Any] = np.empty(len(place.names))
        for part in place.parts:
            some = self._functions.get(self._call, part)
            if place.single:
                number = some[int(part.inside[0])]
                return bool(number) if part.kind == "Boolean" else number
            values[part.where] = np.array(some)[part.inside]
        if len(place.parts) == 1 and place.parts[0].kind == "Boolean":
            return values.astype(bool)
        return values

    def __setitem__(self, name: str, value: npt.ArrayLike) -> None:
        """Sets one variable, or all behind a stem or glob: to one number, or to one each."""
        self._set(name, self._place(name), value)

    def _set(self, name: str, place: _Place, value: npt.ArrayLike) -> None:
        given = one_each(name, place.names, value)
        for part in place.parts:
            some_given = given[part.where]
            if part.kind != "Real" and not np.all((some_given == np.round(some_given)) & (abs(some_given) < 2**31)):
                raise Error(f"'{name}' takes whole numbers of 32 bits, not {value!r}")
            values = some_given.tolist()
            values = values if part.kind == "Real" else [int(one) for one in values]
            self._functions.set(self._call, part, values)

    def step(self, duration: SupportsFloat) -> None:
        """Simulates so many seconds; inputs keep their values meanwhile.

        Raises:
            Error: if the FMU refuses the step; after a failure only `reset`, `restore` and `close` help.
        """
        seconds = number("a step", duration)
        if not (math.isfinite(seconds) and seconds > 0):
            raise Error(f"a step takes a positive time, not {duration!r} s")
        with self._lock:
            begin = self.time
            try:
                self._functions.step(self._call, begin, seconds)
            except Error:
                raise
            except BaseException:
                # Ctrl-C, or a warning that is made an error: only the FMU knows whether it has taken the step.
                self._time = self._functions.reached(self._call, begin)
                raise
            self._time = begin + seconds

    def reset(self, start_values: Mapping[str, npt.ArrayLike] | None = None) -> None:
        """Back to the start.

        Args:
            start_values: in place of those of the constructor; they hold from now on.

        Raises:
            Error: if a start value is refused; the simulation is then at the start with those of before.
        """
        with self._lock:
            before = self._start_values
            if start_values is not None:
                self._start_values = by_name("start values", start_values)
            try:
                self._call("Reset")
                self._initialize()
            except Error:
                if self._start_values is not before:
                    self._start_values = before
                    self._call("Reset")
                    self._initialize()
                raise

    def save(self) -> State:
        """The present state, of which `restore` continues with the same bits."""
        get, length, write, _, _, free = self._functions.save
        pointer = ctypes.c_void_p()
        with self._lock:
            self._call(get, ctypes.byref(pointer))
            try:
                size = ctypes.c_size_t()
                self._call(length, pointer, ctypes.byref(size))
                data = ctypes.create_string_buffer(size.value)
                self._call(write, pointer, data, size)
            finally:
                self._call(free, ctypes.byref(pointer))
            return State(self.time, data.raw)

    def restore(self, state: State) -> None:
        """Back to a saved state, also of another simulation of the same FMU.

        Raises:
            Error: if it is of another FMU, or damaged.
        """
        if not isinstance(state, State):
            raise Error(f"restore takes what save has given, not {state!r:.60}")
        saved = number("the time of a saved state", state.time)
        if not isinstance(state.data, (bytes, bytearray)):
            raise Error(f"the data of a saved state are bytes, not {state.data!r:.60}")
        _, _, _, read, put, free = self._functions.save
        pointer = ctypes.c_void_p()
        data = bytes(state.data)
        with self._lock:
            self._call(read, data, ctypes.c_size_t(len(data)), ctypes.byref(pointer))
            try:
                self._call(put, pointer)
                # The state has a time of its own, whatever the tuple says.
                self._time = self._functions.reached(self._call, saved)
            finally:
                self._call(free, ctypes.byref(pointer))

    def close(self) -> None:
        """Ends the simulation; a second time it does nothing."""
        with self._lock:
            if self._instance is not None:
                self._instance = None
                self._free()

    def __reduce__(self) -> str | tuple[Any, ...]:
        # A copy would call the same instance, also when it is freed.
        raise TypeError("a Simulation cannot be copied or pickled; what save() gives can, for another Simulation")

    def __enter__(self) -> Simulation:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()


def _free(functions: _functions.Functions, instance: ctypes.c_void_p, lock: threading.RLock) -> None:
    """Frees an instance, unless a thread is still in a call to it at the end of Python, which ends it anyway."""
    if not lock.acquire(timeout=_PATIENCE):
        return
    try:
        getattr(functions.fmu.functions, functions.prefix + "FreeInstance")(instance)
        functions.fmu.instances.discard(instance.value)
    finally:
        lock.release()
