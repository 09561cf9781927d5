"""From a motor file to a better, checked motor: the study from its first to its last step."""

import json
from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from contextlib import AbstractContextManager
from datetime import UTC, datetime
from pathlib import Path
from typing import Protocol

import numpy as np

import camring
from camring.interfaces.config import MotorFile, missing_design_space, parse_motor_file
from camring.interfaces.config.document import decode, read_text
from camring.interfaces.config.goal_tables import BAYESIAN, GRADIENT
from camring.interfaces.coordinator import Search, search
from camring.interfaces.desk import WorkersGone
from camring.interfaces.errors import InputError
from camring.interfaces.evaluator import MotorEvaluator
from camring.interfaces.executors import InThisProcess, batch_of
from camring.interfaces.finished import Finished
from camring.interfaces.finishing import finish
from camring.interfaces.interrupt import Interrupted, Interruption
from camring.interfaces.own_evaluator import OwnEvaluator, from_fact, to_fact
from camring.interfaces.record import Record
from camring.interfaces.strategy import first_points, strategy_for
from camring.interfaces.study_choices import command_of, method_of
from camring.interfaces.study_folder import StudyFolder, require_vacant, unwritable


class Watcher(Protocol):
    """Who follows a study: called with each evaluation, told of each step."""

    def __call__(self, record: Record) -> None: ...

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
Watch = Callable[[Sequence[Record], int], AbstractContextManager[Watcher]]


def optimise(
    motor: str | Path,
    out: str | Path,
    *,
    budget: int | None = None,
    seed: int | None = None,
    method: str | None = None,
    theory: bool = True,
    evaluator: str | Sequence[str] | None = None,
    timeout: str | float | None = None,
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
        without slopes judges.
    theory
        Whether the search begins also with what theory recommends.
    evaluator, timeout
        A program of your own that judges designs, run in the present folder, and the
        seconds (or a text such as "5 min") after which it is stopped; else as in the
        file's `[evaluator]`, which runs in the file's folder. Without either our
        simulation judges.
    executor
        Where evaluations run, such as `camring.Workers(4)`; else in this process.
    batch
        Designs that a search without slopes chooses at once, on which its result depends
        as it does on the seed; else as many as the executor has workers.

    Raises
    ------
    InputError
        When the file or the folder cannot be used; nothing is then written.
    Interrupted
        When Ctrl-C came; `resume` goes on.
    """
    path, folder = Path(motor), Path(out)
    require_vacant(folder)
    read_text(path)  # a regular file of a sensible size
    given = _bytes_of(path)
    motor_file = parse_motor_file(decode(given, str(path)), path)
    if motor_file.design_space is None:
        raise missing_design_space(path)
    budget = motor_file.search.budget if budget is None else budget
    seed = motor_file.search.seed if seed is None else seed
    command = command_of(motor_file, evaluator, timeout)
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
            **({} if command is None else {"evaluator": to_fact(command)}),
            "first_points": json.dumps(first.tolist()),
            "given_name": path.name,
            "camring": camring.__version__,
            "began": datetime.now(UTC).isoformat(timespec="seconds"),
        }
        study = StudyFolder.create(folder, given, facts)
        return _go_on(study, interruption, executor, watch)


def resume(
    folder: str | Path,
    *,
    budget: int | None = None,
    executor: Executor | None = None,
    watch: Watch = Silent,
) -> Finished:
    """Go on with a study as if it had never stopped; see `optimise`.

    Parameters
    ----------
    budget
        Another number of model evaluations in all; noted in the study.
    executor
        Where evaluations run; how many it runs at once changes no design.
    """
    study = StudyFolder.open(Path(folder), write=True)
    if budget is not None:
        study.store.note(budget=str(budget))
    with Interruption() as interruption:
        return _go_on(study, interruption, executor, watch)


def _go_on(
    study: StudyFolder, interruption: Interruption, executor: Executor | None, watch: Watch
) -> Finished:
    here = InThisProcess()
    try:
        facts, kept = study.store.facts(), study.store.records()
        budget = int(facts["budget"])
        motor_file = parse_motor_file(read_text(study.given_path), study.given_path)
        evaluator: MotorEvaluator | OwnEvaluator = MotorEvaluator(motor_file.text)
        if "evaluator" in facts:
            command = from_fact(facts["evaluator"])
            command.require_runnable()
            evaluator = OwnEvaluator(motor_file.text, command)
        first = [np.array(point) for point in json.loads(facts["first_points"])]
        # A study without this note was begun when there was no other method.
        method = facts.get("method", BAYESIAN)
        task = Search(
            evaluate=evaluator,
            constraints=motor_file.goal.constraints.names(),
            strategy=strategy_for(
                motor_file, method, evaluator, first, budget, int(facts.get("batch", "1"))
            ),
            budget=budget,
            seed=int(facts["seed"]),
        )
        with watch(kept, budget) as watcher:
            if method == GRADIENT and executor is not None:
                watcher.say(IDLE)
            reason = search(task, study.store, executor or here, interruption, watcher)
            study.store.note(stopped=reason)
            watcher.say(reason)
            records, facts = study.store.records(), study.store.facts()
            return interruption.run(here, finish, study, motor_file, records, facts, watcher.say)
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
