"""Model folders: what is written is read back, and what is wrong is refused by its name."""

from __future__ import annotations

import copy
import json
import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest
import torch
from safetensors.torch import load_file, save_file

from conftest import MODELS, SHIPPED
from deepshade import ModelError, Network, SpecError, load_model, save_model
from deepshade.model import PARITY, SPEC, WEIGHTS, read_tensors
from specs import ALL
from test_network import without_symmetry

Change = Callable[[dict[str, Any]], object]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A copy of a small shipped network."""
    return Path(shutil.copytree(MODELS / "ao-small", tmp_path / "model"))


@pytest.mark.parametrize("name", ALL)
def test_a_saved_network_makes_the_same_image(name: str, tmp_path: Path) -> None:
    network = without_symmetry(ALL[name]).eval()
    save_model(network, tmp_path / "model")
    again = load_model(tmp_path / "model")
    assert again.spec == network.spec
    x = torch.rand(1, network.spec.input_channels, 21, 30)
    with torch.no_grad():
        torch.testing.assert_close(again(x), network(x), rtol=0.0, atol=0.0)
    parity = read_tensors(tmp_path / "model" / PARITY)
    with torch.no_grad():
        torch.testing.assert_close(again(parity["input"]), parity["output"], rtol=0.0, atol=0.0)


@pytest.mark.parametrize("name", SHIPPED)
def test_a_shipped_network_can_be_saved(name: str, tmp_path: Path) -> None:
    network = load_model(MODELS / name)
    save_model(network, tmp_path)
    x = torch.rand(1, network.spec.input_channels, 21, 30)
    with torch.no_grad():
        torch.testing.assert_close(load_model(tmp_path)(x), network(x), rtol=0.0, atol=0.0)


@pytest.mark.parametrize("name", ["filter", "contiguous"])
def test_features_are_scaled_to_what_half_floats_hold_and_the_network_stays(
    name: str, tmp_path: Path
) -> None:
    network = without_symmetry(ALL[name]).eval()
    with torch.no_grad():
        for index, factor in ((1, 3e6), (2, 1e-9)):
            for values in network.convolutions[index].parameters():
                values.mul_(factor)
    before = copy.deepcopy(network.state_dict())
    save_model(network, tmp_path)
    assert all(torch.equal(values, before[name]) for name, values in network.state_dict().items())
    again = load_model(tmp_path)
    x = torch.rand(1, network.spec.input_channels, 64, 64) * 2.0 - 1.0
    with torch.no_grad():
        assert max(made.abs().max().item() for made in network.layers(x)[:-1]) > 65504.0
        assert all(0.1 < made.abs().max().item() < 10.0 for made in again.layers(x)[:-1])
        torch.testing.assert_close(again(x), network(x), rtol=0.0, atol=0.0)


def test_a_network_of_other_numbers_and_layout_is_saved_in_full(tmp_path: Path) -> None:
    network = without_symmetry(ALL["image"]).bfloat16().to(memory_format=torch.channels_last)
    save_model(network, tmp_path)
    assert all(tensor.dtype == torch.float32 for tensor in load_file(tmp_path / WEIGHTS).values())
    load_model(tmp_path)


def test_files_of_another_network_are_not_left_beside_the_new_one(folder: Path) -> None:
    with pytest.raises(
        ModelError, match=r"holds model\.onnx and card\.md of another network: give a new folder"
    ):
        save_model(load_model(folder), folder)
    (folder / "model.onnx").unlink()
    (folder / "card.md").unlink()
    save_model(load_model(folder), folder)


def test_a_network_that_is_not_finite_is_not_saved(tmp_path: Path) -> None:
    network = Network(ALL["image"])
    network.convolutions[2].bias.data[0] = torch.nan
    with pytest.raises(ModelError, match=r"`convolutions\.2\.bias` holds a number that is not finite"):
        save_model(network, tmp_path / "model")
    assert not (tmp_path / "model").exists()


SPECS: list[tuple[Change, str]] = [
    (lambda spec: spec.update(steps=3), "unknown field `steps`; known are effect, inputs"),
    (lambda spec: spec["blocks"][3].update(stride=2), r"unknown field `blocks\[3\]\.stride`"),
    (lambda spec: spec["head"]["correction"].update(bias=True), r"unknown field `head\.correction\.bias`"),
    (lambda spec: spec["reach"].update(width=1), r"unknown field `reach\.width`"),
    (lambda spec: spec["trained"].update(frames=1), r"unknown field `trained\.frames`"),
    (
        lambda spec: spec["blocks"][10]["reads"]["joined"].update(fine=1),
        r"`blocks\[10\]\.reads\.joined\.fine`",
    ),
    (lambda spec: spec["estimates"][0].update(rays=1), r"unknown field `estimates\[0\]\.rays`"),
    (lambda spec: spec.update(head={"sum": {}}), "`head` is .*; known are image, filter, correction"),
    (lambda spec: spec.update(effect="snow"), '`effect` is "snow"; known are ao, do, gi'),
    (lambda spec: spec["inputs"].append("colour"), r'`inputs\[6\]` is "colour"; known are position'),
    (lambda spec: spec.pop("leak"), "field `leak` is missing"),
    (lambda spec: spec.update(leak=None), "`leak` is null; it has to be a number"),
    (lambda spec: spec.update(leak=2.0), r"`leak` is 2\.0; it must be 0 to 1"),
    (lambda spec: spec["reach"].update(radius=0.0), r"`reach\.radius` is 0\.0; it must be positive"),
    (lambda spec: spec["blocks"][1].update(name="a/b"), "block `a/b`: names are of"),
    (lambda spec: spec["blocks"][1].update(name="fold"), "block `fold` has no name of its own"),
    (lambda spec: spec["blocks"][1].update(kernel=2), "`kernel` is 2; it must be 1, 3, 5 or 7"),
    (
        lambda spec: spec["blocks"][1].update(kernel="3"),
        r'`blocks\[1\]\.kernel` is "3"; it has to be a whole',
    ),
    (
        lambda spec: spec["blocks"][1].update(groups=5),
        "block `residual1` has 5 groups, which do not divide its 12",
    ),
    (
        lambda spec: spec["blocks"][1].update(reads={"plain": 1}),
        "block `residual1` reads a block that comes after",
    ),
    (
        lambda spec: spec["blocks"][10].update(reads={"joined": {"coarse": 9, "skip": 5}}),
        "not one level apart",
    ),
    (
        lambda spec: spec["blocks"][14].update(outputs=75),
        "the last block makes 75 channels; its head needs 76",
    ),
    (
        lambda spec: spec["head"]["correction"].update(over="normal"),
        "works on 3 channels of its input `normal`",
    ),
    (lambda spec: spec["head"]["correction"].update(levels=7), r"`head\.levels` is 7; it must be at most"),
    (lambda spec: spec.update(environment={"sun": 1}), "`environment` is .*; known are sky, file"),
]


@pytest.mark.parametrize(("change", "message"), SPECS)
def test_a_wrong_spec_is_refused_by_name(folder: Path, change: Change, message: str) -> None:
    spec = json.loads((folder / SPEC).read_text())
    change(spec)
    (folder / SPEC).write_text(json.dumps(spec))
    with pytest.raises(ModelError, match=message) as raised:
        load_model(folder)
    assert str(raised.value).startswith(f"{folder / SPEC}: ")
    assert isinstance(raised.value.__cause__, SpecError)


WEIGHT_CHANGES: list[tuple[Change, str]] = [
    (lambda tensors: tensors.pop("up1.bias"), r"has no tensor `up1\.bias`; it holds down2\.bias, "),
    (lambda tensors: tensors.update(extra=torch.zeros(1)), r"network of net\.json has no tensor `extra`"),
    (
        lambda tensors: tensors.update({"up1.bias": torch.zeros(13)}),
        r"`up1\.bias` has shape \[13\], expected \[12\]",
    ),
    (
        lambda tensors: tensors.update({"up1.bias": torch.zeros(12).half()}),
        r"`up1\.bias` holds torch\.float16, expected torch\.float32",
    ),
    (lambda tensors: tensors["up1.bias"].fill_(torch.inf), r"`up1\.bias` holds a number that is not finite"),
]


@pytest.mark.parametrize(("change", "message"), WEIGHT_CHANGES)
def test_wrong_weights_are_refused_by_name(folder: Path, change: Change, message: str) -> None:
    tensors = load_file(folder / WEIGHTS)
    change(tensors)
    save_file(tensors, folder / WEIGHTS)
    with pytest.raises(ModelError, match=message):
        load_model(folder)


def test_missing_and_truncated_files_are_named(folder: Path, tmp_path: Path) -> None:
    with pytest.raises(
        ModelError, match=r"nowhere.net\.json cannot be read: .*is this the folder of a network"
    ):
        load_model(tmp_path / "nowhere")
    whole = (folder / WEIGHTS).read_bytes()
    (folder / WEIGHTS).write_bytes(whole[:-100])
    with pytest.raises(ModelError, match=r"weights\.safetensors is not a whole safetensors file"):
        load_model(folder)
    (folder / WEIGHTS).unlink()
    with pytest.raises(ModelError, match=r"weights\.safetensors cannot be read"):
        load_model(folder)
    (folder / SPEC).write_text("{")
    with pytest.raises(ModelError, match=r"net\.json: is not JSON"):
        load_model(folder)
