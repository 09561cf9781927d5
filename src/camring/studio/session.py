"""One sitting: the motor file that is open, what was done to it, and what is asked of it.

All of it runs on the engine's first thread, one thing after the other.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from camring.files.errors import CamringError, InputError
from camring.files.motor import parse_motor_file
from camring.files.motor.document import read_text
from camring.files.motor.writer import changed_text
from camring.files.new_file import write_new_file
from camring.files.raw_values import Place, with_raw_values
from camring.studio.cam_hand import Grip
from camring.studio.engine import Asked
from camring.studio.envelope_map import Range
from camring.studio.inside_folder import inside
from camring.studio.memory import Memory, recalled, remember
from camring.studio.moved_design import Movable
from camring.studio.opened import Opened, plain

FINEST = 7  # decimals of a metre that the hand can hold a control value to


class Session:
    """The open file and its memory.

    Parameters
    ----------
    folder
        In which files are opened and saved; nothing outside it is touched.
    path
        The motor file.
    """

    def __init__(self, folder: Path, path: Path) -> None:
        self.folder = folder
        self.path = path
        self.point = 0
        self.note = ""
        self.memory, self.opened = self._begun()

    @classmethod
    def new(cls, folder: Path, text: str, name: str) -> "Session":
        """A motor that no file holds yet."""
        session = cls.__new__(cls)
        session.folder, session.point, session.note = folder, 0, ""
        session.begin(text, name)
        return session

    def _begun(self, text: str | None = None) -> tuple[Memory, Opened]:
        """From what is kept of this file where there is anything, else from the file."""
        saved = read_text(self.path) if text is None else None
        kept = recalled(self.path) if text is None else None
        if kept is not None and kept.saved == saved:
            try:
                return kept, Opened(parse_motor_file(kept.text, self.path))
            except CamringError:
                pass
        elif kept is not None and kept.unsaved:
            self.note = (
                f"{self.path.name} has changed on disk since it was last open here: it was read "
                "anew, and what was under the hand is the snapshot “before the file changed”."
            )
        given = saved if text is None else text
        assert given is not None
        memory = Memory.of(given, saved)
        if kept is not None and kept.saved != saved:
            memory.snapshots = {**kept.snapshots, "before the file changed": kept.text}
        return memory, Opened(parse_motor_file(given, self.path))

    # -- what is asked of the engine ---------------------------------------------------------

    def asked(self, message: Mapping[str, Any]) -> Asked:
        """The design of a message: `set` holds SI numbers by path, `grip` what the hand holds."""
        opened, values = self.opened, _numbers(message.get("set"))
        hand, controls = opened.hand, None
        if message.get("grip"):
            controls = np.round(hand.moved(Grip.of(message["grip"])), FINEST)
        file, where = opened.file, opened.where
        leaf = None if controls is None else hand.leaf(controls)
        system = opened.movable.moved(values, leaf)
        if system is None:
            text = with_raw_values(self.memory.text, opened.as_raw(values))
            file = parse_motor_file(text, self.path)
            where = Range.of(file)
            system = Movable(file).moved({}, leaf)
            assert system is not None
        resting = not values and controls is None
        return Asked(
            number=int(message.get("number", 0)),
            file=file,
            system=system,
            controls=hand.given if controls is None else controls,
            point=min(self.point, len(system.operating_points) - 1),
            where=where,
            held=not resting,
            directions=opened.directions() if resting or message.get("arrows") else (),
            words=(
                ("page", str(message.get("page", ""))),
                ("set", values),
                ("grip", bool(message.get("grip"))),
            ),
        )

    def before(self) -> Asked | None:
        """What the design is held against; None where nothing is pinned."""
        if self.memory.pinned is None or self.memory.pinned not in self.memory.snapshots:
            return None
        opened = Opened(parse_motor_file(self.memory.snapshots[self.memory.pinned], self.path))
        points = len(opened.file.system.operating_points)
        return Asked(
            0,
            opened.file,
            opened.movable.system,
            opened.hand.given,
            min(self.point, points - 1),
            opened.where,
            kind="before",
            words=(("name", self.memory.pinned),),
        )

    # -- what changes the text ---------------------------------------------------------------

    def commit(self, message: Mapping[str, Any]) -> None:
        """Takes what was typed, or where the hand let go, into the text.

        `set` holds texts by path, as typed; `grip` the cam's hand.

        Raises
        ------
        InputError
            As the command line says it. What was typed is kept beside its field.
        """
        typed = {str(path): str(text) for path, text in dict(message.get("set") or {}).items()}
        text = self.memory.text
        try:
            if message.get("grip"):
                hand = self.opened.hand
                values = hand.leaf(np.round(hand.moved(Grip.of(message["grip"])), FINEST))
                key = "control_radii" if hand.points is None else "control_points"
                file = self.opened.file
                text = changed_text(
                    text, file.document, {f"motor.cam.{key}": values.tolist()}, file.choices
                )
            changes: dict[Place, Any] = {}
            for path, each in typed.items():
                place, raw = self.opened.typed(path, each, changes, self.memory.typed)
                changes[place] = raw
            if changes:
                text = with_raw_values(text, changes)
            self.take(text, str(message.get("label") or ", ".join(typed) or "cam"))
        except CamringError as error:
            for path, each in typed.items():
                self.memory.typed[path] = [each, str(error)]
            self.keep()
            raise
        for path in typed:
            self.memory.typed.pop(path, None)
        self.keep()

    def take(self, text: str, label: str) -> None:
        """Another text, if the reader takes it."""
        opened = Opened(parse_motor_file(text, self.path))
        self.memory.add(text, label)
        self._use(opened)

    def _use(self, opened: Opened) -> None:
        self.opened = opened
        self.point = min(self.point, len(opened.file.system.operating_points) - 1)
        self.keep()

    def keep(self) -> None:
        remember(self.path, self.memory)

    def free(self, path: str, bounds: list[str] | None) -> None:
        """Lets a search change a number between two bounds, or takes it out of its hands."""
        space = self.opened.file.document.get("design_space", {})
        place: Place = ("design_space", path)
        if path not in space and bounds is None:
            raise InputError(
                f'design_space."{path}"',
                "stands in a table of its own",
                "take it out in the motor file",
            )
        raw: Any = None if bounds is None else [plain(each) for each in bounds]
        given = space.get(path)
        if isinstance(given, dict) and raw is not None:
            key = "relative" if "relative" in given else "bounds"
            raw = {**given, key: raw}
        text = with_raw_values(self.memory.text, {place: raw})
        if bounds is None and len(space) == 1:
            raise InputError("[design_space]", "would let nothing change", "leave one number free")
        self.take(text, f"{path} {'held' if bounds is None else 'free'}")

    def go(self, by: int) -> None:
        """Undo and redo."""
        if self.memory.go(by):
            self.memory.typed.clear()
            self._use(Opened(parse_motor_file(self.memory.text, self.path)))

    # -- snapshots ---------------------------------------------------------------------------

    def snapshot(self, name: str, pin: bool) -> None:
        name = self.memory.free_name(name.strip()[:60] or "snapshot")
        self.memory.snapshots[name] = self.memory.text
        if pin:
            self.memory.pinned = name
        self.keep()

    def pin(self, name: str | None) -> None:
        self.memory.pinned = name if name in self.memory.snapshots else None
        self.keep()

    def restore(self, name: str) -> None:
        if name in self.memory.snapshots:
            self.take(self.memory.snapshots[name], f"snapshot {name}")

    def forget(self, name: str) -> None:
        self.memory.snapshots.pop(name, None)
        if self.memory.pinned == name:
            self.memory.pinned = None
        self.keep()

    # -- files -------------------------------------------------------------------------------

    def save(self, name: str | None, replace: bool) -> None:
        """Writes the text as a motor file of the folder; comments and order are the user's."""
        path = self.path if name is None else inside(self.folder, name)
        if path.suffix != ".toml":
            raise InputError(path.name, "is no name of a motor file", "let it end in .toml")
        write_new_file(path, self.memory.text, replace=replace)
        self.memory.saved = self.memory.text
        self.path = path
        self.opened.file = parse_motor_file(self.memory.text, path)
        self.keep()

    def open(self, name: str) -> None:
        """Another motor file of the folder, or the best design of a study in it."""
        path = inside(self.folder, name)
        before = self.path, self.point, self.note
        self.path, self.point, self.note = path, 0, ""
        try:
            self.memory, self.opened = self._begun()
        except CamringError:
            self.path, self.point, self.note = before
            raise

    def begin(self, text: str, name: str) -> None:
        """A motor that is not saved yet, under a name that is free in the folder."""
        stem = Path(name).stem
        names = (f"{stem}.toml", *(f"{stem}_{k}.toml" for k in range(2, 10_000)))
        path = next(self.folder / each for each in names if not (self.folder / each).exists())
        opened = Opened(parse_motor_file(text, path))
        self.path, self.point, self.note = path, 0, ""
        self.memory, self.opened = Memory.of(text, None), opened
        self.keep()


def _numbers(given: Any) -> dict[str, float]:
    return {str(path): float(value) for path, value in dict(given or {}).items()}
