"""Whether control radii seem to be points of a profile, which they are not."""

import numpy as np

from camring.geometry.cam import AbstractCam, RadialCam
from camring.geometry.profiles import LAWS
from camring.geometry.sampling import sample_spline

__all__ = ["control_range", "seem_a_profile"]

_ROUND = 1e-5  # m; strokes of drawings are whole hundredths of a millimetre
_TYPED = 1e-6  # m; radii of drawings have three decimals of a millimetre at most
_ROUNDING = 1e-8  # m
_LEAST_LOSS = 2e-3  # of the stroke, below which it does not matter
_LIKE_A_LAW = 1e-3  # of the stroke


def control_range(cam: AbstractCam) -> tuple[float, float] | None:
    """Range of the control radii and of the radius itself, m; None for a planar cam."""
    if not isinstance(cam, RadialCam):
        return None
    control = np.asarray(cam.control_radii)
    radius = sample_spline(control, cam.period, cam.degree).value
    return float(np.ptp(control)), float(np.ptp(radius))


def seem_a_profile(cam: AbstractCam) -> list[str]:
    """A sentence where control radii seem to be radii or lifts of a drawing, put in directly.

    A control radius is no point of the curve: the spline passes inside its corners. Said where
    the stroke is no whole number of hundredths of a millimetre, but the range of the control
    radii is one, or each of them a whole number of micrometres, as on a drawing; and where they
    are lifts of a textbook law that their spline does not follow.
    """
    found = control_range(cam)
    if found is None:
        return []
    given, stroke = found
    assert isinstance(cam, RadialCam)
    control = np.asarray(cam.control_radii)
    if given - stroke < _LEAST_LOSS * given or not (_is_round(control, stroke) or _is_law(control)):
        return []
    return [
        f"The control radii range over {1e3 * given:.6g} mm but the stroke is "
        f"{1e3 * stroke:.6g} mm: control radii are no points of the cam, whose spline passes "
        "inside their corners. Where they are radii or lifts of a drawing, put them into a table "
        'and give motor.cam.profile = "lift.csv" instead.'
    ]


def _is_round(control: np.ndarray, stroke: float) -> bool:
    def beside(lengths: np.ndarray | float, unit: float) -> float:
        return float(np.max(np.abs(lengths - unit * np.round(lengths / unit))))

    typed = beside(np.ptp(control), _ROUND) < _ROUNDING or beside(control, _TYPED) < _ROUNDING
    # Radii of four decimals whose spline has a stroke of two are within this of it.
    return typed and beside(stroke, _ROUND) > 50 * _ROUNDING


def _is_law(control: np.ndarray) -> bool:
    """Whether one lobe's control radii are lifts of a law other than the sine.

    A sine's own control radii are a sine as well.
    """
    lift = (control - control.min()) / np.ptp(control)
    phase = 2 * np.pi * np.arange(len(lift)) / len(lift)
    for name, law in LAWS.items():
        if name != "sine" and np.max(np.abs(law(phase) - lift)) < _LIKE_A_LAW:
            return True
    return False
