"""An FMU on disk, its list of variables, and its library, loaded once for all simulations of it."""

from __future__ import annotations

import ctypes
import os
import shutil
import sys
import tempfile
import threading
import weakref
import zipfile
from pathlib import Path, PurePosixPath
from typing import NamedTuple
from xml.etree import ElementTree

from ._command import Error, PathLike


class Variable(NamedTuple):
    """A variable as modelDescription.xml lists it."""

    name: str
    reference: int
    """FMI's number of it."""
    kind: str
    """"Real", "Integer" or "Boolean"."""
    causality: str
    """"input", "output", "parameter" …"""
    variability: str
    """"continuous", "discrete", "tunable", "fixed" …"""
    unit: str
    """Such as "rad/s"; empty where there is none."""
    description: str


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
    except (zipfile.BadZipFile, KeyError, ElementTree.ParseError) as error:
        raise Error(f"'{os.fspath(fmu)}' is no FMU: {error}") from None


def read_variables(root: ElementTree.Element) -> dict[str, Variable]:
    """All variables by their names, in the order of the file."""
    found = {}
    for element in root.iter("ScalarVariable"):
        kind = element[0]
        name = element.get("name", "")
        found[name] = Variable(name, int(element.get("valueReference", "0")), kind.tag,
                               element.get("causality", "local"), element.get("variability", "continuous"),
                               kind.get("unit", ""), element.get("description", ""))
    return found


def is_fmu(robot: PathLike) -> bool:
    """Whether a file's name is that of an FMU."""
    return os.fspath(robot).lower().endswith(".fmu")


class Fmu:
    """An FMU, unpacked and loaded."""

    def __init__(self, path: PathLike) -> None:
        root = read_description(path)
        version = root.get("fmiVersion", "")
        element = root.find("CoSimulation")
        if version != "2.0" or element is None:
            raise Error(f"'{os.fspath(path)}' is an FMU of FMI {version or 'of no version'}; Simulation drives "
                        "co-simulation of FMI 2.0, which export makes without further options")
        self.guid = root.get("guid", "")
        self.variables = read_variables(root)
        folder, end = {"win32": ("win64", "dll"), "darwin": ("darwin64", "dylib")}.get(sys.platform, ("linux64", "so"))
        self._place = tempfile.mkdtemp(prefix="urdf2fmu-")
        remove = weakref.finalize(self, shutil.rmtree, self._place, True)
        name = f"binaries/{folder}/{element.get('modelIdentifier')}.{end}"
        library = self._unpack(path, name)
        try:
            self.functions = ctypes.CDLL(str(library))
        except OSError as error:
            raise Error(f"the FMU's library for {folder} cannot be loaded here: {error}") from None
        self.resources = Path(self._place, "resources").as_uri()
        self.functions.fmi2Instantiate.restype = ctypes.c_void_p
        self.functions.fmi2FreeInstance.restype = None
        remove.detach()
        weakref.finalize(self, _let_go, self.functions._handle, self._place)

    def _unpack(self, path: PathLike, library: str) -> Path:
        with zipfile.ZipFile(path) as archive:
            names = archive.namelist()
            if library not in names:
                there = sorted({PurePosixPath(n).parts[1] for n in names if n.startswith("binaries/") and n.count("/") > 1})
                raise Error(f"the FMU has no library for this system: there is no {library}; it has: "
                            f"{', '.join(there) or 'none'}")
            archive.extract(library, self._place)
            for name in names:
                if name.startswith("resources/") and not name.startswith("resources/source/"):
                    archive.extract(name, self._place)
        return Path(self._place, library)


def _let_go(handle: int, folder: str) -> None:
    """Unloads the library, without which Windows could not remove its file."""
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
