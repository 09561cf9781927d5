"""Errors that the command line turns into one sentence and an exit code."""

LONGEST_QUOTE = 60


class CamringError(Exception):
    """An error whose text is written for the person at the keyboard."""

    exit_code = 1


class InputError(CamringError):
    """What the user gave cannot be used: field, value, limit and way out in one sentence.

    Parameters
    ----------
    field
        Where it stands, as the user wrote it: `motor.cam.control_radii[3]` or a file's path.
    problem
        What is wrong, with value and limit: `is "0 mm" but must be above zero`.
    way_out
        What to do about it, as an imperative: `give a length such as "36 mm"`.
    """

    exit_code = 2

    def __init__(self, field: str, problem: str, way_out: str) -> None:
        self.field = field
        self.problem = problem
        self.way_out = way_out
        super().__init__(field, problem, way_out)

    def __str__(self) -> str:
        return f"{self.field} {self.problem}; {self.way_out}."


def quote(value: object) -> str:
    """A value as the user wrote it, on one line and short enough to read."""
    if isinstance(value, str):
        text = '"' + value.encode("unicode_escape").decode("ascii").replace('"', '\\"') + '"'
    elif isinstance(value, bool):
        text = "true" if value else "false"
    elif isinstance(value, dict):
        text = "a table"
    elif isinstance(value, list):
        text = f"a list of {len(value)}"
    else:
        text = _digits(value)
    return text if len(text) <= LONGEST_QUOTE else text[: LONGEST_QUOTE - 3] + "..."


def _digits(value: object) -> str:
    # A whole number of more than 4,300 digits cannot be printed in decimal.
    if isinstance(value, int) and abs(value) > 10**LONGEST_QUOTE:
        return "a whole number of more than 60 digits"
    return " ".join(repr(value).split())
