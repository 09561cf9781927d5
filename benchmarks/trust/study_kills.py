"""`kill -9` of a study of cheap evaluations, at instants drawn from its evaluations.

The store, the folder, the lock and the loop are those of every study; the model is a few sums, so
that a thousand kills take minutes. Each study is killed again and again while it is resumed,
until it ends; then it must be bit for bit the one that nobody killed.
"""

import argparse
import random
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import fake_study

BUDGET = 60
PAUSE = 0.004  # s an evaluation
KILLS_A_STUDY = 12
PROGRAM = Path(fake_study.__file__)


def study_kills(asked: argparse.Namespace) -> int:
    """So many kills; how many lost or altered anything."""
    chance, counts, wrong = random.Random(asked.seed), Counter[str](), 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        fake_study.run(folder / "whole", BUDGET)
        whole = fake_study.sequence(folder / "whole")
        number, kills = 0, 0
        while kills < asked.count:
            study, number = folder / f"study{number}", number + 1
            lost = 0
            for _ in range(min(KILLS_A_STUDY, asked.count - kills)):
                if not _killed(study, chance):
                    counts["ended before the kill"] += 1
                    break
                kills += 1
                rows, _ = fake_study.sequence(study)
                counts[f"{len(rows) // 10}0 and more kept"] += 1
                lost += rows != whole[0][: len(rows)]
            fake_study.run(study, BUDGET)
            if lost or fake_study.sequence(study) != whole:
                print(f"study {number}: not what nobody killed")
                wrong += 1
    print(f"{kills} kills in {number} studies: {dict(sorted(counts.items()))}; {wrong} wrong")
    return wrong


def _killed(study: Path, chance: random.Random) -> bool:
    """Whether a kill came between two evaluations, or in one, of what is left of a study."""
    before = len(fake_study.sequence(study)[0]) if study.exists() else 0
    process = subprocess.Popen(
        [sys.executable, str(PROGRAM), str(study), str(BUDGET), str(PAUSE)],
        stderr=subprocess.DEVNULL,
    )
    while process.poll() is None and not _more_than(study, before):
        time.sleep(0.001)
    # A share of what the evaluations left over take, small so that many kills fit in one study.
    time.sleep(chance.random() * max(1, BUDGET - before) * PAUSE / 4)
    process.kill()
    return process.wait() != 0


def _more_than(study: Path, count: int) -> bool:
    if not (study / "study.sqlite").exists():
        return False
    return len(fake_study.sequence(study)[0]) > count
