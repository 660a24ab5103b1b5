"""Files beside an FMU: its parameters, its licences, and a reference run that any importer can repeat."""

import re
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import fmpy
import numpy as np
import pytest
from fmpy.util import read_csv
from lxml import etree
from test_fmi3 import simulate, valid

FOLDER = "extra/org.fmi-standard.fmi-ls-ref/"
SCHEMAS = Path(fmpy.__file__).parent / "ssp/schema"
LS = "{http://fmi-standard.org/fmi-ls-manifest}fmi-ls-"
SSV = "{http://ssp-standard.org/SSP1/SystemStructureParameterValues}"
SSC = "{http://ssp-standard.org/SSP1/SystemStructureCommon}"


def inside(fmu):
    """The files of the layered standard by their names; the manifest has what FMI-LS-REF 1.0.0-alpha.1 asks for."""
    with zipfile.ZipFile(fmu) as archive:
        files = {name.removeprefix(FOLDER): archive.read(name) for name in archive.namelist() if name.startswith(FOLDER)}
    manifest = etree.fromstring(files.pop("fmi-ls-manifest.xml"))
    assert manifest.tag == "fmiReferences" and set(manifest.attrib) == {f"{LS}{key}" for key in ("name", "version", "description")}
    assert manifest.get(f"{LS}name") == "org.fmi-standard.fmi-ls-ref" and manifest.get(f"{LS}version") == "1.0.0-alpha.1"
    assert all(entry.tag == "Related" and set(entry.attrib) == {"type", "source", "role", "description"} for entry in manifest)
    related = {entry.get("source"): entry.get("role") for entry in manifest}
    assert all(source in files for source in related)
    return files, related


def ssv(text):
    """A parameter set by a reader of its own: values, units and version."""
    root = ET.fromstring(text)
    values = {}
    for parameter in root.iter(f"{SSV}Parameter"):
        sizes = [int(dimension.get("size")) for dimension in parameter.iter(f"{SSC}Dimension")]
        numbers = [{"true": 1.0, "false": 0.0}.get(word) if word in ("true", "false") else float(word)
                   for word in parameter[0].get("value").split()]
        assert len(numbers) == int(np.prod(sizes or [1]))
        values[parameter.get("name")] = numbers if sizes else numbers[0]
    return values, root.get("version")


@pytest.mark.parametrize(("options", "version"), [((), "1.0"), (("--fmi", "3"), "2.0"),
                                                  (("--fmi", "3", "--arrays", "none"), "1.0")])
def test_every_fmu_has_its_parameters_as_a_file_of_ssp(options, version, examples, export):
    """Of the schema of SSP 1.0, or of version 2.0 where there are arrays; all parameters of the FMU, with the values at
    which they start, so that it may be applied as it is."""
    fmu = export(examples / "rover.urdf", "", *options)
    files, related = inside(fmu)
    assert related == {"parameters.ssv": "parameter"} and list(files) == ["parameters.ssv"]
    if version == "1.0":
        schema = etree.XMLSchema(etree.parse(str(SCHEMAS / "SystemStructureParameterValues.xsd")))
        schema.assertValid(etree.fromstring(files["parameters.ssv"]))
    values, told = ssv(files["parameters.ssv"])
    assert told == version
    variables = fmpy.read_model_description(str(fmu)).modelVariables
    starts = {v.name: [float(x) for x in str(v.start).split()] for v in variables if v.causality == "parameter"}
    assert len(starts) > 20
    assert values == {v.name: starts[v.name] if v.dimensions else starts[v.name][0]
                      for v in variables if v.causality == "parameter"}
    plain = simulate(fmu, stop_time=0.1)
    given = simulate(fmu, stop_time=0.1, start_values=values)
    assert all(np.array_equal(plain[name], given[name]) for name in plain.dtype.names)


CASES = {
    "rover": ("rover.urdf", "", ()),
    "rover of FMI 3": ("rover.urdf", "", ("--fmi", "3")),
    "arm of FMI 3, all arrays": ("arm.urdf", "[[actuator]]\njoint = \"*\"\nmode = \"position\"\n",
                                 ("--fmi", "3", "--arrays", "all")),
    "world": ("rover.urdf", "[[world.object]]\nname = \"ball\"\nshape = { sphere = 0.1 }\nmass = 1\nxyz = [0.5, 0]\n",
              ("--interface", "both")),
}


@pytest.mark.parametrize("name", CASES)
def test_fmpy_repeats_the_reference_run_to_the_bit(name, examples, export, tmp_path):
    urdf, settings, options = CASES[name]
    fmu = export(examples / urdf, settings, "--reference-run", *options)
    assert fmpy.validation.validate_fmu(str(fmu)) == []
    if "3" in options:
        valid(fmu)
    files, related = inside(fmu)
    assert related["reference.exp"] == "experiment/smoke-test"
    root = etree.fromstring(files["reference.exp"])
    assert root.tag == "Experiments"
    [experiment] = root
    assert experiment.tag == "Experiment" and [element.tag for element in experiment] == ["Stimuli", "References"]
    start, stop, step, tolerance = (float(experiment.get(key)) for key in ("startTime", "stopTime", "stepSize", "tolerance"))
    assert (start, stop, step) == (0, 2, 1 / 240)
    tables = {}
    for element in experiment:
        file = tmp_path / element.get("source")
        file.write_bytes(files[element.get("source")])
        tables[element.tag] = read_csv(file)
    stimuli, expected = tables["Stimuli"], tables["References"]
    found = simulate(fmu, fmi_type="CoSimulation", start_time=start, stop_time=stop, output_interval=step,
                     relative_tolerance=tolerance, input=stimuli, output=list(expected.dtype.names[1:]))
    outputs = {v.name for v in fmpy.read_model_description(str(fmu)).modelVariables if v.causality == "output"}
    assert set(expected.dtype.names[1:]) == outputs
    assert len(expected) == len(found) == 481
    for column in expected.dtype.names:
        assert np.array_equal(expected[column], np.asarray(found[column], dtype=float)), column
    # Every command rises, and the robot obeys.
    for column in stimuli.dtype.names[1:]:
        assert np.any(stimuli[column][-1] != stimuli[column][0]), column
    speeds = [column for column in expected.dtype.names if re.fullmatch(r"(robot\.)?joint\..*velocity", column)]
    assert max(np.abs(expected[column]).max() for column in speeds) > 0.02


def test_a_model_exchange_fmu_has_one_too(examples, export, tmp_path):
    """What `urdf2fmu simulate` integrates; FMPy's CVODE comes near it."""
    fmu = export(examples / "arm.urdf", "", "--interface", "me", "--reference-run")
    files, _ = inside(fmu)
    for name in "reference_inputs.csv", "reference_outputs.csv":
        (tmp_path / name).write_bytes(files[name])
    expected = read_csv(tmp_path / "reference_outputs.csv")
    found = simulate(fmu, stop_time=2.0, output_interval=1 / 240, relative_tolerance=1e-6,
                     input=read_csv(tmp_path / "reference_inputs.csv"), output=list(expected.dtype.names[1:]))
    names = [name for name in expected.dtype.names if name.startswith("joint.") and name.endswith("position")]
    assert len(names) > 3
    off = max(abs(found[name][-1] - expected[name][-1]) for name in names)
    assert off < 1e-3, off


def test_licences_are_told_to_programs(examples, export, tmp_path):
    """SPDX 2.3 in tags and values; each part that license.txt names, and expressions of SPDX's list alone."""
    settings = "[fmu]\nlicense = \"CC-BY-4.0\"\n"
    fmu = export(examples / "rover.urdf", settings)
    with zipfile.ZipFile(fmu) as archive:
        text, people = (archive.read(f"documentation/licenses/license.{end}").decode() for end in ("spdx", "txt"))
    head, *packages = [[line.split(": ", 1) for line in part.splitlines()] for part in text.split("\n\n")]
    head, parts = dict(head), [dict(package) for package in packages]
    guid = fmpy.read_model_description(str(fmu)).guid
    assert head["SPDXVersion"] == "SPDX-2.3" and head["DataLicense"] == "CC0-1.0" and head["SPDXID"] == "SPDXRef-DOCUMENT"
    assert head["DocumentNamespace"] == f"urn:uuid:{guid.strip('{}')}"
    assert len({part["SPDXID"] for part in parts}) == len(parts) and "CC-BY-4.0" in parts[0]["PackageComment"]
    listed = {"MIT", "Apache-2.0", "ZPL-2.1", "GPL-3.0-or-later"}
    exceptions = {"LLVM-exception", "GCC-exception-3.1"}
    for part in parts[1:]:
        assert re.fullmatch(r"SPDXRef-[A-Za-z0-9.-]+", part["SPDXID"])
        assert part["Relationship"] == f"SPDXRef-fmu CONTAINS {part['SPDXID']}"
        for simple in part["PackageLicenseDeclared"].split(" OR "):
            name, _, exception = simple.partition(" WITH ")
            assert name in listed and exception in exceptions | {""}, simple
    licences = {part["PackageName"]: part["PackageLicenseDeclared"] for part in parts}
    crates = re.findall(r"^  (\S+) +(\S.*)$", people, re.M)
    assert len(crates) > 15 and all(licences[name] == licence for name, licence in crates)
