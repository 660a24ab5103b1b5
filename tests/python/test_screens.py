"""Reports at the sizes of a desk and a phone, light and dark: nothing overlaps, nothing is cut off, a robot is seen."""

import numpy as np
import png
import pytest
from browser import Browser

DESK, PHONE = (1440, 900), (390, 844)
# The one with the most to tell on both, the others on one: a page takes seconds.
PAGES = [("humanoid", DESK), ("humanoid", PHONE), ("r2d2", DESK), ("iiwa", PHONE)]

# Rectangles of what stands in the page: left, top, right, bottom. The title is as wide as its text.
LAYOUT = """(() => {
    const box = (node) => { const b = node.getBoundingClientRect(); return [b.left, b.top, b.right, b.bottom]; };
    const text = (id) => { const range = document.createRange();
        range.selectNodeContents(document.getElementById(id)); return box(range); };
    const parts = Object.fromEntries(["tools", "side", "bar", "canvas"].map((id) => [id, box(document.getElementById(id))]));
    return { ...parts, name: text("name"), summary: text("summary"), state: text("state"),
        width: document.documentElement.scrollWidth, height: document.documentElement.scrollHeight };
})()"""

# Buttons and lists that stand beyond an edge of what holds them, which does not scroll there.
CUT = """[...document.querySelectorAll("#bar > *, #tools > button, #tabs > button")].filter((node) => {
    if (!node.getClientRects().length) return false;
    const inner = node.getBoundingClientRect(), outer = node.parentElement.getBoundingClientRect();
    const scrolls = getComputedStyle(node.parentElement).overflowX === "auto";
    return !scrolls && (inner.left < outer.left - 1 || inner.right > outer.right + 1);
}).map((node) => node.id || node.textContent)"""


@pytest.fixture(scope="module")
def browser():
    browser = Browser()
    yield browser
    browser.close()


def overlap(a, b):
    return a[0] < b[2] and b[0] < a[2] and a[1] < b[3] and b[1] < a[3]


def seen(page, file, layout):
    """What the canvas shows, as a picture."""
    page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
    page.picture(file)
    left, top, right, bottom = (round(x) for x in layout["canvas"])
    return png.read(file)[top:bottom, left:right, :3].astype(int)


@pytest.mark.parametrize("name,size", PAGES)
def test_the_page_fits_and_shows_the_robot(browser, made, tmp_path, name, size):
    _, _, report = made(name)
    width, height = size
    address = f"file://{report}?quality=3&theme=light&t=0.5"
    with browser.page(address, width=width, height=height, phone=width < 760).ready() as page:
        layout = page.evaluate(LAYOUT)
        assert (layout["width"], layout["height"]) == (width, height), "nothing scrolls but what should"
        parts = ["tools", "side", "bar", "name", "summary", "state"]
        for i, one in enumerate(parts):
            for other in parts[i + 1:]:
                assert not overlap(layout[one], layout[other]), (one, other, layout)
        assert page.evaluate(CUT) == []
        pictures = [seen(page, tmp_path / "light.png", layout)]
        # Arrows of forces are as long as they have to be.
        page.key("c")
        page.evaluate("document.querySelector('header').style.visibility = 'hidden'")
        without = seen(page, tmp_path / "without.png", layout)
        left, top, right, bottom = (round(x) for x in layout["summary"])
        behind = without[top:bottom, left:right]
        assert np.abs(behind - np.median(behind, axis=(0, 1))).max() < 40, "the robot stands behind its title"
        page.evaluate("document.querySelector('header').style.visibility = ''")
        page.key("c")
        page.key("l")
        pictures.append(seen(page, tmp_path / "dark.png", layout))
    brightness = []
    for picture in pictures:
        tall, wide = picture.shape[:2]
        middle = picture[tall // 4:tall * 3 // 4, wide // 4:wide * 3 // 4].reshape(-1, 3)
        assert len(np.unique(middle, axis=0)) > 200, "a robot has many shades"
        # What is behind the robot has one colour, or few; the robot stands out from it.
        background = np.median(picture[: tall // 20].reshape(-1, 3), axis=0)
        apart = (np.abs(middle - background).max(axis=1) > 40).mean()
        assert 0.02 < apart < 0.95, apart
        brightness.append(background.mean())
    assert brightness[0] > 180 and brightness[1] < 70, "light and dark"
