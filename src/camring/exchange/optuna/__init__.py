"""Our search for users of Optuna, and our studies for its dashboard (extra `optuna`)."""

from importlib import import_module
from importlib.util import find_spec
from typing import TYPE_CHECKING, Any

from camring.files.errors import InputError

if TYPE_CHECKING:
    from camring.exchange.optuna.exporting import Exported, export_to_optuna
    from camring.exchange.optuna.sampler import CamringSampler

_HOMES = {
    "CamringSampler": "camring.exchange.optuna.sampler",
    "Exported": "camring.exchange.optuna.exporting",
    "export_to_optuna": "camring.exchange.optuna.exporting",
}

__all__ = ["CamringSampler", "Exported", "export_to_optuna"]


def __getattr__(name: str) -> Any:
    if name not in _HOMES:
        raise AttributeError(f"module 'camring.optuna' has no attribute {name!r}")
    if find_spec("optuna") is None:
        raise InputError(
            f"camring.optuna.{name}",
            "needs the extra optuna, which is missing",
            'pip install "camring[optuna]"',
        )
    return getattr(import_module(_HOMES[name]), name)
