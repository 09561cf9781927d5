"""A name from a stranger is text everywhere: no markup, no formula, no command of a terminal."""

import io
import re
import shutil
from dataclasses import replace
from html.parser import HTMLParser
from pathlib import Path
from xml.etree import ElementTree
from zipfile import ZipFile

import ezdxf
import hostile
import motor_files
import pytest
import report_example
from rich.table import Table
from typer.testing import CliRunner

import camring
from camring.cli.app import app
from camring.drawing.svg import escape
from camring.exchange.fmu.description import model_description
from camring.files.csv_table import csv_table
from camring.files.terminal import Terminal
from camring.files.visible import visible
from camring.report.page import render

SOURCE = Path(camring.__file__).parent


def run(*words):
    return CliRunner().invoke(app, list(map(str, words)))


@pytest.fixture(scope="module")
def place(tmp_path_factory):
    """A motor file of a hostile name, with a hostile name in it, and all that is made of it."""
    folder = tmp_path_factory.mktemp("hostile")
    text = motor_files.with_line(f"name = '''{hostile.NAME}'''")
    (folder / hostile.FILE_NAME).write_text(text)
    return folder


@pytest.fixture(scope="module")
def said(place):
    """What the commands print."""
    motor, found = place / hostile.FILE_NAME, []
    for words in (
        ["check", motor],
        ["simulate", motor, "--waveforms", place / "waves.csv"],
        ["simulate", motor, "--waveforms", place / "waves.xlsx"],
        ["compare", motor, motor],
        ["export", motor, "--out", place / hostile.FILE_NAME.removesuffix(".toml")],
    ):
        done = run(*words)
        assert done.exit_code in (0, 3), done.output
        found.append(done.output)
    return found


def test_commands_show_it_and_obey_nothing(said):
    for text in said:
        assert not hostile.leads_a_terminal(text)
        assert "Traceback" not in text
    assert "[red]x[/nope]" in said[0]
    assert "\\x1b[2J" in "".join(said[3].split())


def test_a_refusal_shows_the_name_and_obeys_nothing(tmp_path):
    wrong = tmp_path / hostile.FILE_NAME
    wrong.write_text("[motor]\nname = 3\n")
    for words in (
        ["check", wrong],
        ["report", tmp_path / "\x1b[31mnothing\u202e"],
        ["resume", tmp_path / "\x1b[31mnothing\u202e"],
        ["optimise", wrong, "--out", wrong],
        ["fit", wrong, wrong],
        ["sweep", wrong, "\x1b[2J=1..2"],
    ):
        done = run(*words)
        assert done.exit_code == 2
        assert not hostile.leads_a_terminal(done.output)
        assert "Traceback" not in done.output


def test_no_cell_of_a_table_computes(said, place):
    tables = [place / "waves.csv", *place.rglob("*.csv")]
    assert len(tables) >= 4
    for each in tables:
        assert not hostile.formulae(each.read_text())


def test_no_cell_of_a_workbook_computes_or_links(said, place):
    with ZipFile(place / "waves.xlsx") as book:
        parts = {name: book.read(name).decode() for name in book.namelist()}
    assert "HYPERLINK" in parts["xl/sharedStrings.xml"]
    for name, part in parts.items():
        assert not re.search(r"<f[ >]|<hyperlink", part), name


def test_drawings_hold_it_as_text(said, place):
    drawings = [*place.rglob("*.svg"), *place.rglob("*.dxf")]
    assert {each.name for each in drawings} >= {"ring.svg", "sheet.svg", "ring.dxf"}
    for each in drawings:
        if each.suffix == ".svg":
            tree = ElementTree.parse(each)
            assert not [node for node in tree.iter() if node.tag.endswith("script")]
            continue
        drawing = ezdxf.readfile(each)
        assert not drawing.audit().errors
        assert hostile.NAME.strip() in dict(drawing.header.custom_vars.properties).values()


class Scripts(HTMLParser):
    """Counts what a browser would run."""

    def __init__(self):
        super().__init__()
        self.found = []

    def handle_starttag(self, tag, attributes):
        self.found += [tag] * (tag == "script")
        self.found += [name for name, _ in attributes if name.startswith("on")]


def scripts_of(text):
    reader = Scripts()
    reader.feed(text)
    return reader.found


def test_the_report_holds_it_as_text():
    plain = report_example.make_report()
    bad = f"{hostile.NAME}\x1b[2J\u202e\x00"
    designs = [replace(each, label=bad) for each in plain.designs]
    checks = [replace(each, name=bad, detail=bad) for each in plain.verdict.checks]
    data = replace(
        plain,
        title=bad,
        subtitle=bad,
        designs=tuple(designs),
        warnings=(bad,),
        verdict=replace(plain.verdict, sentence=bad, checks=tuple(checks)),
        provenance=replace(plain.provenance, input_name=bad, input_text=bad, settings={bad: bad}),
    )
    text = render(data)
    assert scripts_of(text) == scripts_of(render(plain))
    assert not hostile.leads_a_terminal(text)
    start = text.index("<svg")
    while start >= 0:
        end = text.index("</svg>", start) + len("</svg>")
        ElementTree.fromstring(text[start:end])
        start = text.find("<svg", end)


def test_an_fmu_describes_itself_in_xml_whatever_its_motor_is_called():
    point = camring.read_motor_file(
        Path(__file__).parents[2] / "examples" / "derivation_motor.toml"
    ).system.operating_points[0]
    text = model_description("motor", "{1}", hostile.NAME, "2026-01-01T00:00:00Z", point, 8)
    assert ElementTree.fromstring(text).get("description") == hostile.NAME


@pytest.mark.parametrize("sign", ["\x00", "\x1b", "\x85", "\ud800", "\uffff", "\u202e", "\u2066"])
def test_what_no_page_may_hold_is_shown_by_its_number(sign):
    assert escape(f"a{sign}b") in (f"a{sign.encode('unicode_escape').decode()}b", f"a{sign}b")
    ElementTree.fromstring(f"<p>{escape(f'a{sign}b')}</p>")
    assert visible(f"a{sign}b") == f"a{sign.encode('unicode_escape').decode()}b"


def test_blanks_and_letters_of_all_languages_stay():
    assert visible("5\u202f000 Größe 中文 é") == "5\u202f000 Größe 中文 é"


def test_a_terminal_gets_its_colours_from_us_alone():
    out = Terminal(file=io.StringIO(), force_terminal=True, width=60)
    table = Table("a\x1b[2J", title="\u202et")
    table.add_row("b\x1b]0;x\x07", style="red")
    out.print(table)
    text = out.file.getvalue()
    assert "\x1b[31m" in text  # red, as asked
    for words in ("\\x1b[2J", "\\u202et", "\\x1b]0;x\\x07"):
        assert words in text


def test_text_that_begins_like_a_formula_is_marked_and_numbers_are_not():
    cells = ["=1+1", "-1+HYPERLINK(1)", "@SUM(1)", "+cmd|x", "＝1", "-", "-2.5e-3", "+5", -3.0]
    (row,) = csv_table(["=a"] + ["b"] * 8, [cells]).splitlines()[1:]
    assert row == "'=1+1,'-1+HYPERLINK(1),'@SUM(1),'+cmd|x,'＝1,-,-2.5e-3,+5,-3.0"
    text = csv_table(["a"], [], remarks=['x,=HYPERLINK("e"); @A1, -5 bar', "from +x to +y"])
    assert text == "# x,'=HYPERLINK(\"e\"); '@A1, -5 bar\n# from +x to +y\na\n"
    assert not hostile.formulae(text)


def test_sentences_reach_the_terminal_through_one_door():
    """`typer.echo` prints documents in JSON, which hold plain signs; everything else is `say`."""
    allowed = ("document(", "json.dumps(", "dumps(", 'f"camring {__version__}"')
    for path in SOURCE.rglob("*.py"):
        if path.name in ("visible.py", "consent.py"):
            continue
        text = path.read_text(encoding="utf-8")
        for rest in text.split("typer.echo(")[1:]:
            assert rest.startswith(allowed), f"{path.name}: {rest[:60]}"
        assert "= Console(" not in text, path.name
        assert "or Console(" not in text, path.name


def test_the_folder_of_a_study_is_shown_and_obeyed_nowhere(tmp_path):
    folder = tmp_path / "s\x1b[2Jtudy\u202e"
    folder.mkdir()
    (folder / "study.sqlite").write_bytes(b"no database")
    for words in (["report", folder], ["resume", folder]):
        done = run(*words)
        assert done.exit_code == 2
        assert not hostile.leads_a_terminal(done.output)
    shutil.rmtree(folder)
