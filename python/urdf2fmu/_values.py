"""What callers give as numbers: of any of numpy's kinds that are numbers, and of no other."""

from __future__ import annotations

import difflib
import functools
import re
from collections.abc import Collection, Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from ._command import Error

_ENDS = ("x", "y", "z", "w"), ("x", "y", "z"), ("roll", "pitch", "yaw"), ("x", "y")


def numbers(what: str, value: Any) -> npt.NDArray[np.float64]:
    """A number or an array of them, as float64.

    numpy would take a text for the number that it spells, None for NaN, what a mask hides for valid, and leave out the
    imaginary part: each is a mistake of the caller.

    Raises:
        Error: that `what` takes numbers.
    """
    try:
        given = np.asarray(value)
        if given.dtype.kind == "O":
            # Fractions and decimals are numbers, texts and None are not.
            texts = any(isinstance(item, (str, bytes)) for item in given.flat)
            given = given if texts else np.array([float(item) for item in given.flat]).reshape(given.shape)
    except (TypeError, ValueError, OverflowError):
        raise Error(f"{what} takes numbers, not {value!r}") from None
    if given.dtype.kind not in "biuf" or np.ma.is_masked(value):
        raise Error(f"{what} takes numbers, not {value!r}")
    return given.astype(np.float64)


def number(what: str, value: Any) -> float:
    """One number.

    Raises:
        Error: that `what` takes one.
    """
    given = numbers(what, value)
    if given.shape != ():
        raise Error(f"{what} takes one number, not {value!r}")
    return float(given)


def by_name(what: str, values: Any) -> dict[str, Any]:
    """Values by their names; none for None.

    Raises:
        Error: that `what` are values by name.
    """
    if values is None:
        return {}
    if not isinstance(values, Mapping):
        raise Error(f"{what} are values by name, as a dict, not {values!r}")
    return dict(values)


def text(what: str, value: Any) -> str:
    """A text.

    Raises:
        Error: that `what` is one.
    """
    if not isinstance(value, str):
        raise Error(f"{what} is a text, not {value!r}")
    return value


def is_glob(name: str) -> bool:
    """Whether it is more than a plain name."""
    return "*" in name or "?" in name


def matches(glob: str, name: str) -> bool:
    """Whether a glob means a name, by the rule of the command: `*` any characters, `?` one, and all others themselves.

    Brackets are parts of names, as in `sensor.lidar.ray[1,2]`; those of Python's `fnmatch` would be sets of letters.
    """
    return _expression(glob).fullmatch(name) is not None


@functools.lru_cache(maxsize=256)
def _expression(glob: str) -> re.Pattern[str]:
    signs = {"*": ".*", "?": "."}
    return re.compile("".join(signs.get(sign) or re.escape(sign) for sign in glob), re.S)


def meant(variables: Collection[str], name: str) -> list[str]:
    """Variables that a name means: itself, those of a vector by their stem, or all that match a glob.

    Raises:
        Error: if there is none, with the nearest names.
    """
    if name in variables:
        return [name]
    for ends in _ENDS:
        vector = [f"{name}.{end}" for end in ends]
        if all(n in variables for n in vector):
            return vector
    # With a number each, or with row and column.
    element = re.compile(re.escape(name) + r"\[\d+(,\d+)*\]")
    numbered = [n for n in variables if element.fullmatch(n)]
    found = numbered or [n for n in variables if matches(name, n)]
    if not found:
        near = difflib.get_close_matches(name, variables, 3, 0.5)
        advice = " (did you mean " + " or ".join(f"'{n}'" for n in near) + "?)" if near else ""
        raise Error(f"there is no variable '{name}'{advice}")
    return found


_SETTABLE = "input", "parameter"
"""Causalities of what can be set."""


def start_names(causalities: Mapping[str, str], name: str) -> list[str]:
    """Variables that the name of a start value means: as of `meant`, but a glob means what can be set.

    Args:
        causalities: of all variables, by name.

    Raises:
        Error: if there is none, with the nearest names.
    """
    glob = is_glob(text("a variable's name", name))
    settable = [known for known, causality in causalities.items() if causality in _SETTABLE]
    return meant(settable if glob else causalities, name)


def output_names(variables: Collection[str], name: str) -> list[str]:
    """What the command is to record: the variables of a stem, else the name or glob as it is."""
    name = text("the name of an output", name)
    try:
        names = meant(variables, name)
    except Error:
        return [name]
    # What a glob matches the command finds itself, among outputs alone.
    return names if all(n.startswith(name) for n in names) else [name]


def one_each(name: str, names: list[str], value: Any) -> npt.NDArray[np.float64]:
    """A number for each of the variables that a name means, from one for all or from one each.

    Raises:
        Error: if these are neither.
    """
    given = numbers(f"'{name}'", value)
    if given.shape not in ((), (len(names),)):
        many = "one number" if names == [name] else f"one number or {len(names)}"
        raise Error(f"'{name}' takes {many}; the given value has the shape {given.shape}")
    return np.broadcast_to(given, len(names))
