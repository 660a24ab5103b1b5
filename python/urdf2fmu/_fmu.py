"""An FMU on disk, its list of variables, and its library, loaded once for all simulations of it."""

from __future__ import annotations

import ctypes
import math
import os
import platform
import shutil
import sys
import tempfile
import threading
import weakref
import zipfile
import zlib
from pathlib import Path, PurePosixPath
from typing import NamedTuple
from xml.etree import ElementTree

from ._command import Error, PathLike, file_name


class Variable(NamedTuple):
    """A variable as modelDescription.xml lists it."""

    name: str
    reference: int
    """FMI's number of it; an element of an array of FMI 3 has that of the array."""
    kind: str
    """"Real", "Integer" or "Boolean"."""
    causality: str
    """"input", "output", "parameter" …"""
    variability: str
    """"continuous", "discrete", "tunable", "fixed" …"""
    unit: str
    """Such as "rad/s"; empty where there is none."""
    description: str
    place: int = 0
    """Place in the array of FMI 3; 0 for a scalar."""
    size: int = 1
    """Number of the array's elements; 1 for a scalar."""


_ELEMENTS = "io.github.urdf2fmu.elements"
"""The annotation that names the elements of arrays: a line for each, its value reference first."""
_KINDS = {"Float64": "Real", "Int32": "Integer", "Boolean": "Boolean"}
"""What the types of FMI 3 are called here, as in FMI 2."""


def read_description(fmu: PathLike) -> ElementTree.Element:
    """The root of modelDescription.xml.

    Raises:
        Error: if this is no FMU.
    """
    try:
        with zipfile.ZipFile(fmu) as archive:
            return ElementTree.fromstring(archive.read("modelDescription.xml"))
    except OSError as error:
        raise Error(f"cannot read '{os.fspath(fmu)}': {error.strerror or error}") from None
    except KeyError:
        raise Error(f"'{os.fspath(fmu)}' is no FMU: it has no modelDescription.xml at its top") from None
    except zipfile.BadZipFile as error:
        raise Error(f"'{os.fspath(fmu)}' is no FMU: {_no_archive(fmu, error)}") from None
    except ElementTree.ParseError as error:
        raise Error(f"'{os.fspath(fmu)}' is no FMU: its modelDescription.xml is no XML: {error}; {_AGAIN}") from None


_AGAIN = "copy or download it once more, or export it again"


def _no_archive(fmu: PathLike, error: zipfile.BadZipFile) -> str:
    """Why a file is no zip archive, and what to do."""
    with open(fmu, "rb") as file:
        begin = file.read(2)
    if not begin:
        return f"it is empty; {_AGAIN}"
    return f"it is cut short or damaged ({error}); {_AGAIN}" if begin == b"PK" else "an FMU is a zip archive, and this is none"


def read_variables(root: ElementTree.Element) -> dict[str, Variable]:
    """All variables by their names, in the order of the file; of the arrays of FMI 3 each element."""
    found: dict[str, Variable] = {}
    for element in root.iter("ScalarVariable"):
        kind = element[0]
        name = element.get("name", "")
        found[name] = Variable(name, int(element.get("valueReference", "0")), kind.tag,
                               element.get("causality", "local"), element.get("variability", "continuous"),
                               kind.get("unit", ""), element.get("description", ""))
    arrays = [element for element in root.find("ModelVariables") or () if element.tag in _KINDS]
    named = {line.split()[0]: line.split()[1:] for annotation in root.iterfind("Annotations/Annotation")
             if annotation.get("type") == _ELEMENTS for line in (annotation.text or "").splitlines() if line.strip()}
    scalars = {element.get("name") for element in arrays if element.find("Dimension") is None}
    for element in arrays:
        causality = element.get("causality", "local")
        if causality == "independent":
            continue
        usual = "continuous" if element.tag == "Float64" else "discrete"
        names = _elements(element, named.get(element.get("valueReference", ""), []))
        for index, name in enumerate(names):
            # A name is that of a scalar, else that of the first array that has it.
            if len(names) > 1 and (name in scalars or name in found):
                continue
            found[name] = Variable(name, int(element.get("valueReference", "0")), _KINDS[element.tag], causality,
                                   element.get("variability", usual), element.get("unit", ""),
                                   element.get("description", ""), index, len(names))
    return found


def _elements(element: ElementTree.Element, named: list[str]) -> list[str]:
    """Names of the elements of a variable of FMI 3, `named` where these are known; those of a scalar are its own."""
    name = element.get("name", "")
    shape = [int(dimension.get("start", "1")) for dimension in element.iter("Dimension")]
    if not shape:
        return [name]
    if len(named) == math.prod(shape):
        return named
    names = []
    for index in range(math.prod(shape)):
        numbers = []
        for size in reversed(shape):
            index, number = divmod(index, size)
            numbers.append(str(number + 1))
        names.append(f"{name}[{','.join(reversed(numbers))}]")
    return names


def is_fmu(robot: PathLike) -> bool:
    """Whether a file's name is that of an FMU."""
    return file_name(robot).lower().endswith(".fmu")


class Fmu:
    """An FMU, unpacked and loaded."""

    def __init__(self, path: PathLike) -> None:
        root = read_description(path)
        version = root.get("fmiVersion", "")
        element = root.find("CoSimulation")
        if version.partition(".")[0] not in ("2", "3"):
            raise Error(f"'{os.fspath(path)}' is an FMU of FMI {version or 'of no version'}; Simulation drives FMI 2.0 "
                        "and 3.0")
        if element is None:
            raise Error(f"'{os.fspath(path)}' is for Model Exchange alone: simulate() integrates it; Simulation needs "
                        "co-simulation, which export(…, interface=\"both\") adds")
        self.version = int(version[0])
        """Of FMI: 2 or 3."""
        self.guid = root.get("guid" if self.version == 2 else "instantiationToken", "")
        self.variables = read_variables(root)
        times = [int(element.get("valueReference", "0")) for element in root.find("ModelVariables") or ()
                 if element.get("causality") == "independent"]
        self.time = times[0] if times else None
        """The reference of the time, of which FMI 3 demands a variable."""
        folder, end = _platform(self.version)
        try:
            self._place = tempfile.mkdtemp(prefix="urdf2fmu-")
        except OSError as error:
            raise Error(f"cannot make a temporary folder: {error}") from None
        remove = weakref.finalize(self, shutil.rmtree, self._place, True)  # where what follows fails
        name = f"binaries/{folder}/{element.get('modelIdentifier')}.{end}"
        try:
            library = self._unpack(path, name)
        except OSError as error:
            raise Error(f"'{os.fspath(path)}' cannot be unpacked to {self._place}: {error.strerror or error}") from None
        except (zipfile.BadZipFile, zlib.error, EOFError) as error:
            raise Error(f"'{os.fspath(path)}' is damaged: {error}; {_AGAIN}") from None
        try:
            self.functions = ctypes.CDLL(str(library))
        except OSError as error:
            raise Error(f"the FMU's library for {folder} cannot be loaded here: {error}; it is damaged, or lacks what "
                        "this system has not: download or export the FMU once more") from None
        resources = Path(self._place, "resources")
        self.resources = resources.as_uri() if self.version == 2 else f"{resources}{os.sep}"
        self.instances: set[int | None] = set()
        """Those that are not freed; while there is one its thread may be in the library."""
        remove.detach()
        weakref.finalize(self, _let_go, self.functions._handle, self._place, self.instances, os.getpid())

    def _unpack(self, path: PathLike, library: str) -> Path:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
            if library not in names:
                there = sorted({PurePosixPath(n).parts[1] for n in names if n.startswith("binaries/") and n.count("/") > 1})
                raise Error(f"the FMU has no library for this system: there is no {library}; it has: "
                            f"{', '.join(there) or 'none'}; export it with platform=\"{_platform(self.version)[0]}\"")
            archive.extract(library, self._place)
            for name in names:
                if name.startswith("resources/") and not name.startswith("resources/source/"):
                    archive.extract(name, self._place)
        return Path(self._place, library)


def _platform(version: int) -> tuple[str, str]:
    """The folder of this system's library in an FMU, and the end of its name."""
    if version == 2:
        return {"win32": ("win64", "dll"), "darwin": ("darwin64", "dylib")}.get(sys.platform, ("linux64", "so"))
    machine = {"amd64": "x86_64", "arm64": "aarch64"}.get(platform.machine().lower(), platform.machine().lower())
    system, end = {"win32": ("windows", "dll"), "darwin": ("darwin", "dylib")}.get(sys.platform, ("linux", "so"))
    return f"{machine}-{system}", end


def _let_go(handle: int, folder: str, instances: set[int | None], owner: int) -> None:
    """Unloads the library, without which Windows could not remove its file.

    A process that was forked ends with the same duties, and the files are still those of its parent.
    """
    if os.getpid() != owner:
        return
    if not instances:
        import _ctypes
        if sys.platform == "win32":
            _ctypes.FreeLibrary(handle)
        else:
            _ctypes.dlclose(handle)
    shutil.rmtree(folder, ignore_errors=True)


_open: weakref.WeakValueDictionary[tuple[str, int, int], Fmu] = weakref.WeakValueDictionary()
_lock = threading.Lock()


def load(path: PathLike) -> Fmu:
    """An FMU; one that is in use already is shared."""
    try:
        place = os.path.realpath(path)
        status = os.stat(place)
    except OSError as error:
        raise Error(f"cannot read '{os.fspath(path)}': {error.strerror}") from None
    key = place, status.st_mtime_ns, status.st_size
    with _lock:
        fmu = _open.get(key)
        if fmu is None:
            _open[key] = fmu = Fmu(place)
        return fmu
