"""What a sitting remembers: every text since the file was opened, and named snapshots.

It is written to this user's own folder at every change, so that neither a closed page nor a
stopped server loses anything that was typed.
"""

import contextlib
import hashlib
import json
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from camring.evaluation.consent import state_folder
from camring.files.whole_file import make_folder, write_privately

MOST_TEXTS = 400
MOST_CHARACTERS = 8_000_000
VERSION = 1
NOW = "now"
"""What a comparison calls the design in the hand."""


@dataclass
class Memory:
    """Texts of a motor file in the order in which they came, and where the hand is among them.

    Attributes
    ----------
    saved
        The text as it stands on disk; None for a motor that is not saved yet.
    labels
        What led to each text, in a few words.
    typed
        By path what was typed and refused, and the sentence why.
    """

    saved: str | None
    texts: list[str]
    labels: list[str]
    at: int = 0
    snapshots: dict[str, str] = field(default_factory=dict)
    pinned: str | None = None
    typed: dict[str, list[str]] = field(default_factory=dict)

    @classmethod
    def of(cls, text: str, saved: str | None) -> "Memory":
        return cls(saved, [text], ["opened"])

    @property
    def text(self) -> str:
        return self.texts[self.at]

    @property
    def unsaved(self) -> bool:
        return self.text != self.saved

    def add(self, text: str, label: str) -> None:
        """What was undone and is now overtaken is forgotten."""
        if text == self.text:
            return
        self.texts = [*self.texts[: self.at + 1], text]
        self.labels = [*self.labels[: self.at + 1], label]
        while len(self.texts) > MOST_TEXTS or sum(map(len, self.texts)) > MOST_CHARACTERS:
            if len(self.texts) == 1:
                break
            del self.texts[0], self.labels[0]
        self.at = len(self.texts) - 1

    def go(self, by: int) -> bool:
        """Back or forth; whether there was anywhere to go."""
        to = min(max(self.at + by, 0), len(self.texts) - 1)
        moved, self.at = to != self.at, to
        return moved

    def free_name(self, stem: str) -> str:
        """A name that no snapshot has, nor the design in the hand."""
        names = (stem, *(f"{stem} {k}" for k in range(2, 10_000)))
        taken = {NOW, *self.snapshots}
        return next(name for name in names if name not in taken)


def place_of(path: Path) -> Path:
    """Where the memory of a motor file is kept."""
    digest = hashlib.sha256(str(path.resolve()).encode()).hexdigest()[:24]
    return state_folder() / "studio" / f"{digest}.json"


def remember(path: Path, memory: Memory) -> None:
    """Writes it whole or not at all; a full disk costs the memory, not the work."""
    place = place_of(path)
    with contextlib.suppress(OSError, RuntimeError):
        make_folder(place.parent, 0o700)
        content = json.dumps({"version": VERSION, "path": str(path), **vars(memory)})
        write_privately(place, content.encode())


def recalled(path: Path) -> Memory | None:
    """What was kept of a motor file; None for nothing, or nothing that can be read."""
    try:
        kept: dict[str, Any] = json.loads(place_of(path).read_text(encoding="utf-8"))
        if kept.pop("version") != VERSION or not kept["texts"]:
            return None
        kept.pop("path")
        found = Memory(**kept)
        found.at = min(max(found.at, 0), len(found.texts) - 1)
    except (OSError, RuntimeError, ValueError, TypeError, KeyError):
        return None
    return found
