"""The table [motor.cam], for either representation of the pitch curve."""

from typing import Annotated as Key

from camring.files.motor.entries import Count, Number, NumberOrWord, Numbers, Text, Word
from camring.files.motor.table import FULL_TURN, LARGEST_RADIUS, Table, modulus, poisson, unit_of
from camring.geometry.cam import PlanarCam, RadialCam

__all__ = ["CamTable", "PlanarCamTable", "RadialCamTable"]

LEAST_TOLERANCE, USUAL_TOLERANCE = 1e-8, 1e-5  # m


class CamTable(Table):
    """[motor.cam]: keys of every representation; the control values follow below."""

    representation: Key[
        str, Word("how the pitch curve is written", '"radial"', words=("radial", "planar"))
    ] = "radial"
    symmetry: Key[str, Word("over which part it repeats", '"lobes"', words=("lobes", "ring"))] = (
        "lobes"
    )
    reference_radius: Key[
        str | float,
        NumberOrWord(
            "the pitch radius at lift zero",
            '"minimum", "mean" or "90 mm"',
            unit="m",
            low=1e-4,
            high=LARGEST_RADIUS,
            words=("minimum", "mean"),
            leaves=("motor.given_reference_radius",),
        ),
    ] = "minimum"
    degree: Key[int, Count("the degree of the spline", "3", low=3, high=5)] = 3
    outer_diameter: Key[
        float | None,
        Number("the outer diameter of the ring's body", '"250 mm"', unit="m", low=1e-3, high=20.0),
    ] = None
    elastic_modulus: Key[float, modulus("motor.ring_material.elastic_modulus")]
    poisson_ratio: Key[float, poisson("motor.ring_material.poisson_ratio")]


def _control_value(meaning: str, unit: str, low: float) -> Number:
    return Number(meaning, '"90 mm"', unit=unit, low=low, high=LARGEST_RADIUS)


CONTROL_RADIUS = _control_value("a control radius", unit_of(RadialCam, "control_radii"), 1e-4)
COORDINATE = _control_value("a coordinate", unit_of(PlanarCam, "control_points"), -LARGEST_RADIUS)


class RadialCamTable(CamTable):
    """[motor.cam] whose spline is the radius itself."""

    control_radii: Key[
        list[float],
        Numbers(
            "the control radii of one period",
            '["84 mm", "86 mm", ...]',
            item=CONTROL_RADIUS,
            most=720,
            leaves=("motor.cam.control_radii",),
        ),
    ]
    profile: Key[
        str | None,
        Text(
            "a file of points that stand for control_radii: a table, a DXF drawing or a curve file",
            '"lift.csv", "ring.dxf" or "cam.sldcrv"',
        ),
    ] = None
    tolerance: Key[
        float,
        Number(
            "how far a point of the profile may lie from the fitted cam",
            '"10 um"',
            unit="m",
            low=LEAST_TOLERANCE,
            high=1e-2,
        ),
    ] = USUAL_TOLERANCE
    profile_curve: Key[
        str | None,
        Word(
            "what the profile's points are of, the path of the roller centre or the ring itself",
            '"surface"',
            words=("pitch", "surface"),
        ),
    ] = None
    profile_turn: Key[
        float,
        Number(
            "by how much the profile is turned",
            '"12.5 deg"',
            unit="rad",
            low=-FULL_TURN,
            high=FULL_TURN,
        ),
    ] = 0.0
    base_radius: Key[
        float | None,
        Number(
            "the pitch radius at lift zero of a profile of lifts",
            '"84.9 mm"',
            unit="m",
            low=1e-4,
            high=LARGEST_RADIUS,
        ),
    ] = None
    control_count: Key[
        int | None,
        Count("how many control radii are fitted to the profile", "24", low=4, high=720),
    ] = None


class PlanarCamTable(CamTable):
    """[motor.cam] whose spline is a curve in the plane."""

    control_points: Key[
        list[list[float]],
        Numbers(
            "the control points of one period",
            '[["84 mm", "0 mm"], ...]',
            item=Numbers("a point", '["84 mm", "0 mm"]', item=COORDINATE, fewest=2, most=2),
            most=720,
            leaves=("motor.cam.control_points",),
        ),
    ]
