"""No program that a file or a study names runs before its user has agreed to it."""

import io
import json
import shutil
import sys

import pytest
from motor_files import SOUND, added
from typer.testing import CliRunner

import camring
from camring.analyses.layouts.layout import layouts_of
from camring.cli.app import app
from camring.evaluation.consent import ask_at_terminal, files_of, mark_of, require_consent
from camring.evaluation.user_programs.command import UserCommand
from camring.evaluation.user_programs.evaluator import to_fact
from camring.files.errors import InputError
from camring.studies.study_folder import StudyFolder
from camring.workflows import optimisation
from camring.workflows.layouts import layouts

MAPPING = 'fmu = "a.fmu"\nuntil = "1 s"\nstep = "1 ms"\nparameters = {}\nresults = {}\n'


@pytest.fixture
def place(tmp_path):
    """A folder as a stranger sends it: a motor file, and a script that leaves a trace."""
    (tmp_path / "model.py").write_text("open('it ran', 'w').close()")
    words = json.dumps([sys.executable, "model.py", "--all"])
    (tmp_path / "motor.toml").write_text(added("[evaluator]", f"command = {words}"))
    (tmp_path / "machine.toml").write_text(MAPPING)
    (tmp_path / "a.fmu").write_bytes(b"an FMU")
    (tmp_path / "fmu.toml").write_text(added("[evaluator]", 'fmu = "machine.toml"'))
    return tmp_path


def command_in(place, *words):
    return UserCommand(words or (sys.executable, "model.py", "--all"), 5.0, str(place))


def study_in(place, command, mark):
    facts = {"evaluator": to_fact(command), "evaluator_consent": mark}
    StudyFolder.create(place / "study", SOUND.encode(), facts).close()
    return place / "study"


@pytest.mark.parametrize("name", ["motor.toml", "fmu.toml"])
@pytest.mark.parametrize("verb", [("optimise",), ("layouts", "--pistons", "7", "--lobes", "6")])
def test_a_file_that_names_a_program_is_refused_without_a_word_from_its_user(place, name, verb):
    before = sorted(place.iterdir())
    said = CliRunner().invoke(app, [*verb, str(place / name), "--out", str(place / "out")])
    assert said.exit_code == 2, said.output
    words = "model.py --all" if name == "motor.toml" else "camring.evaluation.user_programs.fmu"
    for part in (words, f"in {place}", "--allow-evaluator", "allow_evaluator=True", f"{name} "):
        assert part in said.stderr
    assert sorted(place.iterdir()) == before


def test_python_scripts_are_refused_alike(place):
    for attempt in (
        lambda **more: camring.optimise(place / "motor.toml", place / "out", **more),
        lambda **more: layouts(
            place / "motor.toml", place / "out", layouts_of("7", "6"), say=lambda _: None, **more
        ),
    ):
        for more in ({}, {"allow_evaluator": lambda command: False}):
            with pytest.raises(InputError, match="nobody has agreed"):
                attempt(**more)
    assert not (place / "out").exists()
    assert not (place / "it ran").exists()


def test_a_program_named_by_the_caller_is_agreed_to(place, monkeypatch):
    class Began(Exception):
        pass

    def began(*_, **__):
        raise Began

    monkeypatch.setattr(optimisation, "first_points", began)
    for more in (
        {"evaluator": [sys.executable, "model.py"]},
        {"allow_evaluator": True},
        {"allow_evaluator": lambda command: command.words[1] == "model.py"},
    ):
        with pytest.raises(Began):
            camring.optimise(place / "motor.toml", place / "out", **more)


def test_a_study_remembers_what_its_user_agreed_to_and_nothing_else(place, monkeypatch):
    gone_on = []
    monkeypatch.setattr(optimisation, "_go_on", lambda study, *_: gone_on.append(study.close()))
    study = study_in(place, command_in(place), mark_of(command_in(place)))
    camring.resume(study)
    assert len(gone_on) == 1

    (place / "model.py").write_text("something else")
    with pytest.raises(InputError, match="have changed"):
        camring.resume(study)
    said = CliRunner().invoke(app, ["resume", str(study)])
    assert said.exit_code == 2
    assert "model.py --all" in said.stderr
    camring.resume(study, allow_evaluator=True)
    camring.resume(study)  # the new script is what is remembered now
    assert len(gone_on) == 3

    monkeypatch.setenv("XDG_STATE_HOME", str(place / "another user"))
    with pytest.raises(InputError, match="nobody has agreed"):
        camring.resume(study)


def test_a_study_begun_elsewhere_is_asked_about(place):
    study = study_in(place, command_in(place), "")
    with pytest.raises(InputError, match="nobody has agreed"):
        camring.resume(study)
    StudyFolder.open(study, write=True).close()  # and its lock is free again
    shutil.rmtree(study)
    study = study_in(place, command_in(place), "ä" * 64)
    with pytest.raises(InputError, match="nobody has agreed"):
        camring.resume(study)
    assert not (place / "it ran").exists()


def test_a_mark_is_of_words_folder_and_files(place):
    mark = mark_of(command_in(place))
    assert mark == mark_of(command_in(place))
    assert mark != mark_of(command_in(place, sys.executable, "model.py"))
    moved = shutil.copytree(place, place / "moved")
    assert mark != mark_of(command_in(moved))

    (place / "package").mkdir()
    for name in ("module.py", "package/__main__.py", "settings.toml", "solver"):
        (place / name).write_text("1")
    commands = {
        "module.py": ("python", "-m", "module"),
        "package/__main__.py": ("python", "-m", "package"),
        "settings.toml": ("solver", "--settings=settings.toml"),
        "solver": ("./solver",),
        "a.fmu": (
            sys.executable,
            "-m",
            "camring.evaluation.user_programs.fmu",
            str(place / "machine.toml"),
        ),
    }
    for name, words in commands.items():
        command = command_in(place, *words)
        assert (place / name).samefile(files_of(command)[-1])
        before = mark_of(command)
        (place / name).write_text("2")
        assert mark_of(command) != before, name


def test_the_key_is_its_users_alone(place, monkeypatch):
    monkeypatch.setenv("XDG_STATE_HOME", str(place / "state"))
    mark = mark_of(command_in(place))
    key = place / "state" / "camring" / "consent.key"
    assert key.stat().st_mode & 0o777 == 0o600
    assert len(mark) == 64
    assert [each.name for each in key.parent.iterdir()] == [key.name]
    key.chmod(0o644)  # whoever can read it can make marks
    assert mark_of(command_in(place)) == ""
    key.chmod(0o600)
    assert mark_of(command_in(place)) == mark
    monkeypatch.setenv("XDG_STATE_HOME", str(place / "model.py"))
    assert mark_of(command_in(place)) == ""
    assert require_consent(command_in(place), True, "x") == ""


class Terminal(io.StringIO):
    def isatty(self):
        return True


@pytest.mark.parametrize(("typed", "answer"), [("y\n", True), ("n\n", False), ("\n", False)])
def test_a_terminal_shows_the_exact_command_and_takes_an_answer(monkeypatch, typed, answer):
    command = UserCommand(("python", "-c", "a b\x1b[2Kc", "\u202e"), 1.0, "/a/folder")
    shown = Terminal()
    monkeypatch.setattr(sys, "stdin", Terminal(typed))
    monkeypatch.setattr(sys, "stderr", shown)
    monkeypatch.setattr(sys, "stdout", Terminal())
    assert ask_at_terminal(command) is answer
    assert "python -c 'a b\\x1b[2Kc' '\\u202e'" in shown.getvalue()
    assert "/a/folder" in shown.getvalue()
    assert "\x1b" not in shown.getvalue()


def test_nobody_is_asked_where_there_is_no_terminal(monkeypatch):
    monkeypatch.setattr(sys, "stdin", io.StringIO("y\n"))
    assert not ask_at_terminal(UserCommand(("python",), 1.0, "."))
