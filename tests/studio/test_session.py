"""A sitting at the studio: what is typed, undone, kept and saved. Nothing is simulated."""

import math

import jax
import numpy as np
import pytest

from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.files.motor.keys import key_map
from camring.files.starting.library import library
from camring.studio import following
from camring.studio.description import described
from camring.studio.evaluation import shown_repeats
from camring.studio.fields import GROUPS
from camring.studio.inside_folder import inside
from camring.studio.moved_design import Movable
from camring.studio.session import Session

TEXT = library()["wheel"]


@pytest.fixture
def session(tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(tmp_path / "state"))
    folder = tmp_path / "motors"
    folder.mkdir()
    (folder / "motor.toml").write_text(TEXT)
    return Session(folder, folder / "motor.toml")


def test_every_key_of_the_file_has_a_field(session):
    paths = {each.path.split("[")[0].rstrip("]") for each in session.opened.fields}
    known = {path.replace("operating_points.", "operating_points") for path in paths}
    for key in key_map(session.opened.file.choices):
        at_hand = key.startswith(("motor.cam.control", "motor.cam.profile", "evaluator."))
        assert at_hand or key in paths or key.startswith("operating_points."), (key, known)


def test_a_slider_holds_its_value(session):
    sliders = [each for each in session.opened.fields if each.low is not None]
    numbers = [each for each in sliders if each.kind == "number"]
    assert len(numbers) > 30
    assert all(each.low <= each.value <= each.high and each.low < each.high for each in numbers)


@pytest.mark.parametrize(
    ("path", "typed"),
    [
        ("motor.valve_plate.shift", "-0.7 deg"),
        ("motor.bore", "31 mm"),
        ("motor.roller.elastic_modulus", "200 GPa"),
        ("operating_points[1].return_pressure", "12 bar"),
        ("operating_points[0].speed", "250 rpm"),
    ],
)
def test_a_moved_number_is_the_number_typed(session, path, typed):
    session.commit({"set": {path: typed}})
    wanted = Movable(session.opened.file).system
    value = session.opened.movable.values()[path]
    session.go(-1)
    moved = session.opened.movable.moved({path: value})
    for one, other in zip(jax.tree.leaves(moved), jax.tree.leaves(wanted), strict=True):
        np.testing.assert_array_equal(one, other)


def test_a_number_that_no_leaf_holds_is_read_anew(session):
    asked = session.asked({"set": {"fluid.temperature": 320.0}})
    assert float(asked.system.fluid.viscosity) > float(session.opened.file.system.fluid.viscosity)


def test_a_wrong_number_is_refused_in_the_words_of_the_command_line(session):
    with pytest.raises(InputError) as refused:
        session.commit({"set": {"motor.bore": "0 mm"}})
    with pytest.raises(InputError) as said:
        parse_motor_file(TEXT.replace('bore = "', 'bore = "0 mm" # "', 1))
    assert str(refused.value) == str(said.value)
    assert session.memory.text == TEXT
    assert session.memory.typed["motor.bore"] == ["0 mm", str(refused.value)]
    session.commit({"set": {"motor.bore": "31 mm"}})
    assert not session.memory.typed


def test_undo_and_redo_go_through_every_text(session):
    texts = [session.memory.text]
    for typed in ("-0.2 deg", "-0.4 deg"):
        session.commit({"set": {"motor.valve_plate.shift": typed}})
        texts.append(session.memory.text)
    session.go(-1)
    assert session.memory.text == texts[1]
    session.go(-1)
    session.go(-1)
    assert session.memory.text == texts[0]
    session.go(1)
    session.go(1)
    assert session.memory.text == texts[2]
    session.go(-1)
    session.commit({"set": {"motor.valve_plate.shift": "0.3 deg"}})
    assert not session.memory.go(1)


def test_nothing_is_lost_when_the_server_starts_again(session):
    session.commit({"set": {"motor.valve_plate.shift": "-0.3 deg"}})
    session.snapshot("mine", pin=True)
    session.commit({"grip": {"kind": "handle", "number": 2, "to": 0.0857, "mirror": True}})
    with pytest.raises(InputError):
        session.commit({"set": {"motor.bore": "x"}})
    again = Session(session.folder, session.path)
    assert vars(again.memory) == vars(session.memory)


def test_a_file_that_changed_on_disk_is_read_anew_and_the_hand_s_text_is_a_snapshot(session):
    session.commit({"set": {"motor.valve_plate.shift": "-0.3 deg"}})
    mine = session.memory.text
    session.path.write_text(TEXT.replace("Wheel", "Other", 1))
    again = Session(session.folder, session.path)
    assert again.memory.text == session.path.read_text()
    assert mine in again.memory.snapshots.values()
    assert "changed on disk" in again.note


def test_saving_keeps_the_user_s_comments_and_order(session):
    session.commit({"set": {"motor.valve_plate.shift": "-0.3 deg"}})
    session.save(None, replace=True)
    written = session.path.read_text().splitlines()
    before = TEXT.splitlines()
    assert [line for line in before if line.lstrip().startswith("#")] == [
        line for line in written if line.lstrip().startswith("#")
    ]
    changed = [line for line in written if line not in before]
    assert changed == ['shift = "-0.3 deg"']
    assert not session.memory.unsaved


def test_a_number_is_made_free_and_held_again(session):
    session.free("motor.bore", ["29 mm", "31 mm"])
    names = session.opened.file.design_space.names
    assert "motor.bore" in names
    session.free("motor.bore", None)
    assert session.memory.text == TEXT


def test_a_cam_moved_by_hand_is_written_in_the_file_s_own_unit(session):
    to = float(session.opened.hand.given[3]) + 1e-4
    session.commit({"grip": {"kind": "handle", "number": 3, "to": to, "mirror": True}})
    line = next(each for each in session.memory.text.splitlines() if "control_radii" in each)
    assert "mm" in line
    assert session.opened.hand.given[3] == pytest.approx(to, abs=1e-9)


@pytest.mark.parametrize("name", ["../other.toml", "/etc/passwd", ".", "a/../../b.toml"])
def test_nothing_outside_the_folder_can_be_named(session, name):
    with pytest.raises(InputError, match="outside"):
        inside(session.folder, name)


def test_a_link_does_not_lead_out_of_the_folder(session, tmp_path):
    (tmp_path / "secret.toml").write_text(TEXT)
    (session.folder / "link.toml").symlink_to(tmp_path / "secret.toml")
    with pytest.raises(InputError, match="outside"):
        session.open("link.toml")


def test_the_motor_in_words_is_json_without_a_name_of_the_machine(session):
    import json

    text = json.dumps(described(session), allow_nan=False)
    assert str(session.folder) not in text


def test_an_evaluator_cannot_be_named_from_the_page(session):
    with pytest.raises(InputError):
        session.commit({"set": {"evaluator.command": "rm -rf /"}})
    assert not any(each.path.startswith("evaluator.command") for each in session.opened.fields)


def test_every_table_of_a_motor_file_has_its_group():
    tables = {path.rsplit(".", 1)[0] for path in key_map(parse_motor_file(TEXT).choices)}
    assert tables <= set(GROUPS)


@pytest.mark.parametrize("name", ["<b>&amp;</b>\"'`${x}", "back\\slash", "é 日本 ½"])
def test_a_name_of_any_letters_and_signs_is_the_name_that_the_file_holds(session, name):
    session.commit({"set": {"motor.name": name}})
    session.save(None, replace=True)
    assert parse_motor_file(session.path.read_text()).system.motor.name == name


@pytest.mark.parametrize("name", ["\x1b[31mred\x07", "two\nlines", "\u202emirrored"], ids=ascii)
def test_signs_that_steer_a_terminal_are_refused_in_a_sentence_without_them(session, name):
    with pytest.raises(InputError, match="one line") as refused:
        session.commit({"set": {"motor.name": name}})
    assert str(refused.value).isprintable()
    session.snapshot(name, pin=True)  # which no terminal sees, and the page shows as text
    assert Session(session.folder, session.path).memory.pinned in described(session)["snapshots"]


def test_no_snapshot_takes_the_name_of_the_design_in_the_hand(session):
    session.snapshot("now", pin=False)
    assert list(session.memory.snapshots) == ["now 2"]


def test_a_note_of_one_file_is_not_said_of_the_next(session):
    session.commit({"set": {"motor.valve_plate.shift": "-0.3 deg"}})
    session.path.write_text(TEXT.replace("Wheel", "Other", 1))
    (session.folder / "second.toml").write_text(TEXT)
    again = Session(session.folder, session.path)
    assert again.note
    again.open("second.toml")
    assert not again.note


HALF = TEXT.replace(
    "[[operating_points]]",
    '[motor.modes.half]\nidle_lobes = [1, 3, 5]\n\n[[operating_points]]\nmode = "half"',
    1,
)


def test_a_mode_is_named_with_its_own_torque_order_and_its_whole_pattern_is_shown(session):
    session.take(HALF, "a mode")
    system = session.opened.file.system
    found = described(session)
    assert found["points"][0]["text"].endswith(", half")
    assert found["points"][0]["idle"] == [0, 2, 4]
    for point in found["points"]:
        pattern = 3 if point["idle"] else system.motor.lobes
        assert point["order"] == math.lcm(system.motor.pistons, pattern)
    assert found["motor"]["repeats"] == 3 == shown_repeats(system)


def test_motors_of_several_modes_are_followed_one_by_one(session, monkeypatch):
    session.take(HALF, "a mode")
    monkeypatch.setattr(following, "evaluated", lambda *_: "one by one")
    file = session.opened.file
    assert following.followed(session.asked({}).system, file.goal) == "one by one"


def test_a_point_that_brakes_says_against_what(session):
    session.commit(
        {
            "set": {
                "operating_points[0].supply_pressure": "15 bar",
                "operating_points[0].return_pressure": "200 bar",
            }
        }
    )
    assert "15 against 200 bar" in described(session)["points"][0]["text"]
