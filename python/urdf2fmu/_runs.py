"""Whole runs: a table of results, or a page that plays them."""

from __future__ import annotations

import csv
import html
import os
import re
import tempfile
from collections.abc import Iterable, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, Iterator, Union

import numpy as np
import numpy.typing as npt

from ._command import Error, Option, PathLike, Settings, arguments, export, file_name, run, settings
from ._fmu import Variable, is_fmu, read_description, read_variables
from ._values import by_name, number, numbers, one_each, output_names, start_names

Table = Union[npt.NDArray[Any], Mapping[str, npt.ArrayLike]]
"""Columns by their names, `time` first: a structured array, a dict of arrays, or a pandas DataFrame, whose index may be
the time if it is called so."""


def simulate(robot: PathLike, *, input: Table | PathLike | None = None, start_values: Mapping[str, npt.ArrayLike] | None = None,
             output: str | Sequence[str] | None = None, config: Settings | None = None, **options: Option) -> npt.NDArray[Any]:
    """Simulates from start to stop.

    Args:
        robot: an FMU, or a robot.
        input: inputs over time, `time` first, or a CSV file of them; straight lines between the rows, two rows of
            one time are a jump.
        start_values: parameters and inputs by name, stem or glob, as of `Simulation`.
        output: variables that are wanted, as a name, stem or glob or a list of them; without it all outputs.
        config: as of `export`.
        options: those of `urdf2fmu simulate`, such as `stop_time=2.0`, `output_interval=0.01`, `tolerance=1e-5`.

    Returns:
        A structured array with one row for each communication point, `time` first, equal to the bit to that of
        `fmpy.simulate_fmu`; `pandas.DataFrame(result)` makes a DataFrame of it.

    Raises:
        Error: if the robot, an option or a step is refused.
    """
    with _fmu(robot, config, options) as (fmu, rest), tempfile.TemporaryDirectory(prefix="urdf2fmu-") as folder:
        variables = read_variables(read_description(fmu))
        more = _asked(Path(folder, "in.csv"), variables, input, start_values, output)
        rest.pop("quiet", None)
        kept = rest.pop("output_file", None)
        out = Path(folder, "out.csv") if kept is None else Path(file_name(str(kept)))
        with _table_named("the table of inputs", Path(folder, "in.csv")):
            run("simulate", file_name(fmu), "--quiet", "--output-file", file_name(out), *more, *arguments(rest))
        kinds = {v.name: v.kind for v in variables.values()}
        return _read_table(out, kinds)


def _asked(place: Path, variables: Mapping[str, Variable], input: Table | PathLike | None,
           start_values: Mapping[str, npt.ArrayLike] | None, output: str | Sequence[str] | None) -> list[str]:
    """What is asked of a run, as options of the command; a table of inputs is written to `place`."""
    more: list[str] = []
    if isinstance(input, (str, os.PathLike)):
        more += ["--input-file", file_name(input)]
    elif input is not None:
        write_table(place, input)
        more += ["--input-file", str(place)]
    causalities = {name: v.causality for name, v in variables.items()}
    for name, value in by_name("start values", start_values).items():
        names = start_names(causalities, name)
        for each, start in zip(names, one_each(name, names, value).tolist()):
            # Booleans and whole numbers without a point.
            more += ["--start-value", each, repr(start) if variables[each].kind == "Real" else f"{start:.17g}"]
    if output is not None and not isinstance(output, Iterable):
        raise Error(f"output is a name or a list of names, not {output!r}")
    wanted = [output] if isinstance(output, str) else list(output or ())
    if output is not None and not wanted:
        raise Error("output is an empty list; leave it out for all outputs")
    for name in wanted:
        for each in output_names(variables, name):
            more += ["--output-variable", each]
    return more


_OF_SIMULATE = ("start_time", "stop_time", "output_interval", "tolerance", "set_input_derivatives", "debug_logging",
                "input_file", "output_file", "output_variable", "plot", "report", "quiet")
"""Options of the command `simulate` that are not of an export."""


@contextmanager
def _fmu(robot: PathLike, config: Settings | None, options: Mapping[str, Option]
         ) -> Iterator[tuple[Path, dict[str, Option]]]:
    """The FMU of a robot, and the options that are not of its export."""
    rest = {name: value for name, value in options.items() if name in _OF_SIMULATE or is_fmu(robot)}
    if is_fmu(robot):
        with settings(config) as file:
            if file:
                raise Error("an FMU has its settings inside; config is for a URDF")
        yield Path(robot), rest
        return
    with tempfile.TemporaryDirectory(prefix="urdf2fmu-") as folder:
        of_export = {name: value for name, value in options.items() if name not in rest}
        of_export.setdefault("no_documentation", True)  # nobody looks into it
        yield export(robot, Path(folder, "robot.fmu"), config=config, **of_export), rest


@contextmanager
def _table_named(what: str, place: Path) -> Iterator[None]:
    """Errors that name the file to which a table was written name the table, and rows in place of lines."""
    try:
        yield
    except Error as error:
        said = str(error).replace(f"'{place}'", what).replace(str(place), what)
        if what in said:
            # The names of the columns are the first line; rows count from 0, as in numpy.
            said = re.sub(r"\bline (\d+)", lambda line: f"row {int(line[1]) - 2}" if int(line[1]) > 1 else "names", said)
        raise Error(said) from None


def write_table(place: PathLike, table: Table) -> None:
    """Writes a table as CSV, each number with the digits that read back to it."""
    if hasattr(table, "to_records"):
        index = getattr(getattr(table, "index", None), "name", None)
        table = table.to_records(index=index == "time")
    if isinstance(table, Mapping):
        given = {str(name): values for name, values in table.items()}
    elif isinstance(table, np.ndarray) and table.dtype.names:
        given = {name: table[name] for name in table.dtype.names}
    else:
        raise Error("a table has columns with names: a structured array, a dict of arrays, or a DataFrame")
    columns = {}
    for name, values in given.items():
        columns[name] = numbers(f"the column '{name}' of a table", values)
    if not columns:
        raise Error("a table needs the column 'time' and one for each input that it gives")
    if len({values.shape for values in columns.values()}) != 1 or next(iter(columns.values())).ndim != 1:
        shapes = ", ".join(f"{name} {values.shape}" for name, values in columns.items())
        raise Error(f"the columns of a table have one length; these have the shapes: {shapes}")
    with open(place, "w", encoding="utf-8", newline="\n") as file:
        file.write(",".join('"' + name.replace('"', '""') + '"' for name in columns) + "\n")
        for row in zip(*(values.tolist() for values in columns.values())):
            file.write(",".join(map(repr, row)) + "\n")


def _read_table(place: Path, kinds: Mapping[str, str]) -> npt.NDArray[Any]:
    with open(place, encoding="utf-8") as file:
        names = next(csv.reader([file.readline()]))  # such as "sensor.lidar.ray[1,2]"
        values = np.loadtxt(file, delimiter=",", ndmin=2)
    types = {"Boolean": np.bool_, "Integer": np.int32}
    result = np.empty(len(values), [(name, types.get(kinds.get(name, "Real"), np.float64)) for name in names])
    for name, column in zip(names, values.T):
        result[name] = column
    return result


class Page:
    """A page that plays a run in 3-D and plots it; notebooks show it."""

    def __init__(self, text: str, height: int = 640) -> None:
        self.html = text
        """The whole page; it needs no network."""
        self.height = height
        """pixels, in a notebook"""

    def save(self, place: PathLike) -> Path:
        """Writes it to a file.

        Raises:
            Error: if it cannot be written.
        """
        try:
            Path(place).write_text(self.html, encoding="utf-8")
        except OSError as error:
            raise Error(f"cannot write '{os.fspath(place)}': {error.strerror or error}") from None
        return Path(place)

    def _repr_html_(self) -> str:
        """What notebooks show: the page in a frame of its own."""
        return (f'<iframe srcdoc="{html.escape(self.html)}" width="100%" height="{self.height}" '
                'style="border: 0" allow="fullscreen"></iframe>')

    def __repr__(self) -> str:
        return f"<urdf2fmu page, {len(self.html) // 1000} kB>"


def show(robot: PathLike, result: Table | None = None, *, height: int = 640, input: Table | PathLike | None = None,
         start_values: Mapping[str, npt.ArrayLike] | None = None, config: Settings | None = None,
         **options: Option) -> Page:
    """A page that plays a run, for notebooks and files.

    Args:
        robot: an FMU, or a robot.
        result: what `simulate` gave, or another table with `time` and outputs; without it the robot is simulated, by
            options as of `simulate`.
        height: pixels, in a notebook.
        input, start_values: of that simulation, as of `simulate`; for a page of `result` there is none.
        config, options: as of `simulate`.

    Raises:
        Error: if the robot, an option or the table is refused.
    """
    pixels = number("the height", height)
    if not pixels >= 1:
        raise Error(f"the height is a number of pixels, not {height!r}")
    with _fmu(robot, config, options) as (fmu, rest), tempfile.TemporaryDirectory(prefix="urdf2fmu-") as folder:
        page = Path(folder, "run.html")
        if result is None:
            rest.pop("quiet", None)
            more = _asked(Path(folder, "in.csv"), read_variables(read_description(fmu)), input, start_values, None)
            with _table_named("the table of inputs", Path(folder, "in.csv")):
                run("simulate", file_name(fmu), "--quiet", "--report", page, *more, *arguments(rest))
        elif input is not None or start_values is not None:
            raise Error("input and start_values are those of a simulation, and a result is given: leave one of them out")
        else:
            write_table(Path(folder, "run.csv"), result)
            with _table_named("the table of results", Path(folder, "run.csv")):
                run("report", Path(folder, "run.csv"), "--model", file_name(fmu), "-o", page, *arguments(rest))
        return Page(page.read_text(encoding="utf-8"), int(pixels))
