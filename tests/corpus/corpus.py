"""Every URDF of pybullet_data and example-robot-data: exported, loaded, stepped, nothing lost; the same for others.

Usage: python corpus.py URDF2FMU PYBULLET_DATA EXAMPLE_ROBOTS [--write ../../docs/corpus.md] [--no-peers]

URDF2FMU is the command, such as `target/debug/urdf2fmu`. The peers need pybullet, mujoco, pin and numpy in this
interpreter's environment. Ends with exit code 1 if a file fails, is refused without a line, or loses something. Takes
ten minutes on two cores.

What must be there is counted by `independent.py`, with Python's XML reader.
"""

import json
import os
import re
import subprocess
import sys
from argparse import ArgumentParser
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import ours
from independent import counts, times

HERE = Path(__file__).resolve().parent
PEERS = ("pybullet", "mujoco", "pinocchio")
MOVING = {"revolute", "continuous", "prismatic", "planar", "floating", "spherical", "ball"}
KINDS = ("links", "joints", "colliders", "masses", "inertias")
# Relative to the largest entry; peers turn inertias into principal axes and back.
SAME = 1e-6


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


def turned(R, I):
    """R I Rᵀ"""
    return times(times(R, I), [list(row) for row in zip(*R)])


def joined(parts):
    """Mass, centre and inertia about it of some bodies together."""
    mass = sum(part[0] for part in parts)
    center = [sum(m * c[i] for m, c, _ in parts) / mass for i in range(3)] if mass else [0.0] * 3
    total = [[0.0] * 3 for _ in range(3)]
    for m, c, I in parts:
        d = [a - b for a, b in zip(c, center)]
        square = sum(x * x for x in d)
        for i in range(3):
            for j in range(3):
                total[i][j] += I[i][j] + m * ((square if i == j else 0.0) - d[i] * d[j])
    return mass, center, total


def bodies(said):
    """Joint that moves a body ("" for the root's) -> mass, centre, inertia of what is fixed together, in its frame."""
    below = {}
    for joint, (parent, child, R, p) in said["tree"].items():
        below.setdefault(parent, []).append((joint, child, R, p))
    children = {child for _, child, *_ in said["tree"].values()}
    unit = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]
    parts, todo = {}, [(link, "", unit, [0.0] * 3) for link in said["links"] if link not in children]
    while todo:
        link, body, R, p = todo.pop()
        place = [(mass, [a + sum(R[i][k] * c[k] for k in range(3)) for i, a in enumerate(p)], turned(R, I))
                 for mass, c, I in [said["inertials"].get(link, (0.0, [0.0] * 3, [[0.0] * 3] * 3))]]
        parts.setdefault(body, []).extend(place)
        for joint, child, R_joint, p_joint in below.get(link, []):
            if said["joints"][joint] in MOVING:
                todo.append((child, joint, unit, [0.0] * 3))
            else:
                there = [a + sum(R[i][k] * p_joint[k] for k in range(3)) for i, a in enumerate(p)]
                todo.append((child, body, times(R, R_joint), there))
    return {body: joined(list_) for body, list_ in parts.items()}


def other_inertia(mine, theirs):
    """Whether two bodies are not the same."""
    (mass, center, I), (their_mass, their_center, their_I) = mine, theirs
    flat, their_flat = sum(I, []), sum(their_I, [])
    scale = max(map(abs, flat)) + mass * max(map(abs, center)) ** 2
    far = max(map(abs, [1e-3, *center]))
    return (abs(mass - their_mass) > SAME * mass
            or any(abs(a - b) > SAME * far for a, b in zip(center, their_center)) and mass > 0
            or any(abs(a - b) > SAME * scale for a, b in zip(flat, their_flat)))


def lost_by_peer(name, said, told):
    """Kinds of things of which it has fewer, or others."""
    moving = {joint for joint, kind in said["joints"].items() if kind in MOVING}
    mass = sum(said["masses"].values())
    children = {child for _, child, *_ in said["tree"].values()}
    links = {link for link in said["links"] if name != "mujoco" or link in children}
    if name == "pybullet":
        mine = {link: inertial for link, inertial in said["inertials"].items() if inertial[0] > 0}
    else:
        mine = {body: inertia for body, inertia in bodies(said).items() if inertia[0] > 0 and body in told["inertias"]}
    return {kind for kind, less in {
        "links": not links <= set(told["links"]),
        "joints": not moving <= set(told["moving"]),
        "colliders": told["colliders"] < sum(said["colliders"].values()),
        "masses": told["mass"] < mass * (1 - 1e-6),
        "inertias": any(other_inertia(inertia, told["inertias"][key]) for key, inertia in mine.items()),
    }.items() if less}


def reason(message):
    """An error message without what differs from file to file."""
    message = message.strip().splitlines()[0] if message.strip() else "no message"
    message = re.sub(r"'[^']*'|\"[^\"]*\"", "'…'", message)
    return re.sub(r"\d+", "n", re.sub(r"/\S+", "…", message)).rstrip(".")


def row(*cells):
    return "| " + " | ".join(str(cell).replace("|", "\\|") for cell in cells) + " |"


def main():
    parse = ArgumentParser()
    parse.add_argument("command")
    parse.add_argument("data", nargs=2, type=lambda name: Path(name).resolve())
    parse.add_argument("--write", type=Path)
    parse.add_argument("--no-peers", action="store_true")
    given = parse.parse_args()
    roots = dict(zip(("pybullet_data", "example-robot-data"), given.data))
    short = {str(file): f"{name}/{file.relative_to(root)}" for name, root in roots.items()
             for file in sorted(root.rglob("*.urdf"))}
    files = list(short)
    said = {file: counts(file) for file in files}
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        told = dict(zip(files, pool.map(lambda file: ours.judge(given.command, file), files), strict=True))

    bad, refused, replaced = [], [], Counter()
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
            wrong, others = ours.lost(said[file], answer)
            bad += [f"{short[file]}: {what}" for what in wrong]
            replaced[file] = len(others)

    text = ["# Other people's robots", "",
            "This page is written by `tests/corpus/corpus.py --write`. Every URDF of pybullet_data 3.2.7 (with",
            "its `random_urdfs`) and of example-robot-data 6.0.0 is exported with the default settings. The FMU",
            f"is loaded through its C functions (`urdf2fmu simulate`) and takes {ours.STEPS} steps of 1/240 s, in which",
            "every output must stay finite. An independent XML reader (Python's `xml.etree`) counts the contents",
            "of each file, and the script looks for them in the FMU: links and joints by name, collision shapes",
            "by link, the mass of every `<inertial>` to the last digit, its centre and matrix in the link's axes",
            "to 1e-12.", "",
            row("files", *roots, "together"), row("---", "---", "---", "---")]
    fates = {name: Counter(told[f]["fate"] for f in files if short[f].startswith(name + "/")) for name in roots}
    for what in ("loaded", "refused", "failed"):
        numbers = [fates[name][what] for name in roots]
        text.append(row({"loaded": "exported, loaded, stepped", "refused": "refused for a fault in the file",
                         "failed": "failed"}[what], *numbers, sum(numbers)))
    good = [f for f in files if told[f]["fate"] == "loaded" and "fault" not in said[f]]
    text += ["", "In the files that load:", "", row("what", "in the files", "lost"), row("---", "---", "---")]
    for kind, field, size in (("links", "links", len), ("joints", "joints", len),
                              ("colliders", "colliders", lambda c: sum(c.values())), ("masses", "inertials", len),
                              ("inertias", "inertials", len)):
        have = sum(size(said[f][field]) for f in good)
        gone = sum(1 for line in bad if f": {kind}" in line)
        text.append(row(kind, have, gone))
    text += ["", f"{sum(replaced.values())} of the inertias, in {sum(1 for n in replaced.values() if n)} files, are replaced, because they",
             "are zero, or zero about an axis, and the mass matrix would be singular. Each is reported with its",
             "line (A123, U063, U064). Nearly all belong to the `random_urdfs`: 0.1 kg with",
             "`ixx=\"1\" iyy=\"1\" izz=\"0\"`.",
             "", "The refused files, with the first error of each:", "", row("file", "line", "errors", "what"),
             row("---", "---", "---", "---")]
    for name, line, errors, message in refused:
        for file, other in short.items():
            message = message.replace(file.rsplit("/", 1)[0], other.rsplit("/", 1)[0])
        text.append(row(name, line, errors, message))

    if not given.no_peers:
        text += ["", "## The same files in other programs", "",
                 "Each program reads the unchanged files with its default settings. Pinocchio gets the folders above",
                 "the file as package paths, and a free-flying root. *Lost* counts files that load but have fewer",
                 "links, moving joints or collision shapes, less mass or other inertias than the XML states (for",
                 "MuJoCo and Pinocchio summed over links that are fixed together, to 1e-6). PyBullet computes inertias",
                 "from the shapes instead. MuJoCo merges links that are fixed to others, and welds a root link to the",
                 "world, where it has no mass.", "",
                 row("", "loaded", "refused", "crashed or hung", *(f"{kind} lost" for kind in KINDS)),
                 row(*["---"] * (4 + len(KINDS)))]
        all_fates = Counter(answer["fate"] for answer in told.values())
        text.append(row("urdf2fmu", all_fates["loaded"], all_fates["refused"], all_fates["failed"],
                        *(len({line.split(": ")[0] for line in bad if f": {kind}" in line}) for kind in KINDS)))
        reasons = {}
        for name in PEERS:
            answers = dict(zip(files, peer(name, files), strict=True))
            fate = Counter(answer["fate"] for answer in answers.values())
            gone = Counter(kind for f, answer in answers.items() if answer["fate"] == "loaded" and "fault" not in said[f]
                           for kind in lost_by_peer(name, said[f], answer))
            text.append(row(name, fate["loaded"], fate["refused"], fate["crashed"], *(gone[kind] for kind in KINDS)))
            reasons[name] = Counter((reason(answer["reason"]), "random_urdfs" in f) for f, answer in answers.items()
                                    if answer["fate"] == "refused")
        text += ["", "The messages with which files are refused, counted (`'…'` is a name, `n` a number). The thousand",
                 "`random_urdfs` differ only in a mesh, so that one reason can apply to all of them:", "",
                 row("", "message", "random_urdfs", "others"), row("---", "---", "---", "---")]
        for name, found in reasons.items():
            together = Counter()
            for (message, _), n in found.items():
                together[message] += n
            for message, _ in together.most_common(6):
                text.append(row(name, message, found[message, True], found[message, False]))
            if rest := together.most_common()[6:]:
                text.append(row(name, f"{len(rest)} others", sum(found[m, True] for m, _ in rest),
                                sum(found[m, False] for m, _ in rest)))

    text = "\n".join(text) + "\n"
    print(text)
    if given.write:
        given.write.write_text(text)
    print("\n".join(bad), file=sys.stderr)
    return 1 if bad else 0


if __name__ == "__main__":
    os.environ.pop("PYTHONPATH", None)
    sys.exit(main())
