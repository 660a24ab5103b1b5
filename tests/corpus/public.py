"""Every URDF below some folders: what `check` says, what loads, whether anything is lost, how often a newcomer runs it.

Usage: python public.py URDF2FMU FOLDER…

A refused file is tried again with what the messages of the first run offer, once: the first of their options. What
loads is compared with Python's XML reader (`independent.py`), as corpus.py does.
"""

import json
import os
import re
import sys
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import ours
from independent import counts

# Options that a message offers with their values.
OFFERED = re.compile(r"(--inertia collision --density \d+|--density \d+|--compat pybullet|--inertia collision"
                     r"|--package \S+=/\S+|--package-path /\S+)")


def judge(command, urdf):
    """`fate`, the errors of the first run, the options that made it load, and what is lost."""
    first = json.loads(ours.call(command, "check", "--json", urdf).stdout)
    errors = [finding for finding in first["findings"] if finding["severity"] == "error"]
    options, runs = [], 1
    if errors:
        # U066 tells what would come next.
        for finding in errors + [f for f in first["findings"] if f["code"] == "U066"]:
            found = OFFERED.search(finding["help"] or "")
            if found and found.group(1) not in options:
                options.append(found.group(1))
        if not options:
            return {"fate": "refused", "errors": errors, "runs": 1}
        words = [word for option in options for word in option.split()]
        runs = 2
        again = json.loads(ours.call(command, "check", "--json", urdf, *words).stdout)
        if not again["ok"]:
            return {"fate": "refused", "errors": errors, "runs": 2,
                    "again": [f for f in again["findings"] if f["severity"] == "error"]}
        return {"fate": "loads as offered", "errors": errors, "runs": 2, "options": options}
    told = {"fate": "loads", "runs": runs, "errors": []}
    text = urdf.read_text(errors="replace")
    if "<xacro:" in text:
        return told
    said = counts(str(urdf))
    if "fault" in said:
        return told | {"wrong": [said["fault"]]}
    robot = json.loads(ours.call(command, "info", "--json", urdf).stdout)
    wrong, replaced = ours.lost(said, ours.contents(robot, first["findings"]))
    return told | {"wrong": wrong, "replaced": len(replaced), "counted": {
        "links": len(said["links"]), "joints": len(said["joints"]), "colliders": sum(said["colliders"].values()),
        "masses": len(said["inertials"])}}


def main():
    command, *folders = sys.argv[1:]
    files = [file for folder in folders for file in sorted(Path(folder).resolve().rglob("*.[uU][rR][dD][fF]"))
             if file.is_file()]
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        told = dict(zip(files, pool.map(lambda file: judge(command, file), files), strict=True))
    for fate, number in Counter(answer["fate"] for answer in told.values()).items():
        print(f"{number:6} {fate}")
    ours.sum_up(told, "in those that load")
    for file, answer in told.items():
        if answer["fate"] == "refused":
            errors = answer.get("again", answer["errors"])
            print(f"{file}: refused, {len(errors)}: {errors[0]['code']} line {errors[0]['line']}: {errors[0]['message']}")


if __name__ == "__main__":
    main()
