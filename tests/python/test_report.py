"""Reports in a real browser: poses are the simulator's, values the table's, and nothing is asked of any network."""

import json
import shutil
import struct
import zlib

import numpy as np
import pytest
from browser import Browser
from fmpy.util import read_csv
from scipy.spatial.transform import Rotation

from tables import FOREIGN, joined, rewritten

SMALL = "quality=3&theme=light"

HOSTILE = """<robot name="&lt;script&gt;alert(1)&lt;/script&gt; ロボット">
<link name="&quot;&gt;&lt;img src=x onerror=alert(2)&gt;"><inertial><mass value="1"/>
  <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
  <visual><geometry><box size="0.2 0.2 0.1"/></geometry></visual>
  <collision><geometry><box size="0.2 0.2 0.1"/></geometry></collision></link>
<link name="腕 'arm'"><inertial><mass value="0.3"/>
  <inertia ixx="0.002" iyy="0.003" izz="0.002" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="@SCENE@ 関節 &lt;/script&gt;&lt;b&gt;" type="revolute"><parent link="&quot;&gt;&lt;img src=x onerror=alert(2)&gt;"/>
  <child link="腕 'arm'"/><axis xyz="0 1 0"/><limit lower="-1" upper="1" effort="3" velocity="4"/></joint>
</robot>"""


@pytest.fixture(scope="module")
def browser():
    browser = Browser()
    yield browser
    browser.close()


def open_report(browser, file, more="", **options):
    options = {"width": 480, "height": 360, **options}
    return browser.page(f"file://{file}?{SMALL}&{more}", **options).ready()


def poses_at(page, time):
    """The poses of all links at a time."""
    return page.evaluate(f"(window.page.page.player.seek({float(time)}), window.page.page.view.draw(), window.page.poses())")


def test_rods_of_a_delta_robot_go_from_its_arms_to_its_platform(browser, command, examples, tmp_path):
    worlds = examples / "worlds"
    run = command("simulate", worlds / "delta.urdf", "-c", worlds / "delta.toml", "--input-file", worlds / "delta.csv",
                  "--stop-time", 1, "--report", tmp_path / "r.html")
    assert run.returncode == 0, run.stderr
    loops = []
    for part in (worlds / "delta.toml").read_text().split("[[loop]]")[1:]:
        pairs = (line.split(" = ") for line in part.split("\n") if " = " in line)
        loops.append({key: json.loads(value) for key, value in pairs})
    with open_report(browser, tmp_path / "r.html") as page:
        for time in 0.0, 0.5, 1.0:
            poses = poses_at(page, time)
            spans = page.evaluate("window.page.spans()")
            assert sorted(spans) == sorted(loop["name"] for loop in loops)
            for loop in loops:
                for link, origin, end in zip(loop["links"], loop["origins"], spans[loop["name"]]):
                    position, quaternion = poses[link][:3], poses[link][3:]
                    expected = position + Rotation.from_quat(quaternion).apply(origin)
                    assert end == pytest.approx(expected, abs=1e-5), (time, loop["name"], link)
                assert np.linalg.norm(np.subtract(*spans[loop["name"]])) == pytest.approx(loop["length"], abs=1e-4)


@pytest.mark.parametrize("name", ["r2d2", "iiwa", "humanoid", "joints"])
def test_poses_are_those_of_the_simulator(browser, made, name):
    _, results, file = made(name)
    table = read_csv(results)
    links = [c[5:-11] for c in table.dtype.names if c.startswith("link.") and c.endswith(".position.x")]
    assert len(links) > 2
    moved = 0
    rows = 0, 77, len(table) - 1
    with open_report(browser, file, f"t={float(table['time'][77])}") as page:
        opened = page.evaluate("window.page.poses()")
        shown = [poses_at(page, table["time"][row]) for row in rows]
    assert opened == shown[1], "at a time of the address as at that of the slider"
    for row, poses in zip(rows, shown):
        for link in links:
            expected = [table[f"link.{link}.position.{a}"][row] for a in "xyz"]
            turned = np.array([table[f"link.{link}.orientation.{a}"][row] for a in "xyzw"])
            found = np.array(poses[link])
            np.testing.assert_allclose(found[:3], expected, atol=1e-4, err_msg=f"{link} in row {row}")
            # A rotation and its quaternion's negative are the same.
            np.testing.assert_allclose(found[3:] * np.sign(found[3:] @ turned), turned, atol=1e-4, err_msg=link)
            moved = max(moved, *(np.ptp(table[f"link.{link}.orientation.{a}"]) for a in "xyzw"))
    assert moved > 1e-2, "something moved, or nothing was compared"


def test_values_are_those_of_the_table(browser, made):
    _, results, file = made("r2d2")
    table = read_csv(results)
    with open_report(browser, file) as page:
        for row in 0, 100, 240:
            assert abs(page.evaluate(f"window.page.page.run.time[{row}]") - table["time"][row]) < 1e-8
            page.evaluate(f"window.page.page.player.seek(window.page.page.run.time[{row}])")
            shown = page.evaluate(f"Object.fromEntries({json.dumps(table.dtype.names[1:])}"
                                  ".map((name) => [name, window.page.value(name)]))")
            for name in table.dtype.names[1:]:
                # Half of a 2^-20th of the range, and the digits of a number of 32 bits.
                atol = np.ptp(table[name]) * 2**-21 + abs(table[name][row]) * 2**-23 + 1e-12
                assert abs(shown[name] - table[name][row]) <= atol, name
        # What the first plot draws is the same.
        drawn = page.evaluate("(() => { const p = window.page.page.plots.list[0]; return [p.names, p.u.data.map(x => [...x])]; })()")
        names, (times, *curves) = drawn
        for name, curve in zip(names, curves):
            rows = np.searchsorted(table["time"], np.array(times) - 1e-6)
            np.testing.assert_allclose(curve, table[name][rows], atol=np.ptp(table[name]) * 2**-20 + 1e-6)


def test_no_curve_stands_alone_without_its_name(browser, command, tmp_path):
    """A plot holds eight curves: nine are five and four, as in the SVG, and each has its name."""
    links = "".join(
        f'<link name="l{i}"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
        f'</inertial></link><joint name="lift{i}" type="prismatic"><axis xyz="0 0 1"/><parent link="base"/>'
        f'<child link="l{i}"/><limit lower="-1" upper="1" effort="100" velocity="1"/></joint>' for i in range(9))
    (tmp_path / "nine.urdf").write_text(f'<robot name="nine"><link name="base"/>{links}</robot>')
    run = command("simulate", tmp_path / "nine.urdf", "--stop-time", 0.1, "--report", tmp_path / "r.html")
    assert run.returncode == 0, run.stderr
    with open_report(browser, tmp_path / "r.html") as page:
        plots = page.evaluate("window.page.page.plots.list.map(p => [p.title, p.names.length])")
        assert [count for title, count in plots if title.startswith("Joint force")] == [5, 4]


def test_the_names_of_curves_are_whole_however_long_they_are(browser, command, tmp_path):
    """150 letters without a space: as wide as the plot at most, and whole in the SVG where there is room."""
    names = ["abcdefghij" * 15, "klmnopqrst" * 15]
    links = "".join(
        f'<link name="l{i}"><inertial><mass value="1"/><inertia ixx="1" ixy="0" ixz="0" iyy="1" iyz="0" izz="1"/>'
        f'</inertial></link><joint name="{name}" type="prismatic"><axis xyz="0 0 1"/><parent link="base"/>'
        f'<child link="l{i}"/><limit lower="-1" upper="1" effort="100" velocity="1"/></joint>'
        for i, name in enumerate(names))
    (tmp_path / "long.urdf").write_text(f'<robot name="long"><link name="base"/>{links}</robot>')
    run = command("simulate", tmp_path / "long.urdf", "--stop-time", 0.1, "--report", tmp_path / "r.html")
    assert run.returncode == 0, run.stderr
    with open_report(browser, tmp_path / "r.html") as page:
        wide = "[...document.querySelectorAll('.key span')].map(s => [s.getBoundingClientRect().right, " \
               "s.closest('.plot').getBoundingClientRect().right, s.scrollWidth - s.clientWidth, s.textContent.length])"
        keys = page.evaluate(wide)
        assert any(length > 100 for *_, length in keys), keys
        assert all(right <= of_plot + 1 and over <= 0 for right, of_plot, over, _ in keys), keys


def test_the_notes_begin_with_what_happened_in_the_words_of_the_terminal(browser, made, command, tmp_path):
    fmu, results, _ = made("r2d2")
    done = command("report", results, "--model", fmu, "-o", tmp_path / "r.html")
    told = " ".join(done.stderr.partition("  events\n")[2].split())
    assert done.returncode == 0 and "Deepest contact" in told, done.stderr
    with open_report(browser, tmp_path / "r.html") as page:
        notes = page.evaluate("[...document.querySelectorAll('p.said')].map((p) => p.textContent)")
    assert told == " ".join(f"- {note}" for note in notes)


@pytest.fixture(scope="module")
def expected(browser, made):
    """The poses of R2D2 at 0.7 s of its run."""
    with open_report(browser, made("r2d2")[2], "t=0.7") as page:
        return page.evaluate("window.page.poses()")


@pytest.mark.parametrize("style", FOREIGN)
def test_tables_of_other_programs_show_the_same(browser, made, expected, command, tmp_path, style):
    fmu, results, _ = made("r2d2")
    foreign = rewritten(results, tmp_path, FOREIGN[style])
    run = command("report", foreign, "--model", fmu, "-o", tmp_path / "r.html")
    assert run.returncode == 0, run.stderr
    with open_report(browser, tmp_path / "r.html", "t=0.7") as page:
        found = page.evaluate("window.page.poses()")
    for link, pose in expected.items():
        np.testing.assert_allclose(found[link], pose, atol=1e-6)


def test_what_is_missing_or_unknown_is_said_and_the_rest_is_shown(browser, made, command, tmp_path):
    fmu, results, _ = made("r2d2")

    def change(rows):
        keep = [i for i, n in enumerate(rows[0]) if "head_swivel.position" not in n and "contact" not in n]
        rows = [[row[i] for i in keep] + [extra] for row, extra in zip(rows, ["my.own", *(["1.5"] * len(rows))])]
        rows[5][3] = ""
        return joined(rows)

    run = command("report", rewritten(results, tmp_path, change), "--model", fmu, "-o", tmp_path / "r.html")
    assert run.returncode == 0, run.stderr
    said = "1 joint stays where it starts, because columns of positions are missing: 'head_swivel'."
    for text in said, "contact forces of", "1 column is no variable of this robot", "'my.own'":
        assert text in run.stderr, run.stderr
    with open_report(browser, tmp_path / "r.html", "t=0.5") as page:
        notes = page.evaluate("document.querySelector('#panes > :last-child').textContent")
        assert said in notes
        assert page.evaluate("window.page.value('my.own')") == 1.5
        assert page.evaluate("Number.isNaN([...window.page.page.run.columns.values()][2][4])")


def test_faulty_tables_are_refused_with_their_place(made, command, tmp_path):
    fmu, _, _ = made("r2d2")
    for text, message in ("", "it is empty"), ("a,b\n1,2\n", "no column is called 'time'"), \
            ("time,a\n0\n1,2\n", "line 2: 1 values"), ("time,a\n", "no row"):
        (tmp_path / "bad.csv").write_text(text)
        run = command("report", tmp_path / "bad.csv", "--model", fmu, "-o", tmp_path / "r.html")
        assert run.returncode == 1 and message in run.stderr, run.stderr
        assert "bad.csv" in run.stderr and not (tmp_path / "r.html").exists()


def test_files_that_are_no_tables_are_named_and_not_printed(made, command, tmp_path):
    """An FMU in place of its table, and a table as some shells write it, in two bytes for each letter, which is read."""
    fmu, results, _ = made("r2d2")
    for run in (command("report", fmu, "--model", fmu, "-o", tmp_path / "r.html"),
                command("simulate", fmu, "--input-file", fmu, "--output-file", tmp_path / "out.csv")):
        assert run.returncode == 1
        assert run.stderr.splitlines() == [f"error: '{fmu}': it is no text in UTF-8, as tables have to be"]
    (tmp_path / "wide.csv").write_text(results.read_text(), encoding="utf-16")
    pages = []
    for file in results, tmp_path / "wide.csv":
        run = command("report", file, "--model", fmu, "-o", tmp_path / "r.html")
        assert run.returncode == 0, run.stderr
        pages.append((tmp_path / "r.html").read_bytes())
    assert pages[0] == pages[1]
    # Of the runs that were refused there is nothing.
    assert sorted(file.name for file in tmp_path.iterdir()) == ["r.html", "wide.csv"]


def test_a_table_of_another_robot_is_noticed(browser, made, command, tmp_path):
    _, results, _ = made("r2d2")
    fmu, _, _ = made("iiwa")
    run = command("report", results, "--model", fmu, "-o", tmp_path / "r.html")
    said = "No column says where 'lbr_iiwa' is, so that it stays where it starts: is it a run of this robot?"
    assert run.returncode == 0 and f"warning: {said}" in run.stderr.splitlines(), run.stderr
    with open_report(browser, tmp_path / "r.html") as page:
        assert said in page.evaluate("document.querySelector('#panes > :last-child').textContent")


def test_names_are_text_whatever_they_are(browser, command, tmp_path):
    (tmp_path / "robot.urdf").write_text(HOSTILE)
    run = command("simulate", tmp_path / "robot.urdf", "--stop-time", "0.2", "--report", tmp_path / "r.html")
    assert run.returncode == 0, run.stderr
    assert run.stdout == "", "with a report the results go where they are asked to"
    assert "alert(" not in (tmp_path / "r.html").read_text().split("<body>")[0].replace("&lt;script&gt;alert(1)", "")
    with open_report(browser, tmp_path / "r.html") as page:
        assert page.evaluate("document.getElementById('name').textContent") == "<script>alert(1)</script> ロボット"
        assert page.evaluate("document.title") == "<script>alert(1)</script> ロボット"
        assert not page.evaluate("document.querySelectorAll('#app img, #app script, #app td b').length")
        assert "腕 'arm'" in page.evaluate("Object.keys(window.page.poses())")


def test_keys_slider_and_buttons_move_through_the_run(browser, made):
    _, _, file = made("r2d2")
    with open_report(browser, file) as page:
        now = "window.page.page.run.now"
        assert page.evaluate(now) == 0
        page.key("ArrowRight")
        page.until(f"Math.abs({now} - 1 / 240) < 1e-6")
        page.key("ArrowRight", modifiers=8)
        page.until(f"Math.abs({now} - 1 / 240 - 0.1) < 1e-6")
        page.key("End")
        page.until(f"{now} === window.page.page.run.end")
        page.key("ArrowLeft")
        page.until(f"Math.abs({now} - 239 / 240) < 1e-6")
        page.key("Home")
        page.until(f"{now} === 0")
        page.click("#step")
        page.until(f"Math.abs({now} - 1 / 240) < 1e-6")
        page.key(".")
        page.until(f"Math.abs({now} - 2 / 240) < 1e-6")
        page.click("#seek")
        page.until(f"Math.abs({now} - 0.5) < 0.02")
        page.click("#play")
        page.until(f"{now} > 0.52")
        # The line of the plots is where the slider is.
        page.key(" ", modifiers=0)
        line = "(() => { const p = window.page.page.plots.list[0]; p.tick(); return Math.abs(parseFloat(p.now.style.transform.slice(11)) - p.u.valToPos(window.page.page.run.now, 'x')); })()"
        assert page.evaluate(line) < 0.01
        for key, name in ("f", "follow"), ("c", "forces"), ("t", "path"), ("x", "frames"), ("v", "shapes"):
            before = page.evaluate(f"window.page.page.view.shown.{name}")
            page.key(key)
            page.until(f"window.page.page.view.shown.{name} === {json.dumps(not before)}")
        page.key("l")
        page.until("document.documentElement.dataset.theme === 'dark'")
        page.key("v")
        page.key("]")


def test_a_click_on_a_plot_goes_there_and_a_drag_zooms_all(browser, made):
    _, _, file = made("r2d2")
    with open_report(browser, file, width=1000, height=700) as page:
        left, top, width, height = page.evaluate(
            "(() => { const b = document.querySelector('.u-over').getBoundingClientRect(); return [b.left, b.top, b.width, b.height]; })()")
        x, y = left + 0.25 * width, top + height / 2
        page.mouse("mouseMoved", x, y, buttons=0)
        page.mouse("mousePressed", x, y)
        page.mouse("mouseReleased", x, y, buttons=0)
        page.until("Math.abs(window.page.page.run.now - 0.25) < 0.02")
        page.mouse("mousePressed", x, y)
        for share in 0.4, 0.6, 0.75:
            page.mouse("mouseMoved", left + share * width, y)
        page.mouse("mouseReleased", left + 0.75 * width, y, buttons=0)
        page.until("window.page.page.plots.zoomed")
        for low, high in page.evaluate("window.page.page.plots.list.map(p => [p.u.scales.x.min, p.u.scales.x.max])"):
            assert abs(low - 0.25) < 0.03 and abs(high - 0.75) < 0.03
        assert abs(page.evaluate("window.page.page.run.now") - 0.25) < 0.02


def test_all_is_reached_by_keyboard_and_seen_where_it_is(browser, made):
    _, _, file = made("r2d2")
    with open_report(browser, file) as page:
        seen = set()
        for _ in range(60):
            page.key("Tab")
            name, outline = page.evaluate(
                "(() => { const n = document.activeElement; return [n === document.body ? 'body' : n.id || n.textContent,"
                " getComputedStyle(n).outlineStyle]; })()")
            if name != "body":
                assert outline != "none", name
            seen.add(name)
        assert {"canvas", "Follow", "Home", "play", "step", "seek", "speed", "tab-0"} <= seen, seen
        page.evaluate("document.querySelector('[role=tab]').focus()")
        for title in "Variables", "Parameters", "Notes", "Plots":
            page.key("ArrowRight")
            assert page.evaluate("document.activeElement.textContent") == title
            assert page.evaluate("document.querySelector('[role=tab][aria-selected=true]').textContent") == title
        unnamed = page.evaluate("""[...document.querySelectorAll('button, input, select')].filter(n =>
            !(n.getAttribute('aria-label') || n.labels?.length || n.textContent.trim())).length""")
        assert unnamed == 0


CONTRAST = """(() => {
    const style = getComputedStyle(document.documentElement);
    const canvas = document.createElement('canvas').getContext('2d', { willReadFrequently: true });
    const light = (name) => {
        canvas.fillStyle = style.getPropertyValue('--' + name);
        canvas.fillRect(0, 0, 1, 1);
        const [r, g, b] = [...canvas.getImageData(0, 0, 1, 1).data].map(x => x / 255)
            .map(x => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4));
        return 0.2126 * r + 0.7152 * g + 0.0722 * b;
    };
    const ratio = (a, b) => (Math.max(light(a), light(b)) + 0.05) / (Math.min(light(a), light(b)) + 0.05);
    return [['text', 'panel'], ['text', 'field'], ['dim', 'panel'], ['dim', 'field'], ['accent', 'panel'],
            ['on-accent', 'accent'], ['warning', 'field'], ['text', 'bg'], ['focus', 'panel'], ['edge', 'panel']]
        .map(pair => [...pair, ratio(...pair)]);
})()"""


@pytest.mark.parametrize("theme", ["light", "dark"])
def test_text_stands_out(browser, made, theme):
    _, _, file = made("r2d2")
    with browser.page(f"file://{file}?quality=3&theme={theme}", width=480, height=360).ready() as page:
        for a, b, ratio in page.evaluate(CONTRAST):
            # WCAG 2.2, 1.4.3 for text and 1.4.11 for edges and focus.
            assert ratio >= (3 if a in ("focus", "edge") else 4.5), (a, b, ratio)


def test_a_phone_has_targets_for_fingers(browser, made):
    _, _, file = made("r2d2")
    with open_report(browser, file, width=390, height=844, phone=True) as page:
        small = page.evaluate("""[...document.querySelectorAll('button, select')].filter(n => n.offsetParent)
            .filter(n => n.getBoundingClientRect().height < 40).map(n => n.textContent || n.id)""")
        assert small == []
        assert page.evaluate("document.documentElement.scrollWidth") <= 390


def test_reduced_motion_plays_nothing_by_itself(browser, made):
    _, _, file = made("r2d2")
    with open_report(browser, file, "play", features=[("prefers-reduced-motion", "reduce")]) as page:
        assert page.evaluate("window.page.page.player.playing") is False
        assert page.evaluate("window.page.page.view.stage.controls.enableDamping") is False
    with open_report(browser, file, "play") as page:
        page.until("window.page.page.run.now > 0.02")


def test_plots_and_tables_work_without_webgl(made):
    _, results, file = made("r2d2")
    table = read_csv(results)
    browser = Browser("--disable-3d-apis")
    try:
        with browser.page(f"file://{file}?{SMALL}&t=0.5", width=480, height=360).ready() as page:
            page.errors = [e for e in page.errors if "WebGL" not in e]
            assert "no WebGL" in page.evaluate("document.getElementById('overlay').textContent")
            assert page.evaluate("window.page.page.plots.list.length") > 3
            value = page.evaluate("window.page.value('base.position.z')")
            assert abs(value - table["base.position.z"][120]) < 1e-4
            page.key("ArrowRight")
            page.until("Math.abs(window.page.page.run.now - 121 / 240) < 1e-6")
            page.evaluate("0")
            page.errors = [e for e in page.errors if "WebGL" not in e]
    finally:
        browser.close()


def test_a_minute_of_r2d2_fits_into_three_megabytes(command, export, pybullet_data, tmp_path):
    fmu = export(pybullet_data / "r2d2.urdf")
    wheels = [f"cmd.{side}_{end}_wheel_joint.velocity" for side in ("left", "right") for end in ("front", "back")]
    rng = np.random.default_rng(1)
    rows = ["time," + ",".join(wheels)]
    rows += [f"{time}," + ",".join(f"{x:.2f}" for x in rng.uniform(-8, 8, 4)) for time in range(61)]
    (tmp_path / "in.csv").write_text("\n".join(rows))
    run = command("simulate", fmu, "--input-file", tmp_path / "in.csv", "--stop-time", 60, "--output-interval",
                  1 / 240, "--report", tmp_path / "r.html")
    assert run.returncode == 0, run.stderr
    assert (tmp_path / "r.html").stat().st_size <= 3_000_000


def png(width, height):
    """A picture of stripes."""
    rows = b"".join(b"\0" + bytes([(x * 8) % 256, (y * 8) % 256, 128] * 1)[:3] * width for y in range(height) for x in [y])

    def chunk(kind, data):
        return struct.pack(">I", len(data)) + kind + data + struct.pack(">I", zlib.crc32(kind + data))

    return (b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", struct.pack(">IIBBBBB", width, height, 8, 2, 0, 0, 0))
            + chunk(b"IDAT", zlib.compress(rows)) + chunk(b"IEND", b""))


def test_a_hundred_links_with_textures_are_shown(browser, command, tmp_path):
    (tmp_path / "stripes.png").write_bytes(png(32, 32))
    (tmp_path / "m.mtl").write_text("newmtl a\nKd 1 1 1\nmap_Kd stripes.png\n")
    (tmp_path / "m.obj").write_text(
        "mtllib m.mtl\nusemtl a\nv 0 0 0\nv .1 0 0\nv 0 .1 0\nv 0 0 .1\nvt 0 0\nvt 1 0\nvt 0 1\n"
        "f 1/1 2/2 3/3\nf 1/1 2/2 4/3\nf 1/1 3/2 4/3\nf 2/1 3/2 4/3\n")
    parts = []
    for i in range(100):
        parts.append(f'<link name="l{i}"><inertial><mass value="0.1"/><inertia ixx="1e-3" iyy="1e-3" izz="1e-3" '
                     'ixy="0" ixz="0" iyz="0"/></inertial>'
                     '<visual><geometry><mesh filename="m.obj"/></geometry></visual></link>')
        if i:
            parts.append(f'<joint name="j{i}" type="revolute"><parent link="l{i - 1}"/><child link="l{i}"/>'
                         '<origin xyz="0.1 0 0"/><axis xyz="0 0 1"/>'
                         '<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>')
    (tmp_path / "r.urdf").write_text("<robot name='hundred'>" + "".join(parts) + "</robot>")
    run = command("simulate", tmp_path / "r.urdf", "--fixed-base", "--stop-time", "0.05", "--report", tmp_path / "r.html")
    assert run.returncode == 0, run.stderr
    with open_report(browser, tmp_path / "r.html") as page:
        assert page.evaluate("Object.keys(window.page.poses()).length") == 100
        page.until("[...window.page.page.view.robot.materials.values()].every(m => m.map?.image?.width === 32)")


ARROWS = """(() => { const { view } = window.page.page; view.draw();
    return view.contacts.list.map(({ link }, i) => [view.scene.head.links[link].name,
        view.arrows[i].node.visible ? view.arrows[i].node.position.toArray() : null]); })()"""


def test_forces_stand_where_the_fmu_says_that_they_act(browser, command, export, pybullet_data, tmp_path):
    fmu = export(pybullet_data / "r2d2.urdf", "[outputs]\ncontact_points = true\n")
    run = command("simulate", fmu, "--start-value", "initial.base.rpy.roll", "1.5", "--start-value",
                  "initial.base.position.z", "0.6", "--stop-time", "3", "--output-file", tmp_path / "out.csv",
                  "--report", tmp_path / "r.html")
    assert run.returncode == 0, run.stderr
    table = read_csv(tmp_path / "out.csv")
    with open_report(browser, tmp_path / "r.html", f"t={float(table['time'][-1])}") as page:
        arrows = {link: place for link, place in page.evaluate(ARROWS) if place}
    assert len(arrows) > 1
    for link, place in arrows.items():
        expected = [table[f"contact.{link}.point.{axis}"][-1] for axis in "xyz"]
        # Numbers of 32 bits, in steps of a millionth of what a column spans.
        np.testing.assert_allclose(place, expected, atol=1e-5, err_msg=link)


@pytest.mark.skipif(shutil.which("npm") is None, reason="no npm; on Debian: apt install npm")
def test_the_committed_page_is_that_of_its_sources(examples, tmp_path):
    import subprocess
    folder = shutil.copytree(examples.parent / "build/page", tmp_path / "page",
                             ignore=shutil.ignore_patterns("node_modules"))
    for step in ["npm", "ci", "--no-audit", "--no-fund"], ["npm", "run", "check"]:
        run = subprocess.run(step, cwd=folder, capture_output=True, text=True, check=False)
        assert run.returncode == 0, run.stdout + run.stderr


def test_every_tree_is_drawn_at_its_own_base(browser, command, export, pybullet_data, tmp_path):
    fmu = export(pybullet_data / "r2d2.urdf", "[initial]\nxyz = [0, 0, 0.6]\n",
                 "--object", pybullet_data / "plane.urdf", "--object", f"{pybullet_data / 'cube_small.urdf'}@1,0.5,0.8",
                 "--object", f"{pybullet_data / 'table/table.urdf'}@0,3")
    run = command("simulate", fmu, "--stop-time", 0.5, "--output-file", tmp_path / "out.csv",
                  "--report", tmp_path / "r.html")
    assert run.returncode == 0, run.stderr
    table = read_csv(tmp_path / "out.csv")
    rows = 0, 60, len(table) - 1
    with open_report(browser, tmp_path / "r.html") as page:
        shown = [poses_at(page, table["time"][row]) for row in rows]
    for row, poses in zip(rows, shown):
        for link, name in ("base_link", "base"), ("cube.baseLink", "object.cube"):
            expected = [table[f"{name}.position.{axis}"][row] for axis in "xyz"]
            assert np.allclose(poses[link][:3], expected, atol=1e-4), link
        assert np.allclose(poses["table.baseLink"], [0, 3, 0, 0, 0, 0, 1], atol=1e-6)
    # The cube has fallen by g t^2 / 2 meanwhile: 1.226 m would be below the ground.
    assert table["object.cube.position.z"][-1] < 0.03
