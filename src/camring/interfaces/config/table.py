"""What every table of a motor file is, and entries that several of them share."""

from pydantic import BaseModel, ConfigDict

from camring.interfaces.config.entries import Number

FULL_TURN = 6.283185307179586


class Table(BaseModel):
    """A table of the file: unknown keys are errors, values are final."""

    model_config = ConfigDict(extra="forbid", frozen=True)


def pressure_entry(meaning: str, example: str, low: float = 0.0) -> Number:
    return Number(meaning, example, unit="Pa", low=low, high=1e9)
