"""What networks read that follows from positions and the effect's radius: relief, pixel radius, border."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import torch
import torch.nn.functional as F
from torch import Tensor

#: Levels of the pyramid of depth that relief is against: squares of 4, 16 and 64 pixels.
RELIEF_LEVELS = (2, 4, 6)
#: What logarithms of pixels are divided by.
OCTAVES = 8.0
#: The smallest radius in pixels that is told from smaller ones.
LEAST_PIXELS = 0.25

TINY = torch.finfo(torch.float32).tiny


def made(wanted: Iterable[str], layers: Mapping[str, Tensor], radius: float) -> dict[str, Tensor]:
    """Those of the three that are wanted, by the names of their layers, 0 where no surface is seen.

    `layers` has `position` and `valid`, `[channels, height, width]`; `radius` is in metres.
    """
    makers = {"relief": _relief, "pixel-radius": _pixel_radius, "border": _border}
    wanted = [name for name in wanted if name in makers]
    if not wanted:
        return {}
    seen = layers["valid"] > 0.5
    depth = torch.where(seen, -layers["position"][2:], 0.0)
    pixels = focal_length(layers["position"], seen) * radius / depth.clamp(min=TINY)
    made = {name.replace("-", "_"): makers[name](depth, pixels, radius) for name in wanted}
    return {name: torch.where(depth > 0.0, values, 0.0) for name, values in made.items()}


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


def _relief(depth: Tensor, _pixels: Tensor, radius: float) -> Tensor:
    """Depth against its means over squares of pixels, of what is seen alone, in radii, between -1 and 1."""
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


def _pixel_radius(_depth: Tensor, pixels: Tensor, _radius: float) -> Tensor:
    """The logarithm of the radius in pixels."""
    return pixels.clamp(min=LEAST_PIXELS).log2() / OCTAVES


def _border(_depth: Tensor, pixels: Tensor, _radius: float) -> Tensor:
    """The distance to the image's nearest border, in radii, at most 1."""
    height, width = pixels.shape[1:]
    rows, columns = (torch.arange(size) + 0.5 for size in (height, width))
    rows, columns = (torch.minimum(way, way.flip(0)) for way in (rows, columns))
    return (torch.minimum(rows[:, None], columns) / pixels).clamp(max=1.0)
