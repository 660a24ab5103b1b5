"""Pictures: their outlines held against PyBullet's own renderer, and robots that are hard to draw."""

import os
import re
import struct
import subprocess
import zipfile
import zlib

import numpy
import pytest

import png
import scene
import tables

ROBOTS = {
    "r2d2": "r2d2.urdf",
    "husky": "husky/husky.urdf",
    "iiwa": "kuka_iiwa/model.urdf",
    "laikago": "laikago/laikago.urdf",
    "racecar": "racecar/racecar.urdf",
    "panda": "franka_panda/panda.urdf",
    "a1": "a1/a1.urdf",
    "xarm": "xarm/xarm6_robot.urdf",
    "mini cheetah": "mini_cheetah/mini_cheetah.urdf",
}
SIZE = 480
"""Pixels: one of them is a quarter of a percent of the robot's outline."""


def camera(text):
    """What `picture` says of its camera: where it is, where it looks, and its field of view."""
    numbers = [float(x) for x in re.findall(r"-?\d+(?:\.\d+)?", text.split("camera", 1)[1])]
    return numbers[:3], numbers[3:6], numbers[6]


def outline_by_pybullet(pybullet, client, urdf, head, view):
    """Which pixels PyBullet's software renderer sees the robot in, at the start of the simulation."""
    eye, target, field = view
    base = head["roots"][0]
    robot = pybullet.loadURDF(str(urdf), base["position"]["start"], base["orientation"]["start"],
                              useFixedBase=True, physicsClientId=client)
    starts = {joint["name"]: joint["motions"] for joint in head["joints"]}
    for index in range(pybullet.getNumJoints(robot, physicsClientId=client)):
        motions = starts[pybullet.getJointInfo(robot, index, physicsClientId=client)[1].decode()]
        if len(motions) == 1 and motions[0]["kind"] != "ball":
            pybullet.resetJointState(robot, index, motions[0]["start"][0], physicsClientId=client)
    image = pybullet.getCameraImage(
        SIZE, SIZE, pybullet.computeViewMatrix(eye, target, [0, 0, 1]),
        pybullet.computeProjectionMatrixFOV(field, 1, 0.02, 100), renderer=pybullet.ER_TINY_RENDERER,
        flags=pybullet.ER_SEGMENTATION_MASK_OBJECT_AND_LINKINDEX, physicsClientId=client)
    return numpy.asarray(image[4]).reshape(SIZE, SIZE) >= 0


@pytest.mark.parametrize("place", ["corner", "200,35"])
@pytest.mark.parametrize("name", ROBOTS)
def test_the_outline_is_that_of_pybullet(name, place, command, export, pybullet_data, tmp_path):
    pybullet = pytest.importorskip("pybullet", reason="PyBullet has no wheel for this Python and platform")
    urdf = pybullet_data / ROBOTS[name]
    fmu = export(urdf)
    picture = tmp_path / "robot.png"
    run = command("picture", fmu, "-o", picture, "--theme", "cutout", "--size", f"{SIZE}x{SIZE}", "--from", place)
    assert run.returncode == 0, run.stderr
    ours = png.read(picture)[:, :, 3] > 127
    client = pybullet.connect(pybullet.DIRECT)
    try:
        theirs = outline_by_pybullet(pybullet, client, urdf, scene.read(fmu)[0], camera(run.stdout))
    finally:
        pybullet.disconnect(client)
    share = (ours & theirs).sum() / (ours | theirs).sum()
    # Half a pixel along the outline is one percent of a robot that fills the picture.
    assert share >= 0.97, f"intersection over union is {share:.4f}"


def turn(quaternion):
    """The matrix of x, y, z, w."""
    x, y, z, w = quaternion
    return numpy.array([[1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
                        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
                        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)]])


def outline_by_rays(head, view):
    """Which pixels' rays meet a sphere, a capsule or a box of a robot whose joints are balls or hinges at zero."""
    eye, target, field = view
    ahead = numpy.subtract(target, eye) / numpy.linalg.norm(numpy.subtract(target, eye))
    right = numpy.cross(ahead, [0, 0, 1]) / numpy.linalg.norm(numpy.cross(ahead, [0, 0, 1]))
    steps = (numpy.arange(SIZE) + 0.5 - SIZE / 2) / (SIZE / 2) * numpy.tan(numpy.radians(field / 2))
    rays = ahead + steps[None, :, None] * right - steps[:, None, None] * numpy.cross(right, ahead)
    rays /= numpy.linalg.norm(rays, axis=-1, keepdims=True)
    poses = {
        root["link"]: (turn(root["orientation"]["start"]), numpy.array(root["position"]["start"]))
        for root in head["roots"]
    }
    for joint in head["joints"]:
        R, p = poses[joint["parent"]]
        p, R = p + R @ joint["position"], R @ turn(joint["orientation"])
        for motion in joint["motions"]:
            assert motion["start"] in ([0], [0, 0, 0, 1])
        poses[joint["child"]] = R, p
    seen = numpy.zeros((SIZE, SIZE), bool)
    for shape in head["visuals"] or head["collisions"]:
        R, p = poses[shape["link"]]
        p, R = p + R @ shape["position"], R @ turn(shape["orientation"])
        if "box" in shape["shape"]:
            origin, way = (numpy.array(eye) - p) @ R, rays @ R
            half = numpy.array(shape["shape"]["box"]) / 2
            walls = numpy.sort([(-half - origin) / way, (half - origin) / way], axis=0)
            seen |= walls[0].max(axis=-1) <= walls[1].min(axis=-1)
            continue
        radius, length = shape["shape"].get("capsule") or (shape["shape"]["sphere"], 0)
        # The point of the axis, p + along * axis with |along| <= length / 2, that is nearest to the ray: the square of
        # its distance, |away + along * axis|^2 - (ray . (away + along * axis))^2, is least.
        away, axis = p - eye, R[:, 2]
        forward, tilt = rays @ away, rays @ axis
        along = numpy.clip((forward * tilt - away @ axis) / (1 - tilt ** 2), -length / 2, length / 2)
        square = away @ away + 2 * along * (away @ axis) + along ** 2 - (forward + along * tilt) ** 2
        seen |= square <= radius ** 2
    return seen


@pytest.mark.parametrize("place", ["corner", "200,35"])
def test_the_outline_of_round_shapes_is_that_of_rays(place, command, export, pybullet_data, tmp_path):
    """PyBullet's humanoid is of capsules, whose round ends PyBullet's own renderer draws with so few corners that 4 to
    10 percent of its outline are missing. Rays know no corners."""
    fmu, picture = export(pybullet_data / "humanoid/humanoid.urdf"), tmp_path / "robot.png"
    run = command("picture", fmu, "-o", picture, "--theme", "cutout", "--size", SIZE, "--from", place)
    assert run.returncode == 0, run.stderr
    ours = png.read(picture)[:, :, 3] > 127
    theirs = outline_by_rays(scene.read(fmu)[0], camera(run.stdout))
    share = (ours & theirs).sum() / (ours | theirs).sum()
    assert share >= 0.99, f"intersection over union is {share:.4f}"


INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>'


def write_png(path, pixels):
    """A PNG of rows of red, green and blue."""
    def chunk(name, data):
        return struct.pack(">I", len(data)) + name + data + struct.pack(">I", zlib.crc32(name + data))

    pixels = numpy.asarray(pixels, numpy.uint8)
    header = struct.pack(">IIBBBBB", pixels.shape[1], pixels.shape[0], 8, 2, 0, 0, 0)
    raw = b"".join(b"\0" + row.tobytes() for row in pixels)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw))
                     + chunk(b"IEND", b""))


@pytest.fixture
def take(command, tmp_path):
    """Takes a picture of a URDF's text; gives its pixels as numbers of 0 … 255, and the finished process."""

    def run(content, *arguments):
        urdf, picture = tmp_path / "robot.urdf", tmp_path / "robot.png"
        urdf.write_text(f'<robot name="robot">{content}</robot>', encoding="utf-8")
        done = command("picture", urdf, "-o", picture, *arguments)
        assert done.returncode == 0, done.stderr
        return png.read(picture).astype(int), done

    return run


def test_colours_and_textures_come_from_urdf_obj_and_collada(take, tmp_path):
    """Four cubes seen from above, side by side: each is painted in another way."""
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    (tmp_path / "green.mtl").write_text("newmtl green\nKd 0 0.8 0\nnewmtl map\nKd 1 1 1\nmap_Kd half.png\n")
    vertices = "".join("v %d %d %d\n" % corner for corner in corners)
    (tmp_path / "green.obj").write_text(f"mtllib green.mtl\nusemtl green\n{vertices}f 2 6 8 4\n")
    (tmp_path / "map.obj").write_text(
        f"mtllib green.mtl\nusemtl map\n{vertices}vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 2/1 6/2 8/3 4/4\n")
    # Left half red, right half blue.
    write_png(tmp_path / "half.png", [[(255, 0, 0)] * 8 + [(0, 0, 255)] * 8] * 16)
    (tmp_path / "yellow.dae").write_text(
        '<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1"><asset/>'
        '<library_effects><effect id="e"><profile_COMMON><technique sid="t"><lambert><diffuse>'
        '<color>0.8 0.8 0 1</color></diffuse></lambert></technique></profile_COMMON></effect></library_effects>'
        '<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>'
        '<library_geometries><geometry id="g"><mesh><source id="s"><float_array id="f" count="12">'
        '0 0 1 1 0 1 1 1 1 0 1 1</float_array><technique_common><accessor source="#f" count="4" stride="3"/>'
        '</technique_common></source><vertices id="v"><input semantic="POSITION" source="#s"/></vertices>'
        '<triangles count="2" material="paint"><input semantic="VERTEX" source="#v" offset="0"/>'
        '<p>0 1 2 0 2 3</p></triangles></mesh></geometry></library_geometries>'
        '<library_visual_scenes><visual_scene id="w"><node><instance_geometry url="#g"><bind_material>'
        '<technique_common><instance_material symbol="paint" target="#m"/></technique_common></bind_material>'
        '</instance_geometry></node></visual_scene></library_visual_scenes>'
        '<scene><instance_visual_scene url="#w"/></scene></COLLADA>')

    def visual(x, geometry, material=""):
        return f'<visual><origin xyz="{x} 0 0"/><geometry>{geometry}</geometry>{material}</visual>'

    pixels, _ = take(
        '<material name="violet"><color rgba="0.6 0 0.6 1"/></material>'
        f'<link name="a">{INERTIAL}'
        + visual(0.5, '<box size="1 1 1"/>', '<material name="violet"/>')
        + visual(1, '<mesh filename="green.obj"/>')
        + visual(2, '<mesh filename="map.obj"/>', '<material name="violet"/>')
        + visual(3, '<mesh filename="yellow.dae"/>')
        + "</link>", "--from", "top", "--size", "400x200", "--theme", "cutout")
    row = pixels[100]
    inside = numpy.flatnonzero(row[:, 3] == 255)
    start, width = inside[0], inside[-1] - inside[0]
    at = [row[start + int(width * part)] for part in (0.125, 0.375, 0.56, 0.69, 0.875)]
    violet, green, left, right, yellow = at
    # The sky's reflection pales every colour; a wrong one would not pass for any of these.
    assert min(violet[0], violet[2]) > 1.4 * violet[1]
    assert green[1] > 1.4 * max(green[0], green[2])
    assert left[0] > 1.4 * max(left[1], left[2])
    assert right[2] > 1.4 * max(right[0], right[1])
    assert min(yellow[0], yellow[1]) > 1.4 * yellow[2]


def test_large_textures_are_carried_as_large_as_a_page_can_use(export, command, tmp_path):
    """One of 1536 pixels is halved; nine of 1024 pixels have more than 8 Mi pixels together and are halved as well."""
    for count, side, carried in (1, 1536, 768), (8, 1024, 1024), (9, 1024, 512):
        links, paints, found = "", [], []
        for i in range(count):
            # Textures that are equal are carried once.
            paint = [(255 - i, 0, 0), (0, 255, 0), (0, 0, 255), (255, 255, 0)]
            paints.append(paint)
            quarters = numpy.array(paint, numpy.uint8).reshape(2, 2, 3)
            write_png(tmp_path / f"{i}.png", quarters.repeat(side // 2, axis=0).repeat(side // 2, axis=1))
            (tmp_path / f"{i}.mtl").write_text(f"newmtl m\nmap_Kd {i}.png\n")
            (tmp_path / f"{i}.obj").write_text(f"mtllib {i}.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 1 0 1\nv 0 0 1\n"
                                               "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nf 1/1 2/2 3/3 4/4\n")
            links += (f'<link name="l{i}">{INERTIAL}<visual><geometry><mesh filename="{i}.obj"/></geometry></visual>'
                      "</link>")
            if i:
                links += (f'<joint name="j{i}" type="fixed"><parent link="l0"/><child link="l{i}"/>'
                          f'<origin xyz="0 {i} 0"/></joint>')
        urdf, picture = tmp_path / f"robot{count}.urdf", tmp_path / "robot.png"
        urdf.write_text(f'<robot name="robot">{links}</robot>')
        fmu = export(urdf)
        head, body = scene.read(fmu)
        assert [(t["width"], t["height"]) for t in head["textures"]] == [(carried, carried)] * count
        for texture in head["textures"]:
            (tmp_path / "texture.png").write_bytes(body[texture["at"]:texture["at"] + texture["bytes"]])
            pixels = png.read(tmp_path / "texture.png")
            quarters = [pixels[y:y + carried // 2, x:x + carried // 2] for y in (0, carried // 2)
                        for x in (0, carried // 2)]
            found.append([tuple(quarter[0, 0]) for quarter in quarters])
            assert all((quarter == quarter[0, 0]).all() for quarter in quarters)
        assert sorted(found) == sorted(paints)
        # One number is the side of a square.
        run = command("picture", fmu, "-o", picture, "--theme", "cutout", "--from", "right", "--size", "64")
        assert run.returncode == 0, run.stderr
        seen = png.read(picture).astype(int)
        assert seen.shape[:2] == (64, 64)
        assert seen[16, 16, 0] > 1.4 * seen[16, 16, 2] and seen[48, 16, 2] > 1.4 * seen[48, 16, 0]


def test_a_size_is_two_numbers_or_one(command, examples, tmp_path):
    for size, shape in ("40", (40, 40)), ("48x32", (32, 48)):
        run = command("picture", examples / "rover.urdf", "-o", tmp_path / "r.png", "--size", size)
        assert run.returncode == 0 and png.read(tmp_path / "r.png").shape[:2] == shape
    for size in "8", "40x", "x40", "4097", "-40", "40.5":
        run = command("picture", examples / "rover.urdf", "-o", tmp_path / "no.png", f"--size={size}")
        assert run.returncode == 2 and "one number for both" in run.stderr
    assert not (tmp_path / "no.png").exists()


def test_a_robot_of_a_hundred_links_with_textures_is_drawn(take, tmp_path):
    # Of a mass that fits what is drawn: another one would be told.
    inertial = ('<inertial><mass value="1"/><inertia ixx="0.002" iyy="0.002" izz="0.002" ixy="0" ixz="0" iyz="0"/>'
                '</inertial>')
    parts = []
    for i in range(100):
        write_png(tmp_path / f"{i}.png", [[(i * 2, 255 - i * 2, (i * 7) % 256)] * 2] * 2)
        (tmp_path / f"{i}.mtl").write_text(f"newmtl m\nmap_Kd {i}.png\n")
        (tmp_path / f"{i}.obj").write_text(
            f"mtllib {i}.mtl\nusemtl m\nv 0 0 0\nv 0.1 0 0\nv 0.1 0 0.1\nv 0 0 0.1\nv 0.05 -0.05 0.05\n"
            "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt .5 .5\n"
            "f 1/1 2/2 3/3 4/4\nf 1/1 2/2 5/5\nf 2/2 3/3 5/5\nf 3/3 4/4 5/5\nf 4/4 1/1 5/5\n")
        parts.append(f'<link name="l{i}">{inertial}<visual><geometry><mesh filename="{i}.obj"/></geometry></visual></link>')
        if i:
            parts.append(f'<joint name="j{i}" type="continuous"><parent link="l{i - 1}"/><child link="l{i}"/>'
                         f'<origin xyz="{0.1 if i % 10 else -0.9} 0 {0 if i % 10 else 0.1}"/><axis xyz="0 1 0"/></joint>')
    pixels, done = take("".join(parts), "--floating-base", "--from", "-90,0", "--theme", "cutout", "--size", "200x200")
    assert done.stderr == ""
    solid = pixels[pixels[:, :, 3] == 255]
    assert len(solid) > 0.85 * 200 * 200
    # A hundred squares of different colours.
    assert len({tuple(pixel // 24) for pixel in solid[:, :3]}) > 60


@pytest.mark.parametrize("kind", ["heights", "mesh"])
def test_terrain_is_drawn_where_it_is(kind, command, tmp_path):
    """A slope that rises by 1 m over 4 m, off the middle, and turned: where rays through the pixels meet it."""
    turn, size = 0.5, 2.0
    if kind == "heights":
        name, keys = "slope.csv", 'type = "heightfield"\nsize = [4, 4]'
        (tmp_path / name).write_text("0,0.5,1\n0,0.5,1\n0,0.5,1\n")
    else:
        name, keys = "slope.obj", 'type = "mesh"'
        (tmp_path / name).write_text("v -2 -2 0\nv 2 -2 1\nv 2 2 1\nv -2 2 0\nf 1 2 3 4\n")
    (tmp_path / "ball.urdf").write_text(
        '<robot name="ball"><link name="ball"><inertial><mass value="1"/>'
        '<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>'
        '<collision><geometry><sphere radius="0.1"/></geometry></collision></link></robot>')
    (tmp_path / "ball.toml").write_text(
        f'[initial]\nxyz = [1, 0]\n[[world.terrain]]\nname = "slope"\nfile = "{name}"\n{keys}\n'
        f"xyz = [1, 0, 0.2]\nrpy = [0, 0, {turn}]\n")
    picture = tmp_path / "slope.png"
    run = command("picture", tmp_path / "ball.urdf", "-c", tmp_path / "ball.toml", "-o", picture, "--theme", "cutout",
                  "--size", f"{SIZE}x{SIZE}", "--from", "200,35")
    assert run.returncode == 0, run.stderr
    drawn = png.read(picture)[:, :, 3] > 127
    eye, target, field = camera(run.stdout)
    forward = numpy.subtract(target, eye) / numpy.linalg.norm(numpy.subtract(target, eye))
    right = numpy.cross(forward, [0, 0, 1])
    right /= numpy.linalg.norm(right)
    up = numpy.cross(right, forward)
    steps = (2 * (numpy.arange(SIZE) + 0.5) / SIZE - 1) * numpy.tan(numpy.radians(field) / 2)
    rays = forward + steps[None, :, None] * right - steps[:, None, None] * up
    back = numpy.array([[numpy.cos(turn), numpy.sin(turn), 0], [-numpy.sin(turn), numpy.cos(turn), 0], [0, 0, 1]])
    origin, rays = back @ numpy.subtract(eye, [1, 0, 0.2]), rays @ back.T
    # On the slope z = (x + 2)/4.
    way = (origin[2] - (origin[0] + size) / 4) / (rays[..., 0] / 4 - rays[..., 2])
    hits = origin + way[..., None] * rays
    expected = (way > 0) & (abs(hits[..., 0]) < size) & (abs(hits[..., 1]) < size)
    assert expected.mean() > 0.2
    # The ball stands before a part of its border at most.
    assert (drawn != expected).mean() < 0.005


def test_a_robot_without_visuals_shows_what_it_collides_with(take):
    ball = '<geometry><sphere radius="0.5"/></geometry>'
    pixels, _ = take(f'<link name="a">{INERTIAL}<collision>{ball}</collision></link>', "--theme", "cutout",
                     "--size", "200x200")
    seen, _ = take(f'<link name="a">{INERTIAL}<visual>{ball}</visual></link>', "--theme", "cutout",
                   "--size", "200x200")
    assert numpy.array_equal(pixels[:, :, 3], seen[:, :, 3])
    # A circle that fills 96 percent of the picture.
    assert abs((seen[:, :, 3] > 127).sum() / (numpy.pi * 96 ** 2) - 1) < 0.01


def test_a_robot_without_any_shape_is_drawn_as_balls_and_rods(take):
    pixels, _ = take(f'<link name="a">{INERTIAL}</link><link name="b">{INERTIAL}</link>'
                     '<joint name="j" type="continuous"><parent link="a"/><child link="b"/>'
                     '<origin xyz="0 0 1"/><axis xyz="1 0 0"/></joint>', "--theme", "cutout", "--size", "200x200")
    rows = numpy.flatnonzero((pixels[:, :, 3] > 127).any(axis=1))
    assert len(rows) > 180 and len(rows) == rows[-1] - rows[0] + 1


def test_names_may_hold_markup_quotes_and_any_script(export, tmp_path):
    names = ["<script>alert(1)</script>", "it's \"quoted\" & more", "日本のロボット"]
    urdf = tmp_path / "robot.urdf"
    escaped = [name.replace("&", "&amp;").replace("<", "&lt;").replace('"', "&quot;") for name in names]
    box = '<geometry><box size="1 1 1"/></geometry>'
    urdf.write_text(
        f'<robot name="{escaped[2]}">'
        + "".join(f'<link name="{name}">{INERTIAL}<visual>{box}</visual></link>' for name in escaped)
        + "".join(f'<joint name="{child}" type="continuous"><parent link="{parent}"/><child link="{child}"/></joint>'
                  for parent, child in zip(escaped, escaped[1:])) + "</robot>", encoding="utf-8")
    head, _ = scene.read(export(urdf))
    assert head["robot"] == names[2]
    assert [link["name"] for link in head["links"]] == names
    listed = {variable["name"] for variable in head["variables"]}
    for joint in head["joints"]:
        assert {name for motion in joint["motions"] for name in motion["variables"]} <= listed


def test_what_is_wrong_with_a_picture_is_a_warning_with_its_place(take, tmp_path):
    (tmp_path / "torn.obj").write_text("v 0 0\n")
    (tmp_path / "plain.mtl").write_text("newmtl m\nmap_Kd nowhere.png\n")
    (tmp_path / "plain.obj").write_text("mtllib plain.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 0 1\n"
                                        "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")
    visuals = "".join(f'<visual><geometry><mesh filename="{name}"/></geometry></visual>'
                      for name in ("gone.stl", "torn.obj", "plain.obj"))
    pixels, done = take(f'<link name="a">{INERTIAL}{visuals}</link>', "--theme", "cutout")
    for code in ("U111", "U116", "U117"):
        assert f"warning[{code}]" in done.stderr and "robot.urdf:1:" in done.stderr
    assert (pixels[:, :, 3] > 0).any()


def test_a_damaged_texture_leaves_the_plain_colour(take, tmp_path):
    write_png(tmp_path / "torn.png", [[(255, 0, 0)] * 8] * 8)
    torn = (tmp_path / "torn.png").read_bytes()
    (tmp_path / "torn.mtl").write_text("newmtl m\nmap_Kd torn.png\n")
    (tmp_path / "torn.obj").write_text("mtllib torn.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 0 1\n"
                                       "vt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n")
    mesh = f'<link name="a">{INERTIAL}<visual><geometry><mesh filename="torn.obj"/></geometry></visual></link>'
    for length in range(33, len(torn), 7):
        (tmp_path / "torn.png").write_bytes(torn[:length])
        pixels, _ = take(mesh, "--theme", "cutout", "--size", "32x32", "--from", "right")
        assert (pixels[:, :, 3] > 0).any()


def test_an_fmu_holds_its_picture_and_an_icon(export, examples, command, tmp_path):
    fmu = export(examples / "rover.urdf", documented=True)
    with zipfile.ZipFile(fmu) as archive:
        for name, side in (("model.png", 512), ("terminalsAndIcons/icon.png", 128)):
            (tmp_path / "picture.png").write_bytes(archive.read(name))
            pixels = png.read(tmp_path / "picture.png")
            assert pixels.shape == (side, side, 4)
            alpha = pixels[:, :, 3] / 255
            assert 0.1 < (alpha == 1).mean() < 0.7 and (alpha == 0).mean() > 0.1
        whole = archive.read("model.png")
        assert b'src="../model.png"' in archive.read("documentation/index.html")
    # The same picture is taken of the FMU and of the URDF, by one thread and by several.
    for source in (fmu, examples / "rover.urdf"):
        assert command("picture", source, "-o", tmp_path / "again.png").returncode == 0
        assert (tmp_path / "again.png").read_bytes() == whole
    if hasattr(os, "sched_setaffinity"):
        one = {min(os.sched_getaffinity(0))}
        subprocess.run([os.environ["URDF2FMU"], "picture", fmu, "-o", tmp_path / "one.png"], check=True,
                       preexec_fn=lambda: os.sched_setaffinity(0, one))
        assert (tmp_path / "one.png").read_bytes() == whole


def test_an_animation_shows_each_step_of_a_run(export, examples, command, tmp_path):
    fmu, table, film = export(examples / "rover.urdf"), tmp_path / "run.csv", tmp_path / "film.png"
    table.write_text('"time","base.position.x"\n0,0\n1,0.5\n')
    run = command("picture", fmu, "--run", table, "--rate", "10", "--size", "120x90", "-o", film)
    assert run.returncode == 0, run.stderr
    assert "columns of its position or orientation are missing" in run.stderr
    content = png.chunks(film)
    assert struct.unpack(">II", dict(content)["acTL"]) == (11, 0)
    assert [name for name, _ in content].count("fcTL") == 11
    numbers = [struct.unpack(">I", data[:4])[0] for name, data in content if name in ("fcTL", "fdAT")]
    assert numbers == list(range(21))

    for text, words in (("time,other\n0,1\n", "base.position.x"), ("time\n", "no row")):
        table.write_text(text)
        run = command("picture", fmu, "--run", table, "-o", film)
        assert run.returncode == 1 and words in run.stderr
    table.write_text("time,base.position.x\n0,0\n1,0.5\n")
    assert command("picture", fmu, "--run", table, "-o", film, "--theme", "clear").returncode == 2


@pytest.fixture(scope="module")
def drive(export, examples, command, tmp_path_factory):
    """The rover's FMU and the table of a run of one second, in which its wheels turn and it moves on."""
    folder, fmu = tmp_path_factory.mktemp("drive"), export(examples / "rover.urdf")
    wheels = re.findall(r"(cmd\.\S*wheel\S*\.velocity)\s", command("info", fmu, "--variables").stdout)
    (folder / "in.csv").write_text(f"time,{','.join(wheels)}\n0{',6' * len(wheels)}\n")
    run = command("simulate", fmu, "--input-file", folder / "in.csv", "--stop-time", "1", "--output-interval", "0.1",
                  "--output-file", folder / "run.csv")
    assert run.returncode == 0 and wheels, run.stderr
    return fmu, folder / "run.csv"


def film_and_notes(command, fmu, table, folder):
    """The animation of a table, and what is said of the table; a report says the same."""
    film = folder / "film.png"
    run = command("picture", fmu, "--run", table, "--rate", "5", "--size", "120x90", "-o", film)
    assert run.returncode == 0, run.stderr
    report = command("report", table, "--model", fmu, "-o", folder / "report.html")
    assert report.returncode == 0, report.stderr
    notes, those_of_the_report = ([line for line in text.splitlines() if line.startswith("note: ")]
                                  for text in (run.stderr, report.stderr))
    assert notes == [note for note in those_of_the_report if "contact forces" not in note]
    return film.read_bytes(), notes


@pytest.mark.parametrize("style", tables.FOREIGN)
def test_an_animation_reads_the_tables_of_other_programs(drive, command, tmp_path, style):
    fmu, table = drive
    expected, notes = film_and_notes(command, fmu, table, tmp_path)
    assert not notes and len(set(png.chunks(tmp_path / "film.png"))) > 4
    foreign = tables.rewritten(table, tmp_path, tables.FOREIGN[style])
    film, _ = film_and_notes(command, fmu, foreign, tmp_path)
    assert film == expected


def test_an_animation_leaves_out_what_its_table_does_not_have_and_says_so(drive, command, tmp_path):
    """Columns that are missing or unknown, empty cells, and a last line that is cut off."""
    fmu, table = drive

    def without(word, cell=None):
        def change(rows):
            keep = [i for i, name in enumerate(rows[0]) if cell is not None or word not in name]
            changed = [[cell if cell is not None and r and word in rows[0][i] else row[i] for i in keep]
                       for r, row in enumerate(rows)]
            return tables.joined([[*row, "x" if r else "my.own"] for r, row in enumerate(changed)]) + "1.1,0"
        return tables.rewritten(table, tmp_path, change)

    missing, notes = film_and_notes(command, fmu, without("wheel"), tmp_path)
    for words in ("not complete and is left out", "'my.own'", "joints stay where they start"):
        assert any(words in note for note in notes), notes
    empty, notes = film_and_notes(command, fmu, without("wheel", ""), tmp_path)
    assert not any("stay where" in note for note in notes), notes
    whole, _ = film_and_notes(command, fmu, table, tmp_path)
    # What has no column and what has no value in it stay where they start.
    assert missing == empty != whole


def test_an_fmu_of_an_older_program_has_no_picture_to_take(export, examples, command, tmp_path):
    old = tmp_path / "old.fmu"
    with zipfile.ZipFile(export(examples / "rover.urdf", documented=True)) as full, zipfile.ZipFile(old, "w") as archive:
        for name in full.namelist():
            if not name.endswith("scene.bin"):
                archive.writestr(name, full.read(name))
    run = command("picture", old)
    assert run.returncode == 1 and "export the robot again" in run.stderr
