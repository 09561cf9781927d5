"""What the guides tell a reader to type: options that exist, lines that a motor file takes."""

import re
import shlex
from pathlib import Path

import pytest
import typer

from camring.analyses.modes import modes
from camring.analyses.sweep import assignments
from camring.cli.app import app
from camring.files.motor import parse_motor_file
from camring.files.motor.keys import key_map

DOCS = Path(__file__).parents[2] / "docs"
GUIDE = DOCS / "guide" / "calibrated-two-speed.md"
CALIBRATED = (DOCS.parent / "examples" / "derivation_motor.toml").read_text()
COMMANDS = typer.main.get_command(app).commands


def blocks(page, kind):
    return re.findall(rf"(?m)^```{kind}\n(.*?)^```", page.read_text(), flags=re.DOTALL)


def typed(page):
    """Every `camring ...` of the page's blocks for the shell, as its words."""
    text = "\n".join(blocks(page, r"(?:sh|\{run\} sh)")).replace("\\\n", " ")
    for line in text.splitlines():
        if line.startswith("camring "):
            yield shlex.split(line, comments=True)[1:]


PAGES = sorted(page for page in DOCS.rglob("*.md") if any(typed(page)))


def test_most_guides_are_looked_at():
    assert len(PAGES) > 15
    assert GUIDE in PAGES


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_commands_of_a_page_and_their_options_exist(page):
    for name, *words in typed(page):
        options = {option for each in COMMANDS[name].params for option in each.opts}
        options |= {option for each in COMMANDS[name].params for option in each.secondary_opts}
        used = {word.partition("=")[0] for word in words if word.startswith("--")}
        assert used <= options | {"--help"}, f"camring {name}: {used - options}"


def test_the_lines_of_the_two_speeds_are_a_motor_file_and_its_sweeps_name_its_keys():
    second, tolerances = blocks(GUIDE, "toml")
    text = CALIBRATED.replace("[motor.roller]\n", "[motor.roller]\nfriction = 0.0112433\n")
    text = text.replace('min_contact_force = "0 N"', 'min_contact_force = "200 N"')
    file = parse_motor_file(f"{text}\n{second}\n{tolerances}")
    assert len(file.tolerances.names) == 4
    assert modes(file)[0].sentence.replace("\n", " ") in quoted()
    half = parse_motor_file(f"{text}\n{second.replace('[1, 4]', '[1, 3, 5]')}")
    assert [point.mode for point in half.system.operating_points] == ["", "", "fast"]
    assert modes(half)[0].pushes_everywhere
    known = key_map(half.choices)
    swept = [word for name, *words in typed(GUIDE) if name == "sweep" for word in words]
    keys = assignments([word for word in swept if re.match(r"[a-z_.]+=", word)])
    assert len(keys) == 2
    assert keys.keys() <= known.keys()


def quoted():
    """Quotations of the page, each on one line."""
    return re.sub(r"\n> ", " ", GUIDE.read_text())
