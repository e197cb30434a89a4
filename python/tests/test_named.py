"""Networks by name: those that the program brings, and what a folder of that name does to them."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest
import torch

from conftest import MODELS
from deepshade import ModelError, load_model


@pytest.fixture
def elsewhere(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A folder to be in that has no networks."""
    monkeypatch.chdir(tmp_path)
    return tmp_path


@pytest.fixture
def absolute(program_path: str) -> str:
    """The program's path, from whatever folder."""
    return str(Path(program_path).resolve())


def test_a_network_of_the_program_is_loaded_by_its_name(absolute: str, elsewhere: Path) -> None:
    network, shipped = load_model("ao-small", absolute), load_model(MODELS / "ao-small")
    assert network.spec == shipped.spec and not network.training
    for name, values in shipped.state_dict().items():
        assert torch.equal(network.state_dict()[name], values), name
    assert list(elsewhere.iterdir()) == []


def test_a_name_that_no_network_has_is_refused_with_those_that_there_are(
    absolute: str, elsewhere: Path
) -> None:
    with pytest.raises(ModelError, match=r"no network is called `aos` .*`ao`.*; there are aa, ao, "):
        load_model("aos", absolute)


def test_a_folder_comes_before_a_name(elsewhere: Path) -> None:
    shutil.copytree(MODELS / "gi-paper", elsewhere / "ao-small")
    assert load_model("ao-small", "no-such-program").spec.effect == "gi"


def test_a_path_is_no_name(elsewhere: Path) -> None:
    for place in ("models/ao-small", Path("ao-small")):
        with pytest.raises(ModelError, match=r"ao-small.net\.json cannot be read"):
            load_model(place, "no-such-program")


def test_without_the_program_there_is_no_network_by_name(elsewhere: Path) -> None:
    with pytest.raises(ModelError, match="no folder ao-small, and no program `no-such-program`"):
        load_model("ao-small", "no-such-program")
