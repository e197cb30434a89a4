"""Estimates that networks such as `ao` read: the program makes them of each pair, beside the pairs.

Methods that need the scene are left to the recipe, whose `estimates` puts their images into the pairs.
"""

from __future__ import annotations

import os
import subprocess
import tempfile
from pathlib import Path

import numpy as np

from deepshade import exr
from deepshade.attributes import ATTRIBUTES
from deepshade.errors import DatasetError
from deepshade.manifest import Manifest, PairRecord
from deepshade.model import save_model
from deepshade.network import Network
from deepshade.spec import Block, Correction, Estimate, Input, NetSpec, Plain, Reach

#: What each method makes that needs no scene, by the names of attributes.
MAKES = dict.fromkeys(("gtao", "hbao"), ("openness", "raw-openness"))


def make_estimates(folder: str | os.PathLike[str], spec: NetSpec, program: str = "deepshade") -> None:
    """Makes what a network reads of methods that need no scene, for all pairs that have it not yet.

    `program` is the name or the path of deepshade's program. It takes some tenths of a second a pair.
    """
    manifest = Manifest.load(Path(folder))
    for estimate in [one for one in spec.estimates if one.method in MAKES]:
        with tempfile.TemporaryDirectory() as temporary:
            networks = {name: Path(temporary) / name for name in MAKES[estimate.method]}
            for name, network in networks.items():
                save_model(Network(_unchanging(estimate, name)), network)
            for pair in manifest.pairs:
                path = estimate_path(manifest, pair, estimate)
                if not path.exists():
                    images = {
                        ATTRIBUTES[name].layer: _run(program, network, manifest, pair)
                        for name, network in networks.items()
                    }
                    exr.write(path, images)


def estimate_path(manifest: Manifest, pair: PairRecord, estimate: Estimate) -> Path:
    """The file with what a method makes of a pair, named after its content, too: other data have others."""
    folder = manifest.folder / "estimates" / f"{estimate.method}-{estimate.quality}"
    return folder / f"{pair.name}-{pair.blake3[:16]}.exr"


def _unchanging(estimate: Estimate, name: str) -> NetSpec:
    """A network that leaves an estimate as it is, as corrections do before their first step."""
    return NetSpec(
        effect="ao",
        inputs=MAKES[estimate.method],
        leak=0.01,
        blocks=(Block("first", Input(), 1, 1), Block("last", Plain(0), 1, 1)),
        reach=Reach(radius=1.0, diagonal_share=0.03, height=384),
        head=Correction(of=name, over=name, levels=0, kernel=1),
        colour="rgb",
        estimates=(Estimate(estimate.method, estimate.quality),),
    )


def _run(program: str, network: Path, manifest: Manifest, pair: PairRecord) -> exr.Layer:
    """The image that a network makes of a pair."""
    out = network.with_suffix(".exr")
    gbuffer = manifest.folder / pair.file
    files = ["--model", str(network), "--gbuffer", str(gbuffer), "--out", str(out)]
    command = [program, "infer", "--trusted", "--radius", str(pair.radius), *files]
    try:
        subprocess.run(command, check=True, capture_output=True, text=True)
    except FileNotFoundError as error:
        raise DatasetError(f"there is no program `{program}`: name its path by `program`") from error
    except subprocess.CalledProcessError as error:
        raise DatasetError(f"{gbuffer}: no estimate was made: {error.stderr.strip()}") from error
    return exr.read(out)["ao"].astype(np.float16)
