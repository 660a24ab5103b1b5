"""Times the tree algorithms beside Pinocchio's in C++, on the same URDFs, in turn; a table for docs/performance.md.

    python3.11 -m venv peers && peers/bin/pip install -r benches/peers/requirements.txt
    peers/bin/python benches/peers/pinocchio_compare.py [--rounds 5] [--write]

Needs g++: the C++ side is compiled against headers and libraries of the wheels `pin` and `cmeel-eigen`, with -O3 and the
instruction set that the wheel's own binaries are made for (x86-64). Best of all rounds; each is the best of 25 loops.
"""

import argparse
import json
import subprocess
import tempfile
from importlib.metadata import version
from pathlib import Path

import pinocchio

from ours import ROOT, build
from page import machine, write
from scene import data, panda_free, robot_data, strip, text


def robots():
    """Name, URDF text, whether the base is fixed; masses and joints only, mimic joints none."""
    yield "iiwa", text(strip(data("kuka_iiwa/model.urdf"), keep=())), True
    yield "panda", panda_free().urdf, True
    yield "anymal", text(strip(robot_data("anymal_b_simple_description/robots/anymal.urdf"), keep=())), False
    yield "talos", text(strip(robot_data("talos_data/robots/talos_reduced.urdf"), keep=())), False


def compile_peer(folder):
    """The C++ program."""
    prefix = Path(pinocchio.__file__).parents[4]
    program = folder / "pinocchio_dynamics"
    subprocess.run(["g++", "-O3", "-DNDEBUG", "-march=x86-64", "-std=c++17", "-w",
                    "-DBOOST_MPL_LIMIT_LIST_SIZE=30", "-DBOOST_MPL_LIMIT_VECTOR_SIZE=30",  # as its CMake file asks
                    "-DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS", "-DBOOST_FUSION_INVOKE_MAX_ARITY=12",
                    "-DPINOCCHIO_ENABLE_TEMPLATE_INSTANTIATION",  # the library's own, compiled by its makers
                    f"-I{prefix}/include",
                    f"-I{prefix}/include/eigen3", str(Path(__file__).with_name("pinocchio_dynamics.cpp")),
                    "-o", str(program), f"-L{prefix}/lib", "-lpinocchio_default", "-lboost_serialization",
                    f"-Wl,-rpath,{prefix}/lib,-rpath-link,{prefix}/lib"], check=True)
    return program


def best(old, new):
    """The smaller of each."""
    return new if old is None else {key: min(old[key], new[key]) for key in old}


def main():
    """Command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--write", action="store_true", help="put the table into docs/performance.md")
    arguments = parser.parse_args()
    ours = build("dynamics")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        peer = compile_peer(folder)
        cases = []
        for robot, urdf, fixed in robots():
            (folder / f"{robot}.urdf").write_text(urdf)
            free = () if fixed else (pinocchio.JointModelFreeFlyer(),)
            pinocchio.buildModelFromXML(urdf, *free).saveToBinary(str(folder / f"{robot}.bin"))
            cases.append((robot, [ours, *(["--fixed"] if fixed else []), str(folder / f"{robot}.urdf")],
                          [peer, str(folder / f"{robot}.bin")]))
        results = {robot: [None, None] for robot, *_ in cases}
        for _ in range(arguments.rounds):
            for robot, *commands in cases:
                for i, command in enumerate(commands):
                    answer = subprocess.run(command, stdout=subprocess.PIPE, text=True, check=True).stdout
                    results[robot][i] = best(results[robot][i], json.loads(answer))
    lines = ["| robot | degrees of freedom | ABA, µs, ours / Pinocchio | CRBA | bias `k(q, v)` | RNEA of Pinocchio |",
             "|---|---|---|---|---|---|"]
    for robot, (a, b) in results.items():
        assert a["nv"] == b["nv"], robot
        pair = " | ".join(f"{a[x] / 1e3:.2f} / {b[y] / 1e3:.2f} = {a[x] / b[y]:.2f}"
                          for x, y in (("aba", "aba"), ("crba", "crba"), ("rnea", "bias")))
        lines.append(f"| {robot} | {a['nv']} | {pair} | {b['rnea'] / 1e3:.2f} |")
    lines += ["", f"Best of {arguments.rounds} rounds on {machine()}; pin {version('pin')}, g++ -O3 -march=x86-64."]
    chains = subprocess.run([ours], stdout=subprocess.PIPE, text=True, check=True).stdout
    write("chains", "benches/peers/pinocchio_compare.py", chains.strip(), arguments.write)
    write("pinocchio", "benches/peers/pinocchio_compare.py", "\n".join(lines), arguments.write)


if __name__ == "__main__":
    main()
