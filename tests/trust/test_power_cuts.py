"""Power that goes at any call: what was kept is there when it comes back, whole and unaltered."""

import random
from pathlib import Path

import power_cut
import pytest
from recorded_work import Record

CASES = {"file": 4, "new": 4, "folders": 3, "state": 4, "answers": 4, "study": 6}


@pytest.fixture(scope="module", params=CASES)
def record(request, tmp_path_factory):
    folder = tmp_path_factory.mktemp("power")
    library = power_cut.recorder(folder)
    if library is None:
        pytest.skip("needs Linux and a C compiler: calls are recorded by a library")
    return Record(library, folder, request.param, CASES[request.param])


def test_the_record_is_of_all_that_was_done(record):
    """Played back it gives the files that there are, to the byte."""
    disk = power_cut.Disk(record.below)
    for change in record.changes:
        disk.apply(change)
    there = [path for path in record.below.rglob("*") if path.is_file()]
    assert len(there) > 1
    assert {str(path.relative_to(record.below)): path.read_bytes() for path in there} == {
        name: content for name, content in disk.contents().items() if not name.endswith("/")
    }


def often_where_it_matters(change):
    """Among writes that follow each other a cut is as good before one as before another."""
    return {"sync": 2, "write": 0}.get(change.what, 1)


def test_nothing_acknowledged_is_lost_whatever_of_the_rest_is_kept(record):
    cuts = record.cuts(random.Random(0), often_where_it_matters)
    faults = [fault for cut in cuts if (fault := record.fault(*cut)) is not None]
    assert faults == []


def test_who_synchronises_nothing_loses_something(record):
    """Else a cut would show nothing."""
    lazy = [change for change in record.changes if change.what != "sync"]
    cuts = record.cuts(random.Random(0), lambda change: 1, lazy)
    assert any(record.fault(*cut) is not None for cut in cuts)


def test_a_cut_leaves_sectors_and_first_names():
    disk, below = power_cut.Disk(Path("/below")), Path("/below")

    def does(what, name, place=0, data=b"", other=""):
        disk.apply(power_cut.Change(what, below / name, below / other, place, data))

    does("create", "a")
    does("sync", "")
    does("write", "a", 0, b"1" * 600)
    does("sync", "a")
    does("write", "a", 500, b"2" * 1000)
    does("rename", "a", other="b")
    does("create", "c")
    chance = random.Random(0)
    left = [disk.after_a_cut(chance) for _ in range(400)]
    assert {tuple(sorted(each)) for each in left} == {("a",), ("b",), ("b", "c")}
    contents = {each.get("a", each.get("b")) for each in left}
    # Sectors 500 to 511, 512 to 1023 and 1024 to 1499, each kept or not.
    assert len(contents) == 8
    assert b"1" * 600 in contents
    assert b"1" * 500 + b"2" * 1000 in contents
    does("sync", "")
    assert {tuple(sorted(disk.after_a_cut(chance))) for _ in range(20)} == {("b", "c")}
