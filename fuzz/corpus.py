"""Packs the kept corpus of a fuzz target into one archive, and unpacks it.

    python3 fuzz/corpus.py unpack fuzz/corpus/states.zip target/states
    python3 fuzz/corpus.py pack target/states fuzz/corpus/states.zip

The same files give the same archive to the last byte: entries by name, uncompressed, without time and owner.
"""

import sys
import zipfile
from pathlib import Path


def unpack(archive: Path, folder: Path) -> None:
    folder.mkdir(parents=True, exist_ok=True)
    with zipfile.ZipFile(archive) as entries:
        for name in entries.namelist():
            # No entry leads out of the folder.
            (folder / Path(name).name).write_bytes(entries.read(name))


def pack(folder: Path, archive: Path) -> None:
    with zipfile.ZipFile(archive, "w", zipfile.ZIP_STORED) as entries:
        for path in sorted(path for path in folder.iterdir() if path.is_file()):
            entry = zipfile.ZipInfo(path.name, (1980, 1, 1, 0, 0, 0))
            # Unix, an ordinary file that all may read: the same on every machine that packs.
            entry.create_system = 3
            entry.external_attr = 0o100644 << 16
            entries.writestr(entry, path.read_bytes())


if __name__ == "__main__":
    if len(sys.argv) != 4 or sys.argv[1] not in ("pack", "unpack"):
        sys.exit(__doc__)
    {"pack": pack, "unpack": unpack}[sys.argv[1]](Path(sys.argv[2]), Path(sys.argv[3]))
