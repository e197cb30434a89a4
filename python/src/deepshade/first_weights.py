"""What the weights of a network are before its first step: those that `deepshade train` begins with."""

from __future__ import annotations

import math

import torch
from torch import nn

from deepshade.spec import Correction, Image, Joined, NetSpec

#: Weights of the layer that makes the image, over those of other layers.
IMAGE_SCALE = 0.01
#: The share of their usual deviation that the weights of a residual layer have beside the identity.
RESIDUAL_SCALE = 0.3


@torch.no_grad()
def set_first_weights(spec: NetSpec, convolutions: nn.ModuleList) -> None:
    """Random weights, normal, of variance `2 / ((1 + leak^2) * fan-in)`; biases are 0.

    He and others 2015, "Delving deep into rectifiers", equation 15. An image begins near the effect's
    background, or as the light that the effect filters; a correction begins with its estimate; a kernel
    between blocks of one width begins near the identity.
    """
    for index, convolution in enumerate(convolutions):
        last = index + 1 == len(convolutions)
        image = last and isinstance(spec.head, Image)
        residual = spec.is_residual(index)
        scale = IMAGE_SCALE if image else RESIDUAL_SCALE if residual else 1.0
        fan_in = convolution.weight[0].numel()
        convolution.weight.normal_(0.0, scale * math.sqrt(2.0 / (1.0 + spec.leak**2) / fan_in))
        convolution.bias.fill_(spec.definition.background or 0.0 if image else 0.0)
        if residual:
            middle = convolution.kernel_size[0] // 2
            convolution.weight[:, :, middle, middle].add_(torch.eye(convolution.out_channels))
    if isinstance(spec.head, Correction):
        convolutions[-1].weight.zero_()
    if isinstance(spec.head, Image) and spec.definition.filters_light:
        _pass_light(spec, convolutions[0].weight, convolutions[-1].weight)


def _pass_light(spec: NetSpec, down: nn.Parameter, up: nn.Parameter) -> None:
    """Makes the first block hand on the light, and the last one add it to its image."""
    first, last = spec.blocks[0], spec.blocks[-1]
    lights = spec.channels_of("light")
    fit = first.groups == last.groups == 1 and first.kernel == last.kernel
    if not fit or len(lights) != last.outputs or not len(lights) <= first.outputs <= up.shape[1]:
        return
    middle = first.kernel // 2
    skip = up.shape[1] - first.outputs if isinstance(last.reads, Joined) else 0
    for index, light in enumerate(lights):
        down[index] = 0.0
        down[index, light, middle, middle] = 1.0
        up[index, skip + index, middle, middle] += 1.0
