"""A motor file that has been read: the nouns in it, and the text they came from."""

from collections.abc import Sequence
from dataclasses import dataclass
from os import fspath
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from camring.interfaces.config.build import build_system
from camring.interfaces.config.design import build_design_space
from camring.interfaces.config.document import parse, printable, read_text
from camring.interfaces.config.goal import build_goal
from camring.interfaces.config.goal_tables import GRADIENT
from camring.interfaces.config.keys import Choices, choose, file_tables
from camring.interfaces.config.oil import with_oil
from camring.interfaces.config.soundness import require_sound
from camring.interfaces.config.tables import EvaluatorTable, FileTables, SearchTable
from camring.interfaces.config.tolerances import Tolerances, build_tolerances
from camring.interfaces.config.translate import input_error
from camring.interfaces.config.writer import changed_text
from camring.interfaces.errors import InputError
from camring.objective.design_space import DesignSpace
from camring.objective.objective import Goal
from camring.physics.system import System


@dataclass(frozen=True, eq=False)
class MotorFile:
    """One motor file.

    Attributes
    ----------
    text, document
        As given: the text and the TOML document in it.
    system, goal
        The motor with oil and operating points, and what is wanted of it.
    design_space
        What may change; None when the file has no `[design_space]`.
    tolerances
        What scatters from motor to motor; None when the file has no `[tolerances]`.
    search
        Settings of the search.
    evaluator
        The user's own program that judges designs; None is our simulation.
    choices
        The laws the file has chosen.
    path
        Where it was read, for messages.
    """

    text: str
    document: dict[str, Any]
    system: System
    goal: Goal
    design_space: DesignSpace | None
    tolerances: Tolerances | None
    search: SearchTable
    evaluator: EvaluatorTable | None
    choices: Choices
    path: Path

    def with_design(self, unit_point: Sequence[float]) -> str:
        """The text of a complete motor file of one design; comments stay.

        Raises
        ------
        InputError
            When the file has no design space.
        """
        if self.design_space is None:
            raise missing_design_space(self.path)
        values = self.design_space.document_values(self.system, unit_point)
        return changed_text(self.text, self.document, values, self.choices)


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
    """Read and check a motor file.

    Raises
    ------
    InputError
        In one sentence: the field, its value, the limit and a way out.
    """
    place = Path(fspath(path))
    return parse_motor_file(read_text(place), place)


def parse_motor_file(text: str, path: Path = Path("motor.toml")) -> MotorFile:
    """The motor file of a text; `path` is only for messages."""
    document = parse(text, printable(path))
    choices, tables = validated(document)
    require_sound(tables, document)
    system = build_system(tables, choices)
    space = None
    if tables.design_space is not None:
        space = build_design_space(tables.design_space, tables, system, choices)
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
        tolerances=tolerances,
        search=tables.search,
        evaluator=tables.evaluator,
        choices=choices,
        path=path,
    )


def validated(document: dict[str, Any]) -> tuple[Choices, FileTables]:
    """The document as tables of SI numbers, each key checked on its own."""
    choices = choose(document)
    try:
        return choices, file_tables(choices).model_validate(with_oil(document))
    except ValidationError as error:
        raise input_error(error, choices) from None
