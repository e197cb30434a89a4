"""Networks by name: the program `deepshade` brings some, and writes one into a folder."""

from __future__ import annotations

import os
import shutil
import subprocess
import sysconfig
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from deepshade.errors import ModelError


@contextmanager
def model_folder(place: str | os.PathLike[str], program: str) -> Iterator[Path]:
    """The folder at a place, or one with the network of that name, which is there while this is open.

    Raises `ModelError` where there is no such folder, and the program is missing or has no such network.
    """
    if not _is_name(place):
        yield Path(place)
        return
    with tempfile.TemporaryDirectory() as temporary:
        folder = Path(temporary) / "model"
        _export(os.fspath(place), folder, program)
        yield folder


def _is_name(place: str | os.PathLike[str]) -> bool:
    """Whether it is a mere word, and no folder here: a path is always one of a folder."""
    return isinstance(place, str) and Path(place).name == place and not Path(place).exists()


def _export(name: str, folder: Path, program: str) -> None:
    """Has the program write its network into a folder."""
    # pip puts the program beside Python, which may not be on PATH.
    found = shutil.which(program) or shutil.which(program, path=sysconfig.get_path("scripts"))
    if found is None:
        raise ModelError(f"there is no folder {name}, and no program `{program}` that has networks by name")
    command = [found, "export", f"--model={name}", "--out", str(folder)]
    done = subprocess.run(command, capture_output=True, text=True)
    if done.returncode != 0:
        # Behind an empty line it says how to get help on its options.
        reason, _, _ = done.stderr.strip().partition("\n\n")
        raise ModelError(f"`{name}`: {reason}")
