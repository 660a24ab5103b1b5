"""Takes the pictures of pages in docs/see.md, in a browser: python pages.py URDF2FMU PYBULLET_DATA EXAMPLE_ROBOT_DATA

Each shows one robot's report at the sizes of a desk and of a phone, light and dark.
"""
import base64
import subprocess
import sys
import tempfile
from pathlib import Path

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "tests/python"))
from browser import Browser  # noqa: E402

DESK, PHONE = (1440, 900), (390, 844)


def robots(pybullet, examples):
    return {"r2d2": pybullet / "r2d2.urdf", "arm": pybullet / "kuka_iiwa/model.urdf",
            "quadruped": examples / "anymal_c_simple_description/urdf/anymal.urdf",
            "humanoid": examples / "g1_description/urdf/g1_29dof_rev_1_0.urdf"}


def main(command, pybullet, examples):
    browser = Browser()
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        for name, urdf in robots(Path(pybullet), Path(examples)).items():
            report, sheet = folder / f"{name}.html", folder / "sheet.html"
            subprocess.run([command, "simulate", urdf, "--stop-time", "1", "--quiet", "--report", report,
                            "--package-path", Path(examples).parent], check=True, stderr=subprocess.DEVNULL)
            images = ""
            for theme in "light", "dark":
                for width, height in DESK, PHONE:
                    file = folder / "page.png"
                    address = f"file://{report}?quality=0&theme={theme}&t=0.5"
                    with browser.page(address, width=width, height=height, phone=width < 760).ready() as page:
                        page.evaluate("new Promise((done) => requestAnimationFrame(() => requestAnimationFrame(done)))")
                        page.picture(file)
                    data = base64.b64encode(file.read_bytes()).decode()
                    images += f'<img src="data:image/png;base64,{data}" style="height: 540px">'
            style = "margin: 0; display: grid; grid: auto / auto auto; gap: 6px; width: 1120px"
            sheet.write_text(f'<body style="{style}">{images}')
            with browser.page(f"file://{sheet}", width=1120, height=1086) as page:
                page.until("[...document.images].length === 4 && [...document.images].every((image) => image.complete)")
                shot = page.call("Page.captureScreenshot", format="jpeg", quality=80)
            (HERE / f"pages_{name}.jpg").write_bytes(base64.b64decode(shot["data"]))
    browser.close()


main(*sys.argv[1:])
