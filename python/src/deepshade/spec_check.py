"""What no network can have: the limits that the program sets, so that it runs what was trained here."""

from __future__ import annotations

import re
from collections.abc import Container

from deepshade.errors import SpecError
from deepshade.spec import Block, Correction, Filter, Image, Joined, NetSpec, Plain, Pooled

KERNELS = (1, 3, 5, 7)
MOST_BLOCKS = 64
MOST_CHANNELS = 1 << 14
MOST_LEVEL = 7
MOST_ROWS = 8192


def check(spec: NetSpec) -> None:
    """Refuses a spec with a number out of its range, blocks that do not fit, or a head that does not."""
    reach = spec.reach
    _range("inputs", len(spec.inputs), range(1, 65), "1 to 64 attributes")
    _range("blocks", len(spec.blocks), range(2, MOST_BLOCKS + 1), "2 to 64")
    _range("estimates", len(spec.estimates), range(9), "at most 8")
    for name, value in (("reach.radius", reach.radius), ("reach.diagonal_share", reach.diagonal_share)):
        if value <= 0.0:
            raise SpecError(f"`{name}` is {value}; it must be positive")
    if not 0.0 <= spec.leak <= 1.0:
        raise SpecError(f"`leak` is {spec.leak}; it must be 0 to 1")
    _range("reach.height", reach.height, range(1, MOST_ROWS + 1), "1 to 8192")
    names: set[str] = set()
    for index, block in enumerate(spec.blocks):
        _check_block(spec, index, block)
        if block.name in names:
            raise SpecError(f"block `{block.name}` has no name of its own")
        names.add(block.name)
    for index, block in enumerate(spec.blocks):
        _check_layer(spec, index, block)
    _check_head(spec)
    found = spec.blocks[-1].outputs
    if found != spec.last_channels:
        raise SpecError(f"the last block makes {found} channels; its head needs {spec.last_channels}")


def _range(name: str, found: int, allowed: Container[int], words: str) -> None:
    if found not in allowed:
        raise SpecError(f"`{name}` is {found}; it must be {words}")


def _check_block(spec: NetSpec, index: int, block: Block) -> None:
    """Whether a block has a name and numbers, and reads earlier ones."""
    if not re.fullmatch(r"[a-z0-9_-]{1,64}", block.name):
        raise SpecError(f"block `{block.name}`: names are of up to 64 small letters, digits, - and _")
    _range("kernel", block.kernel, KERNELS, "1, 3, 5 or 7")
    _range("outputs", block.outputs, range(1, MOST_CHANNELS + 1), "1 to 16384")
    _range("groups", block.groups, range(1, MOST_CHANNELS + 1), "1 to 16384")
    blocks: tuple[int, ...] = ()
    match block.reads:
        case Plain(read) | Pooled(read):
            blocks = (read,)
        case Joined(coarse, skip):
            blocks = (coarse, skip)
    if any(read >= index for read in blocks):
        raise SpecError(f"block `{block.name}` reads a block that comes after it")
    if index + 1 == len(spec.blocks) and not blocks:
        raise SpecError(f"block `{block.name}` is the last and reads the input")


def _check_layer(spec: NetSpec, index: int, block: Block) -> None:
    """Whether the levels of what a block reads go together, and its groups divide its channels."""
    layers, blocks = spec.layers, spec.blocks
    inputs = layers[index].inputs
    if layers[index].level > MOST_LEVEL:
        raise SpecError(f"block `{block.name}` is on a level below the seventh")
    divides = inputs % block.groups == 0 and block.outputs % block.groups == 0
    match block.reads:
        case Pooled(read) if isinstance(blocks[read].reads, Joined):
            raise SpecError(f"block `{block.name}` pools a block that joins two")
        case Joined(coarse, skip, groups):
            if layers[coarse].level != layers[skip].level + 1:
                raise SpecError(f"block `{block.name}` joins blocks that are not one level apart")
            divides &= groups > 0 and not any(blocks[read].outputs % groups for read in (coarse, skip))
    if not divides:
        raise SpecError(
            f"block `{block.name}` has {block.groups} groups, which do not divide its {inputs} inputs and "
            f"{block.outputs} outputs"
        )


def _check_head(spec: NetSpec) -> None:
    """Whether the network reads what its head works on, and has the levels."""
    head = spec.head
    match head:
        case Image():
            return
        case Filter():
            least, read = 1, ["light"]
        case Correction():
            least, read = int(head.gated), [head.over, head.of]
    _range("head.levels", head.levels, range(least, spec.levels + 1), "at most as many as the network has")
    _range("head.kernel", head.kernel, KERNELS, "1, 3, 5 or 7")
    for attribute in read:
        found = len(spec.channels_of(attribute))
        if found != spec.output_channels:
            raise SpecError(
                f"the network's head works on {found} channels of its input `{attribute}`, and makes an "
                f"image of {spec.output_channels}"
            )
