"""The FMU's C sources made into this machine's binary, by the compiler that is there."""

import os
import platform
import shlex
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path

__all__ = ["FLAGS", "SOURCES", "Binary", "compiled", "source_texts"]

SOURCES = ("camring_fmu.c", "camring_table.c")
"""What is compiled; headers stand beside."""
_HEADERS = ("camring_fmi2.h", "camring_table.h")
FLAGS = ("-std=c99", "-O2", "-fPIC", "-shared", "-fvisibility=hidden")
_PLATFORMS = {
    ("linux", "x86_64"): ("linux64", ".so"),
    ("darwin", "x86_64"): ("darwin64", ".dylib"),
    ("darwin", "arm64"): ("darwin64", ".dylib"),
}
_PATIENCE = 120  # s


@dataclass(frozen=True)
class Binary:
    """A shared library and its place in the FMU; neither where it could not be made.

    Attributes
    ----------
    why
        Why there is none, in words that follow "sources only, for".
    """

    content: bytes = b""
    path: str = ""
    why: str = ""


def source_texts(*names: str) -> dict[str, str]:
    """Sources that come with camring, by their names; those of an FMU unless named."""
    folder = files("camring.exchange.fmu").joinpath("sources")
    return {name: folder.joinpath(name).read_text() for name in names or (*SOURCES, *_HEADERS)}


def compiled(sources: Mapping[str, str], name: str) -> Binary:
    """The library of an FMU.

    Parameters
    ----------
    sources
        All files by their names.
    name
        Of the model: what the library is called.
    """
    place = _PLATFORMS.get((sys.platform, platform.machine()))
    if place is None:
        return Binary(why=f"FMI 2.0 has no name for {sys.platform} on {platform.machine()}")
    command = _compiler()
    if not command:
        return Binary(why="no C compiler was found (CC, cc, gcc, clang)")
    folder, ending = place
    with tempfile.TemporaryDirectory() as workshop:
        for each, text in sources.items():
            Path(workshop, each).write_text(text)
        library = f"{name}{ending}"
        try:
            done = subprocess.run(
                [*command, *FLAGS, "-o", library, *SOURCES, "-lm"],
                cwd=workshop, capture_output=True, text=True, timeout=_PATIENCE, check=False,
            )  # fmt: skip
        except (OSError, subprocess.TimeoutExpired) as error:
            return Binary(why=f"{command[0]} could not be run ({error})")
        if done.returncode:
            said = next(iter(done.stderr.strip().splitlines()), "nothing")
            return Binary(why=f"{command[0]} failed and said {said!r}")
        return Binary(Path(workshop, library).read_bytes(), f"binaries/{folder}/{library}")


def _compiler() -> list[str]:
    asked = shlex.split(os.environ.get("CC", ""))
    if asked:
        return asked if shutil.which(asked[0]) else []
    return next(([name] for name in ("cc", "gcc", "clang") if shutil.which(name)), [])
