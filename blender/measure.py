# SPDX-License-Identifier: MIT OR Apache-2.0
"""Measures the networks against Cycles, on the room of the tests: the table of the book's chapter on Blender.

python blender/measure.py --program target/release/deepshade
"""

from __future__ import annotations

import argparse
import dataclasses
from pathlib import Path

import bpy
import numpy as np

import deepshade_addon as addon
from test_addon import MODELS, room, sky

RADII = {"ao": 0.5, "gi": 6.0, "do": 6.0}
"""Metres; of light as large as the room, since Cycles' has no end."""
NETWORKS = ("ao", "ao-small", "gi", "gi-paper", "do", "do-paper")


def scene_for(effect: str, size: tuple[int, int], seed: int) -> bpy.types.Scene:
    """The room, for `do` under a sky of colours."""
    scene = room()
    if effect == "do":
        sky(scene)
    scene.render.resolution_x, scene.render.resolution_y = size
    scene.cycles.seed = seed
    return scene


def main() -> None:
    """Prints a row a network, and writes the images into a folder."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--program", default="", help="deepshade; by default the one on PATH")
    parser.add_argument("--samples", type=int, default=128, help="samples of a pixel by Cycles")
    parser.add_argument("--size", type=int, nargs=2, default=(384, 288), help="columns and rows")
    parser.add_argument("--out", type=Path, help="folder for comparisons, one a network")
    given = parser.parse_args()
    rows = []
    for name in NETWORKS:
        network = addon.Network.load(MODELS / name)
        effect = network.effect
        one, other = (
            addon.render_effect(
                scene_for(effect, tuple(given.size), seed), effect, network=network.folder,
                radius=RADII[effect], samples=given.samples, program=given.program,
            )
            for seed in (0, 1)
        )  # fmt: skip
        rows.append(row(one, other))
        if given.out:
            (given.out / name).mkdir(parents=True, exist_ok=True)
            one.save(given.out / name)
    heads = ["network", "radius", "mean difference", "bias", "noise of Cycles", "nothing done"]
    heads += ["Cycles", "estimate", "infer"]
    print(f"| {' | '.join(heads)} |", "|---" * len(heads) + "|", *rows, sep="\n")


def row(one: addon.Comparison, other: addon.Comparison) -> str:
    """A row of the table. Light is told as shares of Cycles' mean. `other` has other random numbers."""
    figures = one.figures
    whole = figures.mean if addon.EFFECTS[one.effect].is_light else 1.0
    nothing = np.full_like(one.learned, 0.0 if addon.EFFECTS[one.effect].is_light else 1.0)
    undone = dataclasses.replace(one, learned=nothing).figures
    # The difference of two renders has twice the variance of one.
    noise = dataclasses.replace(one, learned=other.cycles).figures.difference / np.sqrt(2.0)
    values = [figures.difference, figures.bias, noise, undone.difference]
    told = " | ".join(
        f"{value / whole:{sign}.3f}" for value, sign in zip(values, ("", "+", "", ""), strict=True)
    )
    seconds = [one.seconds.get(part) for part in ("render", "estimate", "network")]
    times = " | ".join("" if value is None else f"{value:.1f} s" for value in seconds)
    return f"| `{one.network}` | {one.radius:g} m | {told} | {times} |"


if __name__ == "__main__":
    main()
