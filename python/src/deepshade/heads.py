"""The heads: an image of what the last block makes and of an input.

Filter: Bako and others 2017, "Kernel-predicting convolutional networks for denoising Monte Carlo renderings";
over several resolutions Vogels and others 2018, "Denoising with kernel prediction and asymmetric loss
functions".
"""

from __future__ import annotations

from collections.abc import Iterator

import torch.nn.functional as F
from torch import Tensor

from deepshade.spec import Correction, Filter

#: Half of a gated correction counts where the estimate differs by this from what the pyramid is of.
HALF_GATE = 1.0 / 256.0


def filtered(head: Filter, light: Tensor, made: Tensor) -> Tensor:
    """The sum of the light that softmax weights weigh.

    `light` is `[batch, channels, height, width]`, padded; `made` is `[batch, weights, height, width]` of the
    image. A weight of black has no light.
    """
    weights = made.softmax(1)
    pixels = enumerate(taps(light, head.levels, head.kernel, made.shape[2:]))
    return sum((weights[:, tap : tap + 1] * pixel for tap, pixel in pixels), light.new_zeros(()))


def corrected(head: Correction, estimate: Tensor, over: Tensor, made: Tensor) -> Tensor:
    """`E + (bias or gain * E) + sum of w * (S - E)` of an estimate `E` and the pixels `S` of `over`, padded.

    `made` is `[batch, biases + weights, height, width]`: the biases, the weights, then the gain. Of a gated
    head nothing is corrected where `E` is `over`.
    """
    biases = head.biases(estimate.shape[1])
    image = estimate + (made[:, -1:] * estimate if head.gain else made[:, :biases])
    for tap, pixel in enumerate(taps(over, head.levels, head.kernel, made.shape[2:]), biases):
        image = image + made[:, tap : tap + 1] * (pixel - estimate)
    if not head.gated:
        return image
    height, width = made.shape[2:]
    difference = (over[:, :, :height, :width] - estimate).abs().amax(1, keepdim=True)
    return estimate + difference / (difference + HALF_GATE) * (image - estimate)


def taps(image: Tensor, levels: int, kernel: int, size: tuple[int, ...]) -> Iterator[Tensor]:
    """The pixels of a pyramid that each pixel of an image of some size reads, in the order of their weights.

    Level `l` has the means of `2^l` pixels squared, is read bilinearly between the middles of its pixels, and
    beyond its edge as at the edge. The taps of a kernel are one pixel of the level apart.
    """
    height, width = size
    radius = kernel // 2
    for level in range(levels):
        if level > 0:
            image = F.avg_pool2d(image, 2)
        wide = F.pad(image, [radius] * 4, mode="replicate")
        if level > 0:
            wide = F.interpolate(wide, scale_factor=2**level, mode="bilinear", align_corners=False)
        for row in range(kernel):
            for column in range(kernel):
                top, left = row << level, column << level
                yield wide[:, :, top : top + height, left : left + width]
