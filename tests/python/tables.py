"""Tables of results as other programs write them."""

import csv


def rewritten(results, folder, change):
    """The results as another program writes them."""
    with open(results, newline="") as file:
        rows = list(csv.reader(file))
    file = folder / "foreign.csv"
    file.write_text(change(rows))
    return file


def joined(rows, separator=","):
    return "\n".join(separator.join(row) for row in rows) + "\n"


def arrays(rows):
    """Vectors as FMPy's write_csv and fmusim have those of FMI 3: the elements in one cell, with spaces between them."""
    stems = [n[:-2] if n[-2:] in (".x", ".y", ".z", ".w") else n for n in rows[0]]
    parts = {stem: [i for i, other in enumerate(stems) if other == stem] for stem in stems}
    return joined([list(parts)] + [[" ".join(row[i] for i in part) for part in parts.values()] for row in rows[1:]])


def with_unit(name):
    """A name with its unit in brackets: other units are refused."""
    if name == "time":
        return f"{name} [s]"
    # R2D2's arm slides; its other joints turn.
    if ".position." in name or name == "joint.gripper_extension.position":
        return f"{name} [m]"
    return f"{name} [rad]" if name.startswith("joint.") and name.endswith(".position") else name


FOREIGN = {
    "arrays of FMI 3": arrays,
    "flat names": lambda rows: joined([[n.replace(".", "_") for n in rows[0]], *rows[1:]]),
    "a path in front": lambda rows: joined([[n if n == "time" else f"plant.root.{n}" for n in rows[0]], *rows[1:]]),
    "any order": lambda rows: joined([row[::-1] for row in rows]),
    "semicolons and decimal commas": lambda rows: joined([[c.replace(".", ",") if i else c for c in row]
                                                          for i, row in enumerate(rows)], ";"),
    "units": lambda rows: joined([[with_unit(n) for n in rows[0]], *rows[1:]]),
    "rows in any order": lambda rows: joined([rows[0], *rows[:0:-1]]),
}
