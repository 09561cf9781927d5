"""The newest position of the hand wins, and what comes later belongs to it."""

import threading
import time
from dataclasses import replace

import numpy as np
import pytest

from camring.files.motor import parse_motor_file
from camring.files.starting.library import library
from camring.metrics.shown import METRICS
from camring.metrics.summary import Metrics
from camring.numerics.quantity import real
from camring.objective.constraints import violations
from camring.studio import engine as engines
from camring.studio.engine import Asked, Engine
from camring.studio.evaluation import Evaluated, limits_of
from camring.studio.frames import unpacked
from camring.studio.moved_design import Movable

FILE = parse_motor_file(library()["wheel"])
SYSTEM = Movable(FILE).system
ROW = np.linspace(0.1, 0.2, len(METRICS))


@pytest.fixture
def posted(monkeypatch):
    """An engine whose simulation takes a hundredth of a second, and what it has posted."""

    def slow(system, goal):
        time.sleep(0.01)
        return Evaluated(system, (), (), np.stack([ROW, ROW]), {"a": -0.5}, "words")

    def at_rest(system, goal):
        return replace(slow(system, goal), cycles=("a cycle",))

    monkeypatch.setattr(engines, "followed", slow)
    monkeypatch.setattr(engines, "evaluated", at_rest)
    messages, engine = [], Engine(lambda message: messages.append(unpacked(message)[0]))
    engine.start()
    yield engine, messages
    engine.stop()


def asked(number):
    return lambda: Asked(number, FILE, SYSTEM, np.zeros(3), 0, None)


def test_only_the_newest_of_what_waits_is_answered_and_always_the_last(posted):
    engine, messages = posted
    for number in range(1, 101):
        engine.follow(asked(number))
        time.sleep(0.001)
    deadline = time.monotonic() + 10
    while not (messages and messages[-1]["number"] == 100) and time.monotonic() < deadline:
        time.sleep(0.005)
    numbers = [each["number"] for each in messages if not each["rest"]]
    assert numbers[-1] == 100
    assert numbers == sorted(set(numbers))
    assert len(numbers) < 100


def test_a_hand_that_rests_is_answered_once_more_by_the_solver_of_every_command(posted):
    engine, messages = posted
    for number in range(1, 6):
        engine.follow(asked(number))
        time.sleep(0.02)
    deadline = time.monotonic() + 10
    while not any(each["rest"] for each in messages) and time.monotonic() < deadline:
        time.sleep(0.005)
    assert [each["number"] for each in messages if each["rest"]] == [5]


def test_what_must_be_done_is_done_in_order_and_before_what_waits(posted):
    engine, _ = posted
    done, gate = [], threading.Event()
    engine.run(gate.wait)
    engine.follow(asked(1))
    futures = [engine.run(lambda k=k: done.append(k)) for k in range(5)]
    gate.set()
    for each in futures:
        each.result(10)
    assert done == [0, 1, 2, 3, 4]


def test_a_design_of_which_nothing_can_be_said_ends_nothing(posted):
    engine, messages = posted

    def wrong():
        raise ValueError("no such number")

    engine.follow(wrong)
    while not messages:
        time.sleep(0.005)
    assert messages[0]["type"] == "trouble"
    engine.follow(asked(2))
    while len(messages) < 2:
        time.sleep(0.005)
    assert messages[1]["number"] == 2


def test_limits_on_the_page_are_those_of_the_search():
    rows = np.stack([ROW, 2 * ROW])
    metrics = tuple(
        Metrics(**{name: real(value) for name, value in zip(METRICS, row, strict=True)})
        for row in rows
    )
    wanted = violations(FILE.goal.constraints, FILE.system, metrics)
    found = limits_of(SYSTEM, FILE.goal.constraints, rows)
    assert list(found) == list(wanted)
    np.testing.assert_allclose(list(found.values()), [float(g) for g in wanted.values()])
