"""From a pair's layers to what a network reads, as the program does it wherever it runs a network.

All of it is found from the whole frame, before a part is cut out.
"""

from __future__ import annotations

from collections.abc import Mapping

import torch
from torch import Tensor

from deepshade.attributes import ATTRIBUTES, COLOUR, MADE_OF
from deepshade.made import made
from deepshade.spec import NetSpec

#: Share of the positive values that do not exceed 1 when light is exposed.
WITHIN = 0.99
#: The most that an estimate comes to, over that, where it is all light that is read.
BRIGHTEST = 64.0
#: Largest factor of light.
MOST = 1e18


def needed(spec: NetSpec) -> list[str]:
    """The layers that a network's input is made of."""
    read = [name for name in spec.inputs if name not in MADE_OF]
    made_of = [source for name in spec.inputs for source in MADE_OF.get(name, ())]
    return list(dict.fromkeys([ATTRIBUTES[name].layer for name in [*read, *made_of]] + ["valid"]))


def network_input(layers: Mapping[str, Tensor], radius: float, spec: NetSpec) -> tuple[Tensor, Tensor]:
    """What all runs read, `[runs, input channels, height, width]`, and what their image is divided by.

    `layers` are 32-bit floats `[channels, height, width]`, those that are `needed`; `radius` is how far the
    effect reaches, metres. Every channel is 0 where no surface is seen, but for what is seen everywhere.
    """
    seen = layers["valid"] > 0.5
    layers = dict(layers) | made(spec.inputs, layers, radius)
    light = exposure(layers, spec)
    factors = {"one": torch.tensor(1.0), "length": torch.tensor(spec.reach.radius / radius), "light": light}
    runs = []
    for run in range(spec.runs):
        channels = []
        for name in spec.inputs:
            attribute = ATTRIBUTES[name]
            powers = torch.tensor([2.0**exponent for exponent in attribute.exponents()])
            values = layers[attribute.layer] * (factors[attribute.scale] * powers)[:, None, None]
            if not is_everywhere(name, spec):
                values = torch.where(seen, values, 0.0)
            mono = spec.colour == "mono" and attribute.components is COLOUR
            channels.append(values[run : run + 1] if mono else values)
        runs.append(torch.cat(channels))
    return torch.stack(runs), light


def is_everywhere(name: str, spec: NetSpec) -> bool:
    """Whether an input is read where no surface is seen, too."""
    return name == "estimate" and spec.definition.background is None


def exposure(layers: Mapping[str, Tensor], spec: NetSpec) -> Tensor:
    """What the light of a frame is multiplied by; 1 where the network reads none."""
    names = [name for name in spec.inputs if ATTRIBUTES[name].scale == "light"]
    if spec.definition.filters_light:
        # An estimate that is made of the frame's light is made after that is exposed.
        names = [name for name in names if name != "estimate"]
    lights = [layers[ATTRIBUTES[name].layer] for name in names]
    if not lights:
        return torch.tensor(1.0)
    values = torch.cat([light.flatten() for light in lights])
    lit = values[(values > 0.0) & values.isfinite()]
    brightness = spec.definition.brightness
    if lit.numel() == 0:
        return torch.tensor(brightness)
    bright = lit.kthvalue(int((lit.numel() - 1) * WITHIN) + 1).values
    if names == ["estimate"]:
        # The rest may be dimmer than what a lamp lights by any number.
        bright = bright.maximum(lit.max() / BRIGHTEST)
    return brightness * (1.0 / bright).clamp(max=MOST)
