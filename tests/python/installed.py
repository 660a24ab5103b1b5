"""The wheel of the package, with the command under test, and environments that it is installed in."""

import os
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def wheel(shared):
    """The wheel, made once in the folder that all tests share; the command is named as docs/python.md does, without
    its folder."""
    for made in shared.glob("*.whl"):
        return made
    folder = shared / f"wheel-{os.getpid()}"
    command = Path(os.environ["URDF2FMU"])
    environment = {**os.environ, "URDF2FMU_BINARY": command.stem, "SOURCE_DATE_EPOCH": "1600000000",
                   "PATH": f"{command.parent}{os.pathsep}{os.environ['PATH']}"}
    done = subprocess.run([sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", folder], cwd=ROOT,
                          env=environment, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    [made] = folder.glob("*.whl")
    # Another process may be at it: the file appears whole.
    return made.replace(shared / made.name)


def packages(python):
    """Where an interpreter has its packages."""
    asked = subprocess.run([python, "-c", "import sysconfig; print(sysconfig.get_path('purelib'))"],
                           capture_output=True, text=True, check=True)
    return Path(asked.stdout.strip())


def environment(wheel, folder, *others):
    """The interpreter of a new environment that has this wheel, and the packages in the folders `others`."""
    subprocess.run([sys.executable, "-m", "venv", "--without-pip", folder], check=True)
    python = Path(folder, "Scripts/python.exe" if os.name == "nt" else "bin/python")
    pip = [sys.executable, "-m", "pip", "--disable-pip-version-check", "--python", python]
    subprocess.run([*pip, "install", "--quiet", "--no-index", "--no-deps", wheel], check=True)
    (packages(python) / "others.pth").write_text("".join(f"{other}\n" for other in others))
    return python


def variables(**more):
    """The environment variables of a process that finds nothing of the repository, and `more`."""
    return {**{k: v for k, v in os.environ.items() if k not in ("URDF2FMU", "PYTHONPATH", "MYPYPATH")}, **more}
