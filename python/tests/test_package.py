"""The package itself: what it offers, and that its program can be had without torch."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

import deepshade

WITHOUT_TORCH = """
import sys
sys.modules["torch"] = None
import deepshade
try:
    deepshade.load_model
except ModuleNotFoundError as error:
    print(error)
"""


def test_all_that_is_offered_is_there() -> None:
    assert all(getattr(deepshade, name) for name in deepshade.__all__)
    with pytest.raises(AttributeError, match="no attribute `train`"):
        _ = deepshade.train


def test_without_torch_it_says_what_to_install() -> None:
    command = [sys.executable, "-c", WITHOUT_TORCH]
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    done = subprocess.run(command, env=environment, capture_output=True, text=True, check=True)
    assert "load_model needs the package `torch`: pip install 'deepshade[torch]'" in done.stdout
