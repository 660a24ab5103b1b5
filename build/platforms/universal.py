"""Writes the universal file of libraries for Macs.

    universal.py OUTPUT FILES…

The bytes are those of build/src/library/universal.rs, which an export makes; the build script of the command compares
the two. See there for the format.
"""

import struct
import sys
from pathlib import Path

MAGIC, ARM64 = 0xCAFEBABE, 0x0100000C

output, *parts = (Path(name) for name in sys.argv[1:])


def page(part: bytes) -> int:
    """The exponent of the size of a memory page."""
    return 14 if struct.unpack_from("<I", part, 4)[0] == ARM64 else 12


files = sorted((part.read_bytes() for part in parts), key=page)
table = struct.pack(">II", MAGIC, len(files))
place = len(table) + 20 * len(files)
body = b""
for file in files:
    gap = -place % (1 << page(file))
    table += struct.pack(">IIIII", *struct.unpack_from("<II", file, 4), place + gap, len(file), page(file))
    body += bytes(gap) + file
    place += gap + len(file)
output.write_bytes(table + body)
