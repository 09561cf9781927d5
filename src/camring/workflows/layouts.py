"""The outer loop over counts: each layout a study of its own, in a folder of its own.

The loop keeps no state but the folders: run again it takes finished studies as they are,
goes on with the one that was stopped, and begins those that are missing.
"""

import json
from collections.abc import Callable, Sequence
from pathlib import Path

from camring.analyses.layouts.derived import Original, Unbuildable
from camring.analyses.layouts.layout import Layout
from camring.analyses.layouts.studied import Refused, Studied, Studies
from camring.evaluation.consent import Allow, require_consent
from camring.evaluation.interrupt import Interrupted
from camring.evaluation.record import best_of
from camring.evaluation.user_programs.command import UserCommand
from camring.files.errors import InputError
from camring.files.motor import parse_motor_file
from camring.files.motor.document import decode, printable, read_text
from camring.files.whole_file import make_folder, write_safely
from camring.studies.database import DATABASE_NAME
from camring.studies.study_choices import command_of
from camring.studies.study_folder import (
    GIVEN_NAME,
    StudyFolder,
    require_vacant,
    unwritable,
)
from camring.studies.validation import Validation
from camring.workflows.optimisation import Silent, Watch, optimise, resume

__all__ = ["Refused", "Studied", "Studies", "layouts"]


def layouts(
    motor: str | Path,
    out: str | Path,
    wanted: Sequence[Layout],
    *,
    budget: int | None = None,
    seed: int | None = None,
    allow_evaluator: Allow = False,
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
    allow_evaluator
        Whether the program of the file's `[evaluator]` may run; see `optimise`.
    say
        Called with each layout as its turn comes.

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
    content = file.kept(content)
    original = Original(file)
    command = command_of(file, None, None)
    if command is not None:
        require_consent(command, allow_evaluator, f"{printable(path)} [evaluator]")
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
            studied.append(
                _study(folder, layout, text, budget, seed, command, allow_evaluator, watch)
            )
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
        make_folder(folder)
        write_safely(kept, given)
    except OSError as error:
        raise unwritable(folder, error) from error


def _study(
    folder: Path,
    layout: Layout,
    text: str,
    budget: int,
    seed: int | None,
    command: UserCommand | None,
    allow: Allow,
    watch: Watch,
) -> Studied:
    def agreed(other: UserCommand) -> bool:
        # A study that lies there may name another program than the file.
        return other == command or (allow(other) if callable(allow) else allow)

    place, motor = folder / str(layout), folder / f"{layout}.toml"
    if not place.exists():
        if not motor.exists():
            write_safely(motor, text.encode("utf-8"))
        optimise(motor, place, budget=budget, seed=seed, evaluator=command, watch=watch)
    elif not _finished(place, budget):
        resume(place, budget=budget, allow_evaluator=agreed, watch=watch)
    return _kept(layout, place)


def _finished(place: Path, budget: int) -> bool:
    study = StudyFolder.open(place, write=False)
    try:
        facts = study.store.facts()
        done = bool(facts.get("stopped")) and study.validation_path.is_file()
        return done and study.report_path.is_file() and facts["budget"] == str(budget)
    finally:
        study.close()


def _kept(layout: Layout, place: Path) -> Studied:
    study = StudyFolder.open(place, write=False)
    try:
        records = study.store.records()
        said = Validation.from_json(study.validation_path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, json.JSONDecodeError, TypeError, KeyError) as error:
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
