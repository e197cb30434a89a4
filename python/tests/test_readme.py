"""The examples of the README run as they stand there."""

from __future__ import annotations

import os
import re
from pathlib import Path

import pytest
import torch

from conftest import MODELS, RECIPE, Program

README = Path(__file__).parents[1] / "README.md"


def test_the_examples_run(
    program: Program, program_path: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    blocks = re.findall(r"```python\n(.*?)```", README.read_text(), re.DOTALL)
    assert len(blocks) == 5
    monkeypatch.chdir(tmp_path)
    Path("bin").mkdir()
    Path("bin/deepshade").symlink_to(Path(program_path).resolve())
    monkeypatch.setenv("PATH", f"{tmp_path / 'bin'}{os.pathsep}{os.environ['PATH']}")
    Path("models").mkdir()
    for name in ("ao", "ao-paper"):
        Path("models", name).symlink_to(MODELS / name)
    recipe = RECIPE.format(effect="ao", vary="", scramblings=2, estimates="[]")
    Path("ao.toml").write_text(
        re.sub("resolution = .*", "resolution = { height = 256, width = 256 }", recipe)
    )
    program("dataset", "generate", "ao.toml", "--out", "data/ao")
    names: dict[str, object] = {"x": torch.rand(2, 6, 40, 50)}
    for block in blocks:
        exec(block.replace("range(10)", "range(1)"), names)
    program(
        "infer",
        "--model",
        "models/mine",
        "--gbuffer",
        next(Path("data/ao/pairs").iterdir()),
        "--out",
        "o.exr",
    )
