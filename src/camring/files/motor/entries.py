"""What one key of the motor file takes: a number with a unit, a count, a word, a list.

An entry reads the raw TOML value or refuses it; it also says which leaves of
the `System` the value becomes, so that reader, design space and parameter
reference share one statement about each key (see `keys.py`).
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from math import isfinite
from typing import Any

from pydantic import GetCoreSchemaHandler
from pydantic_core import CoreSchema, PydanticCustomError, core_schema

from camring.files.errors import ordinal, quote
from camring.files.units import UnitError, difference_to_si, split_quantity, to_si, unit_of


class Unfit(Exception):
    """A value an entry refuses: the problem completes "motor.bore ...", then the way out.

    `inside` is where in the value it stands, such as `, 3rd value`.
    """

    def __init__(self, problem: str, way_out: str, inside: str = "") -> None:
        self.problem, self.way_out, self.inside = problem, way_out, inside
        super().__init__(problem, way_out, inside)


@dataclass(frozen=True)
class Entry(ABC):
    """What a key takes.

    Attributes
    ----------
    meaning
        What it is, in a few words that follow "give".
    example
        A value as it stands in a file.
    leaves
        Paths of the `System` leaves that hold it, such as `motor.piston.bore`.
    """

    meaning: str
    example: str
    leaves: tuple[str, ...] = field(default=(), kw_only=True)

    @abstractmethod
    def read(self, value: Any) -> Any:
        """The value for the program, SI.

        Raises
        ------
        Unfit
            When the value cannot be used.
        """

    @property
    def way_out(self) -> str:
        return f"give {self.meaning}, for example {self.example}"

    def __get_pydantic_core_schema__(
        self, source: Any, handler: GetCoreSchemaHandler
    ) -> CoreSchema:
        return core_schema.no_info_plain_validator_function(self._validate)

    def _validate(self, value: Any) -> Any:
        try:
            return self.read(value)
        except Unfit as error:
            parts = {"problem": error.problem, "way_out": error.way_out, "inside": error.inside}
            raise PydanticCustomError("unfit", "{problem}", parts) from None


@dataclass(frozen=True)
class Number(Entry):
    """A number: bare in SI, or text with a unit of the right dimension.

    `low` and `high` are bounds of sanity, wide enough for every machine: they
    keep a slip of the keyboard from becoming NaN three packages further.
    `difference` is for what lies between two temperatures or pressures: `"5 degC"` is 5 K.
    """

    unit: str = field(default="1", kw_only=True)
    difference: bool = field(default=False, kw_only=True)
    low: float = field(default=0.0, kw_only=True)
    high: float = field(default=1e9, kw_only=True)

    def read(self, value: Any) -> float:
        number = self.convert(value)
        if (self.low >= 0 and number < 0) or (self.low > 0 and number == 0):
            least = "above zero" if self.low > 0 else "zero or more"
            raise Unfit(f"is {quote(value)} but must be {least}", self.way_out)
        if not self.low <= number <= self.high:
            bare = not isinstance(value, str) and self.unit != "1"
            read = f", without a unit and so in {self.unit}," if bare else ""
            raise Unfit(
                f"is {quote(value)}{read} but must lie between {self._limits_like(value)}",
                self.way_out,
            )
        return number

    def _limits_like(self, value: Any) -> str:
        """The bounds of sanity in the unit that a value has, else in SI."""
        unit, low, high = self.unit, self.low, self.high
        try:
            if isinstance(value, str) and (given := split_quantity(value)[1]):
                found = unit_of(given, self.unit)
                zero = 0.0 if self.difference else found.offset
                low, high = ((each - zero) / found.factor for each in (low, high))
                unit = given
        except UnitError:
            pass
        return f"{low:.4g} and {high:.4g}" + (f" {unit}" if unit != "1" else "")

    def convert(self, value: Any) -> float:
        """The SI value, finite, whatever its size."""
        if isinstance(value, str):
            try:
                number = (difference_to_si if self.difference else to_si)(value, self.unit)
            except UnitError as error:
                raise Unfit(f"is {quote(value)}, which {error}", self.way_out) from None
        elif isinstance(value, int | float) and not isinstance(value, bool):
            try:
                number = float(value)
            except OverflowError:
                number = float("inf")
        else:
            raise Unfit(f"is {quote(value)} but must be a number", self.way_out)
        if not isfinite(number):
            raise Unfit(f"is {quote(value)} but must be finite", self.way_out)
        return number


@dataclass(frozen=True)
class NumberOrWord(Number):
    """A number, or one of a few words that stand for a rule."""

    words: tuple[str, ...] = field(default=(), kw_only=True)

    def read(self, value: Any) -> Any:
        if isinstance(value, str) and value in self.words:
            return value
        if isinstance(value, str) and value[:1].isalpha():
            raise Unfit(f"is {quote(value)}{_did_you_mean(value, self.words)}", self.way_out)
        return super().read(value)


@dataclass(frozen=True)
class Count(Entry):
    """A whole number; it shapes arrays and is never varied."""

    low: int = field(default=1, kw_only=True)
    high: int = field(default=1000, kw_only=True)

    def read(self, value: Any) -> int:
        if isinstance(value, bool) or not isinstance(value, int):
            raise Unfit(f"is {quote(value)} but must be a whole number", self.way_out)
        if not self.low <= value <= self.high:
            raise Unfit(
                f"is {quote(value)} but must lie between {self.low} and {self.high}",
                self.way_out,
            )
        return value


@dataclass(frozen=True)
class Word(Entry):
    """One of a few words."""

    words: tuple[str, ...] = field(default=(), kw_only=True)

    def read(self, value: Any) -> str:
        if not isinstance(value, str) or value not in self.words:
            raise Unfit(
                f"is {quote(value)}{_did_you_mean(value, self.words)}",
                "give one of " + ", ".join(f'"{word}"' for word in self.words),
            )
        return value


@dataclass(frozen=True)
class Text(Entry):
    """A line of free text."""

    def read(self, value: Any) -> str:
        if not isinstance(value, str):
            raise Unfit(f"is {quote(value)} but must be text in quotes", self.way_out)
        if len(value) > 200 or not value.isprintable():
            raise Unfit(
                f"is {quote(value)} but must be one line of at most 200 characters", self.way_out
            )
        return value


@dataclass(frozen=True)
class Switch(Entry):
    """true or false."""

    def read(self, value: Any) -> bool:
        if not isinstance(value, bool):
            raise Unfit(f"is {quote(value)} but must be true or false", self.way_out)
        return value


@dataclass(frozen=True)
class Numbers(Entry):
    """A list, each item read by the same entry."""

    item: Entry = field(kw_only=True)
    fewest: int = field(default=1, kw_only=True)
    most: int = field(default=720, kw_only=True)

    def read(self, value: Any) -> Any:
        if not isinstance(value, list):
            raise Unfit(f"is {quote(value)} but must be a list in brackets", self.way_out)
        if not self.fewest <= len(value) <= self.most:
            limit = (
                f"{self.fewest}"
                if self.fewest == self.most
                else f"at least {self.fewest} and at most {self.most}"
            )
            raise Unfit(f"has {len(value)} items but takes {limit}", self.way_out)
        read = []
        for place, item in enumerate(value):
            try:
                read.append(self.item.read(item))
            except Unfit as error:
                inside = f", {ordinal(place + 1)} value{error.inside}"
                raise Unfit(error.problem, error.way_out, inside) from None
        return read


@dataclass(frozen=True)
class Band(Numbers):
    """Two numbers, the lower first."""

    def read(self, value: Any) -> Any:
        if not isinstance(value, list) or len(value) != 2:
            raise Unfit(f"is {quote(value)} but must be a list of two, [low, high]", self.way_out)
        low, high = super().read(value)
        if low == high:
            raise Unfit(
                f"has the empty bounds [{quote(value[0])}, {quote(value[1])}]",
                "put the second above the first",
            )
        if low > high:
            raise Unfit(
                f"has the crossed bounds [{quote(value[0])}, {quote(value[1])}]",
                "put the lower one first",
            )
        return low, high


def band(item: Number) -> Band:
    """A band of what the item measures."""
    example = f"[{item.example}, {item.example}]"
    bound = replace(item, meaning=f"{item.meaning} as a bound")
    return Band(f"a band [low, high] for {item.meaning}", example, item=bound, fewest=2, most=2)


def _did_you_mean(value: Any, words: tuple[str, ...]) -> str:
    close = get_close_matches(value, words, n=1) if isinstance(value, str) else []
    known = ", ".join(f'"{word}"' for word in words)
    return f" (did you mean {close[0]!r}?)" if close else f" but only {known} are known"
