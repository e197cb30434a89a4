"""The layers of an EXR file as numpy arrays `[channels, height, width]`."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path
from typing import TypeAlias

import numpy as np
import OpenEXR
from numpy.typing import NDArray

from deepshade.attributes import COLOUR, MOTION, SCALES, VECTOR
from deepshade.errors import DatasetError

Layer: TypeAlias = NDArray[np.float16] | NDArray[np.float32]

#: Components in their order, which is not that of the file.
COMPONENTS = VECTOR + COLOUR + MOTION + SCALES


def read(path: Path) -> dict[str, Layer]:
    """All layers of a file, half floats where the file has them."""
    with _opened(path, header_only=False) as file:
        planes = {name: channel.pixels for name, channel in file.channels().items()}
        return {
            layer: np.stack([planes[channel] for channel in channels])
            for layer, channels in _by_layer(planes).items()
        }


def names(path: Path) -> list[str]:
    """The names of a file's layers."""
    with _opened(path, header_only=True) as file:
        return list(_by_layer(channel.name for channel in file.header()["channels"]))


def write(path: Path, layers: dict[str, Layer]) -> None:
    """Writes layers of one channel, so that the name never stands for half a file."""
    path.parent.mkdir(parents=True, exist_ok=True)
    partial = path.with_name(f".{path.name}.partial")
    header = {"compression": OpenEXR.ZIP_COMPRESSION, "type": OpenEXR.scanlineimage}
    channels = {name: OpenEXR.Channel(np.ascontiguousarray(plane)) for name, [plane] in layers.items()}
    with OpenEXR.File(header, channels) as file:
        file.write(str(partial))
    partial.replace(path)


def _opened(path: Path, header_only: bool) -> OpenEXR.File:
    if not path.is_file():
        raise DatasetError(f"{path} is missing: `deepshade dataset generate` makes what is missing")
    try:
        file = OpenEXR.File(str(path), header_only=header_only, separate_channels=True)
        # A damaged file has no part, which this finds.
        file.header()
    except (RuntimeError, ValueError) as error:
        raise DatasetError(
            f"{path} is damaged: delete it, and `deepshade dataset generate` makes it again"
        ) from error
    return file


def _by_layer(channels: Iterable[str]) -> dict[str, list[str]]:
    """The channels of each layer: `normal.X`, `.Y` and `.Z` are `normal`; `target.ao` is a layer itself."""
    layers: dict[str, list[str]] = {}
    for channel in channels:
        layer, _, component = channel.rpartition(".")
        layers.setdefault(layer if component in COMPONENTS else channel, []).append(channel)
    for found in layers.values():
        found.sort(key=lambda channel: _order(channel.rpartition(".")[2]))
    return layers


def _order(component: str) -> int:
    return COMPONENTS.index(component) if component in COMPONENTS else 0
