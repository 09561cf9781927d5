"""Loss of power at instants drawn from all calls of a program, of what was not yet synchronised."""

import argparse
import random
import tempfile
from collections import Counter
from pathlib import Path

import power_cut
from recorded_work import WORK, Record

COUNTS = {"file": 20, "new": 20, "folders": 10, "state": 20, "answers": 20, "study": 60}


def power_cuts(asked: argparse.Namespace) -> int:
    """So many of each kind of file; how many lost or altered anything."""
    wrong = 0
    with tempfile.TemporaryDirectory() as name:
        library = power_cut.recorder(Path(name))
        if library is None:
            print("needs Linux and a C compiler")
            return 1
        for kind in WORK:
            chance, found = random.Random(asked.seed), Counter[str]()
            record = Record(library, Path(name), kind, COUNTS[kind])
            places = [chance.randrange(len(record.changes)) for _ in range(asked.count)]
            draws = Counter(places)
            numbers = {id(change): draws[place] for place, change in enumerate(record.changes)}
            for cut in record.cuts(chance, lambda change, of=numbers: of[id(change)]):
                found[record.fault(*cut) or "sound"] += 1
            calls = f"{len(record.changes)} calls, {sum(draws.values())} cuts"
            print(f"{kind}: {calls}: {dict(found)}", flush=True)
            wrong += asked.count - found["sound"]
    return wrong
