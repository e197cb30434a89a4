"""What torch makes of a pair is what the program makes of its file, for networks of every kind of input."""

from __future__ import annotations

import copy
from collections.abc import Mapping
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
import torch
from torch import Tensor

from conftest import MODELS, MakeDataset, Program
from deepshade import DatasetError, Network, PairDataset, load_model, make_estimates, save_model
from deepshade.inputs import network_input
from specs import GAIN
from test_network import without_symmetry

LIGHT = "[vary]\nlight = true\n"
SKY = "[vary]\nenvironment = { sky = 1 }"

#: Shipped networks with the table `vary` of their data.
READ = {
    "aa": LIGHT,
    "ao-paper": "",
    "do-paper": SKY,
    "dof": LIGHT + "lens = [1.0, 12.0]",
    "gi-paper": LIGHT,
    "ibl-paper": "[vary]\nmaterials = true\nenvironment = { sky = 1 }",
    "motion-blur": LIGHT + "motion = [1.0, 24.0]",
    "multi": LIGHT + "lens = [1.0, 12.0]",
    "sss": LIGHT + "mean_free_path = [0.001, 0.02]",
}


#: What of them a pair has to hold.
ESTIMATES = {
    "aa": ["fxaa:high"],
    "dof": ["ring-gather:high"],
    "motion-blur": ["reconstruction:high"],
    "multi": ["occluded-gather:high"],
    "sss": ["separable:ultra"],
}


def by_torch(network: Network, pair: Mapping[str, Tensor]) -> Tensor:
    """The image of a pair, with the effect's background where no surface is seen."""
    with torch.no_grad():
        image = network.eval().image(pair["input"][None], pair["light"][None])[0]
    background = network.spec.definition.background
    return image if background is None else torch.where(pair["valid"] > 0.5, image, background)


def by_program(program: Program, model: Path, gbuffer: Path, out: Path, *options: object) -> Tensor:
    """The image that the program makes of a file, half floats."""
    program("infer", "--model", model, "--gbuffer", gbuffer, "--out", out, *options)
    with OpenEXR.File(str(out), separate_channels=True) as file:
        planes = {name: channel.pixels.astype(np.float32) for name, channel in file.channels().items()}
    names = list(planes) if len(planes) == 1 else sorted(planes, key=lambda name: "RGB".index(name[-1]))
    return torch.from_numpy(np.stack([planes[name] for name in names]))


def agree(image: Tensor, expected: Tensor) -> bool:
    """Whether an image is another one that was rounded to half floats."""
    scale = expected.abs().max().item()
    return bool(((image - expected).abs() <= expected.abs() / 2048 + 1e-4 * scale).all())


@pytest.mark.parametrize("name", READ)
def test_torch_agrees_with_the_program(
    name: str, program: Program, make_dataset: MakeDataset, tmp_path: Path
) -> None:
    network = load_model(MODELS / name)
    folder = make_dataset(network.spec.effect, READ[name], estimates=ESTIMATES.get(name, []))
    changed = copy.deepcopy(network)
    changed.convolutions[0].weight.data.mul_(1.05)
    for pair in PairDataset(folder, spec=network.spec, split="validation"):
        file = folder / f"pairs/{pair['name']}.exr"
        expected = by_program(program, MODELS / name, file, tmp_path / "out.exr")
        assert expected.std() > 0.0
        assert agree(by_torch(network, pair), expected)
        assert not agree(by_torch(changed, pair), expected)


@pytest.mark.parametrize("name", ["ao", "ao-small"])
def test_torch_agrees_with_the_program_on_estimates(
    name: str, program: Program, program_path: str, own_pairs: Path, tmp_path: Path
) -> None:
    network = load_model(MODELS / name)
    with pytest.raises(DatasetError, match=r"is missing: `deepshade\.make_estimates` makes it of the pair"):
        PairDataset(own_pairs, spec=network.spec)
    make_estimates(own_pairs, network.spec, program_path)
    pairs = PairDataset(own_pairs, layers=["valid", "openness"], spec=network.spec, split="all")
    pairs.verify()
    for pair in pairs:
        file = own_pairs / f"pairs/{pair['name']}.exr"
        expected = by_program(program, MODELS / name, file, tmp_path / "out.exr")
        # The estimate itself was rounded to half floats.
        image = by_torch(network, pair)
        assert (image - expected).abs().max() < 2e-3
        assert (image - pair["openness"]).abs().max() > 2e-2


def test_what_is_made_and_a_gain_are_the_programs(
    program: Program, make_dataset: MakeDataset, tmp_path: Path
) -> None:
    folder = make_dataset("do", SKY)
    pair = PairDataset(folder, dtype=torch.float32)[1]
    layers = {name: pair[name] for name in ("normal", "position", "valid")}
    layers["estimate"] = 2.0 * torch.rand(3, *pair["valid"].shape[1:])
    channels = {
        name if len(values) == 1 else f"{name}.{component}": OpenEXR.Channel(values[index].numpy().copy())
        for name, values in layers.items()
        for index, component in enumerate("RGB" if name == "estimate" else "XYZ"[: len(values)])
    }
    OpenEXR.File({"type": OpenEXR.scanlineimage}, channels).write(str(tmp_path / "in.exr"))
    network = without_symmetry(GAIN)
    save_model(network, tmp_path / "model")
    for radius in (0.1, 0.7):
        x, light = network_input(layers, radius, GAIN)
        expected = by_program(
            program, tmp_path / "model", tmp_path / "in.exr", tmp_path / "out.exr", "--radius", radius
        )
        assert agree(by_torch(network, {"input": x, "light": light, "valid": layers["valid"]}), expected)
        for channel in range(GAIN.input_channels):
            damaged = x.clone()
            damaged[:, channel] *= 0.5
            made = by_torch(network, {"input": damaged, "light": light, "valid": layers["valid"]})
            assert not agree(made, expected), f"channel {channel} does not matter"


def test_an_estimate_of_the_scene_comes_from_the_recipe(make_dataset: MakeDataset) -> None:
    folder = make_dataset("do", SKY)
    make_estimates(folder, GAIN)
    assert not (folder / "estimates").exists()
    with pytest.raises(
        DatasetError, match=r'no layer estimate; .*: `estimates = \["ssdo:low"\]` in'
    ):
        PairDataset(folder, spec=GAIN)[0]


def test_a_missing_program_is_said(own_pairs: Path) -> None:
    with pytest.raises(DatasetError, match="there is no program `no-such-program`"):
        make_estimates(own_pairs, load_model(MODELS / "ao").spec, "no-such-program")


def test_what_is_trained_here_is_run_by_the_program(program: Program, ao_pairs: Path, tmp_path: Path) -> None:
    network = load_model(MODELS / "ao-paper").train()
    pairs = PairDataset(ao_pairs, spec=network.spec, crop=32)
    loader = torch.utils.data.DataLoader(pairs, batch_size=2)
    optimiser = torch.optim.Adam(network.parameters(), lr=1e-3)
    losses = []
    for epoch in range(12):
        pairs.set_epoch(epoch % 2)
        for batch in loader:
            image = network.image(batch["input"], batch["light"])
            loss = ((image - batch["target"]).square() * batch["valid"]).mean()
            optimiser.zero_grad()
            loss.backward()
            optimiser.step()
            losses.append(loss.item())
    assert losses[-1] < losses[1]
    save_model(network, tmp_path / "model")
    [first, *_] = PairDataset(ao_pairs, spec=network.spec, split="validation")
    file = ao_pairs / f"pairs/{first['name']}.exr"
    trained, shipped = (
        by_program(program, model, file, tmp_path / "out.exr")
        for model in (tmp_path / "model", MODELS / "ao-paper")
    )
    assert agree(by_torch(network, first), trained)
    assert not agree(by_torch(network, first), shipped)
