"""The outer loop over counts: each layout a study of its own, in a folder of its own.

The loop keeps no state but the folders: run again it takes finished studies as they are,
goes on with the one that was stopped, and begins those that are missing.
"""

import json
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

from camring.interfaces.config import MotorFile, parse_motor_file
from camring.interfaces.config.document import decode, printable, read_text
from camring.interfaces.database import DATABASE_NAME
from camring.interfaces.errors import InputError
from camring.interfaces.interrupt import Interrupted
from camring.interfaces.layouts.derived import Original, Unbuildable
from camring.interfaces.layouts.layout import Layout
from camring.interfaces.optimisation import Silent, Watch, optimise, resume
from camring.interfaces.record import Record, best_of
from camring.interfaces.study_folder import (
    GIVEN_NAME,
    StudyFolder,
    require_vacant,
    unwritable,
    write_safely,
)
from camring.interfaces.validation import Validation

__all__ = ["Refused", "Studied", "Studies", "layouts"]


@dataclass(frozen=True, eq=False)
class Studied:
    """What the study of one layout came to.

    Attributes
    ----------
    given, best
        The derived motor and the best design; None when no design keeps every limit.
    """

    layout: Layout
    folder: Path
    given: Record
    best: Record | None
    validated: bool
    sentence: str
    evaluations: int


@dataclass(frozen=True)
class Refused:
    """A layout that cannot be built, and why."""

    layout: Layout
    reason: str


@dataclass(frozen=True, eq=False)
class Studies:
    """All layouts of a given motor: ranked by the best objective, the infeasible ones last."""

    file: MotorFile
    folder: Path
    own: Layout
    ranked: Sequence[Studied]
    refused: Sequence[Refused]


def layouts(
    motor: str | Path,
    out: str | Path,
    wanted: Sequence[Layout],
    *,
    budget: int | None = None,
    seed: int | None = None,
    watch: Watch = Silent,
    say: Callable[[str], None] = print,
) -> Studies:
    """Derive, search and validate a motor of each layout, each with the same budget.

    Parameters
    ----------
    out
        A new folder, or one that this began: it then goes on.
    budget, seed
        Of each study; else as in the file.
    say
        Told of each layout as its turn comes.

    Raises
    ------
    InputError
        When the file has no design space or a cam that no other counts can have, or the
        folder holds something else.
    Interrupted
        When Ctrl-C came; the same call goes on.
    """
    path, folder = Path(motor), Path(out)
    read_text(path)  # a regular file of a sensible size
    content = path.read_bytes()
    file = parse_motor_file(decode(content, printable(path)), path)
    original = Original(file)
    budget = file.search.budget if budget is None else budget
    texts, refused = dict[Layout, str](), list[Refused]()
    for layout in wanted:
        try:
            texts[layout] = original.derived(layout)
        except Unbuildable as reason:
            refused.append(Refused(layout, str(reason)))
    if not texts:
        first = refused[0]
        raise InputError(
            f"{first.layout}",
            f"{first.reason}, and none of the other layouts can be built either",
            "ask for other counts",
        )
    _open(folder, content)
    studied = []
    for number, (layout, text) in enumerate(texts.items(), 1):
        say(f"{layout.words}, layout {number} of {len(texts)}")
        try:
            studied.append(_study(folder, layout, text, budget, seed, watch))
        except Interrupted as stop:
            raise Interrupted(
                f"Stopped at {layout.words}, with every evaluation kept; the same command goes on."
            ) from stop
    studied.sort(key=_rank)
    return Studies(file, folder, original.layout, studied, refused)


def _rank(each: Studied) -> tuple[bool, float]:
    return each.best is None, each.best.outcome.objective if each.best else 0.0


def _open(folder: Path, given: bytes) -> None:
    """A new folder with the motor file in it, or one that holds just this file."""
    kept = folder / GIVEN_NAME
    try:
        if kept.is_file() and not (folder / DATABASE_NAME).exists():
            if kept.read_bytes() != given:
                raise InputError(
                    printable(folder),
                    "holds the layouts of another motor file, or of this one before it changed",
                    "give another --out",
                )
            return
        require_vacant(folder)
        folder.mkdir(parents=True)
        write_safely(kept, given)
    except OSError as error:
        raise unwritable(folder, error) from error


def _study(
    folder: Path, layout: Layout, text: str, budget: int, seed: int | None, watch: Watch
) -> Studied:
    place, motor = folder / str(layout), folder / f"{layout}.toml"
    if not place.exists():
        if not motor.exists():
            write_safely(motor, text.encode("utf-8"))
        optimise(motor, place, budget=budget, seed=seed, watch=watch)
    elif not _finished(place, budget):
        resume(place, budget=budget, watch=watch)
    return _kept(layout, place)


def _finished(place: Path, budget: int) -> bool:
    study = StudyFolder.open(place, write=False)
    try:
        facts = study.store.facts()
        done = "stopped" in facts and study.validation_path.is_file()
        return done and study.report_path.is_file() and facts["budget"] == str(budget)
    finally:
        study.close()


def _kept(layout: Layout, place: Path) -> Studied:
    study = StudyFolder.open(place, write=False)
    try:
        records = study.store.records()
        said = Validation.from_json(study.validation_path.read_text(encoding="utf-8"))
    except (OSError, json.JSONDecodeError, TypeError, KeyError) as error:
        raise InputError(
            printable(study.validation_path),
            f"cannot be read ({error})",
            f"write it anew with `camring resume {place}`",
        ) from error
    finally:
        study.close()
    return Studied(
        layout, place, records[0], best_of(records), said.validated, said.sentence, len(records)
    )
