"""Built motors as a table of samples, and numbers that tools and people read."""

import csv
import io

import numpy as np

from camring.interfaces.config import MotorFile
from camring.interfaces.grid import plain_unit, quantity, result_names
from camring.interfaces.report.quantities import Quantity
from camring.interfaces.scatter import OBJECTIVE, Scatter, tolerances_of

SHARES = (0.05, 0.5, 0.95)


def shown(name: str) -> Quantity:
    """How a result is written; the objective, too."""
    return Quantity(OBJECTIVE, "Objective", "", 1.0, -1) if name == OBJECTIVE else quantity(name)


def labelled(name: str) -> str:
    """A result with its unit, for an axis."""
    found = shown(name)
    return f"{found.label}, {found.unit}" if found.unit else found.label


def samples_csv(file: MotorFile, scatter: Scatter) -> str:
    """Names, units, then a row for each motor built.

    First how far each toleranced number is from the drawing, in SI or as a share, and waves
    as the amplitudes of cosine and sine in m; then results of all operating points together
    and whether every limit holds; then every result of each operating point, with its number
    behind it.
    """
    tolerances = tolerances_of(file)
    changes, units = [], []
    for each in tolerances.deviations:
        changes.append((each.name, float(each.deviation)))
        units.append("share" if each.relative else "SI")
    if tolerances.waviness is not None:
        waves = zip(tolerances.waviness.orders, tolerances.waviness.amplitudes, strict=True)
        for order, amplitude in waves:
            for kind in ("cos", "sin"):
                changes.append((f"waviness.{order}.{kind}", float(amplitude) / np.sqrt(2)))
                units.append("m")
    names = result_names()
    points = range(len(file.system.operating_points))
    every = [(name, place) for place in points for name in names]
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow(
        ["sample", *(name for name, _ in changes), *scatter.results, "keeps_limits"]
        + [f"{name}.{place + 1}" for name, place in every]
    )
    rows.writerow(
        ["", *units, *(plain_unit(shown(name).unit) for name in scatter.results), ""]
        + [plain_unit(quantity(name).unit) for name, _ in every]
    )
    sizes = np.array([size for _, size in changes])
    kept = scatter.keeps_limits
    factors = [(name, shown(name).factor) for name in scatter.results]
    scaled = [(scatter.by_point[name][place], quantity(name).factor) for name, place in every]
    for number, amounts in enumerate(scatter.deviates):
        rows.writerow(
            [number + 1, *(amounts * sizes).tolist()]
            + [float(scatter.results[name][number]) * factor for name, factor in factors]
            + [int(kept[number])]
            + [float(values[number]) * factor for values, factor in scaled]
        )
    return text.getvalue()


def summary(scatter: Scatter) -> dict[str, dict[str, float]]:
    """Of each result, SI: as drawn, mean, standard deviation and quantiles."""
    return {
        name: {
            "nominal": scatter.nominal[name],
            "mean": float(np.nanmean(values)),
            "standard_deviation": float(np.nanstd(values)),
            **{f"quantile_{100 * s:g}": scatter.quantile(name, s) for s in SHARES},
        }
        for name, values in scatter.results.items()
    }


def kept_sentence(scatter: Scatter) -> str:
    """How many motors keep every limit, and which limits the others break."""
    count, kept = len(scatter.deviates), int(np.count_nonzero(scatter.keeps_limits))
    share = kept / count
    error = np.sqrt(share * (1 - share) / count)
    said = f"{kept} of {count} motors keep every limit: {100 * share:.1f} %"
    said += f" (± {200 * error:.1f})" if error > 0 else ""
    broken = sorted(scatter.broken_by().items(), key=lambda item: -item[1])
    if broken:
        told = ", ".join(f"{name} by {100 * each:.1f} %" for name, each in broken)
        said += f". Broken are {told}"
    failed = int(np.count_nonzero(~scatter.sound))
    if failed:
        said += f". {failed} could not be simulated and count as breaking all"
    return said + "."


__all__ = ["SHARES", "kept_sentence", "labelled", "samples_csv", "shown", "summary"]
