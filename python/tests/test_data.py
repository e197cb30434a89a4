"""Pairs that the program makes: what an item holds, crops, splits, workers, and what is wrong with files."""

from __future__ import annotations

import json
import pickle
from pathlib import Path

import numpy as np
import OpenEXR
import pytest
import torch
from torch.utils.data import DataLoader

from conftest import MODELS, MakeDataset, Program
from deepshade import DatasetError, PairDataset, load_model
from deepshade.data import Pair

COMPONENTS = {"normal": "XYZ", "position": "XYZ", "diffuse_light": "RGB", "diffuse": "RGB"}


def assert_same(a: Pair, b: Pair) -> None:
    assert a.keys() == b.keys()
    for name, value in a.items():
        other = b[name]
        assert torch.equal(value, other) if isinstance(value, torch.Tensor) else value == other, name


def test_layers_are_what_the_exr_library_reads(make_dataset: MakeDataset) -> None:
    folder = make_dataset("gi", vary="[vary]\nlight = true")
    for dtype in (torch.float16, torch.float32):
        pairs = PairDataset(folder, split="all", dtype=dtype)
        assert pairs.layers == ["diffuse", "diffuse_light", "normal", "position", "valid"]
        for pair in pairs:
            with OpenEXR.File(str(folder / f"pairs/{pair['name']}.exr"), separate_channels=True) as file:
                planes = {name: channel.pixels.copy() for name, channel in file.channels().items()}
                radius = float(file.header()["radius_metres"])
            expected = {layer: [f"{layer}.{one}" for one in names] for layer, names in COMPONENTS.items()}
            expected |= {"target": [f"target.gi.{one}" for one in "RGB"], "valid": ["valid"]}
            for layer, channels in expected.items():
                assert pair[layer].dtype == dtype
                held = np.stack([planes[channel] for channel in channels])
                np.testing.assert_array_equal(pair[layer].numpy(), held)
            variance = np.stack([planes[f"variance.{one}"] for one in "RGB"])
            assert pair["variance"].dtype == torch.float32 and variance.any()
            np.testing.assert_array_equal(pair["variance"].numpy(), variance)
            assert pair["radius"].item() == pytest.approx(radius)
            assert pair["scene"].startswith("still-life:")
            assert len(planes) == sum(len(pair[name]) for name in [*expected, "variance"])


def test_variance_is_there_where_the_recipe_makes_it(make_dataset: MakeDataset) -> None:
    pair = PairDataset(make_dataset("ao", scramblings=1))[0]
    assert set(pair) == {"normal", "position", "valid", "target", "radius", "name", "scene"}


def test_splits_are_those_of_the_manifest(ao_pairs: Path) -> None:
    names = {
        split: [pair["name"] for pair in PairDataset(ao_pairs, split=split)]
        for split in ("train", "validation", "all")
    }
    assert names["train"] == ["still-life-0000-000", "still-life-0000-001"]
    assert names["validation"] == ["still-life-0001-000", "still-life-0001-001"]
    assert names["all"] == names["train"] + names["validation"]


def test_layers_may_be_chosen(ao_pairs: Path) -> None:
    pair = PairDataset(ao_pairs, layers=["position"])[1]
    assert set(pair) == {"position", "target", "variance", "radius", "name", "scene"}
    assert pair["position"].shape == (3, 64, 72) and pair["target"].shape == (1, 64, 72)


def test_a_crop_is_a_window_of_all_that_an_item_has(ao_pairs: Path) -> None:
    spec = load_model(MODELS / "ao-paper").spec
    whole, cut = (PairDataset(ao_pairs, crop=crop, spec=spec) for crop in (None, 24))
    corners = set()
    for epoch in range(4):
        cut.set_epoch(epoch)
        for index in range(len(cut)):
            pair, crop = whole[index], cut[index]
            assert crop["valid"].float().mean() >= 0.25
            position = pair["position"].unfold(1, 24, 1).unfold(2, 24, 1)
            same = (position == crop["position"][:, None, None]).all((0, 3, 4)).nonzero()
            assert len(same) == 1
            top, left = same[0].tolist()
            corners.add((index, top, left))
            for name in ("normal", "position", "valid", "target", "variance", "input"):
                expected = pair[name][..., top : top + 24, left : left + 24]
                assert torch.equal(crop[name], expected), name
            assert_same(crop, cut[index])
    assert len(corners) >= 6, "another window in every epoch"


def test_a_crop_as_large_as_a_pair_is_the_pair_and_a_larger_one_is_refused(ao_pairs: Path) -> None:
    assert PairDataset(ao_pairs, crop=64)[0]["target"].shape == (1, 64, 64)
    with pytest.raises(DatasetError, match="is 72 x 64 pixels, smaller than the crop of 65"):
        PairDataset(ao_pairs, crop=65)[0]


@pytest.mark.parametrize("start", ["fork", "spawn"])
def test_workers_read_the_same_as_none(ao_pairs: Path, start: str) -> None:
    spec = load_model(MODELS / "ao-paper").spec
    pairs = PairDataset(ao_pairs, split="all", crop=16, spec=spec)
    workers = DataLoader(
        pairs, batch_size=2, num_workers=2, persistent_workers=True, multiprocessing_context=start
    )
    epochs = []
    for epoch in range(2):
        pairs.set_epoch(epoch)
        alone = list(DataLoader(pairs, batch_size=2))
        for a, b in zip(alone, workers, strict=True):
            assert_same(a, b)
            assert a["input"].shape == (2, 1, 6, 16, 16) and a["light"].shape == a["radius"].shape == (2,)
        epochs.append(torch.cat([batch["position"] for batch in alone]))
    assert not torch.equal(*epochs)


def test_a_dataset_survives_pickling(ao_pairs: Path) -> None:
    pairs = PairDataset(ao_pairs, crop=16)
    pairs.set_epoch(3)
    assert_same(pickle.loads(pickle.dumps(pairs))[1], pairs[1])


def test_a_missing_layer_is_named_with_those_that_are_there(ao_pairs: Path) -> None:
    with pytest.raises(DatasetError, match="has no layer light, depth; it holds normal, position, valid"):
        PairDataset(ao_pairs, layers=["normal", "light", "depth"])


def test_what_is_no_dataset_says_what_to_do(own_pairs: Path, tmp_path: Path) -> None:
    with pytest.raises(DatasetError, match="nowhere is no folder: `deepshade dataset generate RECIPE --out"):
        PairDataset(tmp_path / "nowhere")
    manifest = own_pairs / "manifest.json"
    value = json.loads(manifest.read_text())
    value["origin"]["data_version"] = 3
    manifest.write_text(json.dumps(value))
    with pytest.raises(DatasetError, match="of version 3 of the data; this package reads 4: make them again"):
        PairDataset(own_pairs)
    del value["origin"]
    manifest.write_text(json.dumps(value))
    with pytest.raises(DatasetError, match="is no manifest of this version: it lacks 'origin'"):
        PairDataset(own_pairs)
    manifest.write_text("{")
    with pytest.raises(DatasetError, match=r"manifest\.json is damaged"):
        PairDataset(own_pairs)
    manifest.unlink()
    with pytest.raises(DatasetError, match=r"has no manifest\.json: it is no dataset, or an unfinished one"):
        PairDataset(own_pairs)


def test_a_shard_is_to_be_merged(ao_pairs: Path, program: Program, tmp_path: Path) -> None:
    recipe = ao_pairs.parent / "recipe.toml"
    program("dataset", "generate", recipe, "--shard", "1/2", "--out", tmp_path / "one")
    with pytest.raises(DatasetError, match="holds a shard: merge it with the others first"):
        PairDataset(tmp_path / "one")


def test_damage_is_found_by_reading_or_by_its_hash(own_pairs: Path) -> None:
    pairs = PairDataset(own_pairs)
    pairs.verify()
    path = own_pairs / pairs.records[1].file
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(DatasetError, match=r"0000-001\.exr is damaged: delete it, and `deepshade dataset"):
        pairs[1]
    path.write_bytes(whole.replace(b"still-life", b"still-lifE", 1))
    assert_same(pairs[1], PairDataset(own_pairs)[1])
    (own_pairs / pairs.records[0].file).unlink()
    with pytest.raises(DatasetError, match=r"0000-000\.exr is missing: `deepshade dataset generate` makes"):
        pairs[0]
    message = r"pairs/still-life-0000-000\.exr is missing, pairs/still-life-0000-001\.exr was changed: delete"
    with pytest.raises(DatasetError, match=message):
        pairs.verify()


def test_numbers_beyond_half_floats_are_not_made_infinite(own_pairs: Path) -> None:
    path = own_pairs / PairDataset(own_pairs).records[0].file
    with OpenEXR.File(str(path), separate_channels=True) as file:
        planes = {name: OpenEXR.Channel(channel.pixels.copy()) for name, channel in file.channels().items()}
    planes["position.Z"].pixels = planes["position.Z"].pixels.astype(np.float32) * 1e5
    OpenEXR.File({"type": OpenEXR.scanlineimage}, planes).write(str(path))
    with pytest.raises(DatasetError, match="position holds numbers beyond half floats: ask for dtype="):
        PairDataset(own_pairs)[0]
    position = PairDataset(own_pairs, dtype=torch.float32)[0]["position"]
    assert position.isfinite().all() and position.abs().max() > 65504.0


def test_what_there_is_not_is_said(ao_pairs: Path, own_pairs: Path) -> None:
    with pytest.raises(ValueError, match="no split `test`; there are train, validation and all"):
        PairDataset(ao_pairs, split="test")
    with pytest.raises(ValueError, match=r"no dtype torch\.float64"):
        PairDataset(ao_pairs, dtype=torch.float64)
    with pytest.raises(DatasetError, match="is of `ao`, and the network of `gi`"):
        PairDataset(ao_pairs, spec=load_model(MODELS / "gi").spec)
    manifest = own_pairs / "manifest.json"
    manifest.write_text(manifest.read_text().replace('"validation"', '"training"'))
    with pytest.raises(DatasetError, match="no pairs of the split `validation`: see `validation_share`"):
        PairDataset(own_pairs, split="validation")
