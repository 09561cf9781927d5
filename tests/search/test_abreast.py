"""Searches that take turns: each gets its own answers, in batches, and none is left waiting."""

import threading

import numpy as np
import pytest

from camring.search.parallel_searches import walk_abreast


def squares(points):
    return (points**2,)


def doubles(points):
    return (2 * points,)


def test_everyone_gets_the_answer_to_his_own_question():
    found = {}

    def search(number):
        def run(ask):
            (square,) = ask.values(np.array([float(number)]))
            (double,) = ask.slopes(square)
            found[number] = double[0]

        return run

    searches = iter([search(number) for number in range(10)])
    walk_abreast(lambda: next(searches, None), squares, doubles, seats=4)
    assert found == {number: 2 * number**2 for number in range(10)}


def test_questions_are_answered_together():
    sizes = []

    def counted(points):
        sizes.append(len(points))
        return squares(points)

    def run(ask):
        ask.values(np.zeros(2))
        ask.values(np.ones(2))

    searches = iter([run] * 6)
    walk_abreast(lambda: next(searches, None), counted, doubles, seats=6)
    assert sizes == [6, 6]


def test_a_search_may_follow_from_what_another_found():
    order = []

    def run(ask):
        ask.values(np.zeros(1))
        order.append("found")

    def following():
        if not order and not started:
            started.append(True)
            return run
        return run if order == ["found"] else None

    started = []
    walk_abreast(following, squares, doubles, seats=3)
    assert len(order) >= 2


@pytest.mark.parametrize("who", ["a search", "an answer"])
def test_a_fault_reaches_the_caller_and_no_thread_stays(who):
    def faulty(ask):
        ask.values(np.zeros(1))
        if who == "a search":
            raise ZeroDivisionError
        ask.slopes(np.zeros(1))

    def patient(ask):
        for _ in range(5):
            ask.values(np.ones(1))

    def refused(points):
        raise ZeroDivisionError

    before = threading.active_count()
    searches = iter([patient, patient, faulty])
    with pytest.raises(ZeroDivisionError):
        walk_abreast(
            lambda: next(searches, None),
            squares,
            doubles if who == "a search" else refused,
            seats=3,
        )
    assert threading.active_count() == before
