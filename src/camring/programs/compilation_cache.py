"""Compiled programs kept from one run to the next.

Compiling takes seconds, loading what was compiled takes hundredths of one. What
is kept is machine code that will be run, so it lives in a folder that only its
owner can write (mode 0700), and a folder that others could have written to is
not used. Where nothing can be kept (read-only home, full disk) every run
compiles anew and nothing else changes.

`CAMRING_CACHE=off` switches it off; `CAMRING_CACHE=FOLDER` puts it elsewhere.
"""

import atexit
import contextlib
import fcntl
import hashlib
import os
import platform
import stat
import warnings
from pathlib import Path

SWITCH = "CAMRING_CACHE"
PROGRAMS = "CAMRING_PROGRAMS"
"""The folder of `kept_program`, for this process and what it spawns; empty for none."""
MARKER_SUFFIX = ".running"
PROGRAM_SUFFIX = ".program"
MAKING_SUFFIX = ".making"
OURS = (MARKER_SUFFIX, PROGRAM_SUFFIX, MAKING_SUFFIX)
"""Endings of files that are never there by half; JAX's own grow under their names."""


def keep_compiled_programs() -> Path | None:
    """Tells JAX where to keep them; the folder, or None when there is none to use.

    Call it before JAX is imported: it speaks through the environment, which
    spawned workers inherit and which costs `--help` nothing.
    """
    folder = private_folder()
    os.environ[PROGRAMS] = str(folder or "")
    if folder is None:
        return None
    _discard_foreign(folder)
    _discard_cut_off(folder)
    _mark(folder)

    # A slow compilation on a busy machine is no fault; faults come as exceptions.
    os.environ.setdefault("TF_CPP_MIN_LOG_LEVEL", "3")
    os.environ.update(
        JAX_COMPILATION_CACHE_DIR=str(folder),
        JAX_PERSISTENT_CACHE_MIN_COMPILE_TIME_SECS="0",
        JAX_PERSISTENT_CACHE_MIN_ENTRY_SIZE_BYTES="-1",
        # An entry that cannot be read or written costs a compilation, not a word.
        JAX_RAISE_PERSISTENT_CACHE_ERRORS="false",
    )
    warnings.filterwarnings("ignore", message=".*persistent compilation cache.*")
    return folder


def programs_folder() -> str:
    """Where `kept_program` keeps its own, which needs nothing of JAX; empty for nowhere."""
    if PROGRAMS not in os.environ:
        os.environ[PROGRAMS] = str(private_folder() or "")
    return os.environ[PROGRAMS]


def private_folder() -> Path | None:
    """The folder, made if need be, when it is this user's alone and can be written."""
    choice = os.environ.get(SWITCH, "")
    if choice.lower() in ("off", "0", "no", "false"):
        return None
    try:
        base = Path(choice) if choice else _cache_home() / "camring"
        folder = base / f"compiled-{_this_machine()}"
        base.parent.mkdir(parents=True, exist_ok=True)
        for level in (base, folder):
            level.mkdir(mode=0o700, exist_ok=True)
            if not _private(level):
                return None
    except (OSError, RuntimeError):  # the second when there is no home at all
        return None
    return folder if os.access(folder, os.W_OK | os.X_OK) else None


def _cache_home() -> Path:
    home = os.environ.get("XDG_CACHE_HOME", "")
    # The specification: a relative one is to be ignored.
    return Path(home) if os.path.isabs(home) else Path.home() / ".cache"


def _private(folder: Path) -> bool:
    status = folder.lstat()
    return (
        stat.S_ISDIR(status.st_mode)
        and status.st_uid == os.getuid()
        and not status.st_mode & (stat.S_IWGRP | stat.S_IWOTH)
    )


def _this_machine() -> str:
    """Machine code is made for one kind of processor; homes are shared among several."""
    try:
        lines = Path("/proc/cpuinfo").read_text(errors="replace").splitlines()
        features = next((line for line in lines if line.startswith(("flags", "Features"))), "")
    except OSError:
        features = platform.processor()
    return hashlib.sha256(f"{platform.machine()} {features}".encode()).hexdigest()[:12]


def _mark(folder: Path) -> None:
    """Leaves a locked file while this process runs; see `_discard_cut_off`."""
    marker = folder / f"{os.getpid()}{MARKER_SUFFIX}"
    try:
        descriptor = os.open(marker, os.O_RDWR | os.O_CREAT | os.O_TRUNC | os.O_NOFOLLOW, 0o600)
        fcntl.flock(descriptor, fcntl.LOCK_EX | fcntl.LOCK_NB)
    except OSError:
        return
    atexit.register(marker.unlink, missing_ok=True)


def _discard_foreign(folder: Path) -> None:
    """Drops what is not this user's own, or a link: JAX would run what is in it.

    Such a file may be here from before the folder was private, or from whoever may write
    everywhere and has mistaken the place.
    """
    with contextlib.suppress(OSError):
        for entry in os.scandir(folder):
            status = entry.stat(follow_symlinks=False)
            ours = stat.S_ISREG(status.st_mode) and status.st_uid == os.getuid()
            if not ours or status.st_mode & stat.S_IWOTH:
                with contextlib.suppress(OSError):  # a folder, or gone
                    os.unlink(entry.path)


def _discard_cut_off(folder: Path) -> None:
    """Drops what a killed process may have written by half.

    JAX writes entries in place, and never replaces one. A process that was
    killed leaves its marker without a lock on it; whatever JAX has written since
    may be cut off. Programs of our own are there whole or not at all.
    """
    try:
        for marker in folder.glob(f"*{MARKER_SUFFIX}"):
            with marker.open("rb") as file:
                try:
                    fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
                except BlockingIOError:
                    continue  # its process is alive
                since = marker.stat().st_mtime
                for entry in folder.iterdir():
                    if entry.suffix in OURS:
                        continue
                    with contextlib.suppress(FileNotFoundError):  # another process was quicker
                        if entry.stat().st_mtime >= since:
                            entry.unlink()
                marker.unlink(missing_ok=True)
    except OSError:
        return
