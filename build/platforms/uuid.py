"""Makes the identity of a library for macOS follow from its contents: python uuid.py LIBRARY

The linker takes LC_UUID from a hash that includes names of temporary files, so two builds of the same sources differ
in these 16 bytes. They are replaced by a hash of the rest, and the hashes of an ad-hoc signature are computed again.

Sources: Apple's mach-o/loader.h; cs_blobs.h for the signature, whose numbers are big-endian.
"""

import hashlib
import struct
import sys
from pathlib import Path

LC_UUID, LC_CODE_SIGNATURE = 0x1B, 0x1D
CODE_DIRECTORY = 0xFADE0C02


def commands(data):
    """Numbers and places of the load commands."""
    place = 32
    for _ in range(struct.unpack_from("<I", data, 16)[0]):
        number, size = struct.unpack_from("<II", data, place)
        yield number, place
        place += size


def sign(data, signature):
    """Computes the hashes of all pages in the signature's directory again."""
    for i in range(struct.unpack_from(">I", data, signature + 8)[0]):
        directory = signature + struct.unpack_from(">I", data, signature + 16 + 8 * i)[0]
        if struct.unpack_from(">I", data, directory)[0] != CODE_DIRECTORY:
            continue
        hashes, pages, limit = (struct.unpack_from(">I", data, directory + at)[0] for at in (16, 28, 32))
        length, kind, page = data[directory + 36], data[directory + 37], 1 << data[directory + 39]
        if (length, kind) != (32, 2):
            sys.exit("uuid.py: the signature's hashes are not SHA-256")
        for n in range(pages):
            found = hashlib.sha256(data[n * page:min((n + 1) * page, limit)]).digest()
            data[directory + hashes + 32 * n:directory + hashes + 32 * (n + 1)] = found


def main():
    library = Path(sys.argv[1])
    data = bytearray(library.read_bytes())
    places = dict(commands(data))
    signature = None
    if LC_CODE_SIGNATURE in places:
        signature = struct.unpack_from("<I", data, places[LC_CODE_SIGNATURE] + 8)[0]
    at = places[LC_UUID] + 8
    data[at:at + 16] = bytes(16)
    identity = bytearray(hashlib.sha256(data[:signature]).digest()[:16])
    # RFC 9562, version 8: whatever its maker says.
    identity[6] = identity[6] & 0x0F | 0x80
    identity[8] = identity[8] & 0x3F | 0x80
    data[at:at + 16] = identity
    if signature is not None:
        sign(data, signature)
    library.write_bytes(data)


if __name__ == "__main__":
    main()
