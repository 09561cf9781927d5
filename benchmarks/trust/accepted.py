"""Accepted motor files by the thousand: read, and simulated by structures whose program is kept."""

import argparse
import random
import resource
import time
from collections import Counter
from typing import Any

import accepted_motors
import jax
import numpy as np

from camring.files.errors import InputError
from camring.files.motor import MotorFile, parse_motor_file
from camring.files.motor.writer import whole_text

SLOWEST_READ, SLOWEST_SIMULATION = 5.0, 60.0  # s
MOST_MEMORY = 4 * 2**30  # bytes
STRUCTURES = 4
WIDTH = 0.15
"""Powers of ten by which a number of an ordinary motor is changed."""
NEVER_FINITE = {"l10_life", "max_contact_stress"}
"""Without load a bearing lives for ever; at an undercut line contact has no bound."""


def files(asked: argparse.Namespace) -> int:
    """So many files through the reader; how many broke a promise."""
    counts, wrong, slowest = Counter[str](), 0, (0.0, -1)
    for seed in range(asked.first, asked.count):
        text = whole_text(accepted_motors.accepted(seed + 10_000_000 * asked.seed))
        began = time.process_time()
        try:
            file = parse_motor_file(text)
        except InputError as error:
            counts[error.field.split(",")[0]] += 1
            if not str(error).isprintable():
                print(f"{seed}: {error!r}")
                wrong += 1
            continue
        except Exception as error:
            print(f"{seed}: {type(error).__name__}: {error}")
            wrong += 1
            continue
        slowest = max(slowest, (time.process_time() - began, seed))
        counts["accepted"] += 1
        if not _finite(file):
            print(f"{seed}: a number is not finite")
            wrong += 1
    print(f"{sum(counts.values())} files: {dict(counts.most_common())}")
    print(f"slowest: {slowest[0]:.3f} s of processor time (seed {slowest[1]})")
    return wrong + (slowest[0] > SLOWEST_READ)


def _finite(file: MotorFile) -> bool:
    motor = file.system.motor
    return all(
        leaf is motor.given_reference_radius or np.all(np.isfinite(np.asarray(leaf)))
        for leaf in jax.tree.leaves(file.system)
    )


def simulations(asked: argparse.Namespace) -> int:
    """So many motors through `simulate`, by a few structures; how many broke a promise."""
    from camring.analyses.simulation import simulated

    chance = random.Random(asked.seed)
    documents = [_plain(seed + 1000 * asked.seed) for seed in range(STRUCTURES)]
    counts, wrong, slowest = Counter[str](), 0, 0.0
    seen: set[int] = set()
    for number in range(asked.count):
        place = number * STRUCTURES // asked.count  # one structure after the other, for memory
        text = whole_text(_varied(documents[place], chance))
        if number < asked.first:
            continue
        try:
            file = parse_motor_file(text)
        except InputError:
            counts["refused by the reader"] += 1
            continue
        began = time.perf_counter()
        found = simulated(file, estimate=False)
        seconds = time.perf_counter() - began
        if place in seen:
            slowest = max(slowest, seconds)
        seen.add(place)
        if found.outcome.failure:
            counts["a verdict"] += 1
            continue
        bad = {
            name
            for results in found.outcome.results
            for name, value in results.items()
            if not np.isfinite(value) and name not in NEVER_FINITE
        }
        counts["results"] += not bad
        if bad:
            print(f"{number}: {sorted(bad)} without a verdict")
            wrong += 1
    memory = 1024 * resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    print(f"{asked.count - asked.first} motors of {len(seen)} structures: {dict(counts)}")
    print(f"slowest after compiling {slowest:.2f} s; memory {memory / 2**30:.2f} GiB")
    return wrong + (slowest > SLOWEST_SIMULATION) + (memory > MOST_MEMORY)


def _plain(seed: int) -> dict[str, Any]:
    document = accepted_motors.accepted(seed, width=0.3, most=12)
    del document["operating_points"][1:]
    document["operating_points"][0].pop("mode", None)
    document["motor"].pop("modes", None)
    return document


def _varied(value: Any, chance: random.Random) -> Any:
    """Every number but counts by a factor of its own; a list keeps its shape."""
    if isinstance(value, dict):
        return {name: _varied(each, chance) for name, each in value.items()}
    if isinstance(value, list) and value and isinstance(value[0], float):
        low, high = min(value), max(value)
        rise = 10 ** chance.uniform(-WIDTH, WIDTH)
        return [low + rise * (each - low) for each in value] if low > 0 < high - low else value
    if isinstance(value, list):
        return [_varied(each, chance) for each in value]
    if isinstance(value, float):
        return value * 10 ** chance.uniform(-WIDTH, WIDTH)
    return value
