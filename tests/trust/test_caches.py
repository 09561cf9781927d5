"""Kept machine code is run only when it is whole, this user's own, and what was asked for."""

import os
import random
import shutil

import pytest

from camring.programs import compilation_cache, kept_file
from camring.programs.kept_file import SUFFIX, Untrusted, content_of, sealed, write
from camring.programs.kept_program import from_disk

FLIPS = 400


class Trace:
    """Leaves a file where it is unpickled."""

    def __init__(self, place):
        self.place = str(place)

    def __reduce__(self):
        return open, (self.place, "w")


@pytest.fixture
def path(tmp_path):
    found = tmp_path / f"simulate-0123{SUFFIX}"
    write(found, (b"machine code" * 100, ["a tree"]))
    return found


@pytest.fixture
def trap(tmp_path):
    """A program that a stranger made: to read it is to run it."""
    place = tmp_path / f"trap{SUFFIX}"
    write(place, Trace(tmp_path / "it ran"))
    return place


def ran(tmp_path):
    return (tmp_path / "it ran").exists()


def test_what_is_kept_comes_back_and_only_its_owner_may_read_it(path):
    assert content_of(path) == (b"machine code" * 100, ["a tree"])
    assert path.stat().st_mode & 0o777 == 0o600
    assert [each.name for each in path.parent.iterdir()] == [path.name]


def test_no_cut_and_no_flipped_bit_is_believed(path):
    whole, chance = path.read_bytes(), random.Random(20)
    for _ in range(FLIPS):
        spoilt, place = bytearray(whole), chance.randrange(len(whole))
        spoilt[place] ^= 1 << chance.randrange(8)
        path.write_bytes(spoilt)
        with pytest.raises(Untrusted):
            content_of(path)
    for length in range(len(whole)):
        path.write_bytes(whole[:length])
        with pytest.raises(Untrusted):
            content_of(path)


def test_one_program_is_never_taken_for_another(path):
    """Nor that of another version, whose name is another too."""
    other = path.with_name(f"simulate-4567{SUFFIX}")
    shutil.copy(path, other)
    with pytest.raises(Untrusted):
        content_of(other)
    assert from_disk(other, lambda content: content) is None
    path.write_bytes(path.read_bytes().replace(b"version 2", b"version 1"))
    with pytest.raises(Untrusted):
        content_of(path)


@pytest.mark.parametrize("mode", [0o620, 0o602, 0o666, 0o660])
def test_what_others_may_write_is_not_even_unpacked(trap, tmp_path, mode):
    trap.chmod(mode)
    with pytest.raises(Untrusted):
        content_of(trap)
    assert not ran(tmp_path)


@pytest.mark.skipif(os.geteuid() != 0, reason="only root can give a file away")
def test_what_belongs_to_somebody_else_is_not_even_unpacked(trap, tmp_path):
    os.chown(trap, 65534, -1)
    with pytest.raises(Untrusted):
        content_of(trap)
    assert not ran(tmp_path)


def test_somebody_elses_is_known_by_its_owner(trap, tmp_path, monkeypatch):
    """The same where this process is not root."""
    monkeypatch.setattr(kept_file.os, "getuid", lambda: trap.stat().st_uid + 1)
    with pytest.raises(Untrusted):
        content_of(trap)
    assert not ran(tmp_path)


def test_the_trap_would_have_run(trap, tmp_path):
    content_of(trap).close()
    assert ran(tmp_path)


def test_links_pipes_and_folders_are_no_programs(path, trap, tmp_path):
    link, pipe, folder = (tmp_path / f"{name}{SUFFIX}" for name in ("link", "pipe", "folder"))
    link.symlink_to(trap)
    os.mkfifo(pipe)
    folder.mkdir()
    for each in (link, pipe, folder):
        with pytest.raises((Untrusted, OSError)):
            content_of(each)
        assert from_disk(each, lambda content: content) is None
    assert not ran(tmp_path)


def test_a_link_in_the_place_of_a_draft_is_not_followed(path, tmp_path):
    victim = tmp_path / "victim"
    victim.write_text("mine")
    for name in (f".{os.getpid()}", ""):
        path.with_suffix(name or SUFFIX).unlink(missing_ok=True)
    import threading

    path.with_suffix(f".{os.getpid()}{threading.get_ident()}").symlink_to(victim)
    write(path, "content")
    assert content_of(path) == "content"
    assert victim.read_text() == "mine"


def test_a_digest_of_ones_own_helps_no_stranger(path, tmp_path):
    """Anybody can compute the digest; owner and mode are what keeps a stranger out."""
    path.write_bytes(sealed(path.name, Trace(tmp_path / "it ran")))
    path.chmod(0o666)
    assert from_disk(path, lambda content: content) is None
    assert not ran(tmp_path)


def test_what_is_not_this_users_own_is_thrown_out_of_jaxs_store(tmp_path, monkeypatch):
    own, open_, link, folder = (tmp_path / name for name in ("a-cache", "b-cache", "c-cache", "d"))
    for each in (own, open_):
        each.write_bytes(b"code")
    open_.chmod(0o606)
    link.symlink_to(own)
    folder.mkdir()
    compilation_cache._discard_foreign(tmp_path)
    assert {each.name for each in tmp_path.iterdir()} == {"a-cache", "d"}
    monkeypatch.setattr(compilation_cache.os, "getuid", lambda: own.stat().st_uid + 1)
    compilation_cache._discard_foreign(tmp_path)
    assert {each.name for each in tmp_path.iterdir()} == {"d"}
