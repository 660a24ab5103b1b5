"""The C functions of an instance, the same for FMI 2.0 and 3.0."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np
import numpy.typing as npt

from ._command import Error
from ._fmu import Fmu, Variable

_LAST_SUCCESSFUL_TIME = 2
"""`fmi2LastSuccessfulTime`"""

Call = Callable[..., None]
"""Calls a function by its name without "fmi2" or "fmi3", and raises what it complains of."""


class Part(NamedTuple):
    """Variables of one type behind a name: FMI 3 gets and sets their arrays whole."""

    kind: str
    """"Real", "Integer" or "Boolean"."""
    references: Any
    """Of all scalars and arrays, each once."""
    length: int
    """Number of all their elements."""
    inside: npt.NDArray[np.intp]
    """Places of the variables among these elements."""
    where: npt.NDArray[np.intp]
    """Their places among all variables behind the name."""


def parts(variables: Sequence[Variable]) -> list[Part]:
    """The variables, type by type."""
    found = []
    for kind in ("Real", "Integer", "Boolean"):
        where = [i for i, v in enumerate(variables) if v.kind == kind]
        begins: dict[int, int] = {}
        inside, length = [], 0
        for variable in (variables[i] for i in where):
            if variable.reference not in begins:
                begins[variable.reference] = length
                length += variable.size
            inside.append(begins[variable.reference] + variable.place)
        if where:
            references = (ctypes.c_uint * len(begins))(*begins)
            found.append(Part(kind, references, length, np.array(inside), np.array(where)))
    return found


class Functions:
    """Those of FMI 2.0."""

    prefix = "fmi2"
    save = ("GetFMUstate", "SerializedFMUstateSize", "SerializeFMUstate", "DeSerializeFMUstate", "SetFMUstate",
            "FreeFMUstate")
    """Get, size, to bytes, from bytes, set and free."""
    types: dict[str, tuple[str, Any]] = {"Real": ("Real", ctypes.c_double), "Integer": ("Integer", ctypes.c_int),
                                         "Boolean": ("Boolean", ctypes.c_int)}

    def __init__(self, fmu: Fmu, note: Callable[[int, str], None]) -> None:
        """Prepares an instance that says what it has to say to `note`."""
        self.fmu = fmu
        library = fmu.functions
        library.fmi2Instantiate.restype = ctypes.c_void_p
        library.fmi2FreeInstance.restype = None
        log = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_char_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)

        def heard(_environment: object, _instance: object, status: int, _category: object, text: bytes | None) -> None:
            # A format for printf, in which FMI doubles # and %.
            note(status, (text or b"").decode("utf-8", "replace").replace("%%", "%").replace("##", "#"))

        self._log: Any = log(heard)
        self._callbacks = (ctypes.c_void_p * 5)(ctypes.cast(self._log, ctypes.c_void_p).value)

    def instantiate(self) -> int | None:
        """The instance as a number; none where it cannot be made."""
        made: int | None = self.fmu.functions.fmi2Instantiate(
            b"robot", 1, self.fmu.guid.encode(), self.fmu.resources.encode(), self._callbacks, 0, 0)
        return made

    def initialize(self, call: Call, tolerance: float | None, start: float, start_values: Callable[[], None]) -> None:
        """From instantiated to initialised."""
        call("SetupExperiment", int(tolerance is not None), ctypes.c_double(tolerance or 0.0), ctypes.c_double(start), 0,
             ctypes.c_double(0.0))
        start_values()
        call("EnterInitializationMode")
        call("ExitInitializationMode")

    def step(self, call: Call, time: float, duration: float) -> None:
        """Takes a step."""
        call("DoStep", ctypes.c_double(time), ctypes.c_double(duration), 1)

    def reached(self, call: Call, begin: float) -> float:
        """s; the time that the instance has come to, of which `begin` is said where no step was taken yet."""
        time = ctypes.c_double()
        try:
            call("GetRealStatus", _LAST_SUCCESSFUL_TIME, ctypes.byref(time))
        except Error:
            return begin
        return time.value

    def get(self, call: Call, part: Part) -> Any:
        """The values of all elements of a part."""
        name, number = self.types[part.kind]
        values = (number * part.length)()
        call("Get" + name, part.references, ctypes.c_size_t(len(part.references)), values, *self._more(part))
        return values

    def set(self, call: Call, part: Part, numbers: Sequence[float]) -> None:
        """Sets the variables of a part; other elements of its arrays keep their values."""
        name, number = self.types[part.kind]
        if part.length == len(numbers):
            values = (number * part.length)()
        else:
            values = self.get(call, part)
        for place, value in zip(part.inside.tolist(), numbers):
            values[place] = value
        call("Set" + name, part.references, ctypes.c_size_t(len(part.references)), values, *self._more(part))

    def _more(self, _part: Part) -> tuple[Any, ...]:
        return ()


class Functions3(Functions):
    """Those of FMI 3.0."""

    prefix = "fmi3"
    save = ("GetFMUState", "SerializedFMUStateSize", "SerializeFMUState", "DeserializeFMUState", "SetFMUState",
            "FreeFMUState")
    types = {"Real": ("Float64", ctypes.c_double), "Integer": ("Int32", ctypes.c_int32),
             "Boolean": ("Boolean", ctypes.c_bool)}

    def __init__(self, fmu: Fmu, note: Callable[[int, str], None]) -> None:
        self.fmu = fmu
        library = fmu.functions
        library.fmi3InstantiateCoSimulation.restype = ctypes.c_void_p
        library.fmi3FreeInstance.restype = None
        log = ctypes.CFUNCTYPE(None, ctypes.c_void_p, ctypes.c_int, ctypes.c_char_p, ctypes.c_char_p)

        def heard(_environment: object, status: int, _category: object, text: bytes | None) -> None:
            note(status, (text or b"").decode("utf-8", "replace").replace("##", "#"))

        self._log = log(heard)

    def instantiate(self) -> int | None:
        no, nothing = ctypes.c_bool(False), ctypes.c_void_p()
        made: int | None = self.fmu.functions.fmi3InstantiateCoSimulation(
            b"robot", self.fmu.guid.encode(), self.fmu.resources.encode(), no, no, no, no, nothing, ctypes.c_size_t(0),
            nothing, self._log, nothing)
        return made

    def initialize(self, call: Call, tolerance: float | None, start: float, start_values: Callable[[], None]) -> None:
        start_values()
        call("EnterInitializationMode", ctypes.c_bool(tolerance is not None), ctypes.c_double(tolerance or 0.0),
             ctypes.c_double(start), ctypes.c_bool(False), ctypes.c_double(0.0))
        call("ExitInitializationMode")

    def step(self, call: Call, time: float, duration: float) -> None:
        flag, reached = ctypes.c_bool(), ctypes.c_double()
        call("DoStep", ctypes.c_double(time), ctypes.c_double(duration), ctypes.c_bool(True), ctypes.byref(flag),
             ctypes.byref(flag), ctypes.byref(flag), ctypes.byref(reached))

    def reached(self, call: Call, begin: float) -> float:
        time = ctypes.c_double(begin)
        if self.fmu.time is not None:
            reference = ctypes.c_uint(self.fmu.time)
            one = ctypes.c_size_t(1)
            call("GetFloat64", ctypes.byref(reference), one, ctypes.byref(time), one)
        return time.value

    def _more(self, part: Part) -> tuple[Any, ...]:
        return (ctypes.c_size_t(part.length),)


def of(fmu: Fmu, note: Callable[[int, str], None]) -> Functions:
    """Those of an FMU's version."""
    return (Functions if fmu.version == 2 else Functions3)(fmu, note)
