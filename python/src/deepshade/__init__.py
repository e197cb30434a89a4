"""deepshade's data and networks in PyTorch.

What needs torch is imported when it is first asked for, so that a wheel that was installed for its program
alone can be imported, too.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING

from deepshade.errors import DatasetError, ModelError, SpecError
from deepshade.spec import NetSpec

if TYPE_CHECKING:
    from deepshade.data import PairDataset
    from deepshade.estimates import make_estimates
    from deepshade.model import load_model, save_model
    from deepshade.network import Network

__all__ = [
    "DatasetError",
    "ModelError",
    "NetSpec",
    "Network",
    "PairDataset",
    "SpecError",
    "load_model",
    "make_estimates",
    "save_model",
]

_MODULES = {
    "Network": "deepshade.network",
    "PairDataset": "deepshade.data",
    "load_model": "deepshade.model",
    "make_estimates": "deepshade.estimates",
    "save_model": "deepshade.model",
}


def __getattr__(name: str) -> object:
    """Imports what needs torch."""
    if name not in _MODULES:
        raise AttributeError(f"module `deepshade` has no attribute `{name}`")
    try:
        return getattr(import_module(_MODULES[name]), name)
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(
            f"deepshade.{name} needs the package `{error.name}`: pip install 'deepshade[torch]'",
            name=error.name,
        ) from error
