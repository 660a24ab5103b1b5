"""The library for Windows, driven by FMPy through Wine, gives the bits of the one for Linux.

Needs a `urdf2fmu` that carries both (`build/platforms.sh`) and Wine; skipped with the reason otherwise.
"""

import os
import shutil
import socket
import subprocess
import sys
import time
from pathlib import Path

import fmpy
import numpy as np
import pytest

EXAMPLES = Path(__file__).resolve().parents[2] / "examples"
PORT = 8080
"""Where FMPy's remoting server always listens."""


@pytest.fixture(scope="module")
def wine(tmp_path_factory):
    """A `wine64` on the path that FMPy's remoting can use."""
    program = shutil.which("wine64") or shutil.which("wine64", path="/usr/lib/wine")
    if sys.platform != "linux" or not program:
        pytest.skip("there is no wine64; on Debian: apt-get install wine64")
    if not port_is_free():
        pytest.skip(f"port {PORT}, which FMPy's remoting server needs, is taken")
    folder = tmp_path_factory.mktemp("wine")
    # The client hands the server a file that it has locked, and the server leaves when it can open that file; Wine
    # does not see the lock. Without that argument the server stays until the client ends it.
    wrapper = folder / "wine64"
    wrapper.write_text(f'#!/bin/sh\nexec {program} "$1" "$2"\n')
    wrapper.chmod(0o755)
    # The configuration of the tests in Rust, where they have made one.
    prefix = Path(os.environ["URDF2FMU_WINE"]) if "URDF2FMU_WINE" in os.environ else folder / "prefix"
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("PATH", f"{folder}{os.pathsep}{os.environ['PATH']}")
        patch.setenv("WINEPREFIX", str(prefix))
        patch.setenv("WINEDEBUG", "-all")
        patch.setenv("WINEDLLOVERRIDES", "mscoree,mshtml=")
        patch.delenv("DISPLAY", raising=False)
        # A new configuration takes longer than FMPy waits for its server. Output to a pipe would keep that open.
        subprocess.run([program, "wineboot", "-i"], check=True, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        # FMPy ends a server with everything in its group of processes. The services of Wine, which the first program
        # starts, must not be among them: a program of this group has them started, and keeps them until its input
        # ends. It is no child of this process, because FMPy waits for all of its children.
        input_of_session, keeps = os.pipe()
        subprocess.run(["sh", "-c", 'exec 3<&0; "$0" cmd <&3 &', program], check=True, stdin=input_of_session,
                       stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        os.close(input_of_session)
        yield wrapper
        os.close(keeps)


@pytest.fixture
def export_for(command, tmp_path):
    """Exports a robot for one platform."""

    def run(urdf: Path, platform: str) -> Path:
        fmu = tmp_path / f"{urdf.stem}_{platform}.fmu"
        done = command("export", "--no-documentation", urdf, "-o", fmu, "--platform", platform)
        if "no library for the platform" in done.stderr:
            pytest.skip(f"this urdf2fmu carries no library for {platform}; build/platforms.sh makes it")
        assert done.returncode == 0, done.stderr
        return fmu

    return run


def answer_of_the_server(simulate):
    """What `simulate` gives once FMPy's client has reached its server, for which it waits some ten seconds only."""
    for attempt in range(3):
        # The port of a server that has just been ended.
        deadline = time.monotonic() + 60
        while not port_is_free():
            assert time.monotonic() < deadline, f"port {PORT} stays taken"
            time.sleep(0.1)
        try:
            return simulate()
        except Exception as error:
            # What the client says when it has reached no server, and when the library refuses to be instantiated.
            if str(error) != "Failed to instantiate model" or attempt == 2:
                raise


def port_is_free() -> bool:
    with socket.socket() as probe:
        probe.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        try:
            probe.bind(("localhost", PORT))
        except OSError:
            return False
    return True


@pytest.mark.parametrize("name", ["r2d2.urdf", "kuka_iiwa/model.urdf", "arm.urdf", "quadruped.urdf"])
def test_fmpy_gets_the_same_bits_from_windows_as_from_linux(name, wine, export_for, pybullet_data, monkeypatch):
    urdf = pybullet_data / name if (pybullet_data / name).exists() else EXAMPLES / name
    windows, linux = export_for(urdf, "win64"), export_for(urdf, "linux64")
    description = fmpy.read_model_description(str(linux))
    variables = [v for v in description.modelVariables if v.type == "Real"]
    inputs = [v for v in variables if v.causality == "input"]
    outputs = [v.name for v in variables if v.causality == "output"]

    def command_at(variable, number, t):
        swing = {"velocity": 3.0, "position": 0.3, "effort": 1.0}.get(variable.name.rsplit(".", 1)[-1], 0.0)
        return float(variable.start) + swing * np.sin((1 + 0.1 * number) * t)

    times = np.linspace(0, 1, 21)
    signals = np.array([(t, *(command_at(v, i, t) for i, v in enumerate(inputs))) for t in times],
                       dtype=[("time", float), *((v.name, float) for v in inputs)])
    options = {"stop_time": 1.0, "step_size": 1 / 240, "output_interval": 1 / 240, "input": signals, "output": outputs,
               "fmi_type": "CoSimulation"}
    expected = fmpy.simulate_fmu(str(linux), **options)
    # FMPy's client ends its instance, but not the thread that it talks to the server with: unloaded, it crashes.
    monkeypatch.setattr(fmpy.fmi1._FMU, "freeLibrary", lambda fmu: None)
    found = answer_of_the_server(
        lambda: fmpy.simulate_fmu(str(windows), remote_platform="win64", **options))
    assert len(expected) == 241
    assert found.dtype == expected.dtype
    assert any(np.ptp(expected[output]) > 0.1 for output in outputs), "the robot must move"
    for output in expected.dtype.names:
        assert found[output].tobytes() == expected[output].tobytes(), output
