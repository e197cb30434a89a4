"""What tests share: the program, a dataset that it makes, the shipped networks."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Callable, Sequence
from pathlib import Path

import pytest
import torch

MODELS = Path(__file__).parents[2] / "models"

#: Every shipped network.
SHIPPED = (
    "aa",
    "ao",
    "ao-paper",
    "ao-small",
    "do",
    "do-paper",
    "dof",
    "gi",
    "gi-paper",
    "ibl-paper",
    "motion-blur",
    "multi",
    "phosphor-gi",
    "sss",
)

RECIPE = """
effect = "{effect}"
split = "train"
seed = 5
resolution = {{ height = 64, width = 72 }}
samples = 2
scramblings = {scramblings}
radius = {{ diagonal = 0.1 }}
views_per_scene = 2
validation_share = 0.5
estimates = {estimates}

[[families]]
name = "still-life"
scenes = 2
{vary}
"""

Program = Callable[..., None]
MakeDataset = Callable[..., Path]


@pytest.fixture(scope="session")
def program_path() -> str:
    """Path of the program; the test is skipped where there is none."""
    stated = os.environ.get("DEEPSHADE")
    if stated is not None:
        assert Path(stated).is_file(), f"DEEPSHADE names {stated}, which is no file"
        return stated
    found = shutil.which("deepshade")
    if found is None:
        pytest.skip("no program: DEEPSHADE does not name it, and there is no deepshade on PATH")
    return found


@pytest.fixture(scope="session")
def program(program_path: str) -> Program:
    """Runs the program with some arguments."""

    def run(*arguments: object) -> None:
        done = subprocess.run([program_path, *map(str, arguments)], capture_output=True, text=True)
        assert done.returncode == 0, done.stderr

    return run


@pytest.fixture(scope="session")
def make_dataset(program: Program, tmp_path_factory: pytest.TempPathFactory) -> MakeDataset:
    """Makes four pairs of an effect, two of them for validation."""

    def make(effect: str, vary: str = "", scramblings: int = 2, estimates: Sequence[str] = ()) -> Path:
        folder = tmp_path_factory.mktemp(effect)
        recipe = folder / "recipe.toml"
        held = json.dumps(list(estimates))
        recipe.write_text(RECIPE.format(effect=effect, vary=vary, scramblings=scramblings, estimates=held))
        program("dataset", "generate", recipe, "--out", folder / "data")
        return folder / "data"

    return make


@pytest.fixture(scope="session")
def ao_pairs(make_dataset: MakeDataset) -> Path:
    """A dataset of ambient occlusion, which no test may change."""
    return make_dataset("ao")


@pytest.fixture
def own_pairs(ao_pairs: Path, tmp_path: Path) -> Path:
    """A copy of that dataset, which the test may damage."""
    return Path(shutil.copytree(ao_pairs, tmp_path / "data"))


@pytest.fixture(autouse=True)
def _one_thread_and_seed() -> None:
    torch.set_num_threads(1)
    torch.manual_seed(7)
