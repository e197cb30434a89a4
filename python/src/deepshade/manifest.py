"""`manifest.json` of a dataset: which pairs there are, what each is for, and the hash of its file."""

from __future__ import annotations

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from deepshade.effects import EFFECTS
from deepshade.errors import DatasetError

MANIFEST = "manifest.json"


@dataclass(frozen=True)
class PairRecord:
    """What is known of a pair before its file is read."""

    #: Its EXR file, relative to the dataset's folder.
    file: str
    #: BLAKE3 hash of that file, in hexadecimal.
    blake3: str
    #: `training` or `validation`.
    part: str
    #: The scene, such as `room:7`.
    scene: str
    #: How far the effect reaches, metres.
    radius: float

    @property
    def name(self) -> str:
        """The file's name without its ending."""
        return Path(self.file).stem


@dataclass(frozen=True)
class Manifest:
    """What a dataset consists of."""

    folder: Path
    #: Name of the effect.
    effect: str
    #: Height and width of the images; none where each has a size of its own.
    size: tuple[int, int] | None
    #: Every pair, in the recipe's order.
    pairs: tuple[PairRecord, ...]

    @classmethod
    def load(cls, folder: Path) -> Manifest:
        """Reads the manifest of a dataset's folder."""
        path = folder / MANIFEST
        try:
            value = json.loads(path.read_bytes())
        except OSError as error:
            raise DatasetError(_why_missing(folder, error)) from error
        except ValueError as error:
            raise DatasetError(f"{path} is damaged, {error}: make the data again") from error
        try:
            _check_version(path, value["origin"])
            recipe = value["origin"]["recipe"]
            pairs = tuple(_record(pair) for pair in value["pairs"])
            height, width = recipe["resolution"]["height"], recipe["resolution"]["width"]
        except (KeyError, TypeError) as error:
            raise DatasetError(f"{path} is no manifest of this version: it lacks {error}") from error
        return cls(folder, recipe["effect"], None if "smallest" in recipe else (height, width), pairs)


def _record(value: dict[str, Any]) -> PairRecord:
    scene = value["scene"]["source"]
    fields = {name: value[name] for name in ("file", "blake3", "part", "radius")}
    return PairRecord(scene=scene if isinstance(scene, str) else json.dumps(scene), **fields)


def _check_version(path: Path, origin: dict[str, Any]) -> None:
    """Data of another version hold other things under the same names."""
    theirs, effect = origin.get("data_version"), origin["recipe"]["effect"]
    ours = 5 if effect in {"aa", "motion-blur", "path", "real", "sss", "subsurface"} else 4
    if theirs != ours:
        raise DatasetError(
            f"{path} is of version {theirs} of the data; this package reads {ours}: make them again"
        )
    if effect not in EFFECTS:
        raise DatasetError(f"{path} is of the effect `{effect}`; known are {', '.join(EFFECTS)}")


def _why_missing(folder: Path, error: OSError) -> str:
    make = f"`deepshade dataset generate RECIPE --out {folder}`"
    if not folder.is_dir():
        return f"{folder} is no folder: {make} makes a dataset there"
    if any(folder.glob("shard-*-of-*.json")):
        return f"{folder} holds a shard: merge it with the others first, by `deepshade dataset merge`"
    if isinstance(error, FileNotFoundError):
        return (
            f"{folder} has no {MANIFEST}: it is no dataset, or an unfinished one, which {make} goes on with"
        )
    return f"{folder / MANIFEST} cannot be read: {error.strerror}"
