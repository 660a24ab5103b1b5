"""A newcomer: does what `check` says, to the letter and nothing else, and counts the runs until a file loads.

Usage: python newcomer.py URDF2FMU JSON FOLDER…

Every folder in a FOLDER is one package or repository. Each file below that ends in .urdf or .xacro is checked where it
is, and what loads is compared with Python's XML reader (`independent.py`). What is refused is checked in a copy, in
which the newcomer does what the messages of a run say before the next one (`remedies.py`). JSON gets all that was told,
the output a table of the runs with the worst files on top.

What can be had is had: a package that another FOLDER has, and a cube for a mesh that is missing, so that what would
come next is seen. A file of which something is left that nobody can give counts with the run that told the last of it.
"""

import json
import os
import subprocess
import sys
import tempfile
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import ours
from independent import counts
from packages import firsts
from remedies import Remedies

# More runs are not of interest.
MOST = 6
# Findings that tell beforehand what would be an error.
FORETOLD = ("U066",)


def check(command, file, words):
    """What a run of `check` says."""
    done = ours.call(command, "check", "--json", file, *words)
    try:
        return json.loads(done.stdout)
    except ValueError:
        # The command line itself is refused, or it crashed.
        error = {"severity": "error", "code": "", "message": done.stderr, "help": "", "file": None, "line": None}
        return {"ok": False, "findings": [error]}


def told(answer):
    """What of an answer a newcomer acts upon."""
    return [finding for finding in answer["findings"]
            if finding["severity"] == "error" or finding["code"] in FORETOLD]


def is_part(findings):
    """Whether the file is told to be a part of another one, or has no robot in it."""
    return any("give a file that includes this one" in (finding["help"] or "")
               and "or, if this is a part" not in finding["help"]
               or finding["code"] == "U010" for finding in findings)


def short(finding):
    return {key: finding[key] for key in ("code", "line", "message", "help")}


def compared(command, file, answer, words=()):
    """What a file has and the robot has not, and how much it has."""
    with tempfile.TemporaryDirectory() as folder:
        text = Path(file)
        if any(finding["code"] == "U024" for finding in answer["findings"]):
            expanded = ours.call(command, "expand", file, *words)
            text = Path(folder) / "expanded.urdf"
            text.write_text(expanded.stdout)
        said = counts(text)
    if "fault" in said:
        return {"wrong": [f"the independent reader refuses it: {said['fault']}"]}
    told = ours.call(command, "info", "--json", file, *words)
    try:
        robot = json.loads(told.stdout)
    except ValueError:
        return {"wrong": [f"info: {told.stderr}"]}
    wrong, replaced = ours.lost(said, ours.contents(robot, answer["findings"]))
    return {"wrong": wrong, "replaced": len(replaced), "counted": {
        "links": len(said["links"]), "joints": len(said["joints"]), "colliders": sum(said["colliders"].values()),
        "masses": len(said["inertials"])}}


def mended(command, file, home, packages):
    """Runs `check` and does what it says until the file loads or nothing is left to do."""
    remedies = Remedies(file, home, packages)
    runs, known, last = [], set(), 1
    for run in range(1, MOST + 1):
        answer = check(command, file, remedies.words())
        if answer["ok"]:
            return {"fate": "loads", "runs": run, "told": runs, "words": remedies.words()}
        findings = told(answer)
        runs.append([short(finding) for finding in findings])
        if is_part(findings):
            return {"fate": "part", "runs": run, "told": runs}
        changed, left = remedies.follow(findings, lambda: told(check(command, file, remedies.words())))
        # What cannot be given counts with the run that told it first.
        new = {(finding["code"], finding["message"]) for finding in left} - known
        if new:
            known |= new
            last = run
        if not changed:
            lacks = all(remedies.lacks(finding) for finding in left)
            return {"fate": "lacks" if lacks else "other", "runs": last, "told": runs,
                    "left": [short(finding) for finding in left]}
    return {"fate": "other", "runs": MOST, "told": runs, "left": []}


def judge(command, file, root, packages):
    """What becomes of a file."""
    try:
        first = check(command, file, [])
        if first["ok"]:
            return {"fate": "loads", "runs": 1} | compared(command, file, first)
        findings = told(first)
        if is_part(findings):
            return {"fate": "part", "runs": 1, "told": [[short(finding) for finding in findings]]}
        inner = file.relative_to(root)
        with tempfile.TemporaryDirectory() as folder:
            # Deep enough that no search for packages and meshes comes upon another copy.
            folder = Path(folder) / "of" / "a" / "newcomer"
            folder.mkdir(parents=True)
            # Hard links where they can be had: what is edited is written anew.
            linked = subprocess.run(["cp", "-al", root / inner.parts[0], folder], capture_output=True, check=False)
            if linked.returncode != 0:
                subprocess.run(["cp", "-a", root / inner.parts[0], folder], check=True)
            own = {name: folder / place.relative_to(root) if place.is_relative_to(root / inner.parts[0]) else place
                   for name, place in packages.items()}
            return mended(command, folder / inner, folder, own)
    except subprocess.TimeoutExpired:
        return {"fate": "timeout", "runs": 0}


def report(answers):
    """The table, the worst first, and the files of its upper rows."""
    rows = Counter()
    for answer in answers.values():
        rows[answer["fate"], answer["runs"]] += 1
    meaning = {"loads": "load in run", "lacks": "lack what nobody can give, all of it told in run",
               "other": "cannot be mended so, all of it told in run", "part": "are parts or no robots, told in run",
               "timeout": "take too long"}
    for (fate, runs), number in sorted(rows.items(), key=lambda row: (-row[0][1], row[0][0])):
        print(f"{number:6} {meaning[fate]} {runs}")
    ours.sum_up(answers, "in those that load as they are")
    for file, answer in answers.items():
        if answer["runs"] > 2:
            print(f"{file}: {answer['fate']}, {answer['runs']} runs")
            for run, findings in enumerate(answer["told"], 1):
                for finding in findings:
                    print(f"    {run}: {finding['code']} line {finding['line']}: {finding['message']}")


def main():
    command, table, *folders = sys.argv[1:]
    folders = [Path(folder).resolve() for folder in folders]
    known = firsts(folders)
    files = [(file, root) for root in folders for file in sorted(root.rglob("*"))
             if file.suffix.lower() in (".urdf", ".xacro") and file.is_file()]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        found = pool.map(lambda pair: judge(command, *pair, known), files)
        answers = {str(file): answer for (file, _), answer in zip(files, found, strict=True)}
    Path(table).write_text(json.dumps(answers, indent=1))
    report(answers)


if __name__ == "__main__":
    main()
