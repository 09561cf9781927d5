"""A disk that takes no more, a folder that is gone: a sentence, and nothing that looks complete."""

import os
import shutil

import fake_study
import pytest
import report_example
from scarce_disk import content_of, no_file_beyond

from camring.exchange.waveforms.file import ENDINGS, write_waveforms
from camring.files import new_file
from camring.files.errors import CamringError
from camring.files.new_file import write_new_file
from camring.files.whole_file import write_safely
from camring.plots.style import save
from camring.report.write import write_page
from camring.studies.database import StudyError
from camring.studies.study_folder import StudyFolder, unwritable

TEXT = "a line of text\n" * 1000


def in_words(write):
    """A writer whose caller puts an `OSError` in words, as callers of `write_safely` do."""

    def wrapped(place):
        try:
            write(place)
        except OSError as error:
            raise unwritable(place, error) from error

    return wrapped


@pytest.fixture(scope="module")
def writers(simulated):
    """Everything that puts a file in place, each with a name that it takes."""
    import matplotlib.pyplot as pyplot

    system, cycles = simulated
    page, figure = report_example.make_report(), pyplot.figure()
    figure.add_subplot().plot([0, 1], [0, 1])
    waves = {
        f"waves{ending}": lambda place: write_waveforms(place, system, cycles, samples=36)
        for ending in ENDINGS
    }
    return {
        "new.csv": lambda place: write_new_file(place, TEXT),
        "replaced.csv": lambda place: write_new_file(place, TEXT, replace=True),
        "best.toml": in_words(lambda place: write_safely(place, TEXT.encode())),
        "report.html": lambda place: write_page(place, page),
        **{f"figure{ending}": lambda place: save(figure, place) for ending in (".png", ".svg")},
        **waves,
    }


NAMES = ["new.csv", "replaced.csv", "best.toml", "report.html", "figure.png", "figure.svg"]
NAMES += [f"waves{ending}" for ending in ENDINGS]


@pytest.mark.parametrize("name", NAMES)
def test_a_full_disk_leaves_what_was_there_and_says_so(writers, tmp_path, name):
    """Full after no byte, after a thousand, and near the end; where nothing stood, and where."""
    writers[name](tmp_path / name)
    whole = {each: len(content) for each, content in content_of(tmp_path).items()}
    size = max(whole.values())
    for old, limit in ((False, 0), (False, size - 200), (True, 1000)):
        shutil.rmtree(tmp_path)
        tmp_path.mkdir()
        if old and name != "new.csv":
            writers[name](tmp_path / name)
        before = content_of(tmp_path)
        with no_file_beyond(limit), pytest.raises(CamringError) as caught:
            writers[name](tmp_path / name)
        assert str(caught.value).isprintable()
        assert content_of(tmp_path) == before, limit


@pytest.mark.parametrize("name", ["new.csv", "replaced.csv", "best.toml", "figure.png"])
def test_what_is_in_place_is_readable_like_any_other_file(writers, tmp_path, name):
    writers[name](tmp_path / name)
    mask = os.umask(0)
    os.umask(mask)
    assert (tmp_path / name).stat().st_mode & 0o777 == 0o666 & ~mask


def test_where_files_have_one_name_only_they_are_written_in_place(tmp_path, monkeypatch):
    def no_links(*_):
        raise OSError(new_file.NO_LINKS[0], "no links here")

    monkeypatch.setattr(new_file.os, "link", no_links)
    write_new_file(tmp_path / "a.csv", TEXT)
    assert content_of(tmp_path) == {"a.csv": TEXT.encode()}
    with pytest.raises(CamringError, match="exists"):
        write_new_file(tmp_path / "a.csv", "other")
    assert content_of(tmp_path) == {"a.csv": TEXT.encode()}


class Vandal:
    """An evaluator that does something to the study's folder at its tenth evaluation."""

    def __init__(self, deed):
        self.deed, self.count = deed, 0

    def __call__(self, point):
        self.count += 1
        if self.count == 10:
            self.deed()
        return fake_study.evaluate(point)


@pytest.mark.parametrize("deed", ["removed", "moved", "replaced by a link", "replaced by a copy"])
def test_a_study_whose_folder_is_gone_stops_in_a_sentence_and_writes_nowhere_else(tmp_path, deed):
    """What was kept before is kept: in the folder, wherever that is now."""
    study, moved, other = (tmp_path / name for name in ("study", "moved", "other"))
    fake_study.run(other, budget=5)
    before = content_of(other)

    def vandalise():
        if deed == "removed":
            shutil.rmtree(study)
            return
        study.rename(moved)
        if deed == "replaced by a link":
            study.symlink_to(other)
        elif deed == "replaced by a copy":
            shutil.copytree(other, study)

    with pytest.raises(StudyError, match="removed, moved or replaced"):
        fake_study.run(study, budget=30, evaluator=Vandal(vandalise))
    assert content_of(other) == before
    if deed == "replaced by a copy":
        assert content_of(study) == before
    if moved.exists():
        fake_study.run(moved, budget=30)
        fake_study.run(tmp_path / "straight", budget=30)
        assert fake_study.sequence(moved) == fake_study.sequence(tmp_path / "straight")


@pytest.mark.skipif(os.geteuid() == 0, reason="root may write everywhere")
def test_a_read_only_folder_is_said_before_anything_is_written(tmp_path):
    tmp_path.chmod(0o500)
    with pytest.raises(CamringError, match="cannot be written"):
        StudyFolder.create(tmp_path / "study", fake_study.GIVEN, {})
    with pytest.raises(CamringError, match="cannot be written"):
        write_new_file(tmp_path / "a.csv", TEXT)
    tmp_path.chmod(0o700)
