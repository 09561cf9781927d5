"""The command line as tests call it: in a process of its own, or in this one."""

import os
import subprocess
import sys
from pathlib import Path

from typer.testing import CliRunner

from camring.cli.app import app

EXAMPLE = Path(__file__).parents[2] / "examples" / "derivation_motor.toml"
CAMRING = [sys.executable, "-c", "from camring.cli.app import main; main()"]


def camring_(*arguments, **options):
    environment = {**os.environ, **options.pop("environment", {})}
    return subprocess.run(
        [*CAMRING, *map(str, arguments)],
        capture_output=True,
        text=True,
        env=environment,
        **options,
    )


def refused(*arguments):
    """Exit code 2, nothing on stdout, one sentence on stderr; the sentence.

    In this process, for time: a process of its own shows no more, see the next test.
    """
    done = CliRunner().invoke(app, list(map(str, arguments)))
    assert done.exit_code == 2, done.stderr
    assert done.stdout == ""
    assert "Traceback" not in done.stderr
    return done.stderr
