"""Copies of a study with flipped bits or cut ends, and what reading one comes to."""

import random
import shutil
from pathlib import Path

from camring.files.errors import CamringError
from camring.studies.study_folder import StudyFolder

SAME, NAMED, REFUSED, ALTERED = "the same", "damage named", "refused in words", "altered"


def damaged_copy(study: Path, place: Path, seed: int) -> str:
    """A copy at `place`, its database damaged by chance; what was done to it."""
    shutil.copytree(study, place)
    chance, path = random.Random(seed), place / "study.sqlite"
    content = bytearray(path.read_bytes())
    kind = ("a bit", "some bits", "zeros", "a cut", "noise")[seed % 5]
    if kind == "a cut":
        del content[chance.randrange(len(content)) :]
    elif kind in ("zeros", "noise"):
        start = chance.randrange(len(content))
        end = min(len(content), start + chance.choice((1, 16, 512, 4096)))
        noise = bytes(end - start) if kind == "zeros" else chance.randbytes(end - start)
        content[start:end] = noise
    else:
        for _ in range(1 if kind == "a bit" else 20):
            content[chance.randrange(len(content))] ^= 1 << chance.randrange(8)
    path.write_bytes(content)
    return kind


def content_of(path: Path, write: bool = False) -> tuple[dict, dict, dict, tuple[str, ...]]:
    """Records by trial, facts, memory, and the damage that the study names."""
    folder = StudyFolder.open(path, write=write)
    try:
        kept = folder.store.sound()
    finally:
        folder.close()
    rows = {
        record.trial: (record.phase, record.point.tobytes(), repr(record.outcome), record.started)
        for record in kept.records
    }
    return rows, kept.facts, kept.memory, kept.damage


def came_to(whole: tuple, path: Path, write: bool = False) -> tuple[str, str]:
    """What reading a damaged copy of a study comes to, and its words."""
    try:
        rows, facts, memory, damage = content_of(path, write)
    except CamringError as error:
        return REFUSED, str(error)
    words = "; ".join(damage)
    if any(whole[0].get(trial) != row for trial, row in rows.items()):
        return ALTERED, words
    if any(whole[1].get(key) != value for key, value in facts.items()):
        return ALTERED, words
    if memory not in ({}, whole[2]):
        return ALTERED, words
    if (rows, facts, memory) == whole[:3]:
        return SAME, words
    return (NAMED if damage else ALTERED), words
