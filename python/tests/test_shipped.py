"""Every shipped network: its image, its gradients, and that a changed weight is found out."""

from __future__ import annotations

import pytest
import torch
from torch import Tensor

from conftest import MODELS, SHIPPED
from deepshade import Network, load_model, spec_json
from deepshade.model import PARITY, SPEC, read_tensors

parametrized = pytest.mark.parametrize("name", SHIPPED)


def deviation(network: Network, parity: dict[str, Tensor]) -> float:
    """The largest one, over the image's rms where that is above 1."""
    with torch.no_grad():
        largest = (network(parity["input"]) - parity["output"]).abs().max().item()
    rms = parity["output"].square().mean().sqrt().item()
    return largest / max(1.0, rms)


def share_of_tolerance(network: Network, parity: dict[str, Tensor]) -> float:
    """The deviation over what is allowed."""
    return deviation(network, parity) / 1e-4


def test_no_shipped_network_is_left_out() -> None:
    assert sorted(path.parent.name for path in MODELS.glob(f"*/{SPEC}")) == list(SHIPPED)


@parametrized
def test_the_image_is_that_of_the_parity_file(name: str, record_property: pytest.RecordProperty) -> None:
    network, parity = load_model(MODELS / name), read_tensors(MODELS / name / PARITY)
    record_property("max_abs", deviation(network, parity))
    assert share_of_tolerance(network, parity) < 1.0


@parametrized
def test_a_changed_weight_is_found_out(name: str) -> None:
    network, parity = load_model(MODELS / name), read_tensors(MODELS / name / PARITY)
    weight = network.convolutions[0].weight.detach().view(-1)
    weight[weight.abs().argmax()] *= 1.01
    assert share_of_tolerance(network, parity) > 1.0


@parametrized
def test_every_block_matters(name: str) -> None:
    network, parity = load_model(MODELS / name), read_tensors(MODELS / name / PARITY)
    for block, convolution in zip(network.spec.blocks, network.convolutions, strict=True):
        whole = convolution.weight.detach().clone()
        convolution.weight.data.mul_(0.5)
        assert share_of_tolerance(network, parity) > 1.0, block.name
        convolution.weight.data.copy_(whole)


@parametrized
def test_every_weight_has_a_gradient(name: str) -> None:
    network, parity = load_model(MODELS / name).train(), read_tensors(MODELS / name / PARITY)
    network(parity["input"]).square().mean().backward()
    for parameter, values in network.named_parameters():
        gradient = values.grad
        assert gradient is not None and gradient.isfinite().all() and gradient.any(), parameter


@parametrized
def test_the_spec_is_written_as_it_was(name: str) -> None:
    text = (MODELS / name / SPEC).read_text()
    assert spec_json.write(spec_json.read(text)).strip() == text.strip()


def test_a_batch_of_runs_is_its_images() -> None:
    network = load_model(MODELS / "gi-paper")
    x = torch.randn(2, 3, 7, 21, 30)
    with torch.no_grad():
        images = network(x)
        assert images.shape == (2, 3, 1, 21, 30)
        torch.testing.assert_close(images[1, 2], network(x[1, 2]))


def test_an_input_of_other_channels_is_refused() -> None:
    network = load_model(MODELS / "gi-paper")
    with pytest.raises(ValueError, match="6 channels; the network reads 7: normal, position, diffuse-light"):
        network(torch.zeros(6, 21, 30))
