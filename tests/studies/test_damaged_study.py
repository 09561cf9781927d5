"""A damaged study is named as such, trial by trial; nothing altered is ever taken as it was."""

import json
import shutil
import sqlite3
import time
from dataclasses import asdict

import damage
import fake_study
import numpy as np
import pytest

from camring.evaluation.outcome import Outcome
from camring.evaluation.record import Record
from camring.files.checksums import checksum
from camring.files.errors import InputError
from camring.studies import verified_rows as verified
from camring.studies.database import StudyDamaged
from camring.studies.store import Store
from camring.studies.study_folder import StudyFolder

COPIES = 120
OLD_SCHEMA = """
PRAGMA application_id = 1667329394; PRAGMA user_version = 1;
CREATE TABLE study (key TEXT PRIMARY KEY, value TEXT NOT NULL) WITHOUT ROWID;
CREATE TABLE evaluation (
    trial INTEGER PRIMARY KEY, phase TEXT NOT NULL,
    state TEXT NOT NULL CHECK (state IN ('complete', 'failed')),
    point BLOB NOT NULL, design TEXT NOT NULL, objective REAL, physical_objective REAL,
    approximation REAL, failure TEXT, started REAL NOT NULL, seconds REAL NOT NULL
);
CREATE TABLE constraint_value (
    trial INTEGER NOT NULL, name TEXT NOT NULL, value REAL, PRIMARY KEY (trial, name)
);
CREATE TABLE term (
    trial INTEGER NOT NULL, operating_point INTEGER NOT NULL, name TEXT NOT NULL, value REAL,
    PRIMARY KEY (trial, operating_point, name)
);
CREATE TABLE result (
    trial INTEGER NOT NULL, operating_point INTEGER NOT NULL, name TEXT NOT NULL, value REAL,
    PRIMARY KEY (trial, operating_point, name)
);
CREATE TABLE memory (
    only INTEGER PRIMARY KEY CHECK (only = 0), trial INTEGER NOT NULL, content TEXT NOT NULL
);
"""


@pytest.fixture(scope="module")
def study(tmp_path_factory):
    folder = tmp_path_factory.mktemp("whole") / "study"
    fake_study.run(folder, budget=40)
    return folder


@pytest.fixture
def copy(study, tmp_path):
    return shutil.copytree(study, tmp_path / "copy")


def changed(folder, *statements):
    with sqlite3.connect(folder / "study.sqlite") as connection:
        for statement in statements:
            connection.execute(statement)
    connection.close()


def as_an_old_camring_kept_it(folder, into):
    """The same study in the tables of version 1."""
    shutil.copytree(folder, into)
    opened = StudyFolder.open(folder, write=False)
    records, facts, memory = (
        opened.store.records(), opened.store.facts(), opened.store.memory()
    )  # fmt: skip
    opened.close()
    (into / "study.sqlite").unlink()
    with sqlite3.connect(into / "study.sqlite") as connection:
        connection.executescript(OLD_SCHEMA)
        connection.executemany("INSERT INTO study VALUES (?, ?)", facts.items())
        connection.execute(
            "INSERT INTO memory VALUES (0, ?, ?)", (len(records) - 1, json.dumps(memory))
        )
        for record in records:
            said, trial = record.outcome, record.trial
            connection.execute(
                "INSERT INTO evaluation VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
                (
                    trial, record.phase, "failed" if record.failed else "complete",
                    record.point.tobytes(), json.dumps(said.design), said.objective,
                    said.physical_objective, said.approximation, said.failure, record.started,
                    record.seconds,
                ),
            )  # fmt: skip
            connection.executemany(
                "INSERT INTO constraint_value VALUES (?, ?, ?)",
                [(trial, *each) for each in said.constraints.items()],
            )
            for table in ("term", "result"):
                groups = asdict(said)[f"{table}s"]
                connection.executemany(
                    f"INSERT INTO {table} VALUES (?, ?, ?, ?)",
                    [(trial, k, *each) for k, group in enumerate(groups) for each in group.items()],
                )
    connection.close()
    return into


def test_no_damaged_copy_is_read_with_altered_values(study, tmp_path):
    whole = damage.content_of(study)
    found = []
    for seed in range(COPIES):
        place = tmp_path / str(seed)
        kind = damage.damaged_copy(study, place, seed)
        read = damage.came_to(whole, place)
        written = damage.came_to(whole, place, write=True)
        assert read[0] != damage.ALTERED, (seed, kind, read)
        # Whoever goes on with a study needs all of it.
        assert written[0] in (damage.SAME, damage.REFUSED), (seed, kind, written)
        found.append(read[0])
        shutil.rmtree(place)
    assert found.count(damage.NAMED) > COPIES / 5
    assert found.count(damage.SAME) < COPIES / 2


@pytest.mark.parametrize(
    ("statement", "words"),
    [
        (
            "UPDATE evaluation SET outcome = replace(outcome, '.', ',') WHERE trial = 7",
            "evaluation 7 does not match its checksum",
        ),
        ("UPDATE evaluation SET started = started + 1 WHERE trial = 0", "evaluation 0 does not"),
        ("UPDATE evaluation SET phase = x'ff00' WHERE trial = 3", "evaluation 3 does not"),
        ("DELETE FROM evaluation WHERE trial IN (5, 8, 9)", "evaluations 5, 8 to 9 are missing"),
        ("DELETE FROM evaluation WHERE trial > 37", "evaluations 38 to 39 are missing"),
        ("DELETE FROM evaluation", "evaluations 0 to 39 are missing"),
        ("UPDATE study SET value = '8' WHERE key = 'seed'", 'the fact "seed" does not match'),
        ("DELETE FROM study WHERE key = 'seed'", "a fact about the study is missing"),
        ("UPDATE memory SET content = '{}'", "what the search remembers does not match"),
        ("DELETE FROM memory", "what the search remembers is missing"),
        ("UPDATE seal SET evaluations = 39", "the count of evaluations does not match"),
        ("UPDATE study SET value = 'x' WHERE key = 'given_digest'", '"given_digest" does not'),
    ],
)
def test_each_damage_is_named_and_nobody_goes_on_with_it(copy, statement, words):
    changed(copy, statement)
    for attempt in (
        lambda: StudyFolder.open(copy, write=True),
        lambda: _all_of(StudyFolder.open(copy, write=False)),
    ):
        with pytest.raises(StudyDamaged) as caught:
            attempt()
        assert words in str(caught.value)
        assert "bring it back from a copy" in str(caught.value)


def _all_of(folder):
    try:
        return folder.store.records()
    finally:
        folder.close()


def test_what_is_sound_can_still_be_read(copy):
    whole = damage.content_of(copy)
    changed(copy, "UPDATE evaluation SET seconds = 1e9 WHERE trial IN (4, 6)")
    rows, facts, memory, named = damage.content_of(copy)
    assert named == ("evaluations 4, 6 do not match their checksums",)
    assert rows == {trial: row for trial, row in whole[0].items() if trial not in (4, 6)}
    assert (facts, memory) == whole[1:3]


def test_a_study_without_checksums_is_read_with_a_word_and_renewed(study, tmp_path):
    whole = damage.content_of(study)
    old = as_an_old_camring_kept_it(study, tmp_path / "old")
    reader = StudyFolder.open(old, write=False)
    kept = reader.store.sound()
    reader.close()
    assert damage.content_of(old) == whole
    (remark,) = kept.remarks()
    assert remark.startswith("The first 40 evaluations were kept by an older camring")

    fake_study.run(old, budget=45)  # goes on, and is of this version from now on
    fake_study.run(study, budget=45)
    assert fake_study.sequence(old) == fake_study.sequence(study)
    opened = StudyFolder.open(old, write=False)
    again = opened.store.sound()
    opened.close()
    assert again.remarks() == kept.remarks()
    changed(old, "UPDATE evaluation SET seconds = 1e9 WHERE trial = 44")
    assert damage.content_of(old)[3] == ("evaluation 44 does not match its checksum",)


def test_text_that_is_none_in_an_old_study_is_a_sentence(study, tmp_path):
    for place, statement in enumerate(
        (
            "UPDATE evaluation SET design = '{\"motor' WHERE trial = 2",
            "UPDATE evaluation SET phase = CAST(x'ff' AS TEXT) WHERE trial = 2",
            "UPDATE evaluation SET point = x'00' WHERE trial = 2",
        )
    ):
        old = as_an_old_camring_kept_it(study, tmp_path / str(place))
        changed(old, statement)
        assert "evaluation 2 cannot be read" in damage.content_of(old)[3]
        with pytest.raises(InputError, match="evaluation 2 cannot be read"):
            StudyFolder.open(old, write=True)
    old = as_an_old_camring_kept_it(study, tmp_path / "cut")
    changed(old, "DELETE FROM evaluation WHERE trial > 35")
    assert "evaluations are missing beside the 36" in damage.content_of(old)[3][0]


def test_every_kind_of_number_is_seen_by_sql(tmp_path):
    store = Store.create(tmp_path, {})
    outcome = Outcome(
        1.5,
        {"a": -np.inf, "b": np.nan},
        results=({"torque_ripple": 0.1 + 0.2}, {"torque_ripple": np.inf}),
    )
    store.append(Record(0, "given", np.zeros(1), outcome), {})
    store.close()
    with sqlite3.connect(tmp_path / "study.sqlite") as connection:
        limits = connection.execute("SELECT name, value FROM constraint_value").fetchall()
        results = connection.execute("SELECT operating_point, value FROM result").fetchall()
        (objective,) = connection.execute("SELECT objective FROM objective").fetchone()
    connection.close()
    assert limits == [("a", -np.inf), ("b", None)]
    assert results == [(0, 0.1 + 0.2), (1, np.inf)]
    assert objective == 1.5


def test_thirty_thousand_evaluations_are_verified_within_a_second(tmp_path):
    store = Store.create(tmp_path, {})
    results = ({f"result_{k}": k / 7 for k in range(48)},) * 2
    row = Record(0, "descent 1", np.zeros(12), Outcome(1.0, {"a": -1.0}, results=results))
    rest = verified.row_of(row)[1:-1]
    rows = [(trial, *rest, checksum(trial, *rest)) for trial in range(30_000)]
    connection = store._connection
    connection.execute("BEGIN")
    connection.executemany("INSERT INTO evaluation VALUES (?, ?, ?, ?, ?, ?, ?, ?)", rows)
    connection.execute("INSERT INTO memory VALUES (?, ?, ?, ?)", verified.memory_row(29_999, {}))
    connection.execute(
        "INSERT OR REPLACE INTO seal VALUES (?, ?, ?, ?)", verified.seal_row(30_000, [])
    )
    connection.execute("COMMIT")
    began = time.process_time()
    assert verified.damage_in(connection) == []
    took = time.process_time() - began
    store.close()
    print(f"30,000 evaluations verified in {took:.2f} s")
    assert took < 1.0
