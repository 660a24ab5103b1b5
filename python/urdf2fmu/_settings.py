"""Nested dicts as TOML."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping, Sequence
from typing import Any


def to_toml(table: Mapping[str, Any], path: str = "") -> str:
    """A mapping as the text of a settings file; lists of mappings become arrays of tables."""
    lines: list[str] = []
    tables: list[str] = []
    for key, value in table.items():
        name = json.dumps(str(key), ensure_ascii=False)
        place = path + name
        if value is None:
            continue
        if isinstance(value, Mapping):
            tables.append(f"[{place}]\n" + to_toml(value, place + "."))
        elif _is_list(value) and len(value) > 0 and all(isinstance(item, Mapping) for item in value):
            tables += [f"[[{place}]]\n" + to_toml(item, place + ".") for item in value]
        else:
            lines.append(f"{name} = {_value(value)}\n")
    return "".join(lines) + "".join(tables)


def plain(value: Any) -> Any:
    """A number of Python's other kinds, such as a fraction or a decimal, as a float; whatever else as it is."""
    return float(value) if hasattr(value, "__float__") and not isinstance(value, (int, float)) else value


def _is_list(value: Any) -> bool:
    return isinstance(value, Sequence) and not isinstance(value, (str, bytes))


def _value(value: Any) -> str:
    # Those of numpy first: some of them are floats, too, and print otherwise.
    if hasattr(value, "tolist"):
        value = value.tolist()
    value = plain(value)
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, os.PathLike):
        value = os.fspath(value)
    if isinstance(value, str):
        # TOML has the escapes of JSON; DEL must be escaped there, too.
        return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
    if isinstance(value, Mapping):
        pairs = (f"{json.dumps(str(k), ensure_ascii=False)} = {_value(v)}" for k, v in value.items())
        return "{" + ", ".join(pairs) + "}"
    if _is_list(value):
        return "[" + ", ".join(map(_value, value)) + "]"
    raise TypeError(f"settings hold numbers, texts, lists and tables, and no {type(value).__name__}")
