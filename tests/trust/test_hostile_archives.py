"""A stranger's FMU is unpacked into its folder, in bounded space, or refused in a sentence."""

import stat
from zipfile import ZIP_DEFLATED, ZipFile, ZipInfo
from zlib import crc32

import pytest

from camring.evaluation.user_programs.fmu import Mapped, evaluated
from camring.files import archive
from camring.files.archive import LARGEST_UNPACKED, require_harmless
from camring.files.errors import InputError

MAPPING = 'fmu = "a.fmu"\nuntil = "1 s"\nstep = "1 ms"\nparameters = {}\nresults = {}\n'


def packed(path, *names, content=b"x"):
    with ZipFile(path, "w", ZIP_DEFLATED) as file:
        for name in names:
            file.writestr(name if isinstance(name, ZipInfo) else ZipInfo(name), content)
    return path


def link(name):
    found = ZipInfo(name)
    found.external_attr = (stat.S_IFLNK | 0o777) << 16
    return found


@pytest.mark.parametrize(
    ("name", "words"),
    [
        ("../evil.so", "leads elsewhere"),
        ("binaries/../../evil.so", "leads elsewhere"),
        ("..\\evil.so", "leads elsewhere"),
        ("/etc/evil", "leads elsewhere"),
        ("C:/evil", "leads elsewhere"),
        ("a\x1b[2J", "leads elsewhere"),
        (link("resources"), "is a link"),
    ],
)
def test_a_path_that_climbs_out_is_refused(tmp_path, name, words):
    with pytest.raises(InputError, match=words) as caught:
        require_harmless(packed(tmp_path / "a.fmu", "modelDescription.xml", name))
    assert str(caught.value).isprintable()


def test_a_thousand_megabytes_in_one_are_refused_before_they_are_unpacked(tmp_path):
    """A megabyte whose archive says that it is a thousand; `benchmarks.trust` packs the whole."""
    large = packed(tmp_path / "a.fmu", "resources/zeros", content=bytes(1_000_000))
    said, wanted = ((10**each).to_bytes(4, "little") for each in (6, 9))
    large.write_bytes(large.read_bytes().replace(said, wanted))
    with pytest.raises(InputError, match="1,000,000,000 bytes, more than"):
        require_harmless(large)
    (tmp_path / "map.toml").write_text(MAPPING)
    pytest.importorskip("fmpy", reason="the extra camring[fmu]")
    document = {"motor_file": str(tmp_path / "out" / "motor.toml"), "points": []}
    with pytest.raises(InputError, match="1,000,000,000 bytes, more than"):
        evaluated(Mapped.read(tmp_path / "map.toml"), document)
    assert not (tmp_path / "out").exists()


def test_an_archive_that_says_less_than_it_holds_gives_no_more_than_it_says(tmp_path):
    """So that the sizes in its list are a bound."""
    path = packed(tmp_path / "a.fmu", "x", content=bytes(100_000))
    whole = path.read_bytes()
    for true, said in ((100_000, 10), (crc32(bytes(100_000)), crc32(bytes(10)))):
        whole = whole.replace(true.to_bytes(4, "little"), said.to_bytes(4, "little"))
    path.write_bytes(whole)
    require_harmless(path)
    with ZipFile(path) as file:
        assert file.read("x") == bytes(10)


@pytest.mark.parametrize("content", [b"", b"no archive", b"PK\x05\x06" + bytes(3)])
def test_what_is_no_archive_is_refused(tmp_path, content):
    path = tmp_path / "a\x1b[2J.fmu"
    path.write_bytes(content)
    with pytest.raises(InputError, match="no archive") as caught:
        require_harmless(path)
    assert str(caught.value).isprintable()


def test_too_many_files_or_too_long_a_description_are_refused(tmp_path, monkeypatch):
    monkeypatch.setattr(archive, "MOST_FILES", 3)
    with pytest.raises(InputError, match="4 files"):
        require_harmless(packed(tmp_path / "a.fmu", *"abcd"))
    monkeypatch.setattr(archive, "LARGEST_DESCRIPTION", 10)
    with pytest.raises(InputError, match="XML in one file"):
        require_harmless(packed(tmp_path / "b.fmu", "modelDescription.xml", content=bytes(11)))
    assert LARGEST_UNPACKED < 1_000_000_000
