"""DXF for machine controls, read back by another program and measured against the exact curves."""

from math import pi

import ezdxf
import motor_files
import numpy as np
import pytest
from exported_motors import MOTORS, motor, normal_error
from ezdxf.bbox import extents
from ezdxf.math import bulge_to_arc

from camring.exchange.drawings import Wishes, export
from camring.files.errors import InputError

TOLERANCES = {"polyline": "2 um", "arcs": "0.5 um"}


@pytest.fixture(params=["lobes", "planar ring"], scope="module")
def file(request):
    return motor(MOTORS[request.param])


@pytest.fixture(params=TOLERANCES, scope="module")
def written(request, file, tmp_path_factory):
    """A motor file, the kind of its DXF, its folder, and what was said of ring.dxf."""
    folder, kind = tmp_path_factory.mktemp("dxf"), request.param
    wishes = Wishes.read(dxf=kind, dxf_tolerance=TOLERANCES[kind])
    products = export(file, folder, only=["ring", "plate"], wishes=wishes)
    return file, kind, folder, products[0]


def links(polyline):
    """Ends (complex, mm) and bulges of a closed polyline's links."""
    ends = np.array([each.dxf.location.x + 1j * each.dxf.location.y for each in polyline.vertices])
    return ends, np.array([each.dxf.bulge for each in polyline.vertices])


def dense(ends, bulges, count=41):
    """Many places of every link, as the reading program has its arcs."""
    part, found = np.linspace(0, 1, count), []
    for start, end, bulge in zip(ends, np.roll(ends, -1), bulges, strict=True):
        if bulge == 0:
            found.append(start + (end - start) * part)
            continue
        centre, first, last, radius = bulge_to_arc(
            (start.real, start.imag), (end.real, end.imag), bulge
        )
        angle = first + ((last - first) % (2 * pi)) * part
        found.append(centre.x + 1j * centre.y + radius * np.exp(1j * angle))
    return np.concatenate(found)


def test_lines_and_arcs_stay_within_the_tolerance_and_the_deviation_that_the_file_states(written):
    file, kind, folder, said = written
    drawing = ezdxf.readfile(folder / "ring.dxf")
    assert drawing.dxfversion == "AC1009"
    found = {each.dxf.layer: each for each in drawing.modelspace().query("POLYLINE")}
    assert set(found) == {"PITCH_CURVE", "WORKING_SURFACE"}
    assert not drawing.modelspace().query("SPLINE LWPOLYLINE")
    roller, worst = float(file.system.motor.roller.radius), 0.0
    for layer, distance in (("PITCH_CURVE", 0.0), ("WORKING_SURFACE", roller)):
        assert found[layer].is_closed
        assert found[layer].is_2d_polyline
        ends, bulges = links(found[layer])
        assert len(ends) == said.figures[f"{layer.lower()}_segments"]
        assert bool(np.any(bulges)) == (kind == "arcs")
        turned = np.angle(np.roll(ends, -1) / ends)
        assert np.all(turned > 0)
        assert turned.sum() == pytest.approx(2 * pi, rel=1e-12)
        worst = max(worst, normal_error(file, dense(ends, bulges), distance))
    tolerance = 1e3 * said.figures["tolerance"]
    assert worst <= tolerance
    stated = 1e3 * said.figures["normal_error"]
    # Fifteen places of a link miss less than a hundredth of what it strays.
    assert 0.99 * stated < worst < 1.01 * stated
    comments = (folder / "ring.dxf").read_text().split("SECTION")[0].replace("\n", " ")
    claimed = float(comments.split("normal error at most ")[1].split(" um")[0])
    assert 1e3 * worst <= claimed <= 1.1e3 * worst
    assert f"within {claimed:.2g} um" in said.holds


def test_arcs_meet_without_a_corner_and_are_fewer_than_lines(file, tmp_path):
    wishes = Wishes.read(dxf="arcs")
    [said, _] = export(file, tmp_path, only=["ring"], wishes=wishes)
    for polyline in ezdxf.readfile(tmp_path / "ring.dxf").modelspace().query("POLYLINE"):
        ends, bulges = links(polyline)
        chord = np.angle(np.roll(ends, -1) - ends)
        leaving, arriving = chord - 2 * np.arctan(bulges), chord + 2 * np.arctan(bulges)
        corner = np.exp(1j * (np.roll(leaving, -1) - arriving))
        assert np.abs(np.angle(corner)).max() < 1e-9
    export(file, tmp_path, only=["ring"], wishes=Wishes.read(dxf="polyline"), replace=True)
    lines = ezdxf.readfile(tmp_path / "ring.dxf").modelspace().query("POLYLINE")
    assert said.figures["working_surface_segments"] < min(len(each) for each in lines) / 3


def test_release_12_passes_an_audit_and_holds_the_ports_as_well(written):
    file, _, folder, _ = written
    for name in ("ring.dxf", "valve_plate.dxf"):
        drawing = ezdxf.readfile(folder / name)
        audited = drawing.audit()
        assert not audited.errors
        assert not audited.fixes
        assert "millimetres" in (folder / name).read_text("cp1252").split("SECTION")[0]
    for kind in ("SUPPLY", "RETURN"):
        slots = drawing.modelspace().query(f'POLYLINE[layer=="{kind}_PORTS"]')
        assert len(slots) == file.system.motor.lobes
        assert all(slot.is_closed and slot.has_arc for slot in slots)


@pytest.mark.parametrize("kind", ["spline", "arcs"])
def test_the_header_says_where_the_drawing_lies_and_in_which_unit(kind, tmp_path):
    file = motor(motor_files.SOUND)
    export(file, tmp_path, only=["ring", "plate"], wishes=Wishes.read(dxf=kind))
    for name in ("ring.dxf", "valve_plate.dxf"):
        drawing = ezdxf.readfile(tmp_path / name)
        header, box = drawing.header, extents(drawing.modelspace())
        np.testing.assert_allclose(header["$EXTMIN"], box.extmin, atol=1e-9)
        np.testing.assert_allclose(header["$EXTMAX"], box.extmax, atol=1e-9)
        np.testing.assert_allclose(header["$LIMMAX"], box.extmax.vec2, atol=1e-9)
        assert header["$LUNITS"] == 2
        if kind == "spline":
            assert header["$INSUNITS"] == ezdxf.units.MM
            assert header["$MEASUREMENT"] == 1
    outer = 1e3 * float(np.max(np.asarray(file.system.motor.cam.control_radii)))
    assert outer < ezdxf.readfile(tmp_path / "ring.dxf").header["$EXTMAX"][0] < 1.5 * outer


def test_the_name_of_a_motor_that_release_12_cannot_write_gives_a_file_that_can_be_read(tmp_path):
    file = motor(motor_files.with_line('name = "Größe Ω <4>"'))
    export(file, tmp_path, only=["ring", "plate"], wishes=Wishes.read(dxf="arcs"))
    for name in ("ring.dxf", "valve_plate.dxf"):
        drawing = ezdxf.readfile(tmp_path / name)
        assert not drawing.audit().errors
        texts = {each.dxf.text for each in drawing.modelspace().query("TEXT")}
        # Beyond its code page release 12 has numbers of Unicode.
        assert "Motor: Größe \\U+03a9 <4>" in texts


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"dxf": "arc"}, "did you mean 'arcs'"),
        ({"dxf": "nurbs"}, "give one of spline, polyline, arcs"),
        ({"dxf_tolerance": "2 um"}, "no effect on splines"),
        ({"dxf": "arcs", "dxf_tolerance": "1 nm"}, r"from 0\.01 to 100 um"),
        ({"dxf": "polyline", "dxf_tolerance": "2 bar"}, "measures a pressure"),
    ],
)
def test_a_slip_of_style_is_said_in_a_sentence(arguments, said):
    with pytest.raises(InputError, match=said):
        Wishes.read(**arguments)


def test_the_angles_at_the_edges_of_the_ports_do_not_lie_on_each_other(tmp_path):
    export(motor(motor_files.SOUND), tmp_path, only=["plate"])
    space = ezdxf.readfile(tmp_path / "valve_plate.dxf").modelspace()
    texts = space.query('TEXT[layer=="TIMING"]')
    places = np.array([each.dxf.align_point.x + 1j * each.dxf.align_point.y for each in texts])
    apart = np.abs(places[:, None] - places) + 1e9 * np.eye(len(places))
    assert apart.min() > 1.3 * texts[0].dxf.height
    # Each word stands within two degrees of the edge whose angle it is.
    edges = np.array([float(each.dxf.text.removesuffix("%%d")) for each in texts])
    assert np.abs(np.angle(places * np.exp(-1j * np.radians(edges)), deg=True)).max() < 2
