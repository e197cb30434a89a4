"""Small networks of every kind of head, for tests."""

from __future__ import annotations

from dataclasses import replace

from deepshade.spec import (
    Block,
    Correction,
    Estimate,
    Filter,
    Folded,
    Head,
    Image,
    Input,
    Joined,
    NetSpec,
    Plain,
    Pooled,
    Reach,
)

REACH = Reach(radius=1.0, diagonal_share=0.05, height=64)


def u_net(
    last: int, head: Head, effect: str, inputs: tuple[str, ...], colour: str = "rgb", kernel: int = 3
) -> NetSpec:
    """Three levels of the thesis' form, with groups."""
    blocks = (
        Block("down0", Input(), kernel, 4),
        Block("down1", Pooled(0), kernel, 8, groups=2),
        Block("down2", Pooled(1), kernel, 16, groups=4),
        Block("up1", Joined(2, 1, groups=2), kernel, 8, groups=2),
        Block("up0", Joined(3, 0), kernel, last),
    )
    return NetSpec(effect, inputs, 0.01, blocks, REACH, head, colour)


def trunk(channels: int, correction: Correction, effect: str, inputs: tuple[str, ...]) -> NetSpec:
    """Two levels of today's form: folded, residual, the last block at half the resolution."""
    blocks = (
        Block("fold", Folded(), 1, 8),
        Block("residual", Plain(0), 3, 8),
        Block("down", Pooled(1), 3, 16, groups=2),
        Block("up", Joined(2, 1, groups=4), 3, 8, groups=4),
        Block("head", Plain(3), 1, 4 * (correction.biases(channels) + correction.weights)),
    )
    return NetSpec(effect, inputs, 0.01, blocks, REACH, correction, "rgb")


IMAGE = u_net(1, Image(), "ao", ("normal", "position"))
#: Its groups see channels of one of the two joined blocks alone.
CONTIGUOUS = replace(
    IMAGE,
    blocks=(*IMAGE.blocks[:3], replace(IMAGE.blocks[3], reads=Joined(2, 1), groups=4), IMAGE.blocks[4]),
)
LIGHT = u_net(3, Image(), "aa", ("depth", "light"))
FILTER = u_net(27, Filter(levels=3, kernel=3), "dof", ("depth", "light"))
BLACK = u_net(28, Filter(levels=3, kernel=3, black=True), "multi", ("depth", "light"))
MONO = u_net(18, Filter(levels=2, kernel=3), "sss", ("position", "mean-free-path", "light"), "mono")
CORRECTION = trunk(
    1, Correction("openness", "raw-openness", 2, 3), "ao", ("normal", "relief", "openness", "raw-openness")
)
GAIN = replace(
    trunk(
        3,
        Correction("estimate", "estimate", 2, 3, gain=True),
        "do",
        ("normal", "relief", "pixel-radius", "border", "estimate"),
    ),
    estimates=(Estimate("ssdo", "low"),),
    environment={"sky": 1},
)
GATED = trunk(
    3,
    Correction("estimate", "light", 2, 3, gain=True, gated=True),
    "motion-blur",
    ("movement", "relief", "light", "estimate"),
)

#: Each by its name.
ALL = {
    "image": IMAGE,
    "contiguous": CONTIGUOUS,
    "light": LIGHT,
    "filter": FILTER,
    "black": BLACK,
    "mono": MONO,
    "correction": CORRECTION,
    "gain": GAIN,
    "gated": GATED,
}
