"""Pistons and rollers that do not fit round the block, as sentences."""

from camring.geometry.block import guided_length, meeting_radius, wall_between
from camring.physics.motor import Motor


def crowded(motor: Motor, inner: float) -> list[str]:
    """A sentence each for pistons and rollers that run into their neighbours.

    Parameters
    ----------
    inner
        Least radius of the pitch curve, where the rollers' centres stand furthest in, m.

    Notes
    -----
    A piston is taken to be as long as its gap, from the roller's centre inwards; where the
    file has none, as long as its bore.
    """
    pistons, bore = motor.pistons, float(motor.piston.bore)
    wanted = bore if motor.gap is None else float(motor.gap.length)
    whose = "as long as its bore, so that it does not tilt," if motor.gap is None else "of that gap"
    said = []
    free = float(guided_length(pistons, bore, inner))
    if free < wanted:
        left = f"leaves {1e3 * free:.3g} mm" if free > 0 else "leaves nothing"
        said.append(
            f"The pistons do not fit round the block: {pistons} bores of {1e3 * bore:.4g} mm run "
            f"into each other at a radius of {1e3 * float(meeting_radius(pistons, bore)):.4g} mm, "
            f"which {left} of piston below the roller's centre at {1e3 * inner:.4g} mm, where a "
            f"piston {whose} takes {1e3 * wanted:.3g} mm; take fewer pistons, a smaller bore or a "
            "larger ring."
        )
    across = 2 * float(motor.roller.radius)
    if across > bore:
        said.append(
            f"The rollers, {1e3 * across:.4g} mm across, are wider than the pistons of "
            f"{1e3 * bore:.4g} mm: a piston that carries its roller in its end cannot hold it."
        )
    apart = float(wall_between(pistons, across, inner))
    if apart < 0:
        said.append(
            f"The rollers run into each other: {pistons} rollers {1e3 * across:.4g} mm across "
            f"overlap by {-1e3 * apart:.3g} mm at the inner dead centre; take fewer, smaller "
            "rollers or a larger ring."
        )
    return said
