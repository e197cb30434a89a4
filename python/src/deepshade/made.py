"""What networks read that follows from other attributes and the effect's radius."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping

import torch
import torch.nn.functional as F
from torch import Tensor

from deepshade.attributes import MADE_OF

#: Levels of the pyramid of depth that relief is against: squares of 4, 16 and 64 pixels.
RELIEF_LEVELS = (2, 4, 6)
#: What logarithms of pixels are divided by.
OCTAVES = 8.0
#: The smallest radius in pixels that is told from smaller ones.
LEAST_PIXELS = 0.25
#: What pixels of circles and movements are divided by, and the most of these of a circle.
EIGHT_PIXELS = 8.0
MOST_EIGHTS = 8.0

TINY = torch.finfo(torch.float32).tiny


def made(wanted: Iterable[str], layers: Mapping[str, Tensor], radius: float) -> dict[str, Tensor]:
    """Those that are wanted, by the names of their layers, 0 where no surface is seen.

    `layers` has `valid` and what they are made of (`MADE_OF`), `[channels, height, width]`; `radius` is in
    metres.
    """
    wanted = [name for name in wanted if name in MADE_OF]
    seen = layers["valid"] > 0.5
    found = {}
    for name in wanted:
        shown = seen & (_depth(layers, seen) > 0.0) if "position" in MADE_OF[name] else seen
        found[name.replace("-", "_")] = torch.where(shown, MAKERS[name](layers, seen, radius), 0.0)
    return found


def _depth(layers: Mapping[str, Tensor], seen: Tensor) -> Tensor:
    return torch.where(seen, -layers["position"][2:], 0.0)


def _pixels(layers: Mapping[str, Tensor], seen: Tensor, length: float | Tensor) -> Tensor:
    """How many pixels a length covers."""
    return focal_length(layers["position"], seen) * length / _depth(layers, seen).clamp(min=TINY)


def focal_length(position: Tensor, seen: Tensor) -> float:
    """Pixels, at depth 1, between two points one unit apart: the number that fits positions best."""
    height, width = position.shape[1:]
    x, y, z = position.double()
    depth = -z
    counts = seen[0] & (depth > 0.0) & depth.isfinite()
    columns = torch.arange(width) + 0.5 - 0.5 * width
    rows = 0.5 * height - 0.5 - torch.arange(height)
    pixels = torch.stack([columns.expand(height, width), rows[:, None].expand(height, width)])[:, counts]
    slopes = (torch.stack([x, y]) / depth)[:, counts]
    found = ((slopes * pixels).sum() / slopes.square().sum()).item()
    return found if 0.0 < found < float("inf") else 1.0


def _relief(layers: Mapping[str, Tensor], seen: Tensor, radius: float) -> Tensor:
    """Depth against its means over squares of pixels, of what is seen alone, in radii, between -1 and 1."""
    depth = _depth(layers, seen)
    height, width = depth.shape[1:]
    sums = torch.cat([depth, (depth > 0.0).float()])[None]
    reliefs = []
    for level in range(1, RELIEF_LEVELS[-1] + 1):
        sums = F.avg_pool2d(sums, 2, ceil_mode=True, divisor_override=1)
        if level in RELIEF_LEVELS:
            wide = F.interpolate(sums, scale_factor=2**level, mode="bilinear", align_corners=False)
            total, weight = wide[0, :, :height, :width]
            relief = (depth[0] - total / weight.clamp(min=TINY)) / radius
            reliefs.append(relief / (1.0 + relief.abs()))
    return torch.stack(reliefs)


def _pixel_radius(layers: Mapping[str, Tensor], seen: Tensor, radius: float) -> Tensor:
    """The logarithm of the radius in pixels."""
    return _pixels(layers, seen, radius).clamp(min=LEAST_PIXELS).log2() / OCTAVES


def _border(layers: Mapping[str, Tensor], seen: Tensor, radius: float) -> Tensor:
    """The distance to the image's nearest border, in radii, at most 1."""
    pixels = _pixels(layers, seen, radius)
    height, width = pixels.shape[1:]
    rows, columns = (torch.arange(size) + 0.5 for size in (height, width))
    rows, columns = (torch.minimum(way, way.flip(0)) for way in (rows, columns))
    return (torch.minimum(rows[:, None], columns) / pixels).clamp(max=1.0)


def _signed_circle(layers: Mapping[str, Tensor], _seen: Tensor, _radius: float) -> Tensor:
    """The signed radius of the circle of confusion, in eights of pixels."""
    circle = layers["blurriness"] / (layers["depth"] * EIGHT_PIXELS)
    return circle.clamp(-MOST_EIGHTS, MOST_EIGHTS)


def _movement(layers: Mapping[str, Tensor], _seen: Tensor, _radius: float) -> Tensor:
    """A movement in eights of pixels as a vector at twice its angle: back and forth are the same."""
    direction, length = layers["motion"]
    return length / EIGHT_PIXELS * torch.stack([(2.0 * direction).cos(), (2.0 * direction).sin()])


def _free_path_pixels(layers: Mapping[str, Tensor], seen: Tensor, _radius: float) -> Tensor:
    """The logarithm of the mean free path of each colour in pixels."""
    return _pixels(layers, seen, layers["mean_free_path"]).clamp(min=LEAST_PIXELS).log2() / OCTAVES


MAKERS: dict[str, Callable[[Mapping[str, Tensor], Tensor, float], Tensor]] = {
    "relief": _relief,
    "pixel-radius": _pixel_radius,
    "border": _border,
    "signed-circle": _signed_circle,
    "movement": _movement,
    "free-path-pixels": _free_path_pixels,
}
