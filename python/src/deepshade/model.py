"""Model folders: `net.json` and `weights.safetensors`, beside which an input and its image lie for checks."""

from __future__ import annotations

import copy
import os
from pathlib import Path

import torch
from safetensors import SafetensorError
from safetensors.torch import load as load_tensors
from safetensors.torch import save as tensors_to_bytes
from torch import Tensor

from deepshade import spec_check, spec_json
from deepshade.balance import balanced
from deepshade.errors import ModelError, SpecError
from deepshade.named import model_folder
from deepshade.network import Network
from deepshade.spec import NetSpec

SPEC = "net.json"
WEIGHTS = "weights.safetensors"
PARITY = "parity.safetensors"
#: What `deepshade export` writes beside them.
OTHERS = ("model.onnx", "card.md")
#: Height and width of the image that other runtimes are checked with.
PARITY_SIZE = (75, 101)


def load_model(folder: str | os.PathLike[str], program: str = "deepshade") -> Network:
    """The network of a model folder, in evaluation mode.

    A mere name that no folder here has, such as "ao", is that of a network that deepshade's program has;
    `program` is the program's name or path. Raises `ModelError` where a file is missing or damaged, states
    what is not known, or does not fit the other, or there is no network of that name.
    """
    with model_folder(folder, program) as place:
        return _load(place)


def _load(folder: Path) -> Network:
    """The network of a folder that is there."""
    spec = load_spec(folder)
    network = Network(spec)
    tensors = read_tensors(folder / WEIGHTS)
    parameters = {
        f"{block.name}.{kind}": getattr(convolution, kind)
        for block, convolution in zip(spec.blocks, network.convolutions, strict=True)
        for kind in ("weight", "bias")
    }
    for name in tensors:
        if name not in parameters:
            raise ModelError(f"{folder / WEIGHTS}: the network of {SPEC} has no tensor `{name}`")
    with torch.no_grad():
        for name, parameter in parameters.items():
            parameter.copy_(_fitting(folder / WEIGHTS, tensors, name, list(parameter.shape)))
    return network.eval()


def save_model(network: Network, folder: str | os.PathLike[str]) -> None:
    """Writes a network into a model folder, which is made where there is none.

    Of the weights that do not change the image those are written whose features half floats hold
    (`deepshade.balance`). Raises `ModelError` where a weight is not finite, or the folder holds files of
    another network that would be left as they are.
    """
    folder = Path(folder)
    left = [name for name in OTHERS if (folder / name).exists()]
    if left:
        raise ModelError(
            f"{folder} holds {' and '.join(left)} of another network: give a new folder, or delete them"
        )
    for name, parameter in network.named_parameters():
        if not parameter.isfinite().all():
            raise ModelError(f"`{name}` holds a number that is not finite: the network is not saved")
    spec = network.spec
    network = copy.deepcopy(network).float().cpu().eval()
    side = max(64, 2 * spec.alignment)
    tensors = balanced(network, _noise(spec, (side, side)))
    noise = _noise(spec, PARITY_SIZE)
    with torch.no_grad():
        parity = {"input": noise[0], "output": network(noise)[0]}
    folder.mkdir(parents=True, exist_ok=True)
    # Without its spec a folder does not load: weights of one network never stand beside another's spec.
    (folder / SPEC).unlink(missing_ok=True)
    _write(folder / WEIGHTS, _bytes(tensors))
    _write(folder / PARITY, _bytes(parity))
    _write(folder / SPEC, spec_json.write(spec).encode())


def load_spec(folder: str | os.PathLike[str]) -> NetSpec:
    """The spec of a model folder, if a network can have it."""
    path = Path(folder) / SPEC
    try:
        spec = spec_json.read(path.read_bytes())
        spec_check.check(spec)
    except OSError as error:
        raise ModelError(
            f"{path} cannot be read: {error.strerror}; is this the folder of a network?"
        ) from error
    except SpecError as error:
        raise ModelError(f"{path}: {error}") from error
    return spec


def read_tensors(path: Path) -> dict[str, Tensor]:
    """All tensors of a file."""
    try:
        return load_tensors(path.read_bytes())
    except OSError as error:
        raise ModelError(f"{path} cannot be read: {error.strerror}") from error
    except SafetensorError as error:
        raise ModelError(f"{path} is not a whole safetensors file: {error}") from error


def _fitting(path: Path, tensors: dict[str, Tensor], name: str, shape: list[int]) -> Tensor:
    """A tensor of a file, if it is there, of that shape, and of finite 32-bit floats."""
    if name not in tensors:
        raise ModelError(f"{path} has no tensor `{name}`; it holds {', '.join(sorted(tensors))}")
    tensor = tensors[name]
    if list(tensor.shape) != shape:
        raise ModelError(f"{path}: tensor `{name}` has shape {list(tensor.shape)}, expected {shape}")
    if tensor.dtype != torch.float32:
        raise ModelError(f"{path}: tensor `{name}` holds {tensor.dtype}, expected torch.float32")
    if not tensor.isfinite().all():
        raise ModelError(f"{path}: tensor `{name}` holds a number that is not finite")
    return tensor


def _noise(spec: NetSpec, size: tuple[int, int]) -> Tensor:
    """Numbers of rms 1 as an input, always the same."""
    generator = torch.Generator().manual_seed(1)
    return (2.0 * torch.rand(1, spec.input_channels, *size, generator=generator) - 1.0) * 3**0.5


def _bytes(tensors: dict[str, Tensor]) -> bytes:
    return tensors_to_bytes({name: tensor.contiguous() for name, tensor in tensors.items()})


def _write(path: Path, content: bytes) -> None:
    """Makes a file, or replaces it as a whole."""
    partial = path.with_name(f".{path.name}.partial")
    partial.write_bytes(content)
    partial.replace(path)
