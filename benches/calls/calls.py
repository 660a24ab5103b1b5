"""Times the C functions of our R2D2 and of one made with PythonFMU and PyBullet, in one run; prints a table.

    python3.11 -m venv peers && peers/bin/pip install -r benches/peers/requirements.txt pythonfmu fmpy
    peers/bin/python benches/calls/calls.py URDF2FMU [--rounds 5] [--write]

URDF2FMU is the command, built with --release. `calls.c` measures; rounds of both alternate. Best over all rounds, and the
median of the rounds' medians. `--write` puts the table into docs/performance.md.
"""

import argparse
import os
import platform
import re
import statistics
import subprocess
import sys
import sysconfig
import tempfile
from importlib.metadata import version
from pathlib import Path

import fmpy
import pybullet_data

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
BEGIN, END = "<!-- calls begin: written by benches/calls/calls.py -->", "<!-- calls end -->"
BOUNDS = {"set, get and step without physics": 1e3, "instantiate": 1e6, "save and restore": 1e3}


def command(bench, folder, fmu):
    """The benchmark's arguments for an FMU: its 16 inputs and its first 60 outputs."""
    unpacked = fmpy.extract(str(fmu), unzipdir=str(folder / fmu.stem))
    description = fmpy.read_model_description(unpacked)
    of = lambda causality: [str(v.valueReference) for v in description.modelVariables
                            if v.causality == causality and v.type == "Real"]
    library = Path(unpacked) / "binaries/linux64" / f"{description.coSimulation.modelIdentifier}.so"
    inputs, outputs = of("input")[:16], of("output")[:60]
    print(f"{fmu.stem}: {len(inputs)} inputs, {len(outputs)} outputs", file=sys.stderr)
    return [bench, library, (Path(unpacked) / "resources").as_uri(), description.guid, ",".join(inputs), ",".join(outputs)]


def measure(arguments):
    """(best, median) in ns by name."""
    # PythonFMU's library wants Python's to be there already.
    python = Path(sysconfig.get_config_var("LIBDIR")) / sysconfig.get_config_var("LDLIBRARY")
    environment = {**os.environ, "LD_PRELOAD": str(python), "PYTHONPATH": ":".join(path for path in sys.path if path)}
    done = subprocess.run(arguments, capture_output=True, text=True, check=False, env=environment)
    figures = {}
    for line in done.stdout.splitlines():
        found = re.fullmatch(r"(.+) ([\d.]+) ([\d.]+)", line)
        if found:
            figures[found[1]] = float(found[2]), float(found[3])
    if not figures:
        sys.exit(f"{arguments[1]}: {done.stdout} {done.stderr}")
    return figures


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("urdf2fmu")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        bench = folder / "calls"
        subprocess.run(["cc", "-std=gnu11", "-O2", "-o", bench, HERE / "calls.c", "-ldl"], check=True)
        ours = folder / "urdf2fmu.fmu"
        r2d2 = Path(pybullet_data.getDataPath()) / "r2d2.urdf"
        subprocess.run([options.urdf2fmu, "export", r2d2, "-o", ours], check=True, capture_output=True)
        subprocess.run([sys.executable, "-m", "pythonfmu", "build", "-f", HERE / "pybullet_slave.py", "-d", folder],
                       check=True, capture_output=True)
        programs = {"urdf2fmu": command(bench, folder, ours),
                    "PythonFMU + PyBullet": command(bench, folder, folder / "PyBulletR2D2.fmu")}
        rounds = {who: [] for who in programs}
        for _ in range(options.rounds):
            for who, arguments in programs.items():
                rounds[who].append(measure(arguments))
    names = list(rounds["urdf2fmu"][0])
    lines = ["| per call | bound, µs | urdf2fmu best, µs | median, µs | PythonFMU + PyBullet best, µs | times |", "|---|---|---|---|---|---|"]
    for what in names:
        best = {who: min((r[what][0] for r in results if what in r), default=None) for who, results in rounds.items()}
        median = statistics.median(r[what][1] for r in rounds["urdf2fmu"])
        mine, other = best["urdf2fmu"], best["PythonFMU + PyBullet"]
        bound = f"{BOUNDS[what] / 1e3:g}" if what in BOUNDS else ""
        them = "not offered" if other is None else f"{other / 1e3:.3g}"
        times = "" if other is None else f"{other / mine:.0f}"
        lines.append(f"| {what} | {bound} | {mine / 1e3:.3g} | {median / 1e3:.3g} | {them} | {times} |")
    cpu = next((line.split(":")[1].strip() for line in Path("/proc/cpuinfo").read_text().splitlines()
                if line.startswith("model name")), platform.processor())
    lines += ["", f"Best and median of {options.rounds} alternating rounds on {cpu}; pybullet {version('pybullet')}, "
                  f"pythonfmu {version('pythonfmu')}."]
    table = "\n".join(lines)
    print(table)
    if options.write:
        page = ROOT / "docs/performance.md"
        text = page.read_text()
        head, rest = text.split(BEGIN)
        page.write_text(head + BEGIN + "\n" + table + "\n" + END + rest.split(END)[1])


if __name__ == "__main__":
    main()
