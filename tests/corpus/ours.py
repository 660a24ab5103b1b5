"""What becomes of a URDF here: checked, exported as an FMU, the FMU loaded and stepped."""

import csv
import json
import math
import re
import subprocess
import tempfile
from collections import Counter
from pathlib import Path

STEPS = 100
STEP = 1 / 240
# Relative to the largest entry: a turned inertia is rounded.
ROUNDED = 1e-12


def call(command, *arguments):
    """Runs `urdf2fmu`."""
    return subprocess.run([command, *map(str, arguments)], capture_output=True, text=True, timeout=300, check=False)


def contents(robot, findings):
    """What is in `urdf2fmu info --json`, and which links' inertias `urdf2fmu check --json` tells to be replaced."""
    return {
        "links": [link["name"] for link in robot["links"]],
        "joints": [joint["name"] for joint in robot["joints"]],
        "colliders": {link["name"]: len(link["collision"]) for link in robot["links"] if link["collision"]},
        "inertials": {link["name"]: (link["mass"], link["com"], link["inertia"]) for link in robot["links"]},
        "split": split(findings),
        "replaced": [finding["message"] for finding in findings if finding["code"] in ("A123", "U063", "U064")],
    }


def split(findings):
    """How many colliders more there are because meshes of several objects are several, as a finding says."""
    told = [re.search(r"\((\d+) of (\d+) objects", f["message"]) for f in findings if f["code"] == "U119"]
    return sum(int(found[2]) - int(found[1]) for found in told)


def judge(command, urdf):
    """`fate` is `loaded`, `refused` (with the errors) or `failed` (with the reason); and what the FMU has of the robot."""
    findings = json.loads(call(command, "check", "--json", urdf).stdout)["findings"]
    with tempfile.TemporaryDirectory() as folder:
        fmu, table = Path(folder) / "robot.fmu", Path(folder) / "robot.csv"
        made = call(command, "export", urdf, "-o", fmu, "--platform", "linux64")
        if made.returncode != 0:
            errors = [finding for finding in findings if finding["severity"] == "error"]
            if made.returncode == 1 and errors:
                return {"fate": "refused", "errors": errors}
            return {"fate": "failed", "reason": made.stderr.strip().splitlines()[-1]}
        robot = json.loads(call(command, "info", "--json", fmu).stdout)
        # Through the FMU's C functions, as an importer does.
        done = call(command, "simulate", fmu, "--output-file", table, "--stop-time", STEPS * STEP,
                    "--output-interval", STEP)
        told = {"fate": "loaded"} | contents(robot, findings)
        if done.returncode != 0:
            return told | {"fate": "failed", "reason": done.stderr.strip().splitlines()[-1]}
        with table.open(newline="") as file:
            _names, *rows = csv.reader(file)
        if len(rows) != STEPS + 1:
            return told | {"fate": "failed", "reason": f"{len(rows)} rows, not {STEPS + 1}"}
        if not all(math.isfinite(float(cell)) for row in rows for cell in row):
            return told | {"fate": "failed", "reason": "a number is not finite"}
        return told


def close(a, b, scale):
    """Whether numbers are the same but for round-off."""
    return all(abs(x - y) <= ROUNDED * scale for x, y in zip(a, b, strict=True))


def lost(said, told):
    """What the file says and the FMU does not have, or has otherwise; and inertias that it has otherwise and says so."""
    wrong, replaced = [], []
    for kind, have in (("links", set(told["links"])), ("joints", set(told["joints"]))):
        if missing := set(said[kind]) ^ have:
            wrong.append(f"{kind}: {sorted(missing)}")
    more = 0
    for link, value in said["colliders"].items():
        have = told["colliders"].get(link, 0)
        more += have - value
        if have < value or (have > value and told["split"] == 0):
            wrong.append(f"colliders of {link}: {have}, not {value}")
    if more != told["split"]:
        wrong.append(f"colliders: {more} more than the file has, not {told['split']}")
    for link, (mass, place, inertia) in said["inertials"].items():
        if link not in told["inertials"]:
            continue
        ours_mass, ours_place, ours_inertia = told["inertials"][link]
        if ours_mass != mass:
            wrong.append(f"masses of {link}: {ours_mass}, not {mass}")
        flat, ours_flat = sum(inertia, []), sum(ours_inertia, [])
        same = close(flat, ours_flat, max(map(abs, flat))) and (
            mass == 0 or close(place, ours_place, max(map(abs, [1, *place]))))
        if same:
            continue
        if any(f"'{link}'" in message for message in told["replaced"]):
            replaced.append(link)
        else:
            wrong.append(f"inertias of {link}: {ours_inertia}, not {inertia}")
    for link, (mass, *_) in told["inertials"].items():
        if mass > 0 and link not in said["inertials"] and link not in said["dense"]:
            wrong.append(f"masses of {link}: {mass}, but the file has none")
    return wrong, replaced


def sum_up(answers, where):
    """Prints how much there is in all files that were counted, and what is wrong with each."""
    total = Counter()
    for answer in answers.values():
        total.update(answer.get("counted", {}))
    print(f"{where}:", dict(total))
    for file, answer in answers.items():
        for line in answer.get("wrong", []):
            print(f"{file}: {line}")
