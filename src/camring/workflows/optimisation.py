"""From a motor file to a better, checked motor: the study from its first to its last step."""

import json
import shutil
from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from datetime import UTC, datetime
from pathlib import Path
from typing import Protocol

import numpy as np

from camring.analyses.file_notes import file_notes
from camring.evaluation.consent import Allow, require_consent
from camring.evaluation.evaluator import MotorEvaluator
from camring.evaluation.executors import InThisProcess, batch_of
from camring.evaluation.interrupt import Interrupted, Interruption
from camring.evaluation.queue import WorkersGone
from camring.evaluation.record import Record
from camring.evaluation.strategy import first_points, strategy_for
from camring.evaluation.user_programs.command import UserCommand
from camring.evaluation.user_programs.evaluator import UserEvaluator, from_fact, to_fact
from camring.evaluation.user_programs.numbers import NotBelieved
from camring.files.errors import InputError
from camring.files.motor import MotorFile, missing_design_space, parse_motor_file
from camring.files.motor.document import decode, printable, read_text
from camring.files.motor.goal_tables import BAYESIAN, GRADIENT
from camring.presentation.study import Finished
from camring.studies.coordinator import Search, Watcher, search
from camring.studies.reference_processes import SecondSolver
from camring.studies.study_choices import command_of, method_of
from camring.studies.study_folder import StudyFolder, require_vacant, unwritable
from camring.studies.validation import solve_again, without_second_solver
from camring.version import __version__
from camring.workflows.finishing import finish


class Follower(Watcher, Protocol):
    """A watcher that also hears in sentences what the study does."""

    def say(self, sentence: str) -> None: ...


class Silent:
    """Follows a study without a word."""

    def __init__(self, kept: Sequence[Record], budget: int) -> None:
        pass

    def __enter__(self) -> "Silent":
        return self

    def __exit__(self, *_: object) -> None:
        pass

    def __call__(self, record: Record) -> None:
        pass

    def say(self, sentence: str) -> None:
        pass


IDLE = (
    "A descent by slopes asks for one design after another: workers help with the first "
    "designs only, and --method bayesian keeps them busy."
)
CONSENT = "evaluator_consent"
Watch = Callable[[Sequence[Record], int], AbstractContextManager[Follower]]


def optimise(
    motor: str | Path,
    out: str | Path,
    *,
    budget: int | None = None,
    seed: int | None = None,
    method: str | None = None,
    theory: bool = True,
    evaluator: str | Sequence[str] | UserCommand | None = None,
    timeout: str | float | None = None,
    units: Mapping[str, str] | None = None,
    allow_evaluator: Allow = False,
    executor: Executor | None = None,
    batch: int | None = None,
    watch: Watch = Silent,
) -> Finished:
    """Search for a better motor, validate it and report, all in a new folder.

    Parameters
    ----------
    motor
        Path of a motor file with a design space.
    out
        The folder to make.
    budget, seed
        Model evaluations in all, and where chance comes from; else as in the file.
    method
        "gradient", "scbo" or "bayesian"; else as in the file, and "scbo" where a program
        without slopes evaluates.
    theory
        Whether the search begins also with what theory recommends.
    evaluator, timeout
        A program of your own that evaluates designs, run in the present folder, and the
        seconds (or a text such as "5 min") after which it is stopped; else as in the
        file's `[evaluator]`, which runs in the file's folder. Without either our
        simulation evaluates.
    units
        Of its results, where it does not answer in SI: `{"max_pressure": "bar"}`.
    allow_evaluator
        Whether what the file's `[evaluator]` names may run here, or a function that is
        asked with the command; a program given as `evaluator` may.
    executor
        Where evaluations run, such as `camring.Workers(4)`; else in this process.
    batch
        Designs that a search without slopes chooses at once, on which its result depends
        as it does on the seed; else as many as the executor has workers.

    Raises
    ------
    InputError
        When the file or the folder cannot be used, or the program's numbers for the given
        motor cannot be what they are taken for; nothing is then written.
    Interrupted
        When Ctrl-C came; `resume` goes on.

    Examples
    --------
    >>> found = camring.optimise("motor.toml", "study", budget=100)  # doctest: +SKIP
    >>> found.best.outcome.objective, found.validation.validated  # doctest: +SKIP
    """
    path, folder = Path(motor), Path(out)
    require_vacant(folder)
    read_text(path)  # a regular file of a sensible size
    given = _bytes_of(path)
    motor_file = parse_motor_file(decode(given, str(path)), path)
    given = motor_file.kept(given)
    if motor_file.design_space is None:
        raise missing_design_space(path)
    budget = motor_file.search.budget if budget is None else budget
    seed = motor_file.search.seed if seed is None else seed
    command = command_of(motor_file, evaluator, timeout, units)
    consent = ""
    if command is not None:
        allow = True if evaluator is not None else allow_evaluator
        consent = require_consent(command, allow, f"{printable(path)} [evaluator]")
    method = method_of(motor_file, method, command)
    if batch is not None and method == GRADIENT:
        raise InputError(
            "--batch",
            f"is {batch}, but a descent by slopes asks for one design after another",
            "leave it out, or choose --method bayesian",
        )
    batch = batch_of(batch, executor)
    with Interruption() as interruption:
        try:
            first = interruption.run(InThisProcess(), _first_points, motor_file, theory)
        except Interrupted:
            raise Interrupted("Stopped before the study began; nothing was written.") from None
        facts = {
            "seed": str(seed),
            "budget": str(budget),
            "method": method,
            "batch": str(batch),
            "theory": str(theory).lower(),
            **({} if command is None else {"evaluator": to_fact(command), CONSENT: consent}),
            "first_points": json.dumps(first.tolist()),
            "given_name": path.name,
            "camring": __version__,
            "began": datetime.now(UTC).isoformat(timespec="seconds"),
        }
        study = StudyFolder.create(folder, given, facts)
        try:
            return _go_on(study, interruption, executor, watch)
        except NotBelieved:
            shutil.rmtree(folder, ignore_errors=True)  # made above, and nothing is in it yet
            raise


def resume(
    folder: str | Path,
    *,
    budget: int | None = None,
    executor: Executor | None = None,
    allow_evaluator: Allow = False,
    watch: Watch = Silent,
) -> Finished:
    """Go on with a study as if it had never stopped; see `optimise`.

    Parameters
    ----------
    budget
        Another number of model evaluations in all; noted in the study.
    executor
        Where evaluations run; how many it runs at once changes no design.
    allow_evaluator
        As in `optimise`; needed only where the program that evaluates, or a file that its
        command names, has changed, or the study was begun by somebody else.

    Raises
    ------
    InputError
        When the folder holds no study, or one that this version cannot continue.
    StudyDamaged
        When anything in it is not what was kept.
    Interrupted
        When Ctrl-C came; call it again.

    Examples
    --------
    >>> found = camring.resume("study", budget=300)  # doctest: +SKIP
    """
    study = StudyFolder.open(Path(folder), write=True)
    try:
        _require_consent(study, allow_evaluator)
    except BaseException:
        study.close()
        raise
    if budget is not None:
        # Not stopped any more: whoever is killed now has not come to the end of this budget.
        study.store.note(budget=str(budget), stopped="")
    with Interruption() as interruption:
        return _go_on(study, interruption, executor, watch)


def _require_consent(study: StudyFolder, allow: Allow) -> None:
    facts = study.store.facts()
    if "evaluator" not in facts:
        return
    command, noted = from_fact(facts["evaluator"]), facts.get(CONSENT, "")
    command.require_runnable()
    mark = require_consent(command, allow, printable(study.path), noted)
    if mark != noted:
        study.store.note(**{CONSENT: mark})


def _go_on(
    study: StudyFolder, interruption: Interruption, executor: Executor | None, watch: Watch
) -> Finished:
    here = InThisProcess()
    try:
        found = study.store.sound()
        facts, kept = found.facts, found.records
        budget = int(facts["budget"])
        motor_file = parse_motor_file(read_text(study.given_path), study.given_path)
        # A study without this note was begun when there was no other method.
        method = facts.get("method", BAYESIAN)
        evaluator: MotorEvaluator | UserEvaluator = MotorEvaluator(motor_file.text)
        if "evaluator" in facts:
            command = from_fact(facts["evaluator"])
            command.require_runnable()
            evaluator = UserEvaluator(motor_file.text, command)
        first = [np.array(point) for point in json.loads(facts["first_points"])]
        task = Search(
            evaluate=evaluator,
            constraints=evaluator.names_by_point if method == GRADIENT else evaluator.names,
            strategy=strategy_for(
                motor_file, method, evaluator, first, budget, int(facts.get("batch", "1"))
            ),
            budget=budget,
            seed=int(facts["seed"]),
        )
        with watch(kept, budget) as watcher, SecondSolver() as second:
            missing = without_second_solver(motor_file)
            if missing:
                watcher.say(f"The best design will not be validated: {missing}.")
            if method == GRADIENT and executor is not None:
                watcher.say(IDLE)
            for note in file_notes(motor_file):
                watcher.say(note)
            for remark in found.remarks():
                watcher.say(remark)
            # Two cores are not always busy with a design: the given motor is looked at again now.
            given_again = InThisProcess().submit(solve_again, motor_file, second)
            reason = search(task, study.store, executor or here, interruption, watcher)
            study.store.note(stopped=reason)
            watcher.say(reason)
            records, facts = study.store.records(), study.store.facts()
            return interruption.run(
                here, finish, study, motor_file, records, facts, watcher.say, given_again, second
            )
    except Interrupted:
        count = len(study.store.records())
        raise Interrupted(
            f"Stopped with {count} evaluation{'s' * (count != 1)} kept; "
            f"`camring resume {study.path}` goes on."
        ) from None
    except WorkersGone as error:
        raise WorkersGone(f"{error} `camring resume {study.path}` goes on.") from error
    except OSError as error:
        raise unwritable(study.path, error) from error
    finally:
        study.close()


def _first_points(motor_file: MotorFile, theory: bool) -> np.ndarray:
    return first_points(motor_file, theory=theory)


def _bytes_of(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError as error:
        raise InputError(
            str(path), f"cannot be read ({error.strerror})", "name a file that you may read"
        ) from error
