"""A template of a motor file, filled."""

from typing import Any

from jaxtyping import Float
from numpy import ndarray

IN_A_ROW = 4
COLUMN = 46


def filled(template: str, control_radii: Float[ndarray, " control"], **values: Any) -> str:
    """The text of a template with its values in place.

    Parameters
    ----------
    control_radii
        m; written in mm, to a tenth of a micrometre, where the template has `{control_radii}`.
    """
    quoted = [f'"{1e3 * radius:.4f} mm"' for radius in control_radii]
    rows = [", ".join(quoted[at : at + IN_A_ROW]) for at in range(0, len(quoted), IN_A_ROW)]
    lines = ",\n".join(f"    {row}" for row in rows) + ","
    return _aligned(template.format(control_radii=lines, **values))


def _aligned(text: str) -> str:
    """Comments behind values in one column."""
    lines = []
    for line in text.split("\n"):
        value, mark, comment = line.partition("  # ")
        wanted = mark and value.strip()
        lines.append(f"{value.rstrip():<{COLUMN}}# {comment}" if wanted else line)
    return "\n".join(lines)
