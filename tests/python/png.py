"""Reads the PNG files of the tests: 8 bits, colour with or without alpha, not interlaced (ISO/IEC 15948)."""

import struct
import zlib
from pathlib import Path

import numpy


def chunks(path: Path):
    """Names and contents, after checking every sum."""
    data = Path(path).read_bytes()
    assert data[:8] == b"\x89PNG\r\n\x1a\n"
    at, found = 8, []
    while at < len(data):
        length, name = struct.unpack(">I4s", data[at:at + 8])
        content = data[at + 8:at + 8 + length]
        (check,) = struct.unpack(">I", data[at + 8 + length:at + 12 + length])
        assert zlib.crc32(name + content) == check, name
        found.append((name.decode(), content))
        at += 12 + length
    assert found[0][0] == "IHDR" and found[-1] == ("IEND", b"")
    return found


def read(path: Path) -> numpy.ndarray:
    """Pixels as rows of red, green, blue and, where there is one, alpha."""
    content = chunks(path)
    width, height, depth, kind, _, _, interlaced = struct.unpack(">IIBBBBB", content[0][1])
    assert (depth, interlaced) == (8, 0)
    size = {2: 3, 6: 4}[kind]
    raw = zlib.decompress(b"".join(data for name, data in content if name == "IDAT"))
    rows = numpy.frombuffer(raw, dtype=numpy.uint8).reshape(height, 1 + width * size)
    pixels = numpy.zeros((height, width * size), dtype=numpy.uint8)
    above = [0] * (width * size)
    for y, row in enumerate(rows.tolist()):
        kind, line = row[0], row[1:]
        for i, difference in enumerate(line):
            a, b, c = (line[i - size], above[i], above[i - size]) if i >= size else (0, above[i], 0)
            if kind == 4:
                off = [(abs(b - c), 0), (abs(a - c), 1), (abs(a + b - 2 * c), 2)]
                expected = (a, b, c)[min(off)[1]]
            else:
                expected = (0, a, b, (a + b) // 2)[kind]
            line[i] = (difference + expected) & 255
        pixels[y] = above = line
    return pixels.reshape(height, width, size)
