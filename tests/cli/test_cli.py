"""The command line: quick, quiet, and one sentence for whatever goes wrong."""

import json
import os
import subprocess
import sys

import pytest
from command_line import EXAMPLE, camring_, refused

import camring
from camring.cli.app import COMMANDS

HEAVY = ("jax", "jaxlib", "equinox", "pint", "numpy", "scipy", "xarray", "matplotlib")


def test_what_is_refused_in_this_process_is_refused_in_one_of_its_own(tmp_path):
    asked = "optimise", tmp_path / "motor.toml", "--out", tmp_path / "study"
    done = camring_(*asked)
    assert (done.returncode, done.stdout, done.stderr) == (2, "", refused(*asked))


def test_help_imports_nothing_heavy():
    program = (
        "import sys; from camring.cli.app import COMMANDS, app\n"
        "for arguments in [['--help'], *([name, '--help'] for name in COMMANDS)]:\n"
        "    try: app(arguments)\n"
        "    except SystemExit: pass\n"
        f"    heavy = [name for name in {HEAVY!r} if name in sys.modules]\n"
        "    if heavy: print(arguments, heavy, file=sys.stderr)"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.stderr.strip() == ""
    assert done.stdout.count("Usage") == len(COMMANDS) + 1


def test_help_names_every_command():
    said = camring_("--help").stdout
    assert all(name in said for name in COMMANDS)


def test_no_command_is_help():
    assert "Usage" in camring_().stdout + camring_().stderr


def test_version():
    done = camring_("--version")
    assert (done.returncode, done.stdout) == (0, f"camring {camring.__version__}\n")


def test_a_command_that_does_not_exist_is_refused():
    assert "optimse" in refused("optimse", EXAMPLE)


def test_an_option_out_of_range_is_refused(tmp_path):
    said = refused("optimise", EXAMPLE, "--out", tmp_path / "study", "--budget", "0")
    assert "--budget" in said
    assert not (tmp_path / "study").exists()


def test_a_missing_option_is_refused():
    assert "--out" in refused("optimise", EXAMPLE)


def test_a_file_that_does_not_exist_is_refused_and_leaves_nothing(tmp_path):
    said = refused("optimise", tmp_path / "motor.toml", "--out", tmp_path / "study")
    assert "does not exist" in said
    assert list(tmp_path.iterdir()) == []


def test_a_motor_without_a_design_space_is_refused(tmp_path):
    text = EXAMPLE.read_text()
    motor = tmp_path / "motor.toml"
    motor.write_text(text[: text.index("[design_space")])
    said = refused("optimise", motor, "--out", tmp_path / "study")
    assert "[design_space]" in said
    assert not (tmp_path / "study").exists()


def test_a_folder_that_exists_is_refused_before_anything_is_read(tmp_path):
    said = refused("optimise", "no_such_motor.toml", "--out", tmp_path)
    assert "exists and is no study" in said
    assert list(tmp_path.iterdir()) == []


def test_resuming_nothing_is_refused(tmp_path):
    assert "is no folder of a study" in refused("resume", tmp_path / "study")
    assert "holds no study" in refused("resume", tmp_path)


BROKEN = """
from camring.cli import app as cli
from camring.cli import resume
import os
import signal
import sys
import time

@cli.app.command()
def fail(how: str) -> None:
    if how == "fault":
        raise ZeroDivisionError("division by zero\\nand more")
    if how == "ctrl-c":
        raise KeyboardInterrupt
    if how == "ctrl-c taken for a failure":
        try:
            os.kill(os.getpid(), signal.SIGINT)
            time.sleep(10)
        except KeyboardInterrupt:
            raise RuntimeError("a callback failed") from None
    for _ in range(100000):
        print("a line that nobody reads")

cli.main()
"""


def broken(*arguments, **options):
    return subprocess.run(
        [sys.executable, "-c", BROKEN, "fail", *arguments],
        capture_output=True,
        text=True,
        **options,
    )


def test_a_fault_of_ours_is_one_sentence_and_says_how_to_see_more():
    done = broken("fault")
    assert done.returncode == 1
    assert done.stderr.count("\n") == 1
    assert "ZeroDivisionError: division by zero" in done.stderr
    assert "CAMRING_DEBUG=1 camring fail fault" in done.stderr
    seen = broken("fault", env={**os.environ, "CAMRING_DEBUG": "1"})
    assert seen.returncode == 1
    assert "Traceback" in seen.stderr


def test_ctrl_c_is_exit_code_130_without_a_traceback():
    done = broken("ctrl-c")
    assert done.returncode == 130
    assert done.stderr == "camring: Interrupted.\n"


def test_ctrl_c_that_a_library_takes_for_a_failure_is_130_too():
    assert broken("ctrl-c taken for a failure").returncode == 130


def test_a_reader_that_goes_away_is_no_fault():
    program = [sys.executable, "-c", BROKEN, "fail", "talk"]
    with subprocess.Popen(
        program, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    ) as process:
        process.stdout.readline()
        process.stdout.close()
        assert process.stderr.read() == ""
        assert process.wait() == 1


@pytest.mark.parametrize("text", ["", "[motor]\nbore = 3", "\x00", "[" * 5000])
def test_nonsense_is_refused_in_a_sentence(tmp_path, text):
    motor = tmp_path / "motor.toml"
    motor.write_text(text)
    said = refused("optimise", motor, "--out", tmp_path / "study")
    assert said.startswith("camring: ")
    assert said.count("\n") == 1


def test_json_is_never_mixed_with_other_words():
    """The end-to-end test looks at the document itself."""
    said = refused("resume", "nowhere", "--json")
    with pytest.raises(ValueError, match="Expecting value"):
        json.loads(said)


def test_the_command_offers_the_methods_of_the_motor_file():
    from camring.cli.optimise import Method
    from camring.files.motor.goal_tables import METHODS

    assert tuple(Method) == METHODS
