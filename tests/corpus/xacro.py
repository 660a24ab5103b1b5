"""Every file in xacro below some folders: expanded here and by the xacro program, compared element by element.

Usage: python xacro.py URDF2FMU XACRO FOLDER…

XACRO is the program of ROS, or that of the Python package (2.1.1 was used). Both get the same packages: every folder
with a package.xml below the folders, the one of the same folder first. Ends with exit code 1 if the results of a file
differ, or if one of the two expands a file that the other does not.
"""

import json
import os
import re
import subprocess
import sys
import tempfile
import xml.etree.ElementTree as ET
from collections import Counter
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from packages import packages

# ROS 2's index of packages, as far as the xacro program asks it.
INDEX = """
import json, os

def get_package_share_directory(name):
    return json.loads(os.environ["URDF2FMU_PACKAGES"])[name]
"""


def content(element):
    """An element without what has no meaning: order of attributes, white space, comments."""
    children = [content(child) for child in element if isinstance(child.tag, str)]
    return element.tag, sorted(element.attrib.items()), (element.text or "").split(), children


def count(element):
    return 1 + sum(count(child) for child in element[3])


def call(*words, **more):
    return subprocess.run(words, capture_output=True, text=True, timeout=200, check=False, **more)


def judge(file, root, known, command, xacro, index):
    """What becomes of a file, and how many elements it has then."""
    own = {name: next((f for f in all_ if f.is_relative_to(root)), all_[0]) for name, all_ in known.items()}
    environment = os.environ | {"PYTHONPATH": index,
                                "URDF2FMU_PACKAGES": json.dumps({name: str(f) for name, f in own.items()})}
    theirs = call(xacro, file, env=environment)
    # The own expansion must not be helped by that program.
    ours = call(command, "expand", file, *(word for name, f in own.items() for word in ("--package", f"{name}={f}")),
                env=os.environ | {"PATH": ""})
    if theirs.returncode != 0 or ours.returncode != 0:
        if theirs.returncode != 0 and ours.returncode != 0:
            return "refused by both", 0
        return ("refused by xacro alone" if theirs.returncode else "refused here alone"), 0
    theirs, ours = content(ET.fromstring(theirs.stdout)), content(ET.fromstring(ours.stdout))
    return ("same" if theirs == ours else "different"), count(theirs)


def main():
    command, xacro, *folders = sys.argv[1:]
    folders = [Path(folder).resolve() for folder in folders]
    known = packages(folders)
    files = [(file, root) for root in folders for file in sorted(root.rglob("*"))
             if file.is_file() and (file.suffix == ".xacro" or file.suffix == ".urdf"
                                    and re.search(r"<xacro:(include|macro|property|arg|if|unless)\b",
                                                  file.read_text(errors="replace")))]
    with tempfile.TemporaryDirectory() as index:
        module = Path(index) / "ament_index_python"
        module.mkdir()
        (module / "__init__.py").write_text("")
        (module / "packages.py").write_text(INDEX)
        with ThreadPoolExecutor(os.cpu_count()) as pool:
            told = list(pool.map(lambda pair: judge(str(pair[0]), pair[1], known, command, xacro, index), files))
    for fate, number in sorted(Counter(fate for fate, _ in told).items()):
        print(f"{number:6} {fate}")
    same = [elements for fate, elements in told if fate == "same"]
    print(f"{sum(same):6} elements in what is the same, {sum(1 for n in same if n > 3)} files with more than three")
    bad = [(file, fate) for (file, _), (fate, _) in zip(files, told, strict=True)
           if fate in ("different", "refused here alone", "refused by xacro alone")]
    for file, fate in bad:
        print(f"{file}: {fate}")
    sys.exit(bool(bad))


if __name__ == "__main__":
    main()
