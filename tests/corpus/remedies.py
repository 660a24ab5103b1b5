"""What a newcomer does about the findings of a run of `check`: options, arguments, files, and edits of the text.

Only what a finding writes out is done, where it says: nothing is known here of robots.
"""

import re
import struct
from pathlib import Path

# As a shell reads a word.
WORD = r"(?:'[^'\n]*'|[^\s;,'…]+)"
ONE = (r"(?:--inertia (?:collision|nearest)|--density \d+(?:\.\d+)?|--missing-mass \d+(?:\.\d+)?|--compat pybullet"
       rf"|--package (?!\S*=DIR)(?=\S*=){WORD}|--package-path (?!DIR){WORD})")
# Options that follow each other belong together.
OPTIONS = re.compile(rf"{ONE}(?: {ONE})*")
ARGUMENT = re.compile(r"\b(\w+):=('[^']*'|\"[^\"]*\"|[^\s'\"]+)")
WRITTEN = re.compile(r"it is written in (.+?):(\d+)")
MEANT = re.compile(r"(?:did you mean|the nearest [\w ]+ is|use) '([^']+)'")
TRIED = re.compile(r"tried (/[^\n]+)")
LINK = re.compile(r"write (<link name=\"[^\"]+\"/>)")
CALL = re.compile(r"write ((?:\w+=\"…\" ?)+)into the call")
LEAVE = re.compile(r"leave out '?(\w+)'?: the macro is defined")
PARAMETERS = re.compile(r"write (params=\"[^\"]*\") where it is defined, in (.+):(\d+)")
PREFIX = re.compile(r"<xacro:(\w+) …> in ([^\n]+?):(\d+)")
ATTRIBUTE = re.compile(r"write (\w+=\"[^\"]*\") in place of")
PUT = re.compile(r"put it at (/[^\n]+), where")
WITH_PACKAGE = re.compile(r"with (--missing-mass \d+(?:\.\d+)?) in the same call")
WITH_FILE = re.compile(rf"with the file, pass --package-path ({WORD})")
INCLUDE = re.compile(r"put before its use: (<xacro:include filename=\"[^\"]+\"/>)")
LATER = re.compile(r"it is defined behind this, in line \d+")
CORRECTED = re.compile(r"if it is meant, correct the path in the URDF")
SAMENAME = re.compile(r"have one file of that name, (/[^\n:]+)")
BESIDE = re.compile(r"^(/[^\n]+?) lies beside it: name that one")
# Where a robot begins and ends.
BEGIN = re.compile(r"<robot\b[^>]*>")
END = re.compile(r"(?=</robot>)")
# Messages about something that is not there.
LACKING = re.compile(r"not found|cannot be read|Git LFS|outside of the robot's folders|has no value|have no values"
                     r"|is not set|no such file", re.IGNORECASE)


def cube(path):
    """A mesh of a cube of 10 cm."""
    corners = [(x, y, z) for x in (-0.05, 0.05) for y in (-0.05, 0.05) for z in (-0.05, 0.05)]
    faces = [(0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
             (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3)]
    if path.suffix.lower() == ".stl":
        triangles = b"".join(struct.pack("<12fH", 0, 0, 0, *(x for corner in face for x in corners[corner]), 0)
                             for face in faces)
        return bytes(80) + struct.pack("<I", len(faces)) + triangles
    if path.suffix.lower() == ".obj":
        lines = ["v {} {} {}".format(*corner) for corner in corners]
        lines += ["f {} {} {}".format(*(corner + 1 for corner in face)) for face in faces]
        return "\n".join(lines).encode()
    if path.suffix.lower() == ".dae":
        numbers = " ".join(str(x) for corner in corners for x in corner)
        indices = " ".join(str(corner) for face in faces for corner in face)
        return f"""<?xml version="1.0"?>
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="1"/><up_axis>Z_UP</up_axis></asset>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="a" count="24">{numbers}</float_array><technique_common>
<accessor source="#a" count="8" stride="3"><param name="X" type="float"/><param name="Y" type="float"/>
<param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="12"><input semantic="VERTEX" source="#v" offset="0"/><p>{indices}</p></triangles>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><instance_geometry url="#g"/></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>""".encode()
    return None


def unquoted(text):
    return text.strip().strip("'\"")


def read(path):
    return Path(path).read_text(encoding="utf8", errors="surrogateescape")


def write(path, text):
    """Writes a file anew: the old one may be a hard link."""
    Path(path).unlink(missing_ok=True)
    Path(path).write_text(text, encoding="utf8", errors="surrogateescape")


def edit(file, numbers, change):
    """Changes the first of some lines of a file that a function changes; whether there is one.

    - `numbers`: counted from 1; what is outside of the file is passed over
    - `change`: the new line of an old one
    """
    lines = read(file).split("\n")
    for number in numbers:
        old = lines[number - 1] if 0 < number <= len(lines) else ""
        new = change(old)
        if new != old:
            lines[number - 1] = new
            write(file, "\n".join(lines))
            return True
    return False


class Remedies:
    """What was done so far to a file: the words of the command, and edits."""

    def __init__(self, file, home, packages):
        self.file = file
        # Nothing is written elsewhere.
        self.home = home
        self.packages = packages
        self.options = []
        self.arguments = {}

    def words(self):
        """All that follows the file on the command line."""
        given = [f"{name}:={value}" for name, value in self.arguments.items()]
        return given + [word for option in self.options for word in option]

    @staticmethod
    def lacks(finding):
        """Whether it says that something is not there."""
        return bool(LACKING.search(finding["message"]))

    def follow(self, findings, again):
        """Does what findings say; whether anything was done, and the findings about which nothing can be.

        - `again`: what another look at the same fault tells; used for the meshes that one finding counts
        """
        changed, left = False, []
        for finding in findings:
            done = any([way(finding) for way in (self.option, self.mesh, self.link)]) or any(
                way(finding) for way in (self.argument, self.package, self.same_name, self.meant, self.call,
                                         self.include, self.later, self.beside, self.leave, self.parameters,
                                         self.prefix, self.attribute))
            changed |= done
            if not done:
                left.append(finding)
        while any("and " in finding["message"] and self.of_mesh(finding) for finding in findings):
            if not any([self.mesh(finding) or self.same_name(finding) for finding in again()]):
                break
            changed = True
        return changed, left

    @staticmethod
    def of_mesh(finding):
        return finding["code"] == "U104"

    def add(self, option):
        if option in self.options:
            return False
        self.options.append(option)
        return True

    def option(self, finding):
        """The first options that are offered, and every package."""
        # Nobody has the file that is to be there first.
        offered = WITH_PACKAGE.sub("", finding["help"] or "")
        found = OPTIONS.findall(re.sub(rf"with the file, pass --package-path {WORD}", "", offered))
        # "put it there, or pass …" of what may be another package is a guess.
        if not found or "if another one is meant" in finding["help"]:
            return False
        first, *more = [[tuple(map(unquoted, option.split(" ", 1))) for option in re.findall(ONE, words)] for words in found]
        packages = [options for options in more if options[0][0] == "--package" == first[0][0]]
        return any([self.add(option) for options in [first, *packages] for option in options])

    def argument(self, finding):
        given = [(name, unquoted(value)) for name, value in ARGUMENT.findall(finding["help"] or "")
                 if "…" not in value and value != "FILE"]
        new = {name: value for name, value in given if self.arguments.get(name) != value}
        self.arguments |= new
        return bool(new)

    def package(self, finding):
        """A package that is not found, from elsewhere."""
        name = re.search(r"package '([^']+)' is not found", finding["message"])
        place = self.packages.get(name[1]) if name else None
        if place is None:
            return False
        if with_package := WITH_PACKAGE.search(finding["help"] or ""):
            self.add(tuple(with_package[1].split(" ")))
        return self.add(("--package", f"{name[1]}={place}"))

    def mesh(self, finding):
        """Puts a mesh that is missing where it is looked for first."""
        help_ = finding["help"] or ""
        tried = self.of_mesh(finding) and (PUT.search(help_) or TRIED.search(help_))
        if not tried or CORRECTED.search(help_) and not PUT.search(help_):
            return False
        path = Path(tried[1].strip())
        content = cube(path)
        if content is None or path.is_symlink() or path.exists() or not path.is_relative_to(self.home):
            return False
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_bytes(content)
        # Who has the file passes what is to be passed with it.
        if with_file := WITH_FILE.search(help_):
            self.add(("--package-path", unquoted(with_file[1])))
        return True

    def place(self, finding):
        """The file and line in which to look."""
        written = WRITTEN.search(finding["help"] or "")
        return (written[1], int(written[2])) if written else (finding["file"], finding["line"])

    def replace(self, finding, old, new):
        """Replaces a word in the element at the place of a finding, the nearest line first."""
        file, line = self.place(finding)
        if not file or not line or not Path(file).is_file():
            return False
        lines = read(file).split("\n")
        for at in [*range(line - 1, min(len(lines), line + 8)), *range(max(0, line - 5), line - 1)]:
            if old in lines[at]:
                lines[at] = lines[at].replace(old, new, 1)
                write(file, "\n".join(lines))
                return True
        return False

    def same_name(self, finding):
        """The one file that has the name of a mesh."""
        meant = CORRECTED.search(finding["help"] or "") and SAMENAME.search(finding["help"])
        name = re.search(r"mesh not found: (.+?)(?:, and \d+ more.*)?$", finding["message"])
        return bool(meant and name) and self.replace(finding, name[1], meant[1].strip())

    def meant(self, finding):
        near = MEANT.search(finding["help"] or "")
        quoted = re.findall(r"'([^']+)'", finding["message"])
        return bool(near) and any(self.replace(finding, old, near[1]) for old in reversed(quoted))

    def put(self, element, behind):
        """Writes an element behind a place of the file, unless it has it."""
        text = read(self.file)
        place = behind.search(text)
        if element in text or not place:
            return False
        write(self.file, text[:place.end()] + element + text[place.end():])
        return True

    def link(self, finding):
        missing = LINK.search(finding["help"] or "")
        return bool(missing) and self.put(missing[1], END)

    def call(self, finding):
        """An attribute that the call of a macro lacks."""
        missing = CALL.search(finding["help"] or "")
        file, line = self.place(finding)
        if not missing or not file or not line:
            return False
        given = missing[1].strip().replace("…", "x")
        return edit(file, range(line, line - 6, -1),
                    lambda old: re.sub(r"<xacro:\w+", lambda tag: f"{tag[0]} {given}", old, count=1))

    def leave(self, finding):
        """An attribute of a call that the macro does not have."""
        more = LEAVE.search(finding["help"] or "")
        file, line = self.place(finding)
        if not more or not file or not line:
            return False
        written = rf"\s{more[1]}=(\"[^\"]*\"|'[^']*')"
        return edit(file, range(line, line + 9), lambda old: re.sub(written, "", old, count=1))

    @staticmethod
    def in_tag(file, line, tag, new):
        """Replaces the beginning of the tag that stands in a line or shortly behind."""
        return edit(file, range(line, line + 4),
                    lambda old: old if new in old else re.sub(tag, lambda _: new, old, count=1))

    def parameters(self, finding):
        """The list of parameters of a macro."""
        new = PARAMETERS.search(finding["help"] or "")
        if not new or not Path(new[2]).is_file():
            return False

        def change(old):
            without = re.sub(r"\sparams=(\"[^\"]*\"|'[^']*')", "", old)
            return without.replace("<xacro:macro", f"<xacro:macro {new[1]}", 1)
        return edit(new[2], [int(new[3])], change)

    def prefix(self, finding):
        """Macros that are called without their prefix, with the tags that end them."""
        done = False
        for name, file, line in PREFIX.findall(finding["help"] or ""):
            done |= self.in_tag(file, int(line), rf"<{name}\b", f"<xacro:{name}")
            text = read(file)
            if done and f"</{name}>" in text:
                write(file, text.replace(f"</{name}>", f"</xacro:{name}>"))
        return done

    def attribute(self, finding):
        """An attribute that is written as an element."""
        given = ATTRIBUTE.search(finding["help"] or "")
        tag = re.search(r"<(\w+)> has no", finding["message"])
        file, line = self.place(finding)
        if not given or not tag or not file or not line:
            return False
        return self.in_tag(file, line, rf"<{tag[1]}\b", f"<{tag[1]} {given[1]}")

    def include(self, finding):
        """A file that is not included: before the element of the finding, at the latest."""
        missing = INCLUDE.search(finding["help"] or "")
        return bool(missing) and self.put(missing[1], BEGIN)

    def later(self, finding):
        """A definition that stands behind its use: moved to the beginning."""
        name = re.search(r"(?:no macro|name) '(\w+)'", finding["message"])
        file, _ = self.place(finding)
        if not LATER.search(finding["help"] or "") or not name or not file:
            return False
        text = read(file)
        found = re.search(rf'<xacro:(macro|property)\s+name="{name[1]}"[^>]*?(/>|>.*?</xacro:\1>)', text, re.DOTALL)
        begin = BEGIN.search(text)
        if not found or not begin or found.start() < begin.end():
            return False
        text = text[:found.start()] + text[found.end():]
        write(file, text[:begin.end()] + found[0] + text[begin.end():])
        return True

    def beside(self, finding):
        """The same mesh in a format that is read."""
        twin = BESIDE.search(finding["help"] or "")
        name = re.search(r"mesh (/\S+) cannot be read", finding["message"])
        if not twin or not name:
            return False
        return self.replace(finding, Path(name[1]).name, Path(twin[1]).name)
