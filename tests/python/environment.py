"""Makes the Python environments that the tests run in: virtual environments with pinned packages, and PyBullet's data.

Usage: python environment.py BASE

Needs only Python's standard library and access to a package index. Makes a folder in BASE, which is named after what
it is made from, unless it is there already, and prints its path as the last line. Its interpreter is at bin/python in
it (Windows: Scripts/python.exe), the robots of pybullet_data are in data/pybullet_data, and an environment for the
programs of examples/python lies beside.
"""

import hashlib
import os
import shutil
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
OLDEST = (3, 10)
EXAMPLES = HERE / "requirements-examples.txt"

# Any wheel carries the same data, whatever machine and interpreter it is for.
ANY_WHEEL = ["--python-version", "3.11", "--platform", "manylinux2014_x86_64", "--only-binary", ":all:"]


def interpreter(folder: Path) -> Path:
    """Where a virtual environment keeps its interpreter."""
    return folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def pip(python: Path, *arguments) -> None:
    """Runs pip; its own output tells what went wrong."""
    command = [str(python), "-m", "pip", "--disable-pip-version-check", *map(str, arguments)]
    # Standard output tells where the environment is, and nothing else.
    if subprocess.run(command, stdout=sys.stderr, check=False).returncode != 0:
        sys.exit(f"pip failed: {' '.join(map(str, arguments))}\nThe tests need a package index (PyPI or a mirror; see pip's PIP_INDEX_URL).")


def named(base: Path, kind: str, *made_from) -> Path:
    """A folder in `base` with a short name for what it is made from."""
    return base / f"{kind}-{hashlib.sha256(repr(made_from).encode()).hexdigest()[:16]}"


def finish(folder: Path, fill) -> None:
    """Fills `folder`, unless that was done before: what an earlier run has not finished is made anew."""
    ready = folder / "ready"
    if not ready.exists():
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        fill(folder)
        ready.touch()


def make(folder: Path) -> None:
    """Fills the folder of the tests' environment."""
    # Not the venv module in this process: pyenv and friends start Python through a script that must stay in front.
    if subprocess.run([sys.executable, "-m", "venv", str(folder)], stdout=sys.stderr, check=False).returncode != 0:
        sys.exit("`python3 -m venv` failed; on Debian and Ubuntu: apt-get install python3-venv")
    python = interpreter(folder)
    # All that is needed is in the list: nothing is looked for.
    pip(python, "install", "--quiet", "--no-deps", "--only-binary", ":all:", "-r", HERE / "requirements.txt")
    asked = subprocess.run([python, "-c", "import sysconfig; print(sysconfig.get_path('platlib'))"],
                           capture_output=True, text=True, check=True)
    installed = Path(asked.stdout.strip(), "pybullet_data")
    if installed.is_dir():
        (folder / "data").mkdir()
        installed.rename(folder / "data/pybullet_data")
    else:
        data(python, folder / "data")
    examples(folder)


def data(python: Path, folder: Path) -> None:
    """Takes the robots of PyBullet out of a wheel that cannot be installed here."""
    with tempfile.TemporaryDirectory() as download:
        pip(python, "download", "--quiet", "--no-deps", *ANY_WHEEL, "-d", download, "-r", HERE / "requirements-data.txt")
        for wheel in Path(download).glob("*.whl"):
            with zipfile.ZipFile(wheel) as archive:
                names = [name for name in archive.namelist() if name.startswith("pybullet_data/")]
                archive.extractall(folder, names)


def examples(tests: Path) -> Path:
    """The interpreter of the environment for examples/python, made by that of the tests, in whose folder it lies."""

    def fill(folder: Path) -> None:
        subprocess.run([interpreter(tests), "-m", "venv", "--without-pip", folder], stdout=sys.stderr, check=True)
        pip(interpreter(tests), "--python", interpreter(folder), "install", "--quiet", "--no-deps", "--only-binary",
            ":all:", "-r", EXAMPLES)

    folder = named(tests, "examples", EXAMPLES.read_bytes())
    finish(folder, fill)
    return interpreter(folder)


if __name__ == "__main__":
    if sys.version_info < OLDEST:
        sys.exit(f"Python {OLDEST[0]}.{OLDEST[1]} or later is needed, this is {sys.version.split()[0]}; "
                 "set the environment variable PYTHON to a newer one")
    texts = [(HERE / name).read_bytes() for name in ("requirements.txt", "requirements-data.txt", "environment.py")]
    place = named(Path(sys.argv[1]), "python", sys.version, sys.prefix, *texts)
    finish(place, make)
    print(place)
