"""The effects: how many channels an image has, which values, and what it is where no surface is seen."""

from __future__ import annotations

import math
from dataclasses import dataclass


@dataclass(frozen=True)
class Effect:
    """A quantity at a pixel."""

    #: Its name in files and on the command line.
    name: str
    #: Its value where no surface is seen; none of effects that reach beyond the surface's pixel.
    background: float | None = 0.0
    #: Channels of its image.
    channels: int = 3
    #: The greatest value; the least is 0.
    most: float = math.inf
    #: Whether its image is direct light, averaged over a neighbourhood.
    filters_light: bool = False
    #: How bright light is to its networks: 99 % of what is not black is at most this.
    brightness: float = 1.0


#: Every effect by its name.
EFFECTS: dict[str, Effect] = {
    effect.name: effect
    for effect in (
        Effect("ao", background=1.0, channels=1, most=1.0),
        Effect("do"),
        Effect("gi", brightness=8.0),
        Effect("glossy"),
        Effect("ibl"),
        Effect("occluded-ibl"),
        Effect("sss", filters_light=True),
        Effect("subsurface"),
        Effect("dof", background=None, filters_light=True),
        Effect("motion-blur", background=None, filters_light=True),
        Effect("aa", background=None, filters_light=True),
        Effect("multi", background=None, filters_light=True),
        Effect("fog-direct", background=None),
        Effect("fog-indirect", background=None),
        Effect("fog-multiple", background=None),
        Effect("phosphor"),
        Effect("phosphor-gi"),
        Effect("path", background=None),
        Effect("real", background=None, most=1.0),
    )
}
