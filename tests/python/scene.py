"""Reads `resources/scene.bin` of an FMU, by docs/scene.md alone."""

import json
import struct
import zipfile
from pathlib import Path


def read(fmu: Path):
    """The head and the body."""
    with zipfile.ZipFile(fmu) as archive:
        data = archive.read("resources/scene.bin")
    (length,) = struct.unpack("<I", data[:4])
    assert length % 4 == 0
    head = json.loads(data[4:4 + length].decode("utf-8"))
    assert head["format"] == 2
    return head, data[4 + length:]
