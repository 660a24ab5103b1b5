"""Makes the Python environment that the tests run in: a virtual environment with pinned packages, and PyBullet's data.

Usage: python environment.py FOLDER

Needs only Python's standard library and access to a package index. FOLDER must not exist; it is complete when
this ends with exit code 0. The interpreter is then at FOLDER/bin/python (Windows: FOLDER/Scripts/python.exe) and
the robots of pybullet_data in FOLDER/data/pybullet_data.
"""

import os
import subprocess
import sys
import tempfile
import zipfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
OLDEST = (3, 10)

# Any wheel carries the same data, whatever machine and interpreter it is for.
ANY_WHEEL = ["--python-version", "3.11", "--platform", "manylinux2014_x86_64", "--only-binary", ":all:"]


def interpreter(folder: Path) -> Path:
    """Where a virtual environment keeps its interpreter."""
    return folder / ("Scripts/python.exe" if os.name == "nt" else "bin/python")


def pip(python: Path, *arguments: str) -> None:
    """Runs pip; its own output tells what went wrong."""
    command = [str(python), "-m", "pip", "--disable-pip-version-check", *arguments]
    if subprocess.run(command, check=False).returncode != 0:
        sys.exit(f"pip failed: {' '.join(arguments)}\nThe tests need a package index (PyPI or a mirror; see pip's PIP_INDEX_URL).")


def make(folder: Path) -> None:
    """Fills `folder`."""
    # Not the venv module in this process: pyenv and friends start Python through a script that must stay in front.
    if subprocess.run([sys.executable, "-m", "venv", str(folder)], check=False).returncode != 0:
        sys.exit("`python3 -m venv` failed; on Debian and Ubuntu: apt-get install python3-venv")
    python = interpreter(folder)
    pip(python, "install", "--quiet", "--only-binary", ":all:", "-r", str(HERE / "requirements.txt"))
    with tempfile.TemporaryDirectory() as download:
        pip(python, "download", "--quiet", "--no-deps", *ANY_WHEEL, "-d", download, "-r", str(HERE / "requirements-data.txt"))
        for wheel in Path(download).glob("*.whl"):
            with zipfile.ZipFile(wheel) as archive:
                names = [name for name in archive.namelist() if name.startswith("pybullet_data/")]
                archive.extractall(folder / "data", names)


if __name__ == "__main__":
    if sys.version_info < OLDEST:
        sys.exit(f"Python {OLDEST[0]}.{OLDEST[1]} or later is needed, this is {sys.version.split()[0]}; "
                 "set the environment variable PYTHON to a newer one")
    make(Path(sys.argv[1]))
