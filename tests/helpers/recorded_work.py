"""Work that is recorded for `power_cut.py`, and what must be left of it after any cut.

Also a program: `python recorded_work.py study FOLDER COUNT`. Each time that what it
has done is kept, so far as it can know, it adds a line to `FOLDER/acknowledged`.
"""

import os
import sys
import tempfile
from pathlib import Path
from unittest import mock

import fake_study
import numpy as np
import power_cut

from camring.evaluation import consent
from camring.evaluation.unfinished import Request, Unfinished
from camring.files.errors import CamringError
from camring.files.new_file import whole_folder, write_new_file
from camring.files.whole_file import write_safely
from camring.studies.store import Store
from camring.studio import memory

ACKNOWLEDGED = "acknowledged"
REQUEST = Request("pareto", "[motor]", "motor.toml", {"points": 3})


def study(folder, count, acknowledge):
    plain = Store.append

    def append(*arguments, **named):
        plain(*arguments, **named)
        acknowledge()

    Store.append = append
    fake_study.run(folder / "all" / "study", count)


def study_is_kept(folder, count, acknowledged):
    """All evaluations that were acknowledged, bit for bit, and the study goes on to its end."""
    place, whole = folder / "all" / "study", _whole_study(count)
    if not place.exists():
        assert acknowledged == 0
    else:
        rows, _ = fake_study.sequence(place)
        assert len(rows) >= acknowledged
        assert rows == whole[0][: len(rows)]
    fake_study.run(place, count)
    assert fake_study.sequence(place) == whole


_WHOLE = {}


def _whole_study(count):
    if count not in _WHOLE:
        with tempfile.TemporaryDirectory() as folder:
            fake_study.run(Path(folder) / "study", count)
            _WHOLE[count] = fake_study.sequence(Path(folder) / "study")
    return _WHOLE[count]


def cube(at):
    return (at**3, np.array([len(at)]))


def points(count):
    return [np.linspace(k, k + 1, 50) for k in range(count)]


def answers(folder, count, acknowledge):
    with Unfinished(folder / "front", REQUEST) as unfinished:
        remembered = unfinished.remember("cube", cube)
        for at in points(count):
            remembered(at)
            acknowledge()


def answers_are_kept(folder, count, acknowledged):
    """Whatever of it can be read is right; the last answers may be lost, and are computed again."""
    asked = []

    def noted(at):
        asked.append(at)
        return cube(at)

    with Unfinished(folder / "front", REQUEST) as unfinished:
        remembered = unfinished.remember("cube", noted)
        for at in points(count):
            for found, wanted in zip(remembered(at), cube(at), strict=True):
                np.testing.assert_array_equal(found, wanted)
    assert count - len(asked) >= acknowledged - 1


def file(folder, count, acknowledge):
    for number in range(count):
        write_safely(folder / "file.csv", _content(number))
        acknowledge()


def file_is_kept(folder, count, acknowledged):
    """That of the last time, or of the one under way; never a part."""
    path = folder / "file.csv"
    if acknowledged or path.exists():
        found = path.read_bytes()
        assert found in [_content(number) for number in range(acknowledged - 1, acknowledged + 1)]


def _content(number):
    return b"%d\n" % number * 1000


def new(folder, count, acknowledge):
    for number in range(count):
        write_new_file(folder / f"{number}.toml", _content(number).decode())
        acknowledge()


def new_is_kept(folder, count, acknowledged):
    """Every file, and of the one under way all or nothing."""
    for number in range(count):
        path = folder / f"{number}.toml"
        assert path.exists() or number >= acknowledged
        assert not path.exists() or path.read_bytes() == _content(number)


def folders(folder, count, acknowledge):
    for number in range(count):
        with whole_folder(folder / "all" / str(number)) as draft:
            write_new_file(draft / "front.csv", _content(number).decode())
            (draft / "pictures").mkdir()
            (draft / "pictures" / "front.svg").write_bytes(_content(number))
        acknowledge()


def folders_are_kept(folder, count, acknowledged):
    """Each with all that is in it, or not at all."""
    for number in range(count):
        place = folder / "all" / str(number)
        assert place.exists() or number >= acknowledged
        if place.exists():
            for name in ("front.csv", "pictures/front.svg"):
                assert (place / name).read_bytes() == _content(number)


def state(folder, count, acknowledge):
    os.environ["XDG_STATE_HOME"] = str(folder)
    assert consent._key() is not None
    for number in range(count):
        memory.remember(Path("motor.toml"), memory.Memory.of(str(number), None))
        acknowledge()


def state_is_kept(folder, count, acknowledged):
    """What the studio remembers, and a key that can be used."""
    with mock.patch.dict(os.environ, XDG_STATE_HOME=str(folder)):
        assert consent._key() is not None
        found = memory.recalled(Path("motor.toml"))
    if acknowledged:
        assert found is not None
        assert int(found.texts[0]) in (acknowledged - 1, acknowledged)


WORK = {
    "new": (new, new_is_kept),
    "folders": (folders, folders_are_kept),
    "state": (state, state_is_kept),
    "study": (study, study_is_kept),
    "answers": (answers, answers_are_kept),
    "file": (file, file_is_kept),
}


class Record:
    """One such work from its first call to its last, and what power cuts leave of it."""

    def __init__(self, library, folder, name, count):
        self.name, self.count = name, count
        self.below, log = folder / name, folder / f"{name}.log"
        self.below.mkdir()
        paths = [*sys.path, str(Path(__file__).parent)]
        power_cut.recorded(
            library,
            self.below,
            log,
            __file__,
            name,
            str(self.below),
            str(count),
            PYTHONPATH=os.pathsep.join(each for each in paths if each),
        )
        self.changes = list(power_cut.changes(log))

    def cuts(self, chance, draws, changes=None):
        """How many calls were acknowledged, and what is left, several times before each call."""
        disk = power_cut.Disk(self.below)
        for change in self.changes if changes is None else changes:
            acknowledged = disk.contents().get(ACKNOWLEDGED, b"").count(b"\n")
            for _ in range(draws(change)):
                left = disk.after_a_cut(chance)
                left.pop(ACKNOWLEDGED, None)
                yield acknowledged, left
            disk.apply(change)

    def fault(self, acknowledged, left):
        """What is wrong with what is left; None where nothing is."""
        with tempfile.TemporaryDirectory() as name:
            power_cut.laid_out(left, Path(name))
            try:
                WORK[self.name][1](Path(name), self.count, acknowledged)
            except (AssertionError, CamringError, OSError) as error:
                return f"{type(error).__name__}: {error}"
        return None


if __name__ == "__main__":
    name, where, times = sys.argv[1], Path(sys.argv[2]), int(sys.argv[3])
    line = os.open(where / ACKNOWLEDGED, os.O_CREAT | os.O_WRONLY | os.O_APPEND)
    try:
        WORK[name][0](where, times, lambda: os.write(line, b"kept\n"))
    except CamringError as error:
        sys.exit(str(error))
