"""One rule for the ring's outer diameter, and what a motor file says of it holds everywhere."""

import re
from xml.etree import ElementTree

import motor_files
import pytest
from new_command import CATALOGUE, new, refused
from typer.testing import CliRunner

from camring.analyses.layouts.derived import Original
from camring.analyses.layouts.layout import Layout
from camring.cli.app import app
from camring.exchange.drawings import Wishes, export
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file, read_motor_file
from camring.files.ring_body import beyond_the_body, body_in_words
from camring.geometry.outline import outline_of
from camring.geometry.ring_body import RING_WALL, usual_outer_radius

GREATEST = 0.0968  # m, of the template's pitch curve
ROLLER, BORE = 0.012, 0.030


def with_body(diameter):
    return motor_files.added("[motor.cam]", f'outer_diameter = "{diameter} mm"')


def drawn(file, folder, **wishes):
    """Outer diameter on the sheet, mm, and what was said of it."""
    [said] = export(file, folder, only=["sheet"], wishes=Wishes.read(**wishes), replace=True)
    words = list(ElementTree.parse(folder / "sheet.svg").getroot().itertext())
    return float(words[words.index("Ring outer diameter, datum A") + 2]), said


def test_a_sized_motor_is_drawn_with_the_diameter_of_its_row_and_within_what_was_asked(tmp_path):
    path = tmp_path / "motor.toml"
    options = ["--displacement", "2.5 L/rev", *CATALOGUE]
    done = new(path, *options, "--outer-diameter", "395.5 mm")
    row = next(line for line in done.stdout.splitlines() if line.startswith(">"))
    file = read_motor_file(path)
    assert f"{1e3 * file.outer_diameter:.0f}" in row.split()
    assert file.outer_diameter <= 0.3955
    outer, said = drawn(file, tmp_path)
    assert outer == pytest.approx(1e3 * file.outer_diameter, abs=1e-3)
    assert said.notes == ()
    # Without the key the rule draws the same ring, to the tenth to which the roller is written.
    bare = parse_motor_file(motor_files.without_line("outer_diameter", path.read_text()))
    assert drawn(bare, tmp_path)[0] == pytest.approx(outer, abs=0.1)


def test_without_a_diameter_the_wall_is_that_of_the_rule(tmp_path):
    file = parse_motor_file(motor_files.SOUND)
    greatest = outline_of(file.system.motor.cam).extreme_radius(1)[0]
    expected = 2 * usual_outer_radius(greatest, ROLLER, BORE)
    assert expected == pytest.approx(2 * (greatest + ROLLER + RING_WALL * BORE))
    assert drawn(file, tmp_path)[0] == pytest.approx(1e3 * expected, abs=1e-3)
    assert "(by rule)" in body_in_words(file, greatest)


def test_a_diameter_in_the_file_is_drawn_and_a_thin_wall_is_said(tmp_path):
    outer, said = drawn(parse_motor_file(with_body(260)), tmp_path)
    assert (outer, said.notes) == (260.0, ())
    outer, said = drawn(parse_motor_file(with_body(240)), tmp_path)
    assert outer == 240.0
    assert "leaves 11.2 mm or 0.37 bores of wall" in said.notes[0]
    outer, said = drawn(parse_motor_file(with_body(260)), tmp_path, outer_diameter="250 mm")
    assert outer == 250.0


def test_nothing_is_drawn_beyond_what_the_file_gives_nor_through_its_own_inside(tmp_path):
    with pytest.raises(InputError, match=r"beyond the 240 mm that the motor file gives"):
        drawn(parse_motor_file(with_body(240)), tmp_path, outer_diameter="241 mm")
    pierced = parse_motor_file(with_body(210))
    with pytest.raises(InputError, match=r"of 210 mm, within the working surface of 217\.6 mm"):
        drawn(pierced, tmp_path)
    [warning] = beyond_the_body(pierced, GREATEST)
    assert "reaches to a diameter of 217.6 mm" in warning
    assert not beyond_the_body(parse_motor_file(with_body(218)), GREATEST)


def test_a_radius_where_the_diameter_is_asked_for_is_refused_with_twice_it():
    with pytest.raises(InputError, match=r'if that is the radius, write "240 mm"'):
        parse_motor_file(with_body(120))
    with pytest.raises(InputError, match="not a length"):
        parse_motor_file(motor_files.added("[motor.cam]", 'outer_diameter = "2 bar"'))


def test_other_counts_keep_the_body():
    text = Original(parse_motor_file(with_body(250))).derived(Layout(8, 5))
    assert parse_motor_file(text).outer_diameter == 0.25


def test_check_tells_the_body_and_what_pierces_it(tmp_path):
    path = tmp_path / "motor.toml"
    path.write_text(with_body(210))
    done = CliRunner().invoke(app, ["check", str(path)])
    said = " ".join(done.output.split())
    assert "outer diameter 210 mm (given)" in said
    assert "The ring does not fit its body" in said


@pytest.mark.parametrize(
    ("value", "way_out"),
    [
        ("195 mm", '"390 mm"'),
        ("7.5 in", '"15 in"'),
        ("195", 'with a diameter, "500 mm"'),
        ("2 bar", 'with a diameter, "500 mm"'),
        ("large", 'with a diameter, "500 mm"'),
    ],
)
def test_the_old_names_are_refused_with_the_value_to_write(tmp_path, value, way_out):
    said = refused("--displacement", "2.5 L/rev", *CATALOGUE, "--envelope", value)
    assert "it is now --outer-diameter, a diameter" in said
    assert said.rstrip(".\n").endswith(way_out)
    path = tmp_path / "motor.toml"
    path.write_text(motor_files.SOUND)
    out = ["--out", str(tmp_path / "out"), "--outer-radius", value]
    done = CliRunner().invoke(app, ["export", str(path), *out])
    assert way_out in str(done.exception) + done.output
    assert not (tmp_path / "out").exists()


def test_help_shows_the_new_names_only():
    for command in ("new", "export"):
        said = CliRunner().invoke(app, [command, "--help"], env={"COLUMNS": "200"}).output
        assert "--outer-diameter" in said
        assert not re.search(r"--envelope|--outer-radius", said)
