"""Packages of ROS below some folders."""

import re


def packages(folders):
    """Name -> folders of every package, in the order of the folders."""
    found = {}
    for folder in folders:
        for file in sorted(folder.rglob("package.xml")):
            name = re.search(r"<name>\s*([^<\s]+)\s*</name>", file.read_text(errors="replace"))
            if name:
                found.setdefault(name.group(1), []).append(file.parent)
    return found


def firsts(folders):
    """Name -> folder of every package, the first one where there are several."""
    return {name: found[0] for name, found in packages(folders).items()}
