"""Figures for notebooks and papers: matplotlib's own, which the caller may change and save.

>>> import camring
>>> figure = camring.plots.torque(cycle)  # doctest: +SKIP
>>> figure.savefig("torque.svg")  # doctest: +SKIP

matplotlib is loaded when the first figure is asked for. No figure is pyplot's and
no setting of matplotlib is changed, so these go with any backend and any style.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from camring.files.errors import CamringError

if TYPE_CHECKING:
    from camring.plots.curves import pressure_volume, spectrum, torque, waveforms
    from camring.plots.fits import fitted
    from camring.plots.fronts import front
    from camring.plots.grids import (
        efficiency_map,
        result_map,
        result_maps,
        ripple_map,
        sweep_curves,
    )
    from camring.plots.histograms import robust_comparison, scatter_histograms
    from camring.plots.layouts import layouts_ranked
    from camring.plots.quadrants import quadrant_map
    from camring.plots.ring import cam
    from camring.plots.starts import charge, starting
    from camring.plots.style import save

_HOMES = {
    "cam": "ring",
    "charge": "starts",
    "efficiency_map": "grids",
    "fitted": "fits",
    "front": "fronts",
    "layouts_ranked": "layouts",
    "pressure_volume": "curves",
    "quadrant_map": "quadrants",
    "result_map": "grids",
    "result_maps": "grids",
    "ripple_map": "grids",
    "robust_comparison": "histograms",
    "save": "style",
    "scatter_histograms": "histograms",
    "spectrum": "curves",
    "starting": "starts",
    "sweep_curves": "grids",
    "torque": "curves",
    "waveforms": "curves",
}

__all__ = [
    "cam",
    "charge",
    "drawable",
    "efficiency_map",
    "fitted",
    "front",
    "layouts_ranked",
    "pressure_volume",
    "quadrant_map",
    "require_matplotlib",
    "result_map",
    "result_maps",
    "ripple_map",
    "robust_comparison",
    "save",
    "scatter_histograms",
    "spectrum",
    "starting",
    "sweep_curves",
    "torque",
    "waveforms",
]


class MissingPlotExtra(CamringError, ImportError):
    """matplotlib is not installed."""

    exit_code = 2


def require_matplotlib() -> None:
    """Refuse to begin what will end in a picture.

    Raises
    ------
    MissingPlotExtra
        When matplotlib cannot be imported.
    """
    try:
        import_module("matplotlib")
    except ImportError as error:
        raise MissingPlotExtra(
            'Pictures need matplotlib, which is not installed; pip install "camring[plot]".'
        ) from error


def drawable() -> bool:
    """Whether a picture can be drawn; if not, says so on stderr, as tables need none."""
    try:
        require_matplotlib()
    except MissingPlotExtra as error:
        from camring.files.visible import say

        say(f"The picture is left out. {error}", err=True)
        return False
    return True


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    require_matplotlib()
    found = getattr(import_module(f"{__name__}.{_HOMES[name]}"), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted(__all__)
