"""Options that had another name, as errors that say what to write now."""

from math import isfinite

from camring.files.errors import InputError, quote
from camring.files.units import UnitError, split_quantity, to_si

__all__ = ["doubled"]


def doubled(old: str, text: str, new: str) -> InputError:
    """An option that took a radius, of which the new one takes the diameter.

    The value to write is twice the given one, in its own unit, where it is a length.
    """
    try:
        number, unit = split_quantity(text)
        value = f"{2 * number:.9g} {unit}"
        is_length = bool(unit) and isfinite(to_si(value, "m"))
    except UnitError:
        is_length = False
    way = f'write {new} "{value}"' if is_length else f'write {new} with a diameter, "500 mm"'
    return InputError(old, f"is {quote(text)}, a radius; it is now {new}, a diameter", way)
