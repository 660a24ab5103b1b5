"""Every URDF of pybullet_data and example-robot-data: read, stepped, nothing lost; the same for other simulators.

Usage: python corpus.py DRIVER PYBULLET_DATA EXAMPLE_ROBOTS [--write ../../docs/corpus.md] [--no-peers]

DRIVER is `target/debug/examples/corpus` (`cargo build --example corpus`). The peers need pybullet, mujoco and pin in
this interpreter's environment. Ends with exit code 1 if a file fails, is refused without a line, or loses something.

What must be there is counted by `independent.py`, with Python's XML reader.
"""

import json
import os
import subprocess
import sys
from argparse import ArgumentParser
from collections import Counter
from pathlib import Path

from independent import counts

HERE = Path(__file__).resolve().parent
PEERS = ("pybullet", "mujoco", "pinocchio")
MOVING = {"revolute", "continuous", "prismatic", "planar", "floating", "spherical", "ball"}


def ours(driver, files):
    """What becomes of the files here."""
    done = subprocess.run([driver], input="\n".join(files), capture_output=True, text=True, check=True)
    return [json.loads(line) for line in done.stdout.splitlines()]


def peer(name, files):
    """What becomes of them in another simulator; where it crashes or hangs, it starts again after the file."""
    told = []
    while len(told) < len(files):
        # A chunk at a time bounds what a hang costs.
        rest = files[len(told):len(told) + 100]
        try:
            done = subprocess.run([sys.executable, "-B", HERE / "peers.py", name], input="\n".join(rest), text=True,
                                  stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, check=False, timeout=120)
            answers = done.stdout
        except subprocess.TimeoutExpired as late:
            answers = (late.stdout or b"").decode()
        lines = [json.loads(line) for line in answers.splitlines() if line.endswith("}")]
        told += lines
        if len(lines) < len(rest):
            told.append({"fate": "crashed"})
    return told


def lost(said, told):
    """What the file says and our model does not have; and the other way round."""
    wrong = []
    for kind, have in (("links", set(told["links"])), ("joints", set(told["joints"]))):
        if missing := set(said[kind]) ^ have:
            wrong.append(f"{kind}: {sorted(missing)}")
    for kind in ("colliders", "masses"):
        for link, value in said[kind].items():
            if told[kind].get(link) != value:
                wrong.append(f"{kind} of {link}: {told[kind].get(link)}, not {value}")
    return wrong


def lost_by_peer(said, told):
    """Kinds of things of which it has fewer."""
    moving = {name for name, kind in said["joints"].items() if kind in MOVING}
    mass = sum(said["masses"].values())
    return {kind for kind, less in {
        "joints": not moving <= set(told["moving"]),
        "colliders": told["colliders"] < sum(said["colliders"].values()),
        "mass": told["mass"] < mass * (1 - 1e-6),
    }.items() if less}


def row(*cells):
    return "| " + " | ".join(str(cell) for cell in cells) + " |"


def main():
    parse = ArgumentParser()
    parse.add_argument("driver")
    parse.add_argument("data", nargs=2, type=lambda name: Path(name).resolve())
    parse.add_argument("--write", type=Path)
    parse.add_argument("--no-peers", action="store_true")
    given = parse.parse_args()
    roots = dict(zip(("pybullet_data", "example-robot-data"), given.data))
    short = {str(file): f"{name}/{file.relative_to(root)}" for name, root in roots.items()
             for file in sorted(root.rglob("*.urdf"))}
    files = list(short)
    said = {file: counts(file) for file in files}
    told = dict(zip(files, ours(given.driver, files), strict=True))

    bad, refused = [], []
    for file in files:
        answer = told[file]
        if answer["fate"] == "failed":
            bad.append(f"{short[file]}: {answer['reason']}")
        elif answer["fate"] == "refused":
            first = answer["errors"][0]
            refused.append((short[file], first["line"], len(answer["errors"]), first["message"]))
            if any(error["line"] is None for error in answer["errors"]):
                bad.append(f"{short[file]}: refused without a line")
        elif "fault" in said[file]:
            bad.append(f"{short[file]}: loaded, but it is not XML: {said[file]['fault']}")
        else:
            bad += [f"{short[file]}: {what}" for what in lost(said[file], answer)]

    text = ["# Other people's robots", "",
            "Written by `tests/corpus/corpus.py --write`. Every URDF of pybullet_data 3.2.7 (`random_urdfs` included) and of",
            "example-robot-data 6.0.0 is read with the default settings, assembled and stepped 100 times by 1/240 s; every",
            "number of the state must stay finite. What a file says is counted by an independent XML reader (Python's",
            "`xml.etree`): links and joints by name, collision shapes by link, masses by link and to the last digit.", "",
            row("files", *roots, "together"), row("---", "---", "---", "---")]
    fates = {name: Counter(told[f]["fate"] for f in files if short[f].startswith(name + "/")) for name in roots}
    for what in ("loaded", "refused", "failed"):
        numbers = [fates[name][what] for name in roots]
        text.append(row({"loaded": "loaded and stepped", "refused": "refused for a fault in the file",
                         "failed": "failed in a step"}[what], *numbers, sum(numbers)))
    good = [f for f in files if told[f]["fate"] == "loaded"]
    text += ["", "In the files that load:", "", row("what", "in the files", "lost"), row("---", "---", "---")]
    for kind, size in (("links", len), ("joints", len), ("colliders", lambda c: sum(c.values())), ("masses", len)):
        have = sum(size(said[f][kind]) for f in good if kind in said[f])
        gone = sum(1 for line in bad if f": {kind}" in line)
        text.append(row(kind, have, gone))
    text += ["", "The refused ones, with the first error:", "", row("file", "line", "errors", "what"),
             row("---", "---", "---", "---")]
    for name, line, errors, message in refused:
        for file, other in short.items():
            message = message.replace(file.rsplit("/", 1)[0], other.rsplit("/", 1)[0])
        text.append(row(name, line, errors, message))

    if not given.no_peers:
        text += ["", "## The same files elsewhere", "",
                 "Each program reads the files as they are, with its defaults; Pinocchio is told the folders above the file as",
                 "package paths and given a free-flying root. *Lost* counts files that load but have fewer moving joints,",
                 "fewer collision shapes or less mass than the XML says. MuJoCo welds a root link to the world, which has no",
                 "mass there; the thousand `random_urdfs` differ little, and one reason can refuse nearly all of them.", "",
                 row("", "loaded", "refused", "crashed or hung", "joints lost", "colliders lost", "mass lost"),
                 row(*["---"] * 7)]
        all_fates = Counter(answer["fate"] for answer in told.values())
        text.append(row("urdf2fmu", all_fates["loaded"], all_fates["refused"], all_fates["failed"],
                        *(len({line.split(": ")[0] for line in bad if f": {kind}" in line})
                          for kind in ("joints", "colliders", "masses"))))
        for name in PEERS:
            answers = dict(zip(files, peer(name, files), strict=True))
            fate = Counter(answer["fate"] for answer in answers.values())
            gone = Counter(kind for f, answer in answers.items() if answer["fate"] == "loaded" and "fault" not in said[f]
                           for kind in lost_by_peer(said[f], answer))
            text.append(row(name, fate["loaded"], fate["refused"], fate["crashed"],
                            gone["joints"], gone["colliders"], gone["mass"]))

    text = "\n".join(text) + "\n"
    print(text)
    if given.write:
        given.write.write_text(text)
    print("\n".join(bad), file=sys.stderr)
    return 1 if bad else 0


if __name__ == "__main__":
    os.environ.pop("PYTHONPATH", None)
    sys.exit(main())
