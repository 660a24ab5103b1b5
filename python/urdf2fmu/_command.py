"""Runs the `urdf2fmu` command that the wheel carries."""

from __future__ import annotations

import importlib.metadata
import json
import os
import re
import shutil
import subprocess
import sys
import sysconfig
import tempfile
import warnings
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from types import FrameType
from typing import Any, Union

from ._settings import plain, to_toml

PathLike = Union[str, "os.PathLike[str]"]
"""A file's name."""
Option = Union[None, bool, float, str, "os.PathLike[str]", Sequence[Any], Mapping[str, Any]]
"""A value of an option of the command."""
Settings = Union[str, "os.PathLike[str]", Mapping[str, Any]]
"""A settings file, or what would stand in it."""


class Error(RuntimeError):
    """Whatever goes wrong: its text is what the command or the FMU says.

    Attributes:
        findings: what is wrong with a robot or its settings, each a dict with `severity`, `code`, `message`, `help`,
            `file`, `line` and `column`, as `urdf2fmu check --json` gives them.
        exit_code: of the command; 1 a problem in a file, 2 wrong usage, 3 a simulation failed; 0 if there was none.
    """

    def __init__(self, message: str, findings: Iterable[Mapping[str, Any]] = (), exit_code: int = 0) -> None:
        super().__init__(message)
        self.findings = [dict(finding) for finding in findings]
        self.exit_code = exit_code


def command() -> str:
    """The `urdf2fmu` program: URDF2FMU in the environment, else that of this wheel, else one on the path."""
    name = "urdf2fmu.exe" if sys.platform == "win32" else "urdf2fmu"
    named = os.environ.get("URDF2FMU")
    if named:
        if not os.path.isfile(named):
            raise Error(f"URDF2FMU names the program '{named}', which is no file")
        return named
    for place in _installed(name):
        if place.is_file():
            return os.path.normpath(place)
    found = shutil.which(name)
    if found is None:
        raise Error(f"the program '{name}' of the package urdf2fmu is missing; install the package again")
    return found


def _installed(name: str) -> Iterator[Path]:
    try:
        for file in importlib.metadata.files("urdf2fmu") or ():
            if file.name == name:
                yield Path(str(file.locate()))
    except importlib.metadata.PackageNotFoundError:
        pass
    yield Path(sysconfig.get_path("scripts"), name)


_USAGE = 2
"""The exit code of wrong usage."""
_OF_A_SHELL = re.compile(r"^(  tip: to pass '.*' as a value, .*|Usage: .*|For more information, .*)\n+", re.M)
"""Advice of the command that is of no use where options are those of a function."""


_FLAG = re.compile(r"unexpected value '.*' for '(--[\w-]+)' found; no more were expected")
_VALUE = re.compile(r"a value is required for '(--[\w-]+) <.*>' but none was supplied")
_ONCE = re.compile(r"the argument '(--[\w-]+) <.*>' cannot be used multiple times")


def _for_python(said: str) -> str:
    """What the command says of wrong usage, for options that are arguments of a function."""
    said = _OF_A_SHELL.sub("", said)
    for form, advice in ((_FLAG, "{} is True or False"), (_VALUE, "{} takes a value, not True"),
                         (_ONCE, "{} takes one value, not a list of them")):
        found = form.search(said)
        if found:
            name = found[1].strip("-").replace("-", "_")
            return f"{said.strip()}; {advice.format(name)}"
    return said


_HEAD = re.compile(r"^(note|warning|error)(?:\[(\w+)\])?: ", re.M)
"""How each of the things begins that the command says to standard error."""


def warn(told: str) -> None:
    """A warning that points at the line of the user's program, however deep in the package it is known."""
    # Of Python's own files only that of `with` stands between the package and its user.
    inside = os.path.join(os.path.dirname(__file__), ""), contextmanager.__code__.co_filename
    frame: FrameType | None = sys._getframe(1)
    level = 2
    while frame is not None and frame.f_code.co_filename.startswith(inside):
        frame, level = frame.f_back, level + 1
    warnings.warn(told, RuntimeWarning, stacklevel=level)


def _warn_of(said: str) -> None:
    """What a command that succeeded has warned of."""
    heads = list(_HEAD.finditer(said))
    ends = [head.start() for head in heads[1:]] + [len(said)]
    for head, end in zip(heads, ends):
        if head[1] == "warning":
            warn((head[2] + ": " if head[2] else "") + said[head.end():end].strip())


def run(*arguments: str | os.PathLike[str], accept: Sequence[int] = (0,)) -> str:
    """Runs the command and gives its standard output; what it warns of is a Python warning.

    Raises:
        Error: with what it said, if it ends with another code than those accepted.
    """
    # Colours and the progress of a terminal are not for programs.
    environment = {**os.environ, "NO_COLOR": "1"}
    try:
        done = subprocess.run([command(), *(os.fspath(a) for a in arguments)], capture_output=True, text=True,
                              encoding="utf-8", errors="replace", stdin=subprocess.DEVNULL, env=environment, check=False)
    except (OSError, ValueError) as error:
        # A name with a zero in it, or half of a letter, is that of no file and no option.
        raise Error(f"the command cannot be run with what it is given: {error}") from None
    if done.returncode not in accept:
        said = _for_python(done.stderr) if done.returncode == _USAGE else done.stderr
        text = said.strip() or f"urdf2fmu ended with exit code {done.returncode}"
        raise Error(text, exit_code=done.returncode)
    _warn_of(done.stderr)
    return done.stdout


def arguments(options: Mapping[str, Option]) -> list[str]:
    """Options as the command takes them.

    `fixed_base=True` becomes `--fixed-base`, a list repeats its option, and None and False are left out.
    `xacro_arguments` is a mapping or a list of `name:=value`.

    Raises:
        Error: for what only the command line has, and for a mapping elsewhere.
    """
    out: list[str] = []
    for name, value in options.items():
        if name == "xacro_arguments":
            out += [f"{k}:={v}" for k, v in value.items()] if isinstance(value, Mapping) else list(_list(value))
            continue
        flag = "--" + name.strip("_").replace("_", "-")
        if flag in ("--help", "--version"):
            raise Error(f"{flag} is for the command line; in Python, help(urdf2fmu) tells of the package")
        if isinstance(value, Mapping):
            raise Error(f"{name} takes one value or a list of them, and no dict: {value!r}")
        # numpy's truth values are not Python's, and its arrays no lists.
        value = getattr(value, "tolist", lambda given=value: given)()
        if value is True:
            out.append(flag)
        elif name == "object" and isinstance(value, (list, tuple)) and any(isinstance(n, (int, float)) for n in value):
            raise Error(f"an object is a text such as 'crate.urdf@1,0', or a list of such texts, not {value!r}")
        elif value is not None and value is not False:
            # In one word, so that the command names the option whose value it refuses.
            out += [f"{flag}={item}" for item in _list(value)]
    return out


def _list(value: Option) -> Iterator[str]:
    several = isinstance(value, Iterable) and not isinstance(value, (str, bytes))
    for item in value if several else [value]:  # type: ignore[union-attr]
        yield os.fspath(item) if isinstance(item, os.PathLike) else str(plain(item))


def file_name(robot: PathLike) -> str:
    """A file's name that the command takes for no option.

    Raises:
        Error: if it is empty, or neither a text nor a path.
    """
    name = os.fspath(robot) if isinstance(robot, (str, os.PathLike)) else None
    if not isinstance(name, str):
        raise Error(f"the name of a file is a text or a path, not {robot!r}")
    if not name:
        raise Error("the name of the robot's file is empty")
    if "\0" in name:
        raise Error(f"a name with a zero in it is that of no file: {name!r:.200}")
    if name.lstrip().startswith("<"):
        raise Error("a robot is given by the name of its file, not by its text: write that into a file first")
    return os.path.join(os.curdir, name) if name.startswith("-") else name


@contextmanager
def settings(config: Settings | None) -> Iterator[list[str]]:
    """The option that names a settings file; a mapping is written to one for the time being."""
    if config is None:
        yield []
    elif isinstance(config, Mapping):
        with tempfile.TemporaryDirectory(prefix="urdf2fmu-") as folder:
            place = Path(folder, "settings.toml")
            try:
                place.write_text(to_toml(config), encoding="utf-8")
            except (TypeError, ValueError) as error:
                raise Error(f"the settings cannot be written as TOML: {error}") from None
            except RecursionError:
                raise Error("the settings cannot be written as TOML: they contain themselves") from None
            try:
                current = os.getcwd()
            except OSError:
                raise Error("the current folder is gone, from which names of files in the settings count") from None
            try:
                yield ["-c", str(place), "--config-folder", current]
            except Error as error:
                said = Error(str(error).replace(str(place), _GIVEN), error.findings, error.exit_code)
                for finding in said.findings:
                    _name_given(finding, place)
                raise said from None
    elif isinstance(config, str) and ("\n" in config or "=" in config and not os.path.exists(config)):
        raise Error("settings are given by the name of their file, or as a dict, not by their text")
    else:
        yield ["-c", file_name(config)]


_GIVEN = "config"
"""What settings are called that are given as a dict: the file that they are written to is gone."""


def _name_given(finding: dict[str, Any], place: Path) -> None:
    if finding.get("file") == str(place):
        finding["file"] = _GIVEN


def export(robot: PathLike, output: PathLike | None = None, *, config: Settings | None = None,
           **options: Option) -> Path:
    """Makes an FMU of a robot.

    Args:
        robot: a URDF, also one in xacro.
        output: the FMU to write; without it the robot's name with `.fmu`, beside it.
        config: a settings file (TOML), or the same as nested dicts: `{"robot": {"base": "fixed"}}`. Relative names of
            files in a dict count from the current folder, those in a settings file from its own.
        options: those of `urdf2fmu export`, with `_` for `-`: `fixed_base=True`, `mode="velocity"`,
            `platform="linux64,win64"`, `package_path=[a, b]`, `object=["crate.urdf@1,0"]`.

    Returns:
        Where the FMU is. Each finding that is a warning is a Python warning (`RuntimeWarning`), too.

    Raises:
        Error: if the robot or an option is refused; `findings` has the reasons one by one.
    """
    robot = file_name(robot)
    target = Path(_without_ends(Path(robot)).with_suffix(".fmu") if output is None else file_name(output))
    with settings(config) as file:
        try:
            run("export", robot, "-o", file_name(target), *file, *arguments(options))
        except Error as error:
            raise _with_findings(error, robot, file, options) from None
    if not target.exists():
        raise Error(f"there is no {target}, though {_program()} ended without an error")
    return target


def _program() -> str:
    return f"the program '{command()}'" + (", which URDF2FMU names," if os.environ.get("URDF2FMU") else "")


def _from_json(text: str) -> dict[str, Any]:
    try:
        found: dict[str, Any] = json.loads(text)
    except ValueError:
        raise Error(f"what {_program()} says is no JSON: is it urdf2fmu, of this version?") from None
    return found


def _without_ends(robot: Path) -> Path:
    """`robot.urdf.xacro` is a robot, too."""
    return robot.with_suffix("") if robot.suffix == ".xacro" else robot


def _with_findings(error: Error, robot: PathLike, file: list[str], options: Mapping[str, Option]) -> Error:
    """The same error with what `check` finds, for programs."""
    try:
        found = json.loads(run("check", file_name(robot), "--json", *file, *arguments(options), accept=(0, 1)))["findings"]
    except (Error, ValueError, KeyError):
        return error
    serious = [finding for finding in found if finding["severity"] == "error"]
    return Error(str(error), serious, error.exit_code)


def check(robot: PathLike, *, config: Settings | None = None, **options: Option) -> list[dict[str, Any]]:
    """All that looks wrong in a robot, or is assumed.

    Args: as of `export`.

    Returns:
        Findings as dicts with `severity` ("error", "warning", "note"), `code`, `message`, `help`, `file`, `line`,
        `column`. Errors are among them and are not raised, that there is no such file (U001) included.

    Raises:
        Error: if the file is no robot, or for wrong options.
    """
    with settings(config) as file:
        text = run("check", file_name(robot), "--json", *file, *arguments(options), accept=(0, 1))
        place = Path(file[1]) if isinstance(config, Mapping) else None
    if not text:
        # What is not about a robot: it cannot be read, or is another kind of file.
        with settings(config) as file:
            run("check", file_name(robot), *file, *arguments(options))
    found: list[dict[str, Any]] = _from_json(text)["findings"]
    for finding in found:
        if place is not None:
            _name_given(finding, place)
    return found


def info(robot: PathLike, *, variables: bool = True, config: Settings | None = None,
         **options: Option) -> dict[str, Any]:
    """What is in a robot or an FMU: links, joints, world, platforms, and variables.

    Args:
        robot: a URDF, or an FMU that urdf2fmu made.
        variables: whether the list of the FMU's variables is wanted, too.
        config, options: as of `export`.

    Raises:
        Error: if the file cannot be read; `findings` has what is wrong with a robot.
    """
    with settings(config) as file:
        more = ["--variables"] if variables else []
        try:
            text = run("info", file_name(robot), "--json", *more, *file, *arguments(options))
        except Error as error:
            raise _with_findings(error, robot, file, options) from None
    return _from_json(text)
