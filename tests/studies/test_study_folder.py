"""A study folder is refused in one sentence, with a way out, and nothing is overwritten."""

import errno
import fcntl
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import fake_study
import pytest

from camring.files.errors import InputError
from camring.files.whole_file import write_safely
from camring.studies.database import StudyError
from camring.studies.study_folder import StudyFolder, unwritable


@pytest.fixture
def study(tmp_path):
    folder = tmp_path / "study"
    fake_study.run(folder, budget=5)
    return folder


def tree(folder):
    return {path: path.read_bytes() for path in sorted(folder.rglob("*")) if path.is_file()}


def test_the_motor_file_is_kept_byte_for_byte(tmp_path):
    given = b"\xef\xbb\xbf# mark, tab\t, no end of line at the end\r\nx = 1"
    StudyFolder.create(tmp_path / "study", given, {}).close()
    assert (tmp_path / "study" / "given.toml").read_bytes() == given


def test_a_closed_study_is_one_database_and_the_motor_file(study):
    names = {path.name for path in study.iterdir()}
    assert names == {".lock", "given.toml", "study.sqlite"}
    assert [path.name for path in study.parent.iterdir()] == ["study"]


@pytest.mark.parametrize("kind", ["study", "folder", "empty folder", "file", "dangling link"])
def test_what_exists_is_never_replaced(tmp_path, study, kind):
    place = tmp_path / "place"
    if kind == "study":
        shutil.copytree(study, place)
    elif kind in ("folder", "empty folder"):
        place.mkdir()
        if kind == "folder":
            (place / "thesis.txt").write_text("three years of work")
    elif kind == "file":
        place.write_text("three years of work")
    else:
        place.symlink_to(tmp_path / "nowhere")
    before = tree(tmp_path)
    with pytest.raises(InputError) as caught:
        StudyFolder.create(place, fake_study.GIVEN, {})
    assert ("holds a study already" if kind == "study" else "exists") in str(caught.value)
    assert tree(tmp_path) == before


def test_a_changed_motor_file_is_refused(study):
    path = study / "given.toml"
    path.write_bytes(path.read_bytes().replace(b"8", b"9"))
    for write in (True, False):
        with pytest.raises(InputError, match="is not the motor file that this study began with"):
            StudyFolder.open(study, write=write)
    path.write_bytes(fake_study.GIVEN)
    StudyFolder.open(study, write=True).close()


def test_a_missing_motor_file_is_refused(study):
    (study / "given.toml").unlink()
    with pytest.raises(InputError, match="cannot be read"):
        StudyFolder.open(study, write=True)


def test_a_folder_in_use_is_refused_and_can_still_be_read(study):
    first = StudyFolder.open(study, write=True)
    with pytest.raises(InputError, match=f"is in use by process {os.getpid()} on"):
        StudyFolder.open(study, write=True)
    assert len(fake_study.sequence(study)[0]) == 5
    first.close()
    StudyFolder.open(study, write=True).close()


def test_an_error_on_opening_does_not_keep_the_lock(study):
    original = (study / "given.toml").read_bytes()
    (study / "given.toml").write_bytes(b"changed")
    with pytest.raises(InputError):
        StudyFolder.open(study, write=True)
    (study / "given.toml").write_bytes(original)
    StudyFolder.open(study, write=True).close()


@pytest.mark.parametrize("kind", ["nothing", "folder", "file"])
def test_what_is_no_study_is_refused(tmp_path, kind):
    place = tmp_path / "place"
    if kind == "folder":
        place.mkdir()
    elif kind == "file":
        place.write_text("text")
    for write in (True, False):
        with pytest.raises(InputError, match=r"(holds no study|is no folder of a study)"):
            StudyFolder.open(place, write=write)


def test_missing_parents_are_made(tmp_path):
    StudyFolder.create(tmp_path / "a" / "b" / "study", fake_study.GIVEN, {}).close()


def test_a_parent_that_is_a_file_is_refused(tmp_path):
    (tmp_path / "file").write_text("text")
    with pytest.raises(InputError, match="cannot be written"):
        StudyFolder.create(tmp_path / "file" / "study", fake_study.GIVEN, {})


AS_NOBODY = """
import sys
sys.path[:0] = {path!r}
import os
from pathlib import Path
from camring.studies.study_folder import StudyFolder
from camring.files.errors import InputError
if os.geteuid() == 0:
    os.setgid(65534)
    os.setuid(65534)
study = Path({study!r})
reader = StudyFolder.open(study, write=False)
print(len(reader.store.records()))
reader.close()
for attempt in (
    lambda: StudyFolder.open(study, write=True),
    lambda: StudyFolder.create(study / "inner", b"", {{}}),
):
    try:
        attempt()
    except InputError as error:
        print(error)
"""


def test_a_read_only_study_can_be_read_and_is_not_written(study):
    above = [path for path in study.parents if Path(tempfile.gettempdir()) in path.parents]
    modes = {path: path.stat().st_mode for path in (study, *above)}
    try:
        for path in modes:
            path.chmod(0o755)
        for path in study.iterdir():
            path.chmod(0o444)
        study.chmod(0o555)
        program = AS_NOBODY.format(path=sys.path, study=str(study))
        done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    finally:
        for path, mode in modes.items():
            path.chmod(mode)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[0] == "5"
    assert len(lines) == 3
    assert all("cannot be written" in line for line in lines[1:])


@pytest.mark.parametrize("number", [errno.ENOLCK, errno.ENOSYS, errno.EOPNOTSUPP])
def test_a_disk_that_keeps_no_locks_is_reported(tmp_path, monkeypatch, number):
    """Lustre without -o flock, an NFS server without lockd."""

    def refuse(*_):
        raise OSError(number, os.strerror(number))

    monkeypatch.setattr(fcntl, "flock", refuse)
    with pytest.raises(InputError, match=r"keeps no locks.*a disk of this machine"):
        StudyFolder.create(tmp_path / "study", fake_study.GIVEN, {})
    assert not list(tmp_path.iterdir())


def test_a_file_is_whole_or_untouched(tmp_path, monkeypatch):
    path = tmp_path / "best.toml"
    write_safely(path, b"old")

    def full(_):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(OSError, match="No space") as caught:
        write_safely(path, b"new" * 1000)
    assert path.read_bytes() == b"old"
    assert [each.name for each in tmp_path.iterdir()] == ["best.toml"]
    assert isinstance(unwritable(path, caught.value), StudyError)
    assert unwritable(path, caught.value).exit_code == 1
