"""The documentation in an FMU, in a real browser: the robot in 3-D, or its picture where that cannot be."""

import zipfile

import numpy as np
import png
import pytest
from browser import Browser
from test_report import HOSTILE

FRAME = "document.querySelector('#robot iframe')"
INSIDE = f"{FRAME}.contentWindow.page"


@pytest.fixture(scope="module")
def browser():
    # A page on disk may not look into a frame with another one, unless the browser is told so.
    browser = Browser("--disable-web-security", "--allow-file-access-from-files", "--disable-site-isolation-trials")
    yield browser
    browser.close()


@pytest.fixture(scope="module")
def plain():
    browser = Browser("--disable-3d-apis")
    yield browser
    browser.close()


def documentation(fmu, folder):
    with zipfile.ZipFile(fmu) as archive:
        archive.extractall(folder, [n for n in archive.namelist() if n.startswith(("documentation/", "model.png"))])
    return folder / "documentation" / "index.html"


class Local:
    """A page that may load what lies beside it in the FMU, and nothing else."""

    def __init__(self, browser, file, **options):
        self.page, self.folder = browser.page(f"file://{file}", **options), f"file://{file.parents[1]}/"

    def __enter__(self):
        return self.page

    def __exit__(self, kind, *_):
        self.page.evaluate("0")
        outside = [url for url in self.page.requests if not url.startswith((self.folder, "blob:", "data:", "about:"))]
        errors = self.page.errors
        self.page.close(check=False)
        if kind is None:
            assert not outside, outside
            assert not errors, errors


def in_robot_html(file):
    """The page with the robot alone."""
    return f"file://{file.parent / 'robot.html'}?quality=3"


def test_the_documentation_shows_the_robot_in_3d(browser, export, examples, tmp_path):
    file = documentation(export(examples / "rover.urdf", documented=True), tmp_path)
    with Local(browser, file, width=1440, height=900) as page:
        page.until(f"{FRAME}?.contentDocument?.body?.dataset.ready")
        for width, height in (1440, 900), (390, 844):
            page.call("Emulation.setDeviceMetricsOverride", width=width, height=height, deviceScaleFactor=1,
                      mobile=width < 760)
            page.until(f"innerWidth === {width}")
            # Nothing but the robot: no bar, no panel.
            shown = page.evaluate(f"['side', 'bar', 'canvas', 'tools'].filter(id => {FRAME}.contentDocument"
                                  ".getElementById(id).getBoundingClientRect().height > 0)")
            assert shown == ["canvas", "tools"]
            assert page.evaluate("document.documentElement.scrollWidth") <= width
        labels = f"[...{FRAME}.contentDocument.querySelectorAll('#tools button')].map(n => n.textContent)"
        assert page.evaluate(labels)[:2] == ["Frames", "Shapes"]
        assert page.evaluate("document.querySelector('#robot img')") is None
        assert page.evaluate(f"{INSIDE}.page.view.stage.controls.enableZoom") is False, "the wheel scrolls"
        assert page.evaluate("[...document.images].every(n => n.naturalWidth === 512)")


def test_the_robot_is_drawn_and_its_frames_on_request(browser, export, examples, tmp_path):
    file = documentation(export(examples / "rover.urdf", documented=True), tmp_path)
    with browser.page(in_robot_html(file), width=480, height=360).ready() as page:
        pictures = []
        for name in "plain.png", "frames.png":
            # A frame is drawn before the picture is taken.
            page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
            page.picture(tmp_path / name)
            pictures.append(png.read(tmp_path / name)[:, :, :3].astype(int))
            page.key("x")
        robot, frames = pictures
        assert len(np.unique(robot.reshape(-1, 3), axis=0)) > 300, "a robot has many shades"
        assert (np.abs(frames - robot).max(axis=2) > 40).sum() > 100
        assert page.evaluate("window.page.page.view.stage.controls.enableZoom") is True
        page.key("c")
        assert page.evaluate("window.page.page.view.shown.forces") is True, "there is nothing to hide"


def test_the_picture_stays_where_there_is_no_webgl(plain, export, examples, tmp_path):
    file = documentation(export(examples / "rover.urdf", documented=True), tmp_path)
    page = plain.page(f"file://{file}")
    page.until("document.readyState === 'complete'")
    assert page.evaluate("document.querySelector('iframe')") is None
    assert page.evaluate("document.querySelector('#robot img').naturalWidth") == 512
    assert page.evaluate("document.querySelectorAll('table').length") > 2
    page.close(check=False)
    page = plain.page(in_robot_html(file)).ready()
    assert "index.html" in page.evaluate("document.getElementById('overlay').textContent")
    page.close(check=False)


def test_the_picture_stays_without_scripts(browser, export, examples, tmp_path):
    file = documentation(export(examples / "rover.urdf", documented=True), tmp_path)
    page = browser.page("about:blank")
    page.call("Emulation.setScriptExecutionDisabled", value=True)
    page.call("Page.navigate", url=f"file://{file}")
    page.until("document.readyState === 'complete' && location.protocol === 'file:'")
    assert page.evaluate("document.querySelector('iframe')") is None
    assert page.evaluate("document.querySelector('#robot img').naturalWidth") == 512
    page.close(check=False)


def test_names_of_robots_are_text(browser, export, tmp_path):
    (tmp_path / "hostile.urdf").write_text(HOSTILE)
    file = documentation(export(tmp_path / "hostile.urdf", documented=True), tmp_path)
    with Local(browser, file, width=480, height=360) as page:
        page.until(f"{FRAME}?.contentDocument?.body?.dataset.ready")
        name = "<script>alert(1)</script> ロボット"
        assert page.evaluate("document.querySelector('h1').textContent") == name
        assert page.evaluate("document.title") == name
        assert page.evaluate(f"{FRAME}.contentDocument.getElementById('name').textContent") == name
        assert page.evaluate("document.scripts.length") == 1
        assert page.evaluate("document.querySelectorAll('img[src=x]').length") == 0
        assert len(page.evaluate(f"Object.keys({INSIDE}.poses())")) == 2


def test_the_page_of_a_robot_of_shapes_is_small(export, examples):
    fmu = export(examples / "rover.urdf", documented=True)
    with zipfile.ZipFile(fmu) as archive:
        page = archive.getinfo("documentation/robot.html")
        drawn = archive.getinfo("resources/scene.bin")
    # The page itself has 270 kB; the scene is carried in base64 of its deflated bytes.
    assert page.file_size <= 270_000 + drawn.compress_size * 4 / 3 + 100
    assert page.compress_size <= 215_000 + drawn.compress_size * 1.1


def test_the_picture_of_the_frames_has_three_axes_in_their_colors(export, examples, command, tmp_path):
    fmu = export(examples / "rover.urdf", documented=True)
    with zipfile.ZipFile(fmu) as archive:
        (tmp_path / "frames.png").write_bytes(archive.read("documentation/frames.png"))
        (tmp_path / "model.png").write_bytes(archive.read("model.png"))
    assert command("picture", fmu, "--frames", "-o", tmp_path / "again.png").returncode == 0
    assert (tmp_path / "again.png").read_bytes() == (tmp_path / "frames.png").read_bytes()
    frames, plain = (png.read(tmp_path / name).astype(int) for name in ("frames.png", "model.png"))
    assert frames.shape == plain.shape == (512, 512, 4)
    changed = (frames != plain).any(axis=2)
    # A little of the picture: thin lines at the base, four wheels and the head.
    assert 0.002 < changed.mean() < 0.1
    for channel in range(3):
        others = [c for c in range(3) if c != channel]
        stands_out = frames[:, :, channel] > frames[:, :, others].max(axis=2) + 60
        assert (stands_out & changed).sum() > 100, ("red", "green", "blue")[channel]


#: A robot of one box and, on a joint, a second one; lengths in m by a factor.
BOXES = """<robot name="boxes"><link name="{base}"><inertial><mass value="{mass}"/>
  <inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial>
  <visual><geometry><box size="{size} {size} {size}"/></geometry></visual>
  <collision><geometry><box size="{size} {size} {size}"/></geometry></collision></link>
<link name="{arm}"><inertial><mass value="{mass}"/>
  <inertia ixx="{inertia}" iyy="{inertia}" izz="{inertia}" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="{joint}" type="continuous"><parent link="{base}"/><child link="{arm}"/>
  <origin xyz="0 0 {size}"/><axis xyz="0 1 0"/></joint></robot>"""

#: The share of the view's height that the robot's box takes.
SHARE = """(() => { const { view } = window.page.page; view.draw();
  const { min, max } = view.robot.box(), V = min.constructor, ys = [];
  for (const x of [min.x, max.x]) for (const y of [min.y, max.y]) for (const z of [min.z, max.z])
    ys.push(new V(x, y, z).project(view.stage.camera).y);
  return (Math.max(...ys) - Math.min(...ys)) / 2; })()"""


def test_a_robot_of_a_millimetre_fills_the_view_as_one_of_a_metre(browser, export, tmp_path):
    shares = []
    for size, mass in (1.0, 1.0), (1e-3, 1e-3):
        urdf = tmp_path / f"{size}.urdf"
        urdf.write_text(BOXES.format(base="base", arm="arm", joint="j", size=size, mass=mass,
                                     inertia=mass * size * size / 6))
        folder = tmp_path / str(size)
        folder.mkdir()
        file = documentation(export(urdf, documented=True), folder)
        with browser.page(in_robot_html(file), width=480, height=360).ready() as page:
            shares.append(page.evaluate(SHARE))
    assert shares[0] > 0.3, shares
    assert abs(shares[1] / shares[0] - 1) < 0.01, shares


def test_long_names_do_not_make_the_documentation_scroll_sideways(browser, export, tmp_path):
    urdf = tmp_path / "r.urdf"
    names = {key: key + "_of_a_robot_with_a_name_that_never_comes_to_its_end" * 2 for key in ("base", "arm", "joint")}
    urdf.write_text(BOXES.format(**names, size=0.1, mass=1, inertia=1 / 600))
    settings = f"[[sensor]]\ntype = 'ray'\nlink = '{names['base']}'\nhits = true\n[outputs]\nlinks = ['*']\n"
    file = documentation(export(urdf, settings, documented=True), tmp_path)
    with Local(browser, file, width=1440, height=900) as page:
        page.until("document.readyState === 'complete'")
        for width in 1440, 1024, 360:
            page.call("Emulation.setDeviceMetricsOverride", width=width, height=800, deviceScaleFactor=1,
                      mobile=width < 760)
            page.until(f"innerWidth === {width}")
            assert page.evaluate("document.documentElement.scrollWidth") <= width
