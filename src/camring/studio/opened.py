"""A motor file that the reader took, with all that the hand needs of it."""

import tomllib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from camring.files.errors import InputError
from camring.files.motor import MotorFile
from camring.files.raw_values import Place, raw_value
from camring.studio.arrows import Direction
from camring.studio.cam_hand import CamHand
from camring.studio.envelope_map import Range
from camring.studio.fields import Field, fields_of
from camring.studio.moved_design import Movable

STEP = 0.01  # of a slider's length: what an arrow's number stands for


@dataclass(eq=False)
class Opened:
    """A text that the reader took, with what the hand needs of it."""

    file: MotorFile
    movable: Movable = field(init=False)
    hand: CamHand = field(init=False)
    where: Range | None = field(init=False)
    fields: list[Field] = field(init=False)

    def __post_init__(self) -> None:
        self.movable = Movable(self.file)
        self.hand = CamHand.of(self.file)
        self.where = Range.of(self.file)
        self.fields = fields_of(self.file, self.movable.values())

    def field_at(self, path: str) -> Field:
        for each in self.fields:
            if each.path == path:
                return each
        raise InputError(path, "is no key of this motor file", "search for it by its name")

    def directions(self) -> list[Direction]:
        """Every slider, every mode and every handle of the cam."""
        found = [
            Direction(
                each.path,
                self.movable.places[each.path],
                (np.asarray(STEP * (each.high - each.low)),) * len(self.movable.places[each.path]),
            )
            for each in self.fields
            if each.path in self.movable.places and each.low is not None and each.high is not None
        ]
        hand = self.hand
        place = (self.movable.control_place,)
        stroke = float(np.ptp(hand.given))
        unit = np.eye(len(hand.given))
        rows = [(f"cam-handle-{k}", unit[k]) for k in range(len(hand.given))]
        rows += [(f"cam.{kind}.{k}", hand.wave(kind, k) / k**2) for kind, k, _ in hand.modes()]
        base = hand.leaf(hand.given)
        for path, row in rows:
            change = hand.leaf(hand.given + STEP * stroke * row) - base
            found.append(Direction(path, place, (change,)))
        return found

    def as_raw(self, values: Mapping[str, float]) -> dict[Place, Any]:
        """SI numbers as the document holds them; a band's end with its other end."""
        found: dict[Place, Any] = {}
        for path, value in values.items():
            each = self.field_at(path)
            if each.item is None:
                found[each.place] = value
            else:
                there = found.get(each.place, raw_value(self.file.document, each.place))
                pair = list(there or [value, value])
                pair[each.item] = value
                found[each.place] = pair
        return found

    def typed(
        self,
        path: str,
        text: str,
        others: Mapping[Place, Any],
        refused: Mapping[str, Sequence[str]],
    ) -> tuple[Place, Any]:
        """Where a text belongs in the document, and what TOML value it means there.

        Parameters
        ----------
        others
            What else is changed with it: a band's ends stand in one place.
        refused
            By path what was typed before and could not be used yet.
        """
        each = self.field_at(path)
        text = text.strip()
        if each.item is not None:
            there = others.get(each.place, raw_value(self.file.document, each.place))
            if not text:
                return each.place, None
            if not there:
                other = refused.get(f"{path[:-3]}[{1 - each.item}]")
                if other is None:
                    raise InputError(path, "is one end of a band", "give the other one, too")
                there = [plain(other[0])] * 2
            pair = list(there)
            pair[each.item] = plain(text)
            return each.place, pair
        if text == "" and each.kind != "text":
            return each.place, None
        if each.kind == "switch":
            return each.place, text == "true"
        if each.kind == "list":
            try:
                return each.place, tomllib.loads(f"x = {text}")["x"]
            except tomllib.TOMLDecodeError:
                return each.place, text
        if each.kind in ("word", "text"):
            return each.place, text
        return each.place, plain(text)


def plain(text: str) -> Any:
    """A number without a unit is a number of TOML, anything else its text."""
    try:
        number = float(text)
    except ValueError:
        return text
    return int(text) if text.lstrip("+-").isdigit() else number
