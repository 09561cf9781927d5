"""Files as a disk may hold them after a loss of power, from a record of what a program did.

What a disk has promised is what was synchronised; of everything after that it may keep any part,
in any order, a sector at a time. Names of files are kept as journalling file systems do: those of
a synchronised folder, and of the changes since a first part (Pillai et al. 2014).
"""

import os
import random
import shutil
import subprocess
import sys
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Union

SECTOR = 512  # bytes, which a disk writes whole or not at all
SOURCE = Path(__file__).with_name("file_recorder.c")


def recorder(folder: Path) -> Path | None:
    """The library that records, compiled; None where there is no compiler or no such linking."""
    compiler = shutil.which("cc")
    if compiler is None or not sys.platform.startswith("linux"):
        return None
    library = folder / "file_recorder.so"
    command = [compiler, "-shared", "-fPIC", "-O1", "-o", str(library), str(SOURCE), "-ldl"]
    return library if subprocess.run(command, check=False).returncode == 0 else None


def recorded(library: Path, below: Path, log: Path, *arguments: str, **environment: str) -> None:
    """Runs Python with these arguments, and records what it does to files below a folder."""
    known = {**os.environ, **environment, "RECORDED": str(below), "RECORDING": str(log)}
    known["LD_PRELOAD"] = str(library)
    subprocess.run([sys.executable, *arguments], check=True, env=known)


@dataclass(frozen=True)
class Change:
    """One call of a program: what, of which file, to which other, where, and with which bytes."""

    what: str
    path: Path
    other: Path
    place: int
    data: bytes


def changes(log: Path) -> Iterator[Change]:
    content, at = log.read_bytes(), 0
    while at < len(content):
        end = content.index(b"\n", at)
        what, *numbers = content[at:end].decode().split()
        first, second, place, count = map(int, numbers)
        at, parts = end + 1, []
        for length in (first, second, count):
            parts.append(content[at : at + length])
            at += length
        path, other, data = parts
        yield Change(what, Path(os.fsdecode(path)), Path(os.fsdecode(other)), place, data)


@dataclass(eq=False)
class File:
    """Bytes on the disk, and what is on its way there: sectors, and new lengths as None."""

    settled: bytearray = field(default_factory=bytearray)
    pending: list[tuple[int, bytes | None]] = field(default_factory=list)

    def content(self, kept: list[bool]) -> bytes:
        found = bytearray(self.settled)
        for (place, data), stays in zip(self.pending, kept, strict=True):
            if stays:
                _change(found, place, data)
        return bytes(found)


@dataclass(eq=False)
class Folder:
    entries: dict[str, Union[File, "Folder"]] = field(default_factory=dict)


@dataclass(eq=False)
class Naming:
    """Names that one call has taken away and given, in folders that are not yet synchronised."""

    steps: list[tuple[Folder, str, File | Folder | None]]
    waiting: set[Folder]


class Disk:
    """What stands below a folder, as a program sees it and as the disk has it.

    Parameters
    ----------
    below
        The folder, empty at the beginning.
    """

    def __init__(self, below: Path) -> None:
        self._below = below
        self._seen, self._settled = Folder(), dict[Folder, dict[str, File | Folder]]()
        self._naming: list[Naming] = []

    def apply(self, change: Change) -> None:
        """What a call does."""
        parent, name = self._parent(change.path), change.path.name
        match change.what:
            case "create":
                self._named([(parent, name, File())])
            case "mkdir":
                self._named([(parent, name, Folder())])
            case "unlink":
                self._named([(parent, name, None)])
            case "link":
                self._named([(self._parent(change.other), change.other.name, parent.entries[name])])
            case "rename":
                moved = parent.entries[name]
                to = (self._parent(change.other), change.other.name, moved)
                self._named([(parent, name, None), to])
            case "write":
                file, place = self._file(change.path), change.place
                for start in range(place - place % SECTOR, place + len(change.data), SECTOR):
                    first, last = max(start, place), min(start + SECTOR, place + len(change.data))
                    file.pending.append((first, change.data[first - place : last - place]))
            case "truncate":
                self._file(change.path).pending.append((change.place, None))
            case "sync" if isinstance(there := self._at(change.path), Folder):
                self._names_settle(there)
            case "sync":
                file = self._file(change.path)
                file.settled = bytearray(file.content([True] * len(file.pending)))
                file.pending.clear()

    def contents(self) -> dict[str, bytes]:
        """As the program sees it, by path below the folder."""
        return dict(_walk(self._seen, lambda folder: folder.entries, _everything))

    def after_a_cut(self, chance: random.Random) -> dict[str, bytes]:
        """As it may stand when power comes back."""
        names = {folder: dict(entries) for folder, entries in self._settled.items()}
        for naming in self._naming[: chance.randint(0, len(self._naming))]:
            for folder, name, there in naming.steps:
                _name(names.setdefault(folder, {}), name, there)
        share = chance.choice([0.0, 1.0, chance.random(), None])

        def kept(file: File) -> list[bool]:
            count = len(file.pending)
            if share is None:  # in order, up to some instant
                first = chance.randint(0, count)
                return [place < first for place in range(count)]
            return [chance.random() < share for _ in range(count)]

        return dict(_walk(self._seen, lambda folder: names.get(folder, {}), kept))

    def _named(self, steps: list[tuple[Folder, str, File | Folder | None]]) -> None:
        for folder, name, there in steps:
            _name(folder.entries, name, there)
        self._naming.append(Naming(steps, {folder for folder, _, _ in steps}))

    def _names_settle(self, folder: Folder) -> None:
        """With them all that came before: a journal keeps its order."""
        last = max((k for k, each in enumerate(self._naming) if folder in each.waiting), default=-1)
        for naming in self._naming[: last + 1]:
            for where, name, there in naming.steps:
                _name(self._settled.setdefault(where, {}), name, there)
        del self._naming[: last + 1]

    def _at(self, path: Path) -> File | Folder:
        here: File | Folder = self._seen
        for name in path.relative_to(self._below).parts:
            assert isinstance(here, Folder)
            here = here.entries[name]
        return here

    def _file(self, path: Path) -> File:
        found = self._at(path)
        assert isinstance(found, File)
        return found

    def _parent(self, path: Path) -> Folder:
        if path == self._below:
            return self._seen
        found = self._at(path.parent)
        assert isinstance(found, Folder)
        return found


def laid_out(contents: dict[str, bytes], folder: Path) -> None:
    """The files, in an empty folder."""
    for name, content in contents.items():
        path = folder / name
        if name.endswith("/"):
            path.mkdir(parents=True, exist_ok=True)
        else:
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch(mode=0o600)  # modes are not recorded; the strictest does for all
            path.write_bytes(content)


def _everything(file: File) -> list[bool]:
    return [True] * len(file.pending)


def _walk(folder, entries_of, kept, above=""):
    for name, there in entries_of(folder).items():
        if isinstance(there, Folder):
            yield f"{above}{name}/", b""
            yield from _walk(there, entries_of, kept, f"{above}{name}/")
        else:
            yield f"{above}{name}", there.content(kept(there))


def _name(entries: dict, name: str, there: File | Folder | None) -> None:
    entries.pop(name, None)
    if there is not None:
        entries[name] = there


def _change(content: bytearray, place: int, data: bytes | None) -> None:
    if data is None:
        del content[place:]
        content.extend(bytes(place - len(content)))
    else:
        content.extend(bytes(max(0, place - len(content))))
        content[place : place + len(data)] = data
