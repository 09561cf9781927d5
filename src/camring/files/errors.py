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
        Where it stands, as the user wrote it: `motor.bore` or a file's path; places in lists are
        counted from 1: `[[operating_points]] 2, speed`, `motor.cam.control_radii, 3rd value`.
    problem
        What is wrong, with value and limit: `is "0 mm" but must be above zero`.
    way_out
        What to do about it, as an imperative: `give a length such as "36 mm"`.

    Examples
    --------
    >>> print(camring.InputError("motor.bore", 'is "0 mm"', 'give a length such as "36 mm"'))
    motor.bore is "0 mm"; give a length such as "36 mm".
    """

    exit_code = 2

    def __init__(self, field: str, problem: str, way_out: str) -> None:
        self.field = field
        self.problem = problem
        self.way_out = way_out
        super().__init__(field, problem, way_out)

    def of(self, file: str) -> "InputError":
        """The same, said of one of several files, by its name."""
        field = self.field if file in self.field else f"{file}: {self.field}"
        return InputError(field, self.problem, self.way_out)

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


def ordinal(number: int) -> str:
    """A place counted from 1: 1st, 2nd, 3rd, 11th.

    Examples
    --------
    >>> from camring.files.errors import ordinal
    >>> [ordinal(each) for each in (1, 2, 3, 4, 11, 22)]
    ['1st', '2nd', '3rd', '4th', '11th', '22nd']
    """
    last = 0 if number % 100 in (11, 12, 13) else number % 10
    return f"{number}{ {1: 'st', 2: 'nd', 3: 'rd'}.get(last, 'th') }"


def _digits(value: object) -> str:
    # A whole number of more than 4,300 digits cannot be printed in decimal.
    if isinstance(value, int) and abs(value) > 10**LONGEST_QUOTE:
        return "a whole number of more than 60 digits"
    return " ".join(repr(value).split())
