"""Built motors as a table of samples, and numbers that tools and people read."""

import numpy as np

from camring.evaluation.built_motors import Scatter, shown, tolerances_of
from camring.files.csv_table import Decimal, csv_table, named
from camring.files.motor import MotorFile
from camring.files.motor.entries import Number
from camring.files.motor.keys import key_map
from camring.files.result_names import quantity, result_names

SHARES = (0.05, 0.5, 0.95)


def samples_csv(file: MotorFile, scatter: Scatter, decimal: Decimal = Decimal.POINT) -> str:
    """A row for each motor built.

    First how far each toleranced number is from the drawing, in SI or as a share, and waves
    as the amplitudes of cosine and sine in m; then results of all operating points together
    and whether every limit holds; then every result of each operating point, with its number
    behind it.
    """
    tolerances = tolerances_of(file)
    changes: list[tuple[str, float]] = []
    for each in tolerances.deviations:
        unit = "share" if each.relative else si_unit_of_key(file, each.name)
        changes.append((named(each.name, unit), float(each.deviation)))
    if tolerances.waviness is not None:
        waves = zip(tolerances.waviness.orders, tolerances.waviness.amplitudes, strict=True)
        for order, amplitude in waves:
            for kind in ("cos", "sin"):
                size = float(amplitude) / np.sqrt(2)
                changes.append((named(f"waviness.{order}.{kind}", "m"), size))
    names = result_names()
    points = range(len(file.system.operating_points))
    every = [(name, place) for place in points for name in names]
    sizes = np.array([size for _, size in changes])
    kept = scatter.keeps_limits
    factors = [(name, shown(name).factor) for name in scatter.results]
    scaled = [(scatter.by_point[name][place], quantity(name).factor) for name, place in every]
    return csv_table(
        [
            "sample",
            *(name for name, _ in changes),
            *(named(name, shown(name).unit) for name in scatter.results),
            "keeps_limits",
            *(named(f"{name}.{place + 1}", quantity(name).unit) for name, place in every),
        ],
        (
            [
                number + 1,
                *(amounts * sizes).tolist(),
                *(float(scatter.results[name][number]) * factor for name, factor in factors),
                int(kept[number]),
                *(float(values[number]) * factor for values, factor in scaled),
            ]
            for number, amounts in enumerate(scatter.deviates)
        ),
        decimal=decimal,
    )


def si_unit_of_key(file: MotorFile, name: str) -> str:
    """The SI unit of a number of the motor file; of a cam mode's amplitude m."""
    entry = key_map(file.choices).get(name)
    return entry.unit if isinstance(entry, Number) else "m"


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
        listed = ", ".join(f"{name} by {100 * each:.1f} %" for name, each in broken)
        said += f". Broken are {listed}"
    failed = int(np.count_nonzero(~scatter.sound))
    if failed:
        said += f". {failed} could not be simulated and count as breaking all"
    return said + "."


__all__ = [
    "SHARES",
    "kept_sentence",
    "samples_csv",
    "si_unit_of_key",
    "summary",
]
