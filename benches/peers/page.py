"""Puts tables into pages of docs/."""

import platform
import textwrap
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


def machine():
    """What it ran on."""
    path = Path("/proc/cpuinfo")
    names = [line.split(":")[1].strip() for line in path.read_text().splitlines()
             if line.startswith("model name")] if path.exists() else []
    return names[0] if names else platform.processor() or platform.machine()


def wrapped(text, width=100):
    """Prose in lines of at most `width` columns; rows of tables stay."""
    fill = textwrap.TextWrapper(width, break_long_words=False, break_on_hyphens=False).fill
    return "\n".join(line if line.startswith("|") else fill(line) for line in text.split("\n"))


def write(mark, script, text, to_page, page="docs/performance.md"):
    """Prints a table; `to_page`: puts it between its marks in a page."""
    text = wrapped(text)
    print(text)
    if not to_page:
        return
    begin, end = f"<!-- {mark} begin: written by {script} -->", f"<!-- {mark} end -->"
    path = ROOT / page
    before, rest = path.read_text().split(begin)
    path.write_text(f"{before}{begin}\n{text}\n{end}{rest.split(end)[1]}")
