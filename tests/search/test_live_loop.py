"""Loops that wait in a thread: what they ask, how they end, when they begin anew."""

import pickle
import threading
import time
from functools import partial

import numpy as np
import pytest

from camring.search.live_loop import HeldLoop
from camring.search.problem import Evaluation
from camring.search.replay import Unknown

NAME = "camring-optimiser"


def evaluation(trial, place):
    return Evaluation(trial, np.array([place]), place**2, np.zeros(0))


def sum_of_three(history, ask):
    """Asks for a quarter, a half and three quarters, unless they are known."""
    known = {float(each.point[0]): each for each in history}
    places = (0.25, 0.5, 0.75)
    return sum((known.get(at) or ask(np.array([at]))).objective for at in places)


def asked(held, history, name=0, loop=sum_of_three):
    try:  # not `pytest.raises`, which keeps the traceback and so the holder
        held.continued(partial(loop, history), history, name)
    except Unknown as unknown:
        return float(unknown.point[0])
    raise AssertionError("the loop has asked for nothing")


def waiting():
    return sum(each.name == NAME for each in threading.enumerate())


def ended():
    """Whether all loops have ended, which takes another thread a moment."""
    for _ in range(200):
        if not waiting():
            return True
        time.sleep(0.01)
    return False


def test_a_loop_is_asked_from_where_it_waits_to_its_end():
    held, history = HeldLoop(), []
    for trial, place in enumerate((0.25, 0.5, 0.75)):
        assert asked(held, history) == place
        history.append(evaluation(trial, place))
        # Nothing of the loop runs twice: with this one in its place it would fail.
    assert held.continued(partial(int, "no number"), history, 0) == 0.25**2 + 0.5**2 + 0.75**2
    assert ended()


def test_another_history_or_another_name_begins_anew():
    held, history = HeldLoop(), []
    assert asked(held, history) == 0.25
    others = [evaluation(0, 0.5)]
    assert asked(held, others) == 0.25
    assert asked(held, others, name=1) == 0.25
    again = [evaluation(0, 0.5), evaluation(1, 0.25)]  # equal numbers, another study's
    assert asked(held, again, name=1) == 0.75
    held.forget()
    assert ended()


def test_a_holder_that_is_forgotten_ends_its_loop():
    held = HeldLoop()
    asked(held, [])
    assert waiting() == 1
    del held
    assert ended()


def test_what_a_loop_raises_is_raised_where_it_is_awaited():
    with pytest.raises(ValueError, match="no number"):
        HeldLoop().continued(lambda ask: float("no number"), [], 0)


def test_a_holder_travels_empty():
    held = HeldLoop()
    asked(held, [])
    assert asked(pickle.loads(pickle.dumps(held)), []) == 0.25
    held.forget()
    assert ended()
