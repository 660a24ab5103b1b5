"""`urdf2fmu` is ended by signals, at any time: it goes at once and leaves nothing behind."""

import os
import signal
import subprocess
import sys
import time

import pytest


@pytest.mark.skipif(sys.platform == "win32", reason="signals are those of Unix")
@pytest.mark.parametrize("name", ["SIGINT", "SIGTERM", "SIGHUP"])
@pytest.mark.parametrize("command", ["simulate", "view"])
def test_a_signal_leaves_no_folder_behind(name, command, examples, tmp_path):
    number = getattr(signal, name)
    folder = tmp_path / "temporary"
    folder.mkdir()
    options = ["--stop-time", "100000"] if command == "simulate" else ["--no-open", "--port", "0"]
    with open(os.devnull, "wb") as nowhere:
        # Before the folder is there, while the robot is exported into it, while it is simulated.
        for delay in (0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8):
            # Under nohup these tests ignore SIGHUP, and what they start would do so, too.
            running = subprocess.Popen([os.environ["URDF2FMU"], command, examples / "rover.urdf", *options],
                                       env={**os.environ, "TMPDIR": str(folder)}, stdin=nowhere, stdout=nowhere,
                                       stderr=nowhere, preexec_fn=lambda: signal.signal(number, signal.SIG_DFL))
            try:
                time.sleep(delay)
                running.send_signal(number)
                assert running.wait(20) in (-number, 130, 0), delay
            finally:
                running.kill()
                running.wait()
            assert list(folder.iterdir()) == [], delay
