"""Puts the `urdf2fmu` command into a wheel: one wheel for all Pythons of a platform.

URDF2FMU_BINARY names a command that is built already, by its file or as a shell finds it; without it
`cargo build --release` makes one. URDF2FMU_WHEEL names the platform of a ready command, such as
`manylinux2014_x86_64`; without it the wheel is for this machine.
"""

import os
import shutil
import subprocess
import sys
import sysconfig
from pathlib import Path
from typing import Any

from hatchling.builders.hooks.plugin.interface import BuildHookInterface


class CustomBuildHook(BuildHookInterface):  # type: ignore[type-arg]
    """Called by hatchling."""

    def initialize(self, version: str, build_data: dict[str, Any]) -> None:
        """Adds the command to the wheel's scripts."""
        named = os.environ.get("URDF2FMU_BINARY")
        binary = Path(named or self.build())
        if named and not binary.is_file():
            found = shutil.which(named)
            if found is None:
                raise FileNotFoundError(f"URDF2FMU_BINARY: there is no file or command '{named}'")
            binary = Path(found)
        platform = os.environ.get("URDF2FMU_WHEEL") or sysconfig.get_platform().replace("-", "_").replace(".", "_")
        name = "urdf2fmu.exe" if platform.startswith("win") else "urdf2fmu"
        build_data["pure_python"] = False
        build_data["tag"] = f"py3-none-{platform}"
        build_data["shared_scripts"] = {str(binary): name}

    def build(self) -> Path:
        """Builds the command by cargo."""
        target = Path(os.environ.get("CARGO_TARGET_DIR") or Path(self.root, "target"))
        command = ["cargo", "build", "--release", "--locked", "-p", "urdf2fmu", "--target-dir", str(target)]
        subprocess.run(command, cwd=self.root, check=True)
        return target / "release" / ("urdf2fmu.exe" if sys.platform == "win32" else "urdf2fmu")
