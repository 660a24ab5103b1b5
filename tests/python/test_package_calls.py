"""Calls of the Python package that go wrong: what is said of them names the place and what to do."""

import sys
import zipfile
from pathlib import Path

import pytest

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "python"))
import urdf2fmu  # noqa: E402
from urdf2fmu import Error, Simulation  # noqa: E402


@pytest.fixture(scope="module", params=[2, 3])
def rover(request, examples, tmp_path_factory):
    """The FMU of the example rover, of FMI 2 and of FMI 3."""
    place = tmp_path_factory.mktemp("calls") / "rover.fmu"
    return urdf2fmu.export(examples / "rover.urdf", place, fmi=request.param, no_documentation=True)


def test_flags_and_values_are_told_as_python_has_them(examples):
    """"unexpected value '0' for '--fixed-base'; no more were expected" helped nobody."""
    for options, said in [({"fixed_base": 0}, "fixed_base is True or False"),
                          ({"fixed_base": "no"}, "fixed_base is True or False"),
                          ({"density": True}, "density takes a value, not True"),
                          ({"scale": [1, 2]}, "scale takes one value, not a list of them")]:
        with pytest.raises(Error, match=said):
            urdf2fmu.check(examples / "rover.urdf", **options)


def test_settings_as_a_dict_are_called_so(examples, tmp_path):
    """Findings named a temporary file that was gone."""
    config = {"robot": {"scale": float("nan")}}
    found = urdf2fmu.check(examples / "rover.urdf", config=config)
    assert [one["file"] for one in found if one["severity"] == "error"] == ["config"]
    for function in (urdf2fmu.info, lambda robot, config: urdf2fmu.export(robot, tmp_path / "a.fmu", config=config)):
        with pytest.raises(Error, match=r"config:2:9|config:2:") as raised:
            function(examples / "rover.urdf", config=config)
        assert "settings.toml" not in str(raised.value)
        assert [one["file"] for one in raised.value.findings] == ["config"]
    endless = {}
    endless["robot"] = endless
    with pytest.raises(Error, match="they contain themselves"):
        urdf2fmu.check(examples / "rover.urdf", config=endless)
    with pytest.raises(Error, match="by the name of their file, or as a dict, not by their text"):
        urdf2fmu.check(examples / "rover.urdf", config='[robot]\nbase = "fixed"')


def test_another_program_in_place_of_the_command_is_told(examples, tmp_path, monkeypatch):
    """An export by one that does nothing was a success."""
    monkeypatch.setenv("URDF2FMU", "/bin/true")
    with pytest.raises(Error, match="there is no .*a.fmu, though the program '/bin/true', which URDF2FMU names"):
        urdf2fmu.export(examples / "rover.urdf", tmp_path / "a.fmu")
    with pytest.raises(Error, match="no JSON: is it urdf2fmu"):
        urdf2fmu.info(examples / "rover.urdf")


def test_fmus_that_are_none_are_told_with_what_to_do(rover, tmp_path):
    whole = rover.read_bytes()
    with zipfile.ZipFile(tmp_path / "bare.fmu", "w") as archive:
        archive.writestr("readme", "")
    for name, content, said in [("half.fmu", whole[:len(whole) // 2], "cut short or damaged .* once more"),
                                ("empty.fmu", b"", "it is empty; copy or download it once more"),
                                ("text.fmu", b"hello", "an FMU is a zip archive, and this is none"),
                                ("bare.fmu", None, "it has no modelDescription.xml at its top")]:
        if content is not None:
            (tmp_path / name).write_bytes(content)
        for function in (Simulation, urdf2fmu.simulate):
            with pytest.raises(Error, match=said):
                function(tmp_path / name)
    with pytest.raises(Error, match="a name with a zero in it is that of no file"):
        Simulation("a\0.fmu")


@pytest.mark.parametrize(("change", "said"), [
    (lambda name, data: None if name.startswith("binaries/") else data, "no library for this system: .* export it with platform="),
    (lambda name, data: b"no library" if name.startswith("binaries/") else data, "damaged, or lacks .* export the FMU once more"),
])
def test_fmus_of_other_systems_are_told_with_what_to_do(change, said, rover, tmp_path):
    with zipfile.ZipFile(rover) as archive, zipfile.ZipFile(tmp_path / "a.fmu", "w") as other:
        for name in archive.namelist():
            data = change(name, archive.read(name))
            if data is not None:
                other.writestr(name, data)
    with pytest.raises(Error, match=said):
        Simulation(tmp_path / "a.fmu")


def test_pages_have_a_height_and_a_place_and_are_of_their_robot(rover, examples, tmp_path):
    table = {"time": [0.0, 0.1], "elsewhere": [0.0, 1.0]}
    with pytest.warns(RuntimeWarning, match="is it a run of this robot"):
        page = urdf2fmu.show(rover, table)
    for place in (tmp_path, tmp_path / "none" / "page.html"):
        with pytest.raises(Error, match="^cannot write "):
            page.save(place)
    with pytest.raises(Error, match="the height takes numbers"):
        urdf2fmu.show(rover, table, height="x")
    with pytest.raises(Error, match="the height is a number of pixels, not -1"):
        urdf2fmu.show(rover, table, height=-1)


def test_a_current_folder_that_is_gone_is_told(examples, tmp_path, monkeypatch):
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    with pytest.raises(Error, match="the current folder is gone"):
        urdf2fmu.check(examples / "rover.urdf", config={"robot": {"base": "fixed"}})
