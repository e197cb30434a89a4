"""The pairs of a dataset that `deepshade dataset generate` has made, as a torch dataset."""

from __future__ import annotations

import os
import random
from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Literal, TypeAlias

import torch
from blake3 import blake3
from torch import Tensor
from torch.utils.data import Dataset

from deepshade import exr
from deepshade.errors import DatasetError
from deepshade.estimates import MAKES, estimate_path
from deepshade.inputs import needed, network_input
from deepshade.manifest import Manifest, PairRecord
from deepshade.spec import NetSpec

#: Layers `[channels, height, width]`, `target`, `variance`, `radius`; texts `name` and `scene`.
Pair: TypeAlias = dict[str, Tensor | str]

VARIANCE = "variance"
#: A crop that shows fewer surfaces is drawn again, ...
VALID_SHARE = 0.25
#: ... so many times.
DRAWS = 8


class PairDataset(Dataset[Pair]):
    """G-buffers with the truth of an effect.

    An item has a tensor `[channels, height, width]` for each layer, `target`, and where the data have it
    `variance`, that of the target's noise; `radius`, how far the effect reaches, metres; the pair's `name`
    and its `scene`. With a network's spec it has `input` and `light`, too, for `Network.image`.
    """

    def __init__(
        self,
        folder: str | os.PathLike[str],
        layers: Sequence[str] | None = None,
        split: Literal["train", "validation", "all"] = "train",
        crop: int | None = None,
        spec: NetSpec | None = None,
        dtype: torch.dtype = torch.float16,
    ) -> None:
        """Opens the dataset of a folder; no file is kept open.

        `layers` are those that items have, by default all of the g-buffer. With `crop` an item is a square
        window of so many pixels, drawn anew in every epoch (`set_epoch`). Layers and target are of `dtype`,
        torch.float16 or torch.float32; `variance`, `radius`, `input` and `light` are 32-bit floats.
        """
        if split not in ("train", "validation", "all"):
            raise ValueError(f"no split `{split}`; there are train, validation and all")
        if dtype not in (torch.float16, torch.float32):
            raise ValueError(f"no dtype {dtype} for layers; there are torch.float16 and torch.float32")
        self.manifest = Manifest.load(Path(folder))
        if spec is not None and spec.effect != self.manifest.effect:
            raise DatasetError(f"{folder} is of `{self.manifest.effect}`, and the network of `{spec.effect}`")
        parts = {"train": ("training",), "validation": ("validation",), "all": ("training", "validation")}
        self.records = [record for record in self.manifest.pairs if record.part in parts[split]]
        if not self.records:
            raise DatasetError(
                f"{folder} has no pairs of the split `{split}`: see `validation_share` in its recipe"
            )
        self.crop, self.spec, self.dtype = crop, spec, dtype
        first = self.manifest.folder / self.records[0].file
        held = [name for name in exr.names(first) if name != VARIANCE and not name.startswith("target.")]
        self.layers = list(layers) if layers is not None else held
        self._check_held(first, self.layers, [*held, *(self._estimates(self.records[0]))])
        self._target = f"target.{self.manifest.effect}"
        self._seed = torch.initial_seed()
        # Workers that live on from epoch to epoch see it change.
        self._epoch = torch.zeros(1, dtype=torch.int64).share_memory_()

    def __len__(self) -> int:
        """Number of pairs of the split."""
        return len(self.records)

    def __getitem__(self, index: int) -> Pair:
        """Reads a pair."""
        record = self.records[index]
        path = self.manifest.folder / record.file
        held = exr.read(path) | self._estimates(record)
        wanted = [*self.layers, self._target, *(needed(self.spec) if self.spec else [])]
        self._check_held(path, wanted, list(held))
        if self.manifest.size not in (None, held[self._target].shape[1:]):
            raise DatasetError(f"{path} has not the size of the recipe: delete it, and make the data again")
        tensors = {name: torch.from_numpy(held[name]) for name in {*wanted, VARIANCE, "valid"} & held.keys()}
        images = {layer: self._of_dtype(path, layer, tensors[layer]) for layer in self.layers}
        images["target"] = self._of_dtype(path, self._target, tensors[self._target])
        if VARIANCE in tensors:
            images[VARIANCE] = tensors[VARIANCE].float()
        pair: Pair = {"radius": torch.tensor(record.radius), "name": record.name, "scene": record.scene}
        if self.spec is not None:
            layers = {layer: tensors[layer].float() for layer in needed(self.spec)}
            images["input"], pair["light"] = network_input(layers, record.radius, self.spec)
        if self.crop is not None:
            top, left = self._corner(path, index, tensors["valid"][0], self.crop)
            rows, columns = slice(top, top + self.crop), slice(left, left + self.crop)
            images = {name: image[..., rows, columns].contiguous() for name, image in images.items()}
        return {**images, **pair}

    def set_epoch(self, epoch: int) -> None:
        """Chooses which windows are cut out, before a loader begins on the epoch."""
        self._epoch.fill_(epoch)

    def verify(self) -> None:
        """Holds every file of the dataset, of all splits, against its hash in the manifest.

        Raises `DatasetError` with the names of all files that are missing or differ.
        """
        folder = self.manifest.folder
        faults = [fault for pair in self.manifest.pairs if (fault := _fault(folder, pair))]
        if faults:
            raise DatasetError(
                f"{folder}: {', '.join(faults)}: delete what was changed, and `deepshade dataset generate` "
                "makes these pairs again"
            )

    def _estimates(self, record: PairRecord) -> dict[str, exr.Layer]:
        """What methods that need no scene have made of a pair for the network to read."""
        held: dict[str, exr.Layer] = {}
        for estimate in self.spec.estimates if self.spec else ():
            if estimate.method in MAKES:
                path = estimate_path(self.manifest, record, estimate)
                if not path.exists():
                    raise DatasetError(f"{path} is missing: `deepshade.make_estimates` makes it of the pair")
                held |= exr.read(path)
        return held

    def _check_held(self, path: Path, wanted: Iterable[str], held: Iterable[str]) -> None:
        """Refuses a file without a layer that is wanted."""
        missing = [layer for layer in dict.fromkeys(wanted) if layer not in held]
        if not missing:
            return
        text = f"{path} has no layer {', '.join(missing)}; it holds {', '.join(held)}"
        estimates = self.spec.estimates if self.spec else ()
        of_scene = [f'"{one.method}:{one.quality}"' for one in estimates if one.method not in MAKES]
        if of_scene:
            text += f": `estimates = [{', '.join(of_scene)}]` in the recipe adds what the network reads"
        raise DatasetError(text)

    def _of_dtype(self, path: Path, layer: str, values: Tensor) -> Tensor:
        converted = values.to(self.dtype)
        if not converted.isfinite().all():
            raise DatasetError(
                f"{path}: layer {layer} holds numbers beyond half floats: ask for dtype=torch.float32"
            )
        return converted

    def _corner(self, path: Path, index: int, valid: Tensor, crop: int) -> tuple[int, int]:
        """The corner of a window that shows something, where a few draws find one."""
        height, width = valid.shape
        if crop > min(height, width):
            raise DatasetError(f"{path} is {width} x {height} pixels, smaller than the crop of {crop}")
        numbers = random.Random(f"{self._seed}/{self._epoch.item()}/{index}")
        for _ in range(DRAWS):
            top, left = numbers.randint(0, height - crop), numbers.randint(0, width - crop)
            shown = valid[top : top + crop, left : left + crop].float().mean().item()
            if shown >= VALID_SHARE:
                break
        return top, left


def _fault(folder: Path, pair: PairRecord) -> str | None:
    """What is wrong with a pair's file, if something is."""
    path = folder / pair.file
    if not path.is_file():
        return f"{pair.file} is missing"
    return None if blake3(path.read_bytes()).hexdigest() == pair.blake3 else f"{pair.file} was changed"
