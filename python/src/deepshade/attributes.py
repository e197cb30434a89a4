"""The attributes of a g-buffer: their channels, and what a network multiplies their numbers by."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

#: What lengths and light of a frame are multiplied by follows from the frame; other numbers stay.
Scale = Literal["one", "length", "light"]

VECTOR = ("X", "Y", "Z")
COLOUR = ("R", "G", "B")
MOTION = ("direction", "length")
SCALES = ("4", "16", "64")
DOUBLED_ANGLE = ("X", "Y")
SCALAR = ("",)

#: Pixels count by the eight.
PIXELS = -3
#: Mean free paths are some hundredths of the lengths that positions have.
MEAN_FREE_PATHS = 5


@dataclass(frozen=True)
class Attribute:
    """One physical quantity of a g-buffer."""

    #: Its name in `net.json`.
    name: str
    #: Names of its channels, as they follow the dot in an EXR file; a scalar's is empty.
    components: tuple[str, ...]
    #: What a frame's scaling multiplies it by.
    scale: Scale = "one"
    #: The power of two that it is multiplied by, too; of a movement the length alone.
    exponent: int = 0

    @property
    def layer(self) -> str:
        """Name of its layer in an EXR file."""
        return self.name.replace("-", "_")

    def exponents(self) -> tuple[int, ...]:
        """The power of two of each component."""
        return (0, self.exponent) if self.components is MOTION else (self.exponent,) * len(self.components)


#: Every attribute by its name in `net.json`.
ATTRIBUTES: dict[str, Attribute] = {
    attribute.name: attribute
    for attribute in (
        Attribute("position", VECTOR, "length"),
        Attribute("normal", VECTOR),
        Attribute("world-normal", VECTOR),
        Attribute("depth", SCALAR, "length"),
        Attribute("focal-distance", SCALAR, "length"),
        Attribute("circle-of-confusion", SCALAR, "one", PIXELS),
        Attribute("blurriness", SCALAR, "length", PIXELS),
        Attribute("to-camera", VECTOR),
        Attribute("diffuse", COLOUR),
        Attribute("specular", COLOUR),
        Attribute("glossiness", SCALAR),
        Attribute("mean-free-path", COLOUR, "length", MEAN_FREE_PATHS),
        Attribute("light", COLOUR, "light"),
        Attribute("diffuse-light", COLOUR, "light"),
        Attribute("motion", MOTION, "one", PIXELS),
        Attribute("object-id", SCALAR),
        Attribute("emission", COLOUR, "light"),
        Attribute("valid", SCALAR),
        Attribute("openness", SCALAR),
        Attribute("raw-openness", SCALAR),
        Attribute("estimate", COLOUR, "light"),
        Attribute("relief", SCALES),
        Attribute("pixel-radius", SCALAR),
        Attribute("border", SCALAR),
        Attribute("signed-circle", SCALAR),
        Attribute("movement", DOUBLED_ANGLE),
        Attribute("free-path-pixels", COLOUR),
    )
}

#: What follows from other attributes and the radius, and from which.
MADE_OF = {
    "relief": ("position",),
    "pixel-radius": ("position",),
    "border": ("position",),
    "signed-circle": ("blurriness", "depth"),
    "movement": ("motion",),
    "free-path-pixels": ("mean-free-path", "position"),
}
