"""The second solver in a process of its own says what it says here, or what is wrong."""

import pickle
import subprocess
import sys
from dataclasses import replace

import pytest
from motors import STRUCTURES, sound_case

from camring.reference import OrbitError, independent_results, machine_of
from camring.studies import reference_processes
from camring.studies.reference_processes import COMMAND, SecondSolver

CASE = sound_case(0, STRUCTURES[0])
HARMONICS, TOLERANCE = 60, 1e-5


@pytest.fixture(scope="module")
def here() -> dict[str, float]:
    return independent_results(*CASE, HARMONICS, TOLERANCE)


def test_its_numbers_are_those_of_this_process_to_the_last_bit(here):
    with SecondSolver() as second:
        pending = [second.begin(*CASE, HARMONICS, TOLERANCE) for _ in range(2)]
        assert [each.result() for each in pending] == [here, here]
        assert all(each.process.poll() is None for each in second.children)


def test_what_it_cannot_be_sent_is_solved_here(here, monkeypatch):
    def with_a_law_of_its_own(*nouns):
        machine = machine_of(*nouns)
        return replace(machine, user_leakage=lambda inside, outside: 0.0)

    monkeypatch.setattr(reference_processes, "machine_of", with_a_law_of_its_own)
    with SecondSolver() as second:
        assert second.begin(*CASE, HARMONICS, TOLERANCE).result() == here
        assert all(each.process is None for each in second.children)


def test_one_that_dies_or_cannot_begin_costs_time_alone(here, monkeypatch):
    with SecondSolver() as second:
        for each in second.children:
            each.running().kill()
        assert second.begin(*CASE, HARMONICS, TOLERANCE).result() == here
    monkeypatch.setattr(sys, "executable", "/no/such/python")
    with SecondSolver() as second:
        assert second.begin(*CASE, HARMONICS, TOLERANCE).result() == here


def test_a_motor_without_a_periodic_pressure_is_said_to_have_none(monkeypatch):
    """The sentence comes from the process, not from a second attempt here."""
    machine = replace(machine_of(*CASE), leakage_coefficient=0.0, port_area=0.0)
    monkeypatch.setattr(reference_processes, "machine_of", lambda *nouns: machine)
    monkeypatch.setattr(
        reference_processes, "independent_results", lambda *rest: pytest.fail("here")
    )
    with SecondSolver() as second, pytest.raises(OrbitError, match="neither leaks"):
        second.begin(*CASE, HARMONICS, TOLERANCE).result()


def test_it_ends_with_whoever_started_it_in_the_middle_of_a_machine():
    """The end of that process closes the pipe, whatever has ended it."""
    command = [sys.executable, *COMMAND]
    child = subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
    for _ in range(1000):  # as much work as nobody would wait for
        child.stdin.write(pickle.dumps((machine_of(*CASE), HARMONICS, 1e-9)))
    child.stdin.close()
    answered = child.stdout.read()
    assert child.wait() == 0
    assert len(answered) < 1e5
