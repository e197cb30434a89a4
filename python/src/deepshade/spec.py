"""The shape of a network: a list of blocks, what it reads, and how its image follows from the last block.

`net.json` holds it. `deepshade.spec_json` reads and writes that, `deepshade.spec_check` says what no network
can have.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, Literal, TypeAlias

from deepshade.attributes import ATTRIBUTES, COLOUR
from deepshade.effects import EFFECTS, Effect


@dataclass(frozen=True)
class Input:
    """The network's input."""


@dataclass(frozen=True)
class Folded:
    """The network's input at half the resolution, the four pixels of a square as channels."""


@dataclass(frozen=True)
class Plain:
    """A block's image as it is."""

    block: int


@dataclass(frozen=True)
class Pooled:
    """The means of 2x2 pixels of a block's image."""

    block: int


@dataclass(frozen=True)
class Joined:
    """A coarser block, doubled bilinearly, and one of a level above it."""

    coarse: int
    skip: int
    #: The channels of both are dealt out in so many groups.
    groups: int = 1


#: What a block reads. Blocks are named by their index.
Source: TypeAlias = Input | Folded | Plain | Pooled | Joined


@dataclass(frozen=True)
class Block:
    """A convolution. A leaky ReLU follows all but the last."""

    name: str
    reads: Source
    #: Width and height of the kernel; odd.
    kernel: int
    #: Channels made.
    outputs: int
    groups: int = 1


@dataclass(frozen=True)
class Image:
    """What the last block makes is the image."""


@dataclass(frozen=True)
class Filter:
    """The last block makes weights of pixels of the light that the network reads."""

    levels: int
    kernel: int
    #: Whether the last weight is that of black.
    black: bool = False

    @property
    def weights(self) -> int:
        """Number of weights that a pixel has."""
        return self.levels * self.kernel**2 + self.black


@dataclass(frozen=True)
class Correction:
    """The last block makes what is added to an estimate: a bias or a gain, and weights of pixels."""

    #: The estimate, one of the network's inputs.
    of: str
    #: The input whose pixels are weighed.
    over: str
    levels: int
    kernel: int
    gain: bool = False
    #: Whether nothing is corrected where the estimate is what the pyramid is of.
    gated: bool = False

    def biases(self, channels: int) -> int:
        """Number of biases that a pixel of so many channels has."""
        return 0 if self.gain else channels

    @property
    def weights(self) -> int:
        """Number of weights that a pixel has, the gain counted."""
        return self.levels * self.kernel**2 + self.gain


#: How the image follows from what the last block makes.
Head: TypeAlias = Image | Filter | Correction


@dataclass(frozen=True)
class Reach:
    """What a network was trained to reach."""

    #: Radius of the effect in the units in which the network reads lengths.
    radius: float
    #: Radius of the effect as a share of the scene's diagonal.
    diagonal_share: float
    #: Rows of the training frames.
    height: int


@dataclass(frozen=True)
class Estimate:
    """An analytic method whose image a network reads."""

    method: str
    quality: str
    #: The effect that it is a method of, where that is not the network's own.
    effect: str | None = None


@dataclass(frozen=True)
class Layer:
    """What follows for a block from those that it reads."""

    #: 0 is full resolution; each further level halves it.
    level: int
    #: Channels read.
    inputs: int


@dataclass(frozen=True)
class NetSpec:
    """A network, but for its weights."""

    #: Name of the effect that it computes.
    effect: str
    #: Names of the attributes that it reads, in this order.
    inputs: tuple[str, ...]
    #: Factor of negative values in the leaky ReLU.
    leak: float
    blocks: tuple[Block, ...]
    reach: Reach
    head: Head = Image()
    #: `mono`: a run makes one colour channel, and reads that channel alone of every colour.
    colour: Literal["mono", "rgb"] = "mono"
    estimates: tuple[Estimate, ...] = ()
    #: Ranges of the training data, as `net.json` has them.
    trained: dict[str, Any] | None = None
    #: The environment of the training data, as `net.json` has it.
    environment: dict[str, Any] | None = None

    @property
    def definition(self) -> Effect:
        """The effect."""
        return EFFECTS[self.effect]

    def width(self, attribute: str) -> int:
        """Channels of an attribute that a run reads."""
        components = ATTRIBUTES[attribute].components
        return 1 if self.colour == "mono" and components is COLOUR else len(components)

    @property
    def input_channels(self) -> int:
        """Channels that a run reads."""
        return sum(map(self.width, self.inputs))

    @property
    def output_channels(self) -> int:
        """Channels that a run makes."""
        return 1 if self.colour == "mono" else self.definition.channels

    @property
    def runs(self) -> int:
        """Number of runs that make the effect's image."""
        return self.definition.channels // self.output_channels

    def channels_of(self, attribute: str) -> list[int]:
        """Which of the channels that a run reads are those of an attribute."""
        found: list[int] = []
        read = 0
        for name in self.inputs:
            if name == attribute:
                found.extend(range(read, read + self.width(name)))
            read += self.width(name)
        return found

    @cached_property
    def layers(self) -> tuple[Layer, ...]:
        """What follows for each block."""
        layers: list[Layer] = []
        for block in self.blocks:
            match block.reads:
                case Input():
                    layer = Layer(0, self.input_channels)
                case Folded():
                    layer = Layer(1, 4 * self.input_channels)
                case Plain(index):
                    layer = Layer(layers[index].level, self.blocks[index].outputs)
                case Pooled(index):
                    layer = Layer(layers[index].level + 1, self.blocks[index].outputs)
                case Joined(coarse, skip):
                    both = self.blocks[coarse].outputs + self.blocks[skip].outputs
                    layer = Layer(layers[skip].level, both)
            layers.append(layer)
        return tuple(layers)

    @property
    def levels(self) -> int:
        """Number of levels, the finest and the coarsest counted."""
        return max(layer.level for layer in self.layers) + 1

    @property
    def alignment(self) -> int:
        """Heights and widths are padded to a multiple of this."""
        return 1 << (self.levels - 1)

    @property
    def head_channels(self) -> int:
        """Channels a pixel that the head works on."""
        match self.head:
            case Image():
                return self.output_channels
            case Filter():
                return self.head.weights
            case Correction():
                return self.head.biases(self.output_channels) + self.head.weights

    @property
    def last_channels(self) -> int:
        """Channels that the last block has to make: those of the head for each pixel of a square."""
        return self.head_channels << (2 * self.layers[-1].level)

    def is_residual(self, index: int) -> bool:
        """Whether a block's kernel begins as the identity."""
        block, inputs = self.blocks[index], self.layers[index].inputs
        plain = isinstance(block.reads, Plain) and index + 1 < len(self.blocks)
        return plain and block.groups == 1 and block.kernel > 1 and inputs == block.outputs
