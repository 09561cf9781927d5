"""The store gives back what it was given, or says in a sentence why not."""

import math
import sqlite3

import numpy as np
import pytest

from camring.evaluation.outcome import Outcome
from camring.evaluation.record import Record, best_of
from camring.files.errors import InputError
from camring.studies.database import StudyError
from camring.studies.store import Store


@pytest.fixture
def store(tmp_path):
    store = Store.create(tmp_path, {"seed": "3"})
    yield store
    store.close()


def record(trial, objective=1.0, constraint=-0.5, **changes):
    outcome = Outcome(
        objective=objective,
        constraints={"min_pressure": constraint, "a_limit": -0.1},
        physical_objective=objective / 3,
        approximation=0.1 + 0.2,
        terms=({"efficiency": 0.1 * trial}, {"efficiency": math.pi}),
        results=({"torque_ripple": 1e-300, "jerk": math.inf}, {"torque_ripple": math.nan}),
        design={"motor.bore": 0.03, "motor.cam.control_radii": [0.1, 1 / 3]},
        failure=changes.pop("failure", None),
    )
    point = np.array([0.1, 1 / 3, np.nextafter(1.0, 0.0)])
    return Record(trial, "sobol", point, outcome, started=1.7e9 + trial, seconds=0.25, **changes)


def append_many(store):
    for trial in range(1, 1000):
        store.append(record(trial), {"step": 1})


def test_every_number_comes_back_to_the_last_bit(store):
    given = record(0)
    store.append(given, {"step": 0.1 + 0.2, "seen": [1, 2]})
    (found,) = store.records()
    assert found.point.tobytes() == given.point.tobytes()
    assert repr(found.outcome) == repr(given.outcome)
    assert (found.trial, found.phase, found.started) == (0, "sobol", given.started)
    assert store.memory() == {"step": 0.1 + 0.2, "seen": [1, 2]}


def test_a_failed_evaluation_is_kept_with_its_reason(store):
    store.append(record(0, math.nan, failure="no periodic orbit"), {})
    (found,) = store.records()
    assert found.failed
    assert not found.feasible
    assert found.outcome.failure == "no periodic orbit"
    assert math.isnan(found.outcome.objective)


def test_evaluation_and_memory_are_kept_together_or_not_at_all(store):
    store.append(record(0), {"step": 1})
    with pytest.raises(TypeError):
        store.append(record(1), {"step": object()})
    assert [kept.trial for kept in store.records()] == [0]
    assert store.memory() == {"step": 1}


def test_only_the_last_memory_is_kept(store):
    for trial in range(5):
        store.append(record(trial), {"step": trial})
    assert store.memory() == {"step": 4}


def test_the_best_is_the_lowest_that_keeps_every_limit():
    records = [record(0, 3.0), record(1, 1.0, constraint=0.1), record(2, 2.0), record(3, 2.0)]
    best = best_of(records)
    assert best is not None
    assert best.trial == 2
    assert best_of(records[1:2]) is None


def test_weights_can_be_changed_without_simulating_again(store):
    for trial in range(3):
        store.append(record(trial), {})
    assert [kept.outcome.terms[0]["efficiency"] for kept in store.records()] == [0.0, 0.1, 0.2]


def test_the_database_is_write_ahead_and_fully_synchronous(store):
    connection = store._connection
    assert connection.execute("PRAGMA journal_mode").fetchone() == (b"wal",)
    assert connection.execute("PRAGMA synchronous").fetchone() == (2,)


def test_a_reader_sees_what_a_writer_has_committed(tmp_path, store):
    store.append(record(0), {})
    reader = Store.open(tmp_path, write=False)
    assert len(reader.records()) == 1
    store.append(record(1), {})
    assert len(reader.records()) == 2
    reader.close()


def test_a_full_database_loses_no_completed_evaluation(tmp_path, store):
    store.append(record(0), {"step": 1})
    connection = store._connection
    (pages,) = connection.execute("PRAGMA page_count").fetchone()
    connection.execute(f"PRAGMA max_page_count = {pages}")
    with pytest.raises(StudyError, match=r"takes no more.*camring resume"):
        append_many(store)
    kept = store.records()
    connection.execute("PRAGMA max_page_count = 100000")
    store.append(record(len(kept)), {"step": 2})
    assert [row.trial for row in store.records()] == list(range(len(kept) + 1))


@pytest.mark.parametrize(
    ("damage", "sentence"),
    [
        ("PRAGMA user_version = 99", "has version 99 but this camring knows versions 1 to 2"),
        ("PRAGMA application_id = 7", "is a database of some other program"),
    ],
)
def test_an_unknown_database_is_refused(tmp_path, store, damage, sentence):
    store.close()
    with sqlite3.connect(tmp_path / "study.sqlite") as connection:
        connection.execute(damage)
    connection.close()
    for write in (True, False):
        with pytest.raises(InputError, match=sentence):
            Store.open(tmp_path, write=write)


def test_a_damaged_database_is_refused(tmp_path):
    (tmp_path / "study.sqlite").write_bytes(b"no database at all" * 1000)
    with pytest.raises(InputError, match="is no readable study database"):
        Store.open(tmp_path, write=True)
