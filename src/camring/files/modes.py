"""[motor.modes.NAME]: lobes that a valve leads to the return, and the points that run so.

Lobes are counted from 1 in the file, as an engineer counts them: the first begins at the inner
dead centre at angle 0 and has the first windows. Inside they are counted from 0.
"""

from collections.abc import Mapping
from difflib import get_close_matches
from typing import Any

from camring.files.errors import InputError, quote

__all__ = ["idle_lobes_of", "modes_of"]

KEY = "idle_lobes"
EXAMPLE = "idle_lobes = [1, 3, 5]"


def modes_of(tables: Mapping[str, Any], lobes: int) -> dict[str, tuple[int, ...]]:
    """Idle lobes of each mode by its name, counted from 0, ascending.

    Parameters
    ----------
    tables
        What stands under `[motor.modes]`.
    lobes
        Of the motor.

    Raises
    ------
    InputError
        For a table without the key or with another, for lobes that are none, twice there or all.
    """
    return {name: _lobes(name, table, lobes) for name, table in tables.items()}


def idle_lobes_of(
    modes: Mapping[str, tuple[int, ...]], mode: str | None, place: int
) -> tuple[int, ...]:
    """Those of the mode that an operating point names; none without one.

    Raises
    ------
    InputError
        For a name that is no mode of the file.
    """
    if mode is None:
        return ()
    if mode in modes:
        return modes[mode]
    path, close = f"operating_points[{place}].mode", get_close_matches(mode, modes, n=1)
    if not modes:
        way_out = f"write [motor.modes.{mode}] with {EXAMPLE}, or leave it out"
    elif close:
        way_out = f"you probably meant {close[0]}"
    else:
        way_out = "give one of " + ", ".join(modes)
    raise InputError(path, f"is {quote(mode)}, which is no mode of [motor.modes]", way_out)


def _lobes(name: str, table: Any, lobes: int) -> tuple[int, ...]:
    path = f"motor.modes.{name}"
    if not isinstance(table, dict):
        raise InputError(path, f"is {quote(table)} but must be a table", f"write it as [{path}]")
    for key in table:
        if key != KEY:
            meant = get_close_matches(key, [KEY], n=1)
            way_out = f"you probably meant {path}.{KEY}" if meant else f"leave it out; give {KEY}"
            raise InputError(f"{path}.{key}", f"is not a key of [{path}]", way_out)
    if KEY not in table:
        raise InputError(f"{path}.{KEY}", "is missing", f"give lobes that idle, {EXAMPLE}")
    given = table[KEY]
    if not isinstance(given, list) or not given:
        raise InputError(
            f"{path}.{KEY}", f"is {quote(given)} but must be a list of lobes", f"write {EXAMPLE}"
        )
    for place, lobe in enumerate(given):
        here = f"{path}.{KEY}[{place}]"
        if isinstance(lobe, bool) or not isinstance(lobe, int):
            raise InputError(here, f"is {quote(lobe)} but must be a whole number", EXAMPLE)
        if not 1 <= lobe <= lobes:
            raise InputError(
                here, f"is {lobe}, but lobes are counted from 1 to {lobes}", f"write {EXAMPLE}"
            )
        if lobe in given[:place]:
            raise InputError(here, f"is {lobe}, which is there already", "name each lobe once")
    if len(given) == lobes:
        raise InputError(
            f"{path}.{KEY}", f"names all {lobes} lobes, which leaves none that drives", "keep some"
        )
    return tuple(sorted(lobe - 1 for lobe in given))
