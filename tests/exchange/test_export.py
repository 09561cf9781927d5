"""What is exported is read back by other programs and measured against the exact curves."""

import csv
import json
import xml.etree.ElementTree as ElementTree
from math import pi, radians

import ezdxf
import motor_files
import numpy as np
import pytest
from command_line import EXAMPLE, camring_, refused
from exported_motors import MICROMETRE, MOTORS, motor, normal_error
from scipy.spatial import cKDTree

from camring import __version__
from camring.exchange.drawings import Wishes, export
from camring.exchange.drawings.source import motor_of
from camring.files.errors import InputError
from camring.geometry.outline import outline_of
from camring.geometry.port_shape import ports_of


@pytest.fixture(params=MOTORS, scope="module")
def exported(request, tmp_path_factory):
    """A motor file and the folder of its files."""
    file = motor(MOTORS[request.param])
    folder = tmp_path_factory.mktemp("export")
    export(file, folder)
    return file, folder


def splines(folder):
    drawing = ezdxf.readfile(folder / "ring.dxf")
    return drawing, {spline.dxf.layer: spline for spline in drawing.modelspace().query("SPLINE")}


def test_the_dxf_holds_both_curves_within_a_micrometre(exported):
    file, folder = exported
    _, found = splines(folder)
    assert set(found) == {"PITCH_CURVE", "WORKING_SURFACE"}
    roller = float(file.system.motor.roller.radius)
    for layer, distance in (("PITCH_CURVE", 0.0), ("WORKING_SURFACE", roller)):
        curve = found[layer].construction_tool()
        points = np.array(
            [(p.x + 1j * p.y) for p in curve.points(np.linspace(0, curve.max_t, 5003))]
        )
        assert normal_error(file, points, distance) < 0.15 * MICROMETRE
        assert abs(points[0] - points[-1]) < 1e-9
        # Once round the shaft.
        turned = np.angle(points[1:] / points[:-1]).sum()
        assert turned == pytest.approx(2 * pi, rel=1e-9)


def test_the_surface_lies_one_roller_radius_from_the_pitch_curve_and_nowhere_nearer(exported):
    file, folder = exported
    _, found = splines(folder)
    sampled = {}
    for layer, spline in found.items():
        curve = spline.construction_tool()
        sampled[layer] = np.array(
            [(p.x, p.y) for p in curve.points(np.linspace(0, curve.max_t, 40_001))]
        )
    distance, _ = cKDTree(sampled["PITCH_CURVE"]).query(sampled["WORKING_SURFACE"])
    # Half the step between samples, 0.008 mm, makes a distance of 12 mm longer by 3 nm.
    roller = 1e3 * float(file.system.motor.roller.radius)
    assert np.abs(distance - roller).max() < 0.3 * MICROMETRE


def test_each_curve_is_one_closed_cubic_spline_that_an_auditor_accepts(exported):
    _, folder = exported
    for name in ("ring.dxf", "valve_plate.dxf"):
        audited = ezdxf.readfile(folder / name).audit()
        assert not audited.errors
        assert not audited.fixes
    drawing, found = splines(folder)
    assert drawing.units == ezdxf.units.MM
    for spline in found.values():
        assert spline.dxf.degree == 3
        assert spline.closed
        assert len(spline.control_points) < 1000


def test_every_file_says_which_motor_which_program_and_which_way_angles_run(exported):
    file, folder = exported
    for each in folder.iterdir():
        text = " ".join(each.read_text().replace("\n", " ").split())
        assert file.system.motor.name in text, each.name
        assert f"camring {__version__}" in text, each.name
        assert "anticlockwise" in text, each.name


def test_the_svg_is_the_same_curve_in_true_size(exported):
    file, folder = exported
    root = ElementTree.parse(folder / "ring.svg").getroot()
    assert root.get("width") == f"{root.get('viewBox').split()[2]}mm"
    roller = float(file.system.motor.roller.radius)
    for name, distance in (("PITCH_CURVE", 0.0), ("WORKING_SURFACE", roller)):
        [path] = [each for each in root.iter() if each.get("id") == name]
        start, *bends = path.get("d").removesuffix("Z").removeprefix("M").split("C")
        points = [complex(*map(float, start.split()))]
        part = np.linspace(0, 1, 9)[1:]
        for bend in bends:
            a = points[-1]
            numbers = [float(x) for x in bend.split()]
            b, c, d = (complex(*numbers[k : k + 2]) for k in (0, 2, 4))
            points.extend(
                (1 - part) ** 3 * a
                + 3 * part * (1 - part) ** 2 * b
                + 3 * part**2 * (1 - part) * c
                + part**3 * d
            )
        assert normal_error(file, np.conj(points), distance) < 0.15 * MICROMETRE


def table(path):
    lines = [line for line in path.read_text().splitlines() if not line.startswith("#")]
    head, *rows = csv.reader(lines)
    names = [each.partition(" [")[0] for each in head]
    units = [each.partition(" [")[2].rstrip("]") for each in head]
    columns = zip(*rows, strict=True)
    return dict(zip(names, units, strict=True)), dict(zip(names, columns, strict=True))


def test_the_points_lie_on_the_curves_and_keep_the_chord_tolerance(exported):
    file, folder = exported
    units, columns = table(folder / "ring_points.csv")
    column = {name: np.array(values, float) for name, values in columns.items()}
    assert units["angle"] == "deg"
    assert {units[name] for name in ("pitch_x", "surface_y", "pitch_radius")} == {"mm"}
    roller = float(file.system.motor.roller.radius)
    for curve, distance in (("pitch", 0.0), ("surface", roller)):
        points = column[f"{curve}_x"] + 1j * column[f"{curve}_y"]
        assert normal_error(file, points, distance) < 2e-6
        np.testing.assert_allclose(np.abs(points), column[f"{curve}_radius"], atol=2e-6)
        # Between two rows the curve is an arc of the listed curvature, near enough.
        length = np.abs(np.roll(points, -1) - points) / 1e3
        bent = np.maximum(
            *np.abs([column[f"{curve}_curvature"], np.roll(column[f"{curve}_curvature"], -1)])
        )
        assert (length**2 * bent / 8).max() < 1.1e-6
        middle = outline_of(file.system.motor.cam)
        half = np.radians(column["angle"] + column["angle"][1] / 2)
        exact = 1e3 * middle.places(middle.parameter_at(half), distance).point
        along = np.roll(points, -1) - points
        strays = np.imag(np.conj(along) * (exact - points)) / np.abs(along)
        assert np.abs(strays).max() <= MICROMETRE
    pitch = column["pitch_x"] + 1j * column["pitch_y"]
    np.testing.assert_allclose(np.degrees(np.angle(pitch)) % 360, column["angle"], atol=1e-6)
    normal = column["normal_x"] + 1j * column["normal_y"]
    surface = column["surface_x"] + 1j * column["surface_y"]
    np.testing.assert_allclose(pitch + 1e3 * roller * normal, surface, atol=3e-6)


def test_a_coarser_chord_gives_fewer_points(tmp_path):
    file = motor(motor_files.SOUND)
    for name, chord in (("fine", "0.2 um"), ("coarse", "20 um")):
        export(file, tmp_path / name, only=["points"], wishes=Wishes.read(chord=chord))
    fine, coarse = (
        len((tmp_path / name / "ring_points.csv").read_text()) for name in ("fine", "coarse")
    )
    assert coarse < fine / 5


def test_the_ports_are_drawn_where_the_table_has_them(exported):
    file, folder = exported
    _, column = table(folder / "valve_plate.csv")
    lobes = file.system.motor.lobes
    assert sorted(column["port"]) == ["return"] * lobes + ["supply"] * lobes
    drawing = ezdxf.readfile(folder / "valve_plate.dxf")
    for kind in ("supply", "return"):
        drawn = drawing.modelspace().query(f'LWPOLYLINE[layer=="{kind.upper()}_PORTS"]')
        edges = set()
        for slot in drawn:
            assert slot.closed
            edges |= {round(np.degrees(np.arctan2(y, x)) % 360, 4) for x, y in slot.vertices()}
        listed = {
            round(float(column[name][row]), 4)
            for row, each in enumerate(column["port"])
            if each == kind
            for name in ("slot_start", "slot_end")
        }
        assert edges == listed
    texts = {text.dxf.text for text in drawing.modelspace().query('TEXT[layer=="TIMING"]')}
    assert texts == {f"{float(v):.3f}%%d" for name in ("opens", "closes") for v in column[name]}
    assert len(drawing.modelspace().query("DIMENSION")) == 2


@pytest.mark.parametrize(
    "lines", ['shape = "round"', "notch_angle = 0.03\nnotch_area = 0.05",
              'shape = "tabulated"\nposition = [-1, -0.2, 0.3, 1]\n'
              "opening_share = [0, 1, 1, 0]"]
)  # fmt: skip
def test_other_windows_are_drawn_too(tmp_path, lines):
    text = motor_files.SOUND
    if "tabulated" in lines:
        for key in ("ramp", '"motor.valve_plate.ramp"'):
            text = motor_files.without_line(key, text)
    file = motor(motor_files.added("[motor.valve_plate]", lines, text))
    export(file, tmp_path, only=["plate", "sheet"])
    drawing = ezdxf.readfile(tmp_path / "valve_plate.dxf")
    assert not drawing.audit().errors
    assert len(drawing.modelspace().query("LWPOLYLINE")) >= 2 * file.system.motor.lobes
    ElementTree.parse(tmp_path / "sheet.svg")


@pytest.mark.parametrize(
    ("lines", "circle", "share", "words"),
    [
        ('supply_width = "28 deg"\nreturn_width = "27 deg"', None, -100 / 28, "3.6 % shorter"),
        ('shape = "round"', 1.02, 100 * (1 / 1.02 - 1), "2 % shorter"),
        ('shape = "round"', 0.98, 100 * (1 / 0.98 - 1), "2 % longer"),
    ],
)
def test_a_ramp_that_the_ports_miss_is_said_with_its_direction(
    tmp_path, lines, circle, share, words
):
    text = motor_files.SOUND
    for line in lines.split("\n"):
        replaced = "width" in line
        text = (
            motor_files.with_line(line, text)
            if replaced
            else motor_files.added("[motor.valve_plate]", line, text)
        )
    file = motor(text)
    ports = ports_of(file.system.motor.valve_plate, 0.0425)
    asked = None if circle is None else circle * ports.circle
    found = ports_of(file.system.motor.valve_plate, 0.0425, asked)
    assert 100 * found.ramp_error == pytest.approx(share)
    wishes = Wishes(port_circle=asked)
    export(file, tmp_path, only=["plate", "sheet"], wishes=wishes)
    drawing = ezdxf.readfile(tmp_path / "valve_plate.dxf")
    written = [
        " ".join(each.dxf.text for each in drawing.modelspace().query('TEXT[layer=="NOTES"]')),
        (tmp_path / "valve_plate.csv").read_text(),
        " ".join(ElementTree.parse(tmp_path / "sheet.svg").getroot().itertext()),
    ]
    for each in written:
        said = " ".join(each.split())
        assert f"of the worse kind of window is {words} than the model says" in said


def test_the_sheet_is_an_a3_page_with_the_main_dimensions(exported):
    file, folder = exported
    root = ElementTree.parse(folder / "sheet.svg").getroot()
    assert (root.get("width"), root.get("height")) == ("420mm", "297mm")
    texts = [each.text for each in root.iter("{http://www.w3.org/2000/svg}text")]
    inner = outline_of(file.system.motor.cam).extreme_radius(-1)[0]
    roller = float(file.system.motor.roller.radius)
    for wanted in (
        f"{1e3 * (inner + roller):.4f}",
        f"({1e3 * inner:.4f})",
        f"{2e3 * roller:.4f}",
        f"{1e3 * float(file.system.motor.piston.bore):.4f}",
        "supply",
    ):
        assert wanted in texts
    for each in root.iter("{http://www.w3.org/2000/svg}text"):
        assert 0 < float(each.get("x")) < 420
        assert 0 < float(each.get("y")) < 297


def test_an_undercut_ring_is_refused_with_the_place_and_a_way_out(tmp_path):
    file = motor(motor_files.with_line('radius = "60 mm"'))
    with pytest.raises(InputError) as said:
        export(file, tmp_path / "out")
    sentence = str(said.value)
    undercut = outline_of(file.system.motor.cam).undercut(0.06)
    assert undercut.factor < 0
    assert f"{undercut.factor:.3g} at" in sentence
    largest = float(sentence.split("less than ")[1].split(" mm")[0])
    assert not (tmp_path / "out").exists()
    export(motor(motor_files.with_line(f'radius = "{0.99 * largest} mm"')), tmp_path / "out")
    export(file, tmp_path / "plate", only=["plate"])
    assert {each.name for each in (tmp_path / "plate").iterdir()} == {
        "valve_plate.csv",
        "valve_plate.dxf",
    }


def test_any_name_gives_files_that_can_be_read(tmp_path):
    name = 'name = "Größe <4> & 100 %"'
    export(motor(motor_files.with_line(name)), tmp_path)
    for each in ("ring.svg", "sheet.svg"):
        ElementTree.parse(tmp_path / each)
    for each in ("ring.dxf", "valve_plate.dxf"):
        drawing = ezdxf.readfile(tmp_path / each)
        assert not drawing.audit().errors
        assert "Größe <4> & 100 %" in dict(drawing.header.custom_vars.properties).values()


def test_nothing_is_replaced_unasked(tmp_path):
    file = motor(motor_files.SOUND)
    (tmp_path / "ring.svg").write_text("mine")
    with pytest.raises(InputError, match=r"ring\.svg exists"):
        export(file, tmp_path, only=["ring"])
    assert [each.name for each in tmp_path.iterdir()] == ["ring.svg"]
    export(file, tmp_path, only=["ring"], replace=True)
    assert (tmp_path / "ring.svg").read_text() != "mine"


def test_the_best_motor_of_a_study_is_taken(tmp_path):
    with pytest.raises(InputError, match="without a study"):
        motor_of(tmp_path)
    (tmp_path / "study.sqlite").touch()
    with pytest.raises(InputError, match="camring resume"):
        motor_of(tmp_path)
    (tmp_path / "best.toml").write_text(motor_files.SOUND)
    assert motor_of(tmp_path).text == motor_files.SOUND


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["--only", "rign"], "did you mean 'ring'"),
        (["--only", ","], "names nothing"),
        (["--chord", "2 bar"], "measures a pressure"),
        (["--chord", "-2 um"], "above zero"),
        (["--chord", "0.1 nm"], "give a larger one"),
        (["--port-circle", "5 mm"], "--port-circle of at least"),
        (["--outer-diameter", "100 mm", "--only", "sheet"], "within the working surface"),
    ],
)
def test_a_slip_is_reported_in_a_sentence(tmp_path, arguments, said):
    options = dict(zip(arguments[::2], arguments[1::2], strict=True))
    wishes = {key[2:].replace("-", "_"): each for key, each in options.items() if key != "--only"}
    only = options["--only"].split(",") if "--only" in options else None
    with pytest.raises(InputError, match=said):
        export(motor(motor_files.SOUND), tmp_path / "out", only=only, wishes=Wishes.read(**wishes))
    assert not (tmp_path / "out").exists()


def test_the_command_writes_and_tells(tmp_path):
    # No place for caches of anyone, which must neither fail nor spoil the document.
    (tmp_path / "cache").touch()
    nowhere = {"XDG_CACHE_HOME": str(tmp_path / "cache")}
    done = camring_("export", EXAMPLE, "--out", tmp_path / "out", "--json", environment=nowhere)
    assert (done.returncode, done.stderr) == (0, "")
    files = json.loads(done.stdout)["files"]
    assert {each["path"] for each in files} == {str(path) for path in (tmp_path / "out").iterdir()}
    assert max(each.get("normal_error", 0) for each in files) <= 1e-7
    assert "exists" in refused("export", EXAMPLE, "--out", tmp_path / "out")


def test_a_solid_is_refused_without_its_kernel(tmp_path, monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "OCP", None)
    with pytest.raises(InputError, match=r'pip install "camring\[step\]"'):
        export(motor(motor_files.SOUND), tmp_path / "out", only=["step"])


def test_the_solid_read_back_has_the_lengths_and_areas_of_the_ring(exported, tmp_path):
    pytest.importorskip("OCP", reason="the extra camring[step] is not installed")
    from solid import read_solid

    file, _ = exported
    export(file, tmp_path, only=["step"], wishes=Wishes.read(ring_width="25 mm"))
    text = (tmp_path / "ring.step").read_text()
    assert "AP242" in text
    assert "anticlockwise" in " ".join(text.split())
    roller = float(file.system.motor.roller.radius)
    length = 1e3 * outline_of(file.system.motor.cam).fit(roller, 1e-9).length
    found = read_solid(tmp_path / "ring.step")
    assert found.solids == 1
    around = [each for each in found.edges if abs(each - length) < 1e-3 * length]
    assert len(around) == 2
    # 0.1 um of normal error allow the length of 667 mm about as much.
    np.testing.assert_allclose(around, length, atol=0.3 * MICROMETRE)
    # The kernel integrates an area over many spans to a hundred-thousandth.
    assert min(abs(area / (25 * length) - 1) for area in found.faces) < 2e-5
    # Exact places on the surface lie on the solid.
    angle = np.array([radians(17), radians(118), radians(243.3)])
    outline = outline_of(file.system.motor.cam)
    points = 1e3 * outline.places(outline.parameter_at(angle), roller).point
    assert max(found.distance(p.real, p.imag, 11.0) for p in points) < 0.15 * MICROMETRE
