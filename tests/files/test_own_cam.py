"""Rings that others drew or measured come in, fit within micrometres, and are compared."""

import json
import re
from math import pi, radians

import motor_files
import numpy as np
import pytest
from command_line import refused
from typer.testing import CliRunner

from camring.cli.app import app
from camring.exchange.drawings import Wishes, export
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file, read_motor_file
from camring.files.shapes.profile_like import seem_a_profile
from camring.geometry.outline import outline_of
from camring.geometry.profile_fit import fit_radii, fit_radii_to_noise
from camring.studies.study_folder import GIVEN_NAME

SOUND = parse_motor_file(motor_files.SOUND)
LOBES, ROLLER = SOUND.system.motor.lobes, float(SOUND.system.motor.roller.radius)
BASE, STROKE = 0.0849, 0.0118
MICROMETRE = 1e-6


def with_profile(name, *lines, text=motor_files.SOUND):
    """The motor with a profile in place of its control radii."""
    said = "\n".join([f'profile = "{name}"', *lines])
    changed, count = re.subn(r"control_radii = \[[^\]]*\]", said, text)
    assert count == 1
    return changed


def sine(angle, lobes=LOBES):
    return STROKE / 2 * (1 - np.cos(lobes * angle))


def table(path, header, columns):
    rows = (",".join(f"{value:.6f}" for value in row) for row in zip(*columns, strict=True))
    path.write_text("\n".join([header, *rows]) + "\n")


def lift_table(folder, angle=None, lift=sine, header="angle [deg],lift [mm]", name="lift.csv"):
    """A table of lifts over one lobe, a point every half degree unless given."""
    angle = np.arange(0, 360 / LOBES, 0.5) if angle is None else angle
    table(folder / name, header, (angle, 1e3 * lift(np.radians(angle))))
    return folder / name


def read(folder, *lines, name="lift.csv", text=motor_files.SOUND):
    path = folder / "motor.toml"
    path.write_text(with_profile(name, *lines, text=text))
    return read_motor_file(path)


def refusal(folder, *lines, **kwargs):
    with pytest.raises(InputError) as caught:
        read(folder, *lines, **kwargs)
    return str(caught.value)


BASE_LINE = f'base_radius = "{1e3 * BASE} mm"'


@pytest.fixture(scope="module")
def exported(tmp_path_factory):
    """The files of the sound motor."""
    folder = tmp_path_factory.mktemp("exported")
    export(SOUND, folder, only=["ring", "points", "curve"], wishes=Wishes())
    return folder


def largest_apart(file, other):
    """Largest distance of two motors' pitch curves, m."""
    angle = np.linspace(0, 2 * pi, 7201)
    radii = [
        np.abs(outline_of(each.system.motor.cam).places(angle).point) for each in (file, other)
    ]
    return float(np.max(np.abs(radii[0] - radii[1])))


def test_the_exact_spline_of_given_points_is_found_again():
    rng = np.random.default_rng(1)
    control = 0.09 + 0.004 * rng.standard_normal(16).cumsum() * 0.1
    outline = outline_of(parse_motor_file(motor_files.SOUND).system.motor.cam)
    outline = type(outline)(control, 6, 3)
    for distance in (0.0, 0.008):
        points = outline.places(np.linspace(0, 2 * pi, 700, endpoint=False), distance).point
        found = fit_radii(points, 16, 6, 3, distance)
        np.testing.assert_allclose(found.control_radii, control, rtol=0, atol=1e-12)
        assert found.largest < 1e-12


def test_noise_is_smoothed_and_its_size_is_reported():
    rng = np.random.default_rng(2)
    angle = np.linspace(0, 2 * pi, 1440, endpoint=False)
    exact, noise = BASE + sine(angle), 3 * MICROMETRE
    points = (exact + noise * rng.standard_normal(1440)) * np.exp(1j * angle)
    found = fit_radii_to_noise(points, (8, 12, 16, 24, 32, 48, 96), 6)
    assert found.rms == pytest.approx(noise, rel=0.1)
    radius = np.abs(found.outline.places(angle).point)
    assert np.sqrt(np.mean((radius - exact) ** 2)) < noise / 4


@pytest.mark.parametrize("lines", [[], ['profile_curve = "surface"']])
def test_our_own_table_of_points_comes_back_in(exported, tmp_path, lines):
    (tmp_path / "ring_points.csv").write_bytes((exported / "ring_points.csv").read_bytes())
    file = read(tmp_path, *lines, name="ring_points.csv")
    assert file.fitted_cam.fit.largest < 0.01 * MICROMETRE
    assert largest_apart(file, SOUND) < 0.01 * MICROMETRE


@pytest.mark.parametrize("name", ["pitch_curve.sldcrv", "working_surface.sldcrv"])
def test_our_own_curve_files_come_back_in(exported, tmp_path, name):
    (tmp_path / name).write_bytes((exported / name).read_bytes())
    surface = name.startswith("working")
    file = read(tmp_path, f'profile_curve = "{"surface" if surface else "pitch"}"', name=name)
    assert file.fitted_cam.fit.largest < 0.01 * MICROMETRE
    assert largest_apart(file, SOUND) < 0.01 * MICROMETRE


@pytest.mark.parametrize("kind", ["spline", "arcs", "polyline"])
@pytest.mark.parametrize("curve", ["pitch", "surface"])
def test_our_own_drawing_comes_back_in(exported, tmp_path, kind, curve):
    wishes = Wishes() if kind == "spline" else Wishes.read(dxf=kind)
    export(SOUND, tmp_path, only=["ring"], wishes=wishes)
    file = read(tmp_path, f'profile_curve = "{curve}"', name="ring.dxf")
    assert file.fitted_cam.fit.largest < 1.1 * MICROMETRE
    assert largest_apart(file, SOUND) < 1.1 * MICROMETRE


@pytest.mark.parametrize(
    ("header", "scale"),
    [
        ("angle [deg],lift [mm]", (1, 1)),
        ("Angle (rad);Lift [um]", (pi / 180, 1e3)),
        ("theta / deg,radius / mm", (1, 1)),
        ("x [mm],y [mm]", (1, 1)),
    ],
)
def test_units_and_kinds_of_table_mean_the_same_ring(tmp_path, header, scale):
    angle = np.arange(0, 360 / LOBES, 0.25)
    lift = 1e3 * sine(np.radians(angle))
    columns = [angle, lift]
    if "radius" in header:
        columns[1] = lift + 1e3 * BASE
    if header.startswith("x"):
        point = (lift + 1e3 * BASE) * np.exp(1j * np.radians(angle))
        columns = [point.real, point.imag]
    sign = ";" if ";" in header else ","
    rows = [sign.join(f"{s * c:.9g}" for s, c in zip(scale, row, strict=True))
            for row in zip(*columns, strict=True)]  # fmt: skip
    (tmp_path / "lift.csv").write_text("\n".join([header, *rows]))
    file = read(tmp_path, BASE_LINE, "control_count = 24")
    angle = np.linspace(0, 2 * pi, 999)
    radius = np.abs(outline_of(file.system.motor.cam).places(angle).point)
    np.testing.assert_allclose(radius, BASE + sine(angle), rtol=0, atol=0.5 * MICROMETRE)


def test_a_closed_ring_is_laid_on_one_lobe_and_a_ring_is_kept(tmp_path):
    angle = np.arange(0, 360.25, 0.5)
    lift_table(tmp_path, angle)
    file = read(tmp_path, BASE_LINE)
    assert file.fitted_cam.around_ring
    assert file.system.motor.cam.repeats == LOBES
    assert len(file.fitted_cam.fit.residuals) == 720
    uneven = lift_table(tmp_path, angle, lambda a: sine(a) * (1 + 0.01 * np.cos(a)))
    said = refusal(tmp_path, BASE_LINE)
    assert "more than motor.cam.tolerance of 10 um" in said
    assert uneven.name in said
    file = read(tmp_path, BASE_LINE, 'symmetry = "ring"', 'tolerance = "1 um"')
    assert file.system.motor.cam.repeats == 1
    assert file.fitted_cam.fit.largest < MICROMETRE


def test_what_is_kept_of_the_file_needs_the_profile_no_more(tmp_path):
    lift_table(tmp_path)
    file = read(tmp_path, BASE_LINE, "# a remark stays")
    alone = parse_motor_file(file.text)
    assert alone.fitted_cam is None
    assert "# a remark stays" in file.text
    assert "profile =" not in file.text
    assert file.fitted_cam.sentence in file.text
    assert largest_apart(alone, file) == 0
    assert file.kept(b"as given") == file.text.encode()


def test_a_table_turned_by_some_degrees_says_how_to_turn_it_back(tmp_path):
    lift_table(tmp_path, lift=lambda a: sine(a - radians(7)))
    free = motor_files.without_table("[design_space.cam]", motor_files.without_table("[search]"))
    [note] = read(tmp_path, BASE_LINE, text=free).fitted_cam.notes
    turn = re.search(r'profile_turn = "(.*?) deg"', note)[1]
    assert float(turn) == pytest.approx(-7, abs=0.01)
    assert (
        read(tmp_path, BASE_LINE, f'profile_turn = "{turn} deg"', text=free).fitted_cam.notes == ()
    )


FAULTS = {
    "gap": (lambda a: np.delete(a, slice(30, 40)), "leaves a gap from 14.5 to 20 deg"),
    "duplicate": (lambda a: np.insert(a, 31, a[30]), "has the angle 15 deg a second time"),
    "wrong direction": (lambda a: a[::-1], "runs the wrong way"),
    "back": (lambda a: np.insert(a, 60, 10.0), "line 62 goes back to 10 deg"),
    "part": (lambda a: a[: len(a) * 2 // 3], "covers 39.5 deg, neither a lobe of 60 deg"),
    "few": (lambda a: a[::12], "has 10 points where a cam takes at least 12"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_table_at_fault_is_refused_with_the_place(tmp_path, fault):
    spoil, said = FAULTS[fault]
    lift_table(tmp_path, spoil(np.arange(0, 360 / LOBES, 0.5)))
    assert said in refusal(tmp_path, BASE_LINE)


@pytest.mark.parametrize(
    ("header", "lines", "said"),
    [
        ("angle,lift [mm]", [BASE_LINE], 'the column "angle" without a unit; write angle [deg]'),
        ("angle [mm],lift [mm]", [BASE_LINE], "which measures a length"),
        ("angle [deg],lift [mm]", [], "motor.cam.base_radius is missing: "),
        ("angle [rad],lift [mm]", [BASE_LINE], "neither a lobe of 60 deg"),
        ("time [s],lift [mm]", [BASE_LINE], "has no header that names an angle"),
        (
            "angle [deg],lift [mm]",
            [BASE_LINE, "control_count = 100"],
            "too many for the 120 points",
        ),
        ("angle [deg],lift [mm]", [BASE_LINE, "control_radii = [1, 2]"], "beside control_radii"),
        (
            "angle [deg],lift [mm]",
            [BASE_LINE, 'profil_turn = "1 deg"'],
            "meant motor.cam.profile_tu",
        ),
    ],
)
def test_a_header_or_key_at_fault_says_what_to_write(tmp_path, header, lines, said):
    lift_table(tmp_path, header=header)
    assert said in refusal(tmp_path, *lines)


def test_a_curve_that_does_not_close_and_an_outlier_are_named_by_their_line(tmp_path):
    angle = np.arange(0, 360.25, 0.5)
    lift_table(tmp_path, angle, lambda a: sine(a) + 1e-4 * (a > 6.283))
    assert "line 722 does not close" in refusal(tmp_path, BASE_LINE)
    lift_table(tmp_path, lift=lambda a: sine(a) + 1e-4 * (np.abs(a - radians(20)) < 1e-3))
    assert "line 42 lies " in refusal(tmp_path, BASE_LINE)
    assert "does not exist" in refusal(tmp_path, name="nothing.csv")


def test_keys_of_a_profile_have_no_effect_without_one():
    with pytest.raises(InputError, match=r"motor\.cam\.tolerance has no effect without"):
        parse_motor_file(motor_files.added("[motor.cam]", 'tolerance = "1 um"'))


@pytest.mark.parametrize("law", ["sine", "trapezoid", "constant-acceleration"])
def test_radii_of_a_drawing_put_in_as_control_radii_are_reported(law):
    from camring.geometry.profiles import LAWS

    lift = 12.1 * LAWS[law](2 * pi * np.arange(16) / 16)
    radii = [f"{85 + each:.4f} mm" for each in lift]
    text = re.sub(r"control_radii = \[[^\]]*\]", f"control_radii = {radii}", motor_files.SOUND)
    [said] = seem_a_profile(parse_motor_file(text).system.motor.cam)
    assert "control radii range over 12.1 mm but the stroke is 11." in said
    assert seem_a_profile(SOUND.system.motor.cam) == []


def compared(*arguments):
    """What the command says; in this process, for time."""
    done = CliRunner().invoke(app, ["compare", *map(str, arguments)])
    assert done.exit_code == 0, done.stderr
    return done


def test_a_measured_ring_is_compared_in_micrometres(exported, tmp_path):
    """What is added to the drawn ring is found again: size, shift, turn, a flat."""
    motor = tmp_path / "motor.toml"
    motor.write_text(motor_files.SOUND)
    outline = outline_of(SOUND.system.motor.cam)
    parameter = np.linspace(0, 2 * pi, 1440, endpoint=False)
    place = outline.places(parameter, ROLLER)
    moved = place.point + 4e-6 * place.normal
    moved = moved * np.exp(1j * radians(0.01)) + (7e-6 - 5e-6j)
    table(tmp_path / "measured.csv", "x [mm],y [mm]", (1e3 * moved.real, 1e3 * moved.imag))
    said = compared(motor, "--measured", tmp_path / "measured.csv", "--json")
    found = json.loads(said.stdout)
    assert found["curve"] == "surface"
    fitted = found["best_fit"]
    assert fitted["turn"] == pytest.approx(radians(0.01), rel=1e-3)
    assert fitted["shift_x"] == pytest.approx(7e-6, abs=1e-8)
    assert fitted["shift_y"] == pytest.approx(-5e-6, abs=1e-8)
    assert fitted["mean"] == pytest.approx(4e-6, abs=1e-8)
    assert len(found["lobes"]) == LOBES
    again = compared(motor, "--measured", exported / "ring_points.csv", "--json")
    assert abs(json.loads(again.stdout)["as_it_lies"]["outermost"]) < 1e-9
    text = compared(motor, "--measured", tmp_path / "measured.csv")
    assert "um along the normal" in text.stdout
    assert "name one motor" in refused("compare", motor, motor, "--measured", motor)


def test_a_study_keeps_the_fitted_radii_and_not_the_path(tmp_path, monkeypatch):
    from camring.workflows import optimisation

    lift_table(tmp_path)
    given = read(tmp_path, BASE_LINE)

    def stop(study, *_):
        study.close()
        return study.path

    monkeypatch.setattr(optimisation, "_go_on", stop)
    monkeypatch.setattr(optimisation, "_first_points", lambda *_: np.zeros((1, 3)))
    folder = optimisation.optimise(tmp_path / "motor.toml", out=tmp_path / "study")
    kept = read_motor_file(folder / GIVEN_NAME)
    assert kept.fitted_cam is None
    assert largest_apart(kept, given) == 0
