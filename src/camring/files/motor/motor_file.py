"""A motor file that has been read: the nouns in it, and the text they came from."""

from collections.abc import Sequence
from dataclasses import dataclass
from os import fspath
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from camring.files.errors import InputError
from camring.files.motor.build import build_system
from camring.files.motor.design import build_design_space
from camring.files.motor.document import parse, printable, read_text
from camring.files.motor.envelope import build_envelope, documents_at_temperatures
from camring.files.motor.goal import build_goal
from camring.files.motor.goal_tables import GRADIENT
from camring.files.motor.keys import Choices, choose, file_tables
from camring.files.motor.oil import with_inlet, with_oil
from camring.files.motor.soundness import require_sound
from camring.files.motor.tables import EvaluatorTable, FileTables, SearchTable
from camring.files.motor.tolerances import Tolerances, build_tolerances
from camring.files.motor.translate import input_error
from camring.files.motor.writer import changed_text, found_text
from camring.files.shapes.fitted import (
    FittedCam,
    fitted_cam,
    names_profile,
    require_profile_for_its_keys,
    with_placeholder,
    with_radii,
)
from camring.files.shapes.groove import with_groove
from camring.objective.design_space import DesignSpace
from camring.objective.objective import Goal
from camring.physics.envelope import Envelope
from camring.physics.system import System


@dataclass(frozen=True, eq=False)
class MotorFile:
    """One motor file.

    Attributes
    ----------
    text, document
        As given: the text and the TOML document in it; fitted control radii stand in both where
        the file names a profile.
    system, goal
        The motor with oil and operating points, and what is wanted of it.
    design_space
        What may change; None when the file has no `[design_space]`.
    envelope
        Where the motor must run; None when the file has no `[envelope]`.
    outer_diameter
        Of the ring's body, m; None when the file does not give it.
    tolerances
        What scatters from motor to motor; None when the file has no `[tolerances]`.
    search
        Settings of the search.
    evaluator
        The user's own program that evaluates designs; None is our simulation.
    choices
        The laws the file has chosen.
    path
        Where it was read, for messages.
    fitted_cam
        How the control radii were fitted to the profile that the file names; None without one.

    Examples
    --------
    >>> file = camring.read_motor_file("motor.toml")
    >>> file.path.name, file.choices.laws[0], file.goal.weights.torque_ripple
    ('motor.toml', 'constant', 10.0)
    """

    text: str
    document: dict[str, Any]
    system: System
    goal: Goal
    design_space: DesignSpace | None
    envelope: Envelope | None
    outer_diameter: float | None
    tolerances: Tolerances | None
    search: SearchTable
    evaluator: EvaluatorTable | None
    choices: Choices
    path: Path
    fitted_cam: FittedCam | None = None

    def kept(self, content: bytes) -> bytes:
        """What a folder keeps of the file: its bytes, or its text where a profile was fitted."""
        return content if self.fitted_cam is None else self.text.encode()

    def with_design(self, unit_point: Sequence[float], found_by: str = "") -> str:
        """The text of a complete motor file of one design; comments stay.

        Parameters
        ----------
        found_by
            The command that found it, for a remark at the top; none without it.

        Raises
        ------
        InputError
            When the file has no design space.
        """
        if self.design_space is None:
            raise missing_design_space(self.path)
        values = self.design_space.document_values(self.system, unit_point)
        text = changed_text(self.text, self.document, values, self.choices)
        return found_text(text, found_by) if found_by else text


def missing_design_space(path: Path) -> InputError:
    """What a command says that cannot work without a design space."""
    return InputError(
        printable(path),
        "has no table [design_space]",
        'say what may change, for example "motor.valve_plate.shift" = ["-1 deg", "1 deg"] in it',
    )


def missing_tolerances(path: Path) -> InputError:
    """What a command says that cannot work without tolerances."""
    return InputError(
        printable(path),
        "has no table [tolerances]",
        'say what scatters, for example "motor.valve_plate.shift" = "0.2 deg" in it',
    )


def read_motor_file(path: str | Path) -> MotorFile:
    """Read and check a motor file: TOML with units (docs/theory.md section 9).

    Parameters
    ----------
    path
        Of the file; it runs nothing that the file names.

    Raises
    ------
    InputError
        In one sentence: the field, its value, the limit and a way out.

    Examples
    --------
    >>> file = camring.read_motor_file("motor.toml")
    >>> file.design_space.names, file.envelope
    (('motor.valve_plate.shift', 'motor.dead_volume'), None)
    >>> camring.read_motor_file("nowhere.toml")  # doctest: +IGNORE_EXCEPTION_DETAIL
    Traceback (most recent call last):
    camring.files.errors.InputError: nowhere.toml is no file ...
    """
    place = Path(fspath(path))
    return parse_motor_file(read_text(place), place)


def parse_motor_file(text: str, path: Path = Path("motor.toml")) -> MotorFile:
    """The motor file of a text; `path` is only for messages."""
    document, fitted = parse(text, printable(path)), None
    require_profile_for_its_keys(document)
    if names_profile(document):
        _, tables = validated(with_placeholder(document))
        fitted = fitted_cam(tables.motor, path.parent)
        text = with_radii(text, document, fitted)
        document = parse(text, printable(path))
    choices, tables = validated(document)
    require_sound(tables, document)
    system = build_system(tables, choices)
    space = None
    if tables.design_space is not None:
        space = build_design_space(tables.design_space, tables, system, choices)
    envelope = _envelope(tables, document, system)
    if envelope is None and tables.objective.envelope_ripple > 0:
        raise InputError(
            "objective.envelope_ripple",
            "has no effect without [envelope]",
            "add that table with speed and supply_pressure, or leave this key out",
        )
    tolerances = None
    if tables.tolerances is not None:
        tolerances = build_tolerances(tables.tolerances, tables, document, system, choices)
    for name in ("search", "evaluator"):
        if space is None and name in document:
            raise InputError(
                f"[{name}]",
                "has no effect without [design_space]",
                f"add that, or leave [{name}] out",
            )
    if tables.evaluator is not None:
        tables.evaluator.require_one()
    if tables.evaluator is not None and document.get("search", {}).get("method") == GRADIENT:
        raise InputError(
            "search.method",
            'is "gradient", which needs slopes that [evaluator] does not give',
            'leave it out, or write method = "scbo"',
        )
    return MotorFile(
        text=text,
        document=document,
        system=system,
        goal=build_goal(tables),
        design_space=space,
        envelope=envelope,
        outer_diameter=tables.motor.cam.outer_diameter,
        tolerances=tolerances,
        search=tables.search,
        evaluator=tables.evaluator,
        choices=choices,
        path=path,
        fitted_cam=fitted,
    )


def _envelope(tables: FileTables, document: dict[str, Any], system: System) -> Envelope | None:
    if tables.envelope is None:
        return None
    fluids = []
    for each in documents_at_temperatures(tables.envelope, document):
        choices, other = validated(each)
        fluids.append(build_system(other, choices).fluid)
    moved = [key for key in tables.design_space or {} if key.startswith("fluid.")]
    if fluids and moved:
        raise InputError(
            f'design_space."{moved[0]}"',
            "may change the oil, whose numbers envelope.temperature sets at its ends",
            "leave one of the two out",
        )
    return build_envelope(tables.envelope, document, system, fluids)


def validated(document: dict[str, Any]) -> tuple[Choices, FileTables]:
    """The document as tables of SI numbers, each key checked on its own."""
    choices = choose(document)
    given = with_groove(with_oil(with_inlet(document)))
    try:
        return choices, file_tables(choices).model_validate(given)
    except ValidationError as error:
        raise input_error(error, choices) from None
