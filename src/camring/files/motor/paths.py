"""Tables whose keys are paths of other keys, in quotes or as nested tables."""

from typing import Any

from camring.files.motor.entries import Entry


def flat_paths(
    table: dict[str, Any], keys: dict[str, Entry], without: str
) -> list[tuple[str, Any]]:
    """Paths with their values, whether written in quotes or as nested tables.

    Parameters
    ----------
    without
        A table inside that is something else.
    """
    found: list[tuple[str, Any]] = []
    for name, value in table.items():
        if name != without:
            found += _below(name, value, keys)
    return found


def _below(path: str, value: Any, keys: dict[str, Entry]) -> list[tuple[str, Any]]:
    inner = any(key.startswith(path + ".") for key in keys)
    if not (isinstance(value, dict) and inner):
        return [(path, value)]
    return [each for key in value for each in _below(f"{path}.{key}", value[key], keys)]
