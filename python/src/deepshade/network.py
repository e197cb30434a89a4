"""The network of a spec as a torch module."""

from __future__ import annotations

import torch
import torch.nn.functional as F
from torch import Tensor, nn

from deepshade import spec_check
from deepshade.first_weights import set_first_weights
from deepshade.heads import corrected, filtered
from deepshade.spec import Correction, Filter, Folded, Image, Input, Joined, NetSpec, Plain, Pooled


class Network(nn.Module):
    """A network, with the weights that one has before its first step.

    Module `convolutions[i]` is the convolution of block `i` of the spec.
    """

    def __init__(self, spec: NetSpec) -> None:
        """Makes the convolutions of a spec.

        Raises `SpecError` where the program would not run such a network.
        """
        super().__init__()
        spec_check.check(spec)
        self.spec = spec
        self.convolutions = nn.ModuleList(
            nn.Conv2d(
                layer.inputs, block.outputs, block.kernel, padding=block.kernel // 2, groups=block.groups
            )
            for block, layer in zip(spec.blocks, spec.layers, strict=True)
        )
        set_first_weights(spec, self.convolutions)

    def forward(self, x: Tensor) -> Tensor:
        """What each run makes: `[..., input channels, height, width]` to `[..., channels, height, width]`.

        In training mode the image of a correction is not cut to the effect's range, since what is beyond it
        would have no gradient.
        """
        if x.shape[-3] != self.spec.input_channels:
            raise ValueError(
                f"the input has {x.shape[-3]} channels; the network reads {self.spec.input_channels}: "
                f"{', '.join(self.spec.inputs)}"
            )
        image = self._image(x.reshape(-1, *x.shape[-3:]))
        if isinstance(self.spec.head, Correction) and not self.training:
            image = image.clamp(0.0, self.spec.definition.most)
        return image.reshape(*x.shape[:-3], *image.shape[1:])

    def image(self, x: Tensor, light: Tensor) -> Tensor:
        """The effect's image, in the light that frames have; in evaluation mode within the effect's range.

        `x` is `[batch, runs, input channels, height, width]` and `light` `[batch]`, as `PairDataset` gives
        them; the image is `[batch, effect's channels, height, width]`.
        """
        image = self(x).flatten(1, 2) / light.reshape(-1, 1, 1, 1)
        return image if self.training else image.clamp(0.0, self.spec.definition.most)

    def layers(self, x: Tensor) -> list[Tensor]:
        """What each block makes of an input `[batch, input channels, height, width]`, which it pads."""
        x = self._padded(x)
        made: list[Tensor] = []
        for block, convolution in zip(self.spec.blocks, self.convolutions, strict=True):
            match block.reads:
                case Input():
                    read = x
                case Folded():
                    read = _folded(x)
                case Plain(index):
                    read = made[index]
                case Pooled(index):
                    read = F.avg_pool2d(made[index], 2)
                case Joined(coarse, skip, groups):
                    read = _joined(made[coarse], made[skip], groups)
            sums = convolution(read)
            last = len(made) + 1 == len(self.spec.blocks)
            made.append(sums if last else F.leaky_relu(sums, self.spec.leak))
        return made

    def _image(self, x: Tensor) -> Tensor:
        height, width = x.shape[2:]
        made = _unfolded(self.layers(x)[-1], self.spec.layers[-1].level)[:, :, :height, :width]
        match self.spec.head:
            case Image():
                return made
            case Filter() as head:
                return filtered(head, self._padded(x[:, self.spec.channels_of("light")]), made)
            case Correction() as head:
                over = self._padded(x[:, self.spec.channels_of(head.over)])
                return corrected(head, x[:, self.spec.channels_of(head.of)], over, made)

    def _padded(self, x: Tensor) -> Tensor:
        """Continued at bottom and right by the last row and column."""
        bottom, right = (-size % self.spec.alignment for size in x.shape[2:])
        return F.pad(x, (0, right, 0, bottom), mode="replicate")


def _folded(x: Tensor) -> Tensor:
    """The four pixels of a square as channels, pixel by pixel."""
    return torch.cat([x[:, :, row::2, column::2] for row in (0, 1) for column in (0, 1)], 1)


def _unfolded(x: Tensor, level: int) -> Tensor:
    """Channels that are the pixels of squares, `2^level` along an axis, as those pixels."""
    side = 1 << level
    squares = x.unflatten(1, (side, side, -1))
    return squares.permute(0, 3, 4, 1, 5, 2).flatten(4, 5).flatten(2, 3)


def _joined(coarse: Tensor, skip: Tensor, groups: int) -> Tensor:
    """Two blocks' images, the coarser one doubled, their channels dealt out in groups."""
    doubled = F.interpolate(coarse, scale_factor=2, mode="bilinear", align_corners=False)
    return torch.cat([image.unflatten(1, (groups, -1)) for image in (doubled, skip)], 2).flatten(1, 2)
