"""Compiled programs are kept privately, and nothing fails where they cannot be kept."""

import os
import subprocess
import sys

import pytest

from camring.programs.compilation_cache import MARKER_SUFFIX, SWITCH, private_folder

COMPILES = """
from camring.programs.compilation_cache import keep_compiled_programs
print(keep_compiled_programs())
import jax, jax.numpy as jnp
print(jax.jit(lambda x: jnp.sin(x) * 2)(jnp.arange(3.0)).sum() > 0)
"""


@pytest.fixture
def home(tmp_path, monkeypatch):
    monkeypatch.delenv(SWITCH, raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / "cache"))
    return tmp_path / "cache"


def compile_in_another_process(**changes):
    environment = {**os.environ, **{name: str(value) for name, value in changes.items()}}
    done = subprocess.run(
        [sys.executable, "-c", COMPILES], capture_output=True, text=True, env=environment
    )
    assert done.returncode == 0, done.stderr
    folder, worked = done.stdout.splitlines()
    assert worked == "True"
    return folder, done.stderr


def entries(home):
    return [path for path in home.rglob("*-cache") if path.is_file()]


def test_what_is_compiled_is_kept_in_a_folder_of_mode_0700(home):
    folder, said = compile_in_another_process()
    assert folder.startswith(str(home))
    assert said == ""
    assert entries(home)
    for level in (home / "camring", *(home / "camring").iterdir()):
        assert level.stat().st_mode & 0o777 == 0o700
    before = {path: path.stat().st_mtime_ns for path in entries(home)}
    compile_in_another_process()
    assert {path: path.stat().st_mtime_ns for path in entries(home)} == before
    assert not list(home.rglob(f"*{MARKER_SUFFIX}"))


def test_it_can_be_switched_off(home):
    folder, _ = compile_in_another_process(**{SWITCH: "off"})
    assert folder == "None"
    assert not home.exists()


@pytest.mark.parametrize("word", ["off", "0", "OFF", "no"])
def test_there_are_many_words_for_off(home, monkeypatch, word):
    monkeypatch.setenv(SWITCH, word)
    assert private_folder() is None
    assert not home.exists()


def test_it_can_be_put_elsewhere(home, tmp_path):
    folder, _ = compile_in_another_process(**{SWITCH: tmp_path / "elsewhere"})
    assert folder.startswith(str(tmp_path / "elsewhere"))


def test_a_home_that_cannot_be_written_is_no_error(tmp_path):
    # A file in the way refuses root too, whom permissions do not stop.
    (tmp_path / "file").write_text("")
    folder, said = compile_in_another_process(XDG_CACHE_HOME=tmp_path / "file" / "cache")
    assert folder == "None"
    assert said == ""


@pytest.mark.skipif(os.geteuid() == 0, reason="permissions do not stop root")
def test_a_read_only_home_is_no_error(tmp_path):
    tmp_path.chmod(0o555)
    folder, said = compile_in_another_process(XDG_CACHE_HOME=tmp_path / "cache")
    tmp_path.chmod(0o755)
    assert folder == "None"
    assert said == ""


def test_no_home_at_all_is_no_error(monkeypatch):
    monkeypatch.delenv(SWITCH, raising=False)
    monkeypatch.delenv("XDG_CACHE_HOME", raising=False)
    monkeypatch.setattr("pathlib.Path.home", lambda: (_ for _ in ()).throw(RuntimeError("none")))
    assert private_folder() is None


@pytest.mark.parametrize("mode", [0o770, 0o702])
def test_a_folder_that_others_can_write_is_not_used(home, mode):
    (home / "camring").mkdir(parents=True)
    (home / "camring").chmod(mode)
    assert private_folder() is None


def test_a_link_is_not_followed(home, tmp_path):
    home.mkdir()
    (tmp_path / "others").mkdir()
    (home / "camring").symlink_to(tmp_path / "others")
    assert private_folder() is None


def test_a_relative_cache_home_is_ignored(monkeypatch, tmp_path):
    monkeypatch.delenv(SWITCH, raising=False)
    monkeypatch.setenv("XDG_CACHE_HOME", "relative")
    monkeypatch.setenv("HOME", str(tmp_path))
    folder = private_folder()
    assert folder is not None
    assert folder.is_relative_to(tmp_path / ".cache")


def test_what_a_killed_process_wrote_by_half_is_dropped(home):
    folder, _ = compile_in_another_process()
    (old, *others) = entries(home)
    for path in (old, *others):
        os.utime(path, (1, 1))
    marker = home / "camring" / os.path.basename(folder) / f"999{MARKER_SUFFIX}"
    marker.write_text("")
    half = marker.with_name("jit_half-cache")
    half.write_bytes(b"half")
    whole = marker.with_name("simulate.program")  # ours are renamed when they are whole
    whole.write_bytes(b"whole")
    _, said = compile_in_another_process()
    assert said == ""
    assert old.exists()
    assert not half.exists()
    assert whole.exists()
    assert not marker.exists()
