"""Networks made anew: gradients of every head against differences, first weights, the range of an image."""

from __future__ import annotations

import pytest
import torch
from torch import Tensor, nn

from deepshade import NetSpec, Network
from deepshade.heads import taps
from specs import ALL, CORRECTION, GAIN, LIGHT


def without_symmetry(spec: NetSpec) -> Network:
    """A network whose weights, biases and last block are all random."""
    network = Network(spec)
    with torch.no_grad():
        for convolution in network.convolutions:
            nn.init.kaiming_normal_(convolution.weight)
            convolution.bias.normal_(0.0, 0.3)
        network.convolutions[-1].weight.mul_(0.3)
    return network


@pytest.mark.parametrize("name", ALL)
def test_gradients_are_differences(name: str) -> None:
    network = without_symmetry(ALL[name]).double()
    x = torch.rand(1, network.spec.input_channels, 13, 10, dtype=torch.float64)
    network(x).square().sum().backward()
    for values in network.parameters():
        assert values.grad is not None
        direction = torch.randn_like(values)
        expected = (values.grad * direction).sum().item()
        sums = []
        with torch.no_grad():
            for step in (1e-8, -2e-8):
                values.add_(direction, alpha=step)
                sums.append(network(x).square().sum().item())
            values.add_(direction, alpha=1e-8)
        found = (sums[0] - sums[1]) / 2e-8
        assert found == pytest.approx(expected, rel=1e-4, abs=1e-5)


def test_a_correction_begins_with_its_estimate_and_direct_light_with_itself() -> None:
    for spec, first, exact in ((CORRECTION, 6, True), (GAIN, 8, True), (LIGHT, 1, False)):
        network = Network(spec).eval()
        x = torch.rand(1, spec.input_channels, 21, 30)
        with torch.no_grad():
            image = network(x)
        estimate = x[:, first : first + spec.output_channels]
        assert (image - estimate).abs().max() < (1e-6 if exact else 0.2)


def test_an_image_is_within_the_range_in_evaluation_alone() -> None:
    network = without_symmetry(CORRECTION)
    x = 3.0 * torch.rand(1, CORRECTION.input_channels, 16, 16)
    with torch.no_grad():
        free, cut = network.train()(x), network.eval()(x)
    assert free.max() > 1.0
    torch.testing.assert_close(cut, free.clamp(0.0, 1.0))


def by_definition(image: Tensor, level: int, offset: tuple[int, int], at: tuple[int, int]) -> float:
    """A pixel of the pyramid read as the filter's definition says, one number at a time."""
    for _ in range(level):
        image = image.unfold(0, 2, 2).unfold(1, 2, 2).mean((2, 3))
    sides = []
    for size, pixel, moved in zip(image.shape, at, offset, strict=True):
        position = (pixel + 0.5) / 2**level - 0.5
        first = int(position // 1)
        near, far = (min(max(first + moved + step, 0), size - 1) for step in (0, 1))
        sides.append((near, far, position - first))
    (top, bottom, low), (left, right, wide) = sides
    upper = (1 - wide) * image[top, left] + wide * image[top, right]
    lower = (1 - wide) * image[bottom, left] + wide * image[bottom, right]
    return ((1 - low) * upper + low * lower).item()


def test_taps_read_the_pyramid_as_it_is_defined() -> None:
    image = torch.rand(8, 12)
    read = list(taps(image[None, None], 3, 3, (7, 11)))
    assert len(read) == 27
    offsets = [(row, column) for row in (-1, 0, 1) for column in (-1, 0, 1)]
    for tap, values in enumerate(read):
        for at in ((0, 0), (3, 5), (6, 10), (0, 10), (5, 0)):
            expected = by_definition(image, tap // 9, offsets[tap % 9], at)
            assert values[0, 0, at[0], at[1]].item() == pytest.approx(expected, abs=1e-6), (tap, at)
