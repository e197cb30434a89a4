"""The same network with features that half floats hold.

Training leaves features as large as it likes, half floats end at 65,504, and graphics cards may run a network
in them. Leaky ReLUs pass a positive factor on: where every block but the last is scaled by a power of two,
and what reads it is scaled back, the image is the same to the last bit.
"""

from __future__ import annotations

import math

import torch
from torch import Tensor

from deepshade.network import Network
from deepshade.spec import Joined, NetSpec, Plain, Pooled


@torch.no_grad()
def balanced(network: Network, noise: Tensor) -> dict[str, Tensor]:
    """The weights by their names in `weights.safetensors`.

    Of every block but the last the largest of what it makes of the noise is from 1 to 2.
    """
    made = network.layers(noise)
    factors = [_scale(image.abs().max().item()) for image in made[:-1]] + [1.0]
    tensors: dict[str, Tensor] = {}
    for index, convolution in enumerate(network.convolutions):
        block = network.spec.blocks[index]
        # The factor of each channel that the convolution reads, dealt out to its groups and from there to
        # the outputs.
        read = torch.tensor(_factors_read(network.spec, index, factors))
        read = read.reshape(block.groups, -1).repeat_interleave(block.outputs // block.groups, 0)
        scale = factors[index] / read
        tensors[f"{block.name}.weight"] = convolution.weight * scale[:, :, None, None]
        tensors[f"{block.name}.bias"] = convolution.bias * factors[index]
    return tensors


def _scale(largest: float) -> float:
    """The power of two that brings a number to between 1 and 2; 1 where there is none."""
    normal = math.isfinite(largest) and largest >= torch.finfo(torch.float32).tiny
    return 2.0 ** -math.floor(math.log2(largest)) if normal else 1.0


def _factors_read(spec: NetSpec, index: int, factors: list[float]) -> list[float]:
    """For each channel that a block reads the factor of the block from which it is."""
    match spec.blocks[index].reads:
        case Plain(read) | Pooled(read):
            return [factors[read]] * spec.blocks[read].outputs
        case Joined(coarse, skip, groups):
            shares = ((read, spec.blocks[read].outputs // groups) for read in (coarse, skip))
            return [factors[read] for read, share in shares for _ in range(share)] * groups
        case _:
            return [1.0] * spec.layers[index].inputs
