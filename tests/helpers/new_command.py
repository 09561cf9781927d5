"""`camring new` as tests call it, in this process."""

from typer.testing import CliRunner

from camring.cli.app import app

RUN = CliRunner()
CATALOGUE = ["--pressure", "250 bar", "--speed", "100 rpm"]


def new(*arguments):
    return RUN.invoke(app, ["new", *map(str, arguments)])


def refused(*arguments):
    done = new(*arguments)
    assert done.exit_code == 2
    assert done.stderr.count("\n") == 1
    return done.stderr
