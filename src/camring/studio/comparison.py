"""Two designs side by side in the words of the report."""

from collections.abc import Sequence
from typing import Any

from camring.files.motor import MotorFile
from camring.files.quantities import GROUPS, change
from camring.metrics.shown import METRICS
from camring.studio.description import point_words
from camring.studio.evaluation import evaluated
from camring.studio.moved_design import Movable


def compared(names: Sequence[str], files: Sequence[MotorFile]) -> dict[str, Any]:
    """A table of every result at every operating point that both have."""
    found = [evaluated(Movable(each).system, each.goal) for each in files]
    points = []
    for k in range(min(len(each.results) for each in found)):
        first, second = (dict(zip(METRICS, each.results[k], strict=True)) for each in found)
        groups = []
        for title, quantities in GROUPS:
            rows = []
            for quantity in quantities:
                before, after = first[quantity.name], second[quantity.name]
                if quantity.rare and before == after == 0:
                    continue
                words, better = change(quantity, before, after)
                rows.append(
                    [
                        quantity.label,
                        quantity.unit,
                        quantity.written(before),
                        quantity.written(after),
                        words,
                        better,
                    ]
                )
            groups.append({"title": title, "rows": rows})
        point = files[0].system.operating_points[k]
        points.append({"text": point_words(point), "groups": groups})
    return {"type": "comparison", "names": list(names), "points": points}
