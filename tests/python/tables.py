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


FOREIGN = {
    "flat names": lambda rows: joined([[n.replace(".", "_") for n in rows[0]], *rows[1:]]),
    "a path in front": lambda rows: joined([[n if n == "time" else f"plant.root.{n}" for n in rows[0]], *rows[1:]]),
    "any order": lambda rows: joined([row[::-1] for row in rows]),
    "semicolons and decimal commas": lambda rows: joined([[c.replace(".", ",") if i else c for c in row]
                                                          for i, row in enumerate(rows)], ";"),
    "units": lambda rows: joined([[f"{n} [m]" for n in rows[0]], *rows[1:]]),
    "rows in any order": lambda rows: joined([rows[0], *rows[:0:-1]]),
}
