"""What callers give as numbers: of any of numpy's kinds that are numbers, and of no other."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import numpy.typing as npt

from ._command import Error


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
