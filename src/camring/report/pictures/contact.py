"""Roller on ring: force, stress and the margin to the limit."""

from collections.abc import Sequence

import numpy as np

from camring.drawing.chart import Chart, draw
from camring.drawing.layers import Curve, Rule
from camring.drawing.scale import covering
from camring.files.quantities import significant
from camring.presentation.records import Constraint, Design, Result
from camring.report.figure import Figure, degrees, design_styles, legend, period_axis

__all__ = ["contact_figures"]


def _stress(designs: Sequence[Design], index: int, limit: float | None) -> Figure:
    curves = [1e-9 * d.results[index].waves.contact_stress for d in designs]
    name = f"stress-{index}"
    layers: list = []
    if limit is not None:
        layers.append(Rule(1e-9 * limit, f"limit {1e-9 * limit:.4g} GPa", limit=True))
    layers += [
        Curve(degrees(d.results[index].waves.angle), y, d.label, style)
        for d, y, style in zip(designs, curves, design_styles(designs), strict=True)
    ]
    include = (0.0,) if limit is None else (0.0, 1e-9 * limit)
    svg = draw(
        Chart(
            name,
            "Contact stress along the lobe",
            "Hertz stress between roller and ring over one period of the cam.",
            period_axis(designs),
            covering("Hertz contact stress", "GPa", curves, include=include),
            layers,
            legend(designs),
        )
    )
    return Figure(name, "Contact stress", svg, _stress_words(designs[-1].results[index]))


def _stress_words(result: Result) -> str:
    stress = result.waves.contact_stress
    if not np.isfinite(stress).all():
        return (
            "Where the curve has gaps the ring is undercut: no such surface can be ground, and "
            "there is no contact stress to tell."
        )
    place = float(np.degrees(result.waves.angle[int(np.argmax(stress))]))
    most = significant(1e-9 * result.metrics["max_contact_stress"], 3)
    return (
        f"Stress peaks at {most} GPa, at {place:.1f} deg: it is high where supply pressure meets "
        "a ring that bends away from the roller."
    )


def _force(designs: Sequence[Design], index: int) -> Figure:
    curves = [1e-3 * d.results[index].waves.contact_force for d in designs]
    name = f"force-{index}"
    layers: list = [Rule(0.0, "lift-off", limit=True, below=True)]
    beneath = -0.09 * max(float(y.max()) for y in curves)
    layers += [
        Curve(degrees(d.results[index].waves.angle), y, d.label, style)
        for d, y, style in zip(designs, curves, design_styles(designs), strict=True)
    ]
    svg = draw(
        Chart(
            name,
            "Contact force along the lobe",
            "Force between roller and ring along their normal, over one period of the cam.",
            period_axis(designs),
            covering("Contact force (normal to the ring)", "kN", curves, include=(beneath,)),
            layers,
            legend(designs),
        )
    )
    least = designs[-1].results[index].metrics["min_contact_force"]
    if least >= 0:
        sentence = (
            "The roller stays on the ring: the least radial force is "
            f"{significant(1e-3 * least, 3)} kN."
        )
    else:
        sentence = (
            f"The roller lifts off: the force falls to {significant(1e-3 * least, 3)} kN, and "
            "what is drawn after that point assumes a contact that is not there."
        )
    return Figure(name, "Contact force", svg, sentence)


def _undercut(designs: Sequence[Design], index: int, limit: float | None) -> Figure:
    curves = [d.profile.undercut_factor for d in designs]
    floor = 0.0 if limit is None else limit
    text = "cusp" if limit is None else f"limit {limit:.3g}"
    layers: list = [Rule(floor, text, limit=True)]
    layers += [
        Curve(degrees(d.profile.angle), y, d.label, style)
        for d, y, style in zip(designs, curves, design_styles(designs), strict=True)
    ]
    svg = draw(
        Chart(
            f"undercut-{index}",
            "Undercut factor",
            "One plus pitch curvature times roller radius, over one period of the cam.",
            period_axis(designs),
            covering("Undercut factor", "", curves, include=(0.0,)),
            layers,
            legend(designs),
        )
    )
    return Figure(
        f"undercut-{index}",
        "Curvature and undercut",
        svg,
        "How tightly the ring bends: above one it bends round the shaft and cups the roller, below "
        "one it bulges towards it and stress rises; at zero the ring would have a cusp that no "
        "roller can follow.",
    )


def _side_force(designs: Sequence[Design], index: int) -> Figure:
    curves = [
        1e-3 * d.results[index].waves.contact_force * np.sin(_lean(d, index)) for d in designs
    ]
    layers: list = [Rule(0.0)]
    layers += [
        Curve(degrees(d.results[index].waves.angle), y, d.label, style)
        for d, y, style in zip(designs, curves, design_styles(designs), strict=True)
    ]
    svg = draw(
        Chart(
            f"side-{index}",
            "Side force on a piston",
            "Force across the piston's axis over one period of the cam.",
            period_axis(designs),
            covering("Side force", "kN", curves),
            layers,
            legend(designs),
        )
    )
    most = float(np.abs(curves[-1]).max())
    return Figure(
        f"side-{index}",
        "Side force",
        svg,
        "The part of the roller force across the piston. Times the radius it is the piston's "
        f"torque; the bore has to carry it, at most {significant(most, 3)} kN.",
    )


def _lean(design: Design, index: int) -> np.ndarray:
    """Pressure angle at the angles of the waves, rad."""
    angle = design.results[index].waves.angle
    return np.interp(angle, design.profile.angle, design.profile.pressure_angle)


def _bound(constraints: Sequence[Constraint], name: str) -> float | None:
    bounds = [c.bound for c in constraints if c.name == name and np.isfinite(c.bound)]
    return bounds[0] if bounds else None


def contact_figures(
    designs: Sequence[Design], index: int, constraints: Sequence[Constraint] = ()
) -> list[Figure]:
    """Stress, curvature and forces at one operating point, with limits where there are any."""
    return [
        _stress(designs, index, _bound(constraints, "max_contact_stress")),
        _undercut(designs, index, _bound(constraints, "min_undercut_factor")),
        _force(designs, index),
        _side_force(designs, index),
    ]
