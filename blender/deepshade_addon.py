# SPDX-License-Identifier: MIT OR Apache-2.0
"""deepshade in Blender: learned ambient occlusion, indirect light and sky light beside those of Cycles.

The add-on renders the passes of a scene by Cycles, gives them to the program `deepshade` as a g-buffer, and
shows what a network makes of them beside what Cycles says itself.

It never changes the scene that is open. Passes are rendered of a copy of it, which is removed whatever
happens. From the interface all work is done by a second Blender, on a copy of the file, so that nothing
blocks and all can be cancelled. Without an interface, `render_effect` does the same in this one.

Conventions. Blender has z up; a camera looks down its -z, with y up. deepshade's g-buffer is in camera space,
metres. Images are numpy arrays `[height, width, channels]`, linear, their first row at the top.
"""

from __future__ import annotations

import argparse
import contextlib
import itertools
import json
import math
import os
import re
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import time
import zlib
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import bpy
import numpy as np
from mathutils import Matrix

bl_info = {
    "name": "deepshade",
    "description": "Learned ambient occlusion, indirect and sky light beside those of Cycles",
    "author": "the authors of deepshade",
    "version": (0, 1, 0),
    "blender": (4, 2, 0),
    "location": "Properties > Render > deepshade, and Image Editor > Sidebar > deepshade",
    "doc_url": "https://github.com/deepshade/deepshade/blob/main/book/src/blender.md",
    "category": "Render",
}

Report = Callable[[float, str], None]
"""What is told of progress: the share that is done, 0 to 1, and what is being done."""


class AddonError(Exception):
    """What keeps the add-on from its work, in a sentence that says what to do."""


# ---------------------------------------------------------------------------------------------------------
# Effects
# ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Effect:
    """What is compared: a quantity at a pixel, which deepshade and Cycles both compute."""

    name: str
    label: str
    description: str
    channels: int
    reference: str
    """The pass in which Cycles has it."""
    lamps: bool
    """Whether lamps give light. `do` is lit by the world alone."""

    @property
    def is_light(self) -> bool:
        """Whether it is radiance, which has no end, and not a share."""
        return self.channels == 3


EFFECTS = {
    "ao": Effect(
        name="ao",
        label="Ambient occlusion",
        description="Open share of the hemisphere; of Cycles the pass of the same distance",
        channels=1,
        reference="Ambient Occlusion",
        lamps=True,
    ),
    "gi": Effect(
        name="gi",
        label="Indirect light",
        description="Light of one diffuse bounce; of Cycles the indirect pass, which knows no radius",
        channels=3,
        reference="Diffuse Indirect",
        lamps=True,
    ),
    "do": Effect(
        name="do",
        label="Sky light",
        description="Light of the world that nothing blocks; of Cycles the direct pass without lamps, which "
        "knows no radius",
        channels=3,
        reference="Diffuse Direct",
        lamps=False,
    ),
}

PASSES = {
    "Position": ("position", "XYZ"),
    "Normal": ("normal", "XYZ"),
    "Depth": ("z", "Z"),
    "Ambient Occlusion": ("ambient_occlusion", "RGB"),
    "Diffuse Direct": ("diffuse_direct", "RGB"),
    "Diffuse Indirect": ("diffuse_indirect", "RGB"),
    "Diffuse Color": ("diffuse_color", "RGB"),
}
"""A pass' name in a file of Blender 5: its switch in a view layer, and its channels."""

OLDER_NAMES = {
    "Ambient Occlusion": "AO",
    "Diffuse Direct": "DiffDir",
    "Diffuse Indirect": "DiffInd",
    "Diffuse Color": "DiffCol",
}
"""Names of passes in files of Blender before 5."""


# ---------------------------------------------------------------------------------------------------------
# OpenEXR files: what Blender's Python cannot read of layers, and cannot write at all
# ---------------------------------------------------------------------------------------------------------

EXR_MAGIC = struct.pack("<II", 20000630, 2)
EXR_TYPES = (np.dtype("<u4"), np.dtype("<f2"), np.dtype("<f4"))
EXR_ROWS = {0: 1, 2: 1, 3: 16}
"""Rows of a block, by the number of the compression: none, ZIPS, ZIP."""


def read_exr(path: Path) -> dict[str, np.ndarray]:
    """The channels of a file of one part of scan lines, each `[height, width]` of 32-bit floats.

    Raises AddonError for a compression other than none and ZIP, and for what is no such file.
    """
    data = path.read_bytes()
    if data[:4] != EXR_MAGIC[:4] or data[5] & 0x1A:
        raise AddonError(f"{path} is no OpenEXR file of one part of scan lines.")
    attributes, at = exr_attributes(data)
    compression = attributes["compression"][0]
    if compression not in EXR_ROWS:
        raise AddonError(f"{path} is compressed in a way that the add-on does not read ({compression}).")
    left, top, right, bottom = struct.unpack("<4i", attributes["dataWindow"])
    width, height = right - left + 1, bottom - top + 1
    channels = exr_channels(attributes["channels"])
    image = {name: np.zeros((height, width), np.float32) for name, _ in channels}
    row_bytes = width * sum(kind.itemsize for _, kind in channels)
    blocks = -(-height // EXR_ROWS[compression])
    for offset in struct.unpack_from(f"<{blocks}Q", data, at):
        first, size = struct.unpack_from("<2i", data, offset)
        rows = min(EXR_ROWS[compression], bottom + 1 - first)
        block = exr_block(data[offset + 8 : offset + 8 + size], rows * row_bytes)
        place = 0
        for row in range(first - top, first - top + rows):
            for name, kind in channels:
                image[name][row] = np.frombuffer(block, kind, width, place)
                place += width * kind.itemsize
    return image


def exr_attributes(data: bytes) -> tuple[dict[str, bytes], int]:
    """A header's attributes, and where it ends."""
    attributes, at = {}, 8
    while data[at]:
        name, kind, _ = data[at : at + 600].split(b"\0", 2)
        at += len(name) + len(kind) + 2
        (size,) = struct.unpack_from("<i", data, at)
        attributes[name.decode()] = data[at + 4 : at + 4 + size]
        at += 4 + size
    return attributes, at + 1


def exr_channels(data: bytes) -> list[tuple[str, np.dtype]]:
    """Names and types of channels, in the order in which rows hold them."""
    channels, at = [], 0
    while data[at]:
        end = data.index(b"\0", at)
        (kind,) = struct.unpack_from("<i", data, end + 1)
        channels.append((data[at:end].decode(), EXR_TYPES[kind]))
        at = end + 17
    return channels


def exr_block(data: bytes, size: int) -> bytes:
    """A block's rows, unpacked. What would not have become smaller is stored as it is."""
    if len(data) == size:
        return data
    steps = np.frombuffer(zlib.decompress(data), np.uint8).astype(np.int64)
    steps[1:] -= 128
    halves = (np.cumsum(steps) & 255).astype(np.uint8)
    rows = np.empty(size, np.uint8)
    rows[0::2], rows[1::2] = halves[: (size + 1) // 2], halves[(size + 1) // 2 :]
    return rows.tobytes()


def write_exr(path: Path, channels: dict[str, np.ndarray]) -> None:
    """Writes channels `[height, width]` as 32-bit floats, without compression."""
    names = sorted(channels)
    height, width = channels[names[0]].shape
    listed = b"".join(name.encode() + b"\0" + struct.pack("<iiii", 2, 0, 1, 1) for name in names)
    window = struct.pack("<4i", 0, 0, width - 1, height - 1)
    header = EXR_MAGIC
    for name, kind, value in (
        ("channels", "chlist", listed + b"\0"),
        ("compression", "compression", b"\0"),
        ("dataWindow", "box2i", window),
        ("displayWindow", "box2i", window),
        ("lineOrder", "lineOrder", b"\0"),
        ("pixelAspectRatio", "float", struct.pack("<f", 1.0)),
        ("screenWindowCenter", "v2f", struct.pack("<2f", 0.0, 0.0)),
        ("screenWindowWidth", "float", struct.pack("<f", 1.0)),
    ):
        header += name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(value)) + value
    header += b"\0"
    rows = np.stack([channels[name] for name in names], axis=1).astype("<f4")
    size = 4 * width * len(names)
    start = len(header) + 8 * height
    offsets = struct.pack(f"<{height}Q", *(start + row * (size + 8) for row in range(height)))
    blocks = b"".join(struct.pack("<2i", y, size) + rows[y].tobytes() for y in range(height))
    path.write_bytes(header + offsets + blocks)


def layer(channels: dict[str, np.ndarray], name: str, components: str) -> np.ndarray:
    """A layer `[height, width, components]` of a file's channels."""
    return np.stack([channels[f"{name}.{component}"] for component in components], axis=-1)


def layered(name: str, components: str, image: np.ndarray) -> dict[str, np.ndarray]:
    """A file's channels of an image `[height, width, components]`."""
    return {f"{name}.{component}": image[..., index] for index, component in enumerate(components)}


# ---------------------------------------------------------------------------------------------------------
# The program and its networks
# ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Network:
    """A trained network: a folder with `net.json`."""

    folder: Path
    effect: str
    inputs: tuple[str, ...]
    method: str
    """The analytic method of the same effect whose image it reads, else nothing."""
    quality: str

    @property
    def needs_estimate(self) -> bool:
        """Whether it reads an image that only the scene tells."""
        return "estimate" in self.inputs

    @classmethod
    def load(cls, folder: Path) -> Network:
        """Reads what a network reads. Raises AddonError if the folder holds none."""
        try:
            spec = json.loads((folder / "net.json").read_text(encoding="utf-8"))
            effect, inputs = spec["effect"], tuple(spec["inputs"])
        except (OSError, ValueError, KeyError, TypeError) as error:
            raise AddonError(
                f"{folder} holds no network ({error}). Choose one of deepshade's folder `models`."
            ) from error
        own = [one for one in spec.get("estimates") or () if one.get("effect", effect) == effect]
        method, quality = (own[0]["method"], own[0]["quality"]) if own else ("", "")
        return cls(folder, effect, inputs, method, quality)


class Program:
    """The program `deepshade`."""

    def __init__(self, path: str = "") -> None:
        """Takes a path, or without one what is found on PATH. Raises AddonError if there is none."""
        found = shutil.which(bpy.path.abspath(path) if path else "deepshade")
        if found is None:
            where = f"{path} is not there" if path else "deepshade is not on PATH"
            raise AddonError(
                f"The program {where}. Build it by `cargo build --release`, and state its path in the "
                "add-on's preferences."
            )
        self.path = Path(found)

    def run(self, *arguments: object) -> str:
        """Runs it to its end and gives what it said. Raises AddonError with its words if it fails."""
        command = [str(self.path), *map(str, arguments)]
        done = subprocess.run(command, capture_output=True, encoding="utf-8", errors="replace", check=False)
        if done.returncode != 0:
            raise AddonError(f"deepshade {arguments[0]}: {done.stderr.strip() or f'exit {done.returncode}'}")
        # What a driver says of Wayland on every start is none of the program's words.
        return "\n".join(line for line in done.stderr.splitlines() if "XDG_RUNTIME_DIR" not in line).strip()


def models_folder(stated: str, program: str) -> Path:
    """The folder of networks: the stated one, else `models` above the program, as in a checkout."""
    if stated:
        folder = Path(bpy.path.abspath(stated))
        if folder.is_dir():
            return folder
        raise AddonError(
            f"There is no folder {folder}. State deepshade's folder `models` in the preferences."
        )
    for above in Program(program).path.resolve().parents[:4]:
        if (above / "models").is_dir():
            return above / "models"
    raise AddonError("State deepshade's folder `models` in the add-on's preferences.")


def networks_of(effect: str, models: Path) -> list[Network]:
    """The networks of an effect in a folder, the one of the effect's name first."""
    found = [Network.load(file.parent) for file in sorted(models.glob("*/net.json"))]
    return sorted((one for one in found if one.effect == effect), key=lambda one: one.folder.name != effect)


# ---------------------------------------------------------------------------------------------------------
# The stage: a copy of the scene, which is rendered in its stead
# ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Stage:
    """A copy of a scene with the settings that passes need, and a camera of its own."""

    scene: bpy.types.Scene
    camera: bpy.types.Object
    folder: Path

    @property
    def metres(self) -> float:
        """Metres of a unit of length of the scene."""
        return self.scene.unit_settings.scale_length


def check_scene(scene: bpy.types.Scene) -> None:
    """Raises AddonError if a scene's passes are not what networks read."""
    if scene.render.engine != "CYCLES" or not hasattr(scene, "cycles"):
        raise AddonError(
            f"The scene's engine is {scene.render.engine}. Set it to Cycles, in the properties of the render."
        )
    if scene.camera is None or scene.camera.type != "CAMERA":
        raise AddonError("The scene has no camera. Add one, and make it the scene's active camera.")
    kind = scene.camera.data.type
    if kind != "PERSP":
        name = {"ORTHO": "orthographic", "PANO": "panoramic"}.get(kind, kind)
        raise AddonError(
            f"The camera {scene.camera.name} is {name}. Networks know perspective ones: set its type to that."
        )
    if scene.render.pixel_aspect_x != scene.render.pixel_aspect_y:
        raise AddonError("Pixels are not square. Set both aspects to 1, in the properties of the output.")


@contextlib.contextmanager
def staged(
    source: bpy.types.Scene, view_layer: str, effect: Effect, radius: float, samples: int, folder: Path
) -> Iterator[Stage]:
    """A stage for an effect. All that is made for it is removed in the end, whatever happens.

    The radius is in metres.
    """
    check_scene(source)
    if view_layer not in source.view_layers:
        raise AddonError(f"The scene has no view layer {view_layer}.")
    with contextlib.ExitStack() as undo:
        scene = source.copy()
        undo.callback(bpy.data.scenes.remove, scene)
        world = source.world.copy() if source.world else black_world()
        undo.callback(bpy.data.worlds.remove, world)
        scene.world = world
        camera = plain_camera(source, view_layer, undo)
        scene.collection.objects.link(camera)
        scene.camera = camera
        if not effect.lamps:
            hide_lamps(undo)
        set_render(scene.render, folder)
        set_cycles(scene.cycles, samples)
        set_layers(scene, view_layer)
        world.light_settings.distance = radius / scene.unit_settings.scale_length
        yield Stage(scene, camera, folder)


def black_world() -> bpy.types.World:
    """A world that gives no light."""
    world = bpy.data.worlds.new("deepshade")
    world.color = (0.0, 0.0, 0.0)
    # Blender 5 gives it a grey background.
    if world.node_tree is not None:
        world.node_tree.nodes.clear()
    return world


def plain_camera(source: bpy.types.Scene, view_layer: str, undo: contextlib.ExitStack) -> bpy.types.Object:
    """A camera that stands where the scene's does in this frame, without a parent, and with all in focus."""
    layer_of_source = source.view_layers[view_layer]
    layer_of_source.update()
    evaluated = source.camera.evaluated_get(layer_of_source.depsgraph)
    data = source.camera.data.copy()
    undo.callback(bpy.data.cameras.remove, data)
    data.animation_data_clear()
    data.dof.use_dof = False
    camera = bpy.data.objects.new("deepshade_camera", data)
    undo.callback(bpy.data.objects.remove, camera)
    camera.matrix_world = evaluated.matrix_world.copy()
    return camera


def hide_lamps(undo: contextlib.ExitStack) -> None:
    """Hides all lamps from renders until undone. They belong to all scenes at once: a copy is no help."""
    for lamp in [one for one in bpy.data.objects if one.type == "LIGHT" and not one.hide_render]:
        lamp.hide_render = True
        undo.callback(setattr, lamp, "hide_render", False)


def set_render(render: bpy.types.RenderSettings, folder: Path) -> None:
    """A whole frame, still, into a file of many layers of 32-bit floats that `read_exr` reads."""
    render.use_border = False
    render.use_compositing = False
    render.use_sequencer = False
    render.use_motion_blur = False
    render.use_multiview = False
    render.use_overwrite = True
    render.use_file_extension = True
    render.filepath = str(folder / "passes.exr")
    output = render.image_settings
    if hasattr(output, "media_type"):
        output.media_type = "MULTI_LAYER_IMAGE"
    output.file_format = "OPEN_EXR_MULTILAYER"
    output.color_depth = "32"
    output.exr_codec = "NONE"
    if hasattr(output, "use_exr_interleave"):
        output.use_exr_interleave = True


def set_cycles(cycles: Any, samples: int) -> None:
    """Samples through the middle of each pixel, one bounce, and no shortcut that changes light.

    A g-buffer has one surface a pixel. So Cycles' image, too, is not averaged over edges.
    """
    cycles.samples = samples
    cycles.use_adaptive_sampling = False
    cycles.use_denoising = False
    cycles.time_limit = 0.0
    cycles.film_exposure = 1.0
    # A box is always one pixel wide.
    cycles.pixel_filter_type = "GAUSSIAN"
    cycles.filter_width = 0.01
    cycles.sample_clamp_direct = 0.0
    cycles.sample_clamp_indirect = 0.0
    cycles.use_fast_gi = False
    # Indirect light is what other surfaces reflect diffusely, without their gloss.
    cycles.caustics_reflective = False
    cycles.caustics_refractive = False
    cycles.max_bounces = 1
    cycles.diffuse_bounces = 1
    cycles.glossy_bounces = 0


def set_layers(scene: bpy.types.Scene, view_layer: str) -> None:
    """One view layer, with the passes that are read."""
    for one in scene.view_layers:
        one.use = one.name == view_layer
        if one.use:
            one.samples = 0
            for switch, _ in PASSES.values():
                setattr(one, f"use_pass_{switch}", True)


def render_passes(stage: Stage, report: Report) -> dict[str, np.ndarray]:
    """Renders a stage and gives its passes, by their names in Blender 5, each `[height, width, channels]`."""

    def tell(stats: str, *_: object) -> None:
        found = re.search(r"Sample (\d+)/(\d+)", str(stats))
        if found:
            report(int(found[1]) / int(found[2]), f"Cycles, sample {found[1]} of {found[2]}")

    handlers = bpy.app.handlers.render_stats
    handlers.append(tell)
    try:
        with bpy.context.temp_override(scene=stage.scene, view_layer=stage.scene.view_layers[0]):
            bpy.ops.render.render(write_still=True, scene=stage.scene.name)
    except RuntimeError as error:
        raise AddonError(f"Cycles could not render the scene: {error}") from error
    finally:
        handlers.remove(tell)
    path = stage.folder / "passes.exr"
    if not path.is_file():
        raise AddonError("Cycles wrote no passes. Was the render cancelled?")
    channels = read_exr(path)
    view_layer = next(one.name for one in stage.scene.view_layers if one.use)
    return {name: pass_of(channels, view_layer, name) for name in PASSES}


def pass_of(channels: dict[str, np.ndarray], view_layer: str, name: str) -> np.ndarray:
    """A pass of a file, under its name in Blender 5 or an older one."""
    for called in (name, OLDER_NAMES.get(name, name)):
        with contextlib.suppress(KeyError):
            return layer(channels, f"{view_layer}.{called}", PASSES[name][1])
    raise AddonError(f"Cycles wrote no pass {name} for the view layer {view_layer}.")


# ---------------------------------------------------------------------------------------------------------
# The g-buffer
# ---------------------------------------------------------------------------------------------------------

FAR = 1e9
"""A depth that stands for no surface, in Blender's files."""
MADE_OF_POSITION = {"position", "relief", "pixel-radius", "border", "openness", "raw-openness"}
"""Inputs of networks that deepshade makes of positions and normals."""


def gbuffer_of(
    passes: dict[str, np.ndarray], camera_to_world: Matrix, metres: float, inputs: Sequence[str]
) -> dict[str, np.ndarray]:
    """deepshade's g-buffer of Cycles' passes, as a file's channels.

    Cycles has positions and normals in world space, z up, in units of the scene, of `metres` each. deepshade
    has them in camera space, metres, y up, the camera looking down -z; and normals of the world with y up.
    """
    turn, eye = rigid(camera_to_world)
    normal = unit(passes["Normal"])
    seen = surfaces(passes)
    made = {
        "position": ("position", "XYZ", (passes["Position"] - eye) @ turn * metres),
        "normal": ("normal", "XYZ", normal @ turn),
        "world-normal": ("world_normal", "XYZ", normal[..., [0, 2, 1]] * np.array([1.0, 1.0, -1.0])),
        "diffuse-light": ("diffuse_light", "RGB", passes["Diffuse Direct"] * passes["Diffuse Color"]),
        "diffuse": ("diffuse", "RGB", passes["Diffuse Color"]),
    }
    wanted = {"position" if name in MADE_OF_POSITION else name for name in inputs} - {"estimate"}
    unknown = sorted(wanted - set(made))
    if unknown:
        raise AddonError(f"The network reads {', '.join(unknown)}, which the add-on does not make.")
    channels = {"valid": seen.astype(np.float32)}
    for name in sorted(wanted):
        called, components, image = made[name]
        channels |= layered(called, components, np.where(seen[..., None], image, 0.0))
    return channels


def rigid(camera_to_world: Matrix) -> tuple[np.ndarray, np.ndarray]:
    """A camera's axes as columns, of length 1, and where it stands: `(p - eye) @ axes` is camera space."""
    matrix = np.array(camera_to_world, dtype=np.float64)
    axes = matrix[:3, :3] / np.linalg.norm(matrix[:3, :3], axis=0)
    return axes, matrix[:3, 3]


def unit(vectors: np.ndarray) -> np.ndarray:
    """Vectors of length 1; those of no length stay as they are."""
    length = np.linalg.norm(vectors, axis=-1, keepdims=True)
    return vectors / np.where(length > 0.0, length, 1.0)


def surfaces(passes: dict[str, np.ndarray]) -> np.ndarray:
    """Where a surface is seen, `[height, width]`."""
    has_normal = np.linalg.norm(passes["Normal"], axis=-1) > 0.5
    return has_normal & (passes["Depth"][..., 0] < FAR)


# ---------------------------------------------------------------------------------------------------------
# Estimates: images of analytic methods that networks read, and only the scene tells
# ---------------------------------------------------------------------------------------------------------


def estimate(
    stage: Stage, network: Network, effect: Effect, radius: float, size: tuple[int, int], program: Program
) -> tuple[np.ndarray, list[str]]:
    """The image `[height, width, 3]` of the method that a network corrects, by deepshade, of the scene.

    deepshade gets the scene as glTF, in the scene's units, and the world as an image. The radius is in
    metres. With the image comes what it lacks, in words.
    """
    scene_file, world_file = stage.folder / "scene.glb", stage.folder / "world.exr"
    export_scene(stage, scene_file)
    world = render_world(stage)
    write_exr(world_file, {component: world[..., index] for index, component in enumerate("RGB")})
    sky = ("--environment", world_file) if world.any() else ()
    height, width = size
    out = stage.folder / "estimate"
    said = program.run(
        "compare", "--scene", scene_file, "--camera", stage.camera.name, *sky,
        "--effect", effect.name, "--methods", network.method, "--quality", network.quality,
        "--radius", radius / stage.metres, "--height", height, "--width", width, "--spp", 8, "--out", out,
    )  # fmt: skip
    found = list(out.rglob(f"{network.method}*.exr"))
    if len(found) != 1:
        raise AddonError(f"deepshade made {len(found)} images by {network.method}, and not one.")
    lacks = [line for line in said.splitlines() if " alone: " in line]
    return layer(read_exr(found[0]), effect.name, "RGB"), lacks


def check_estimate(scene: bpy.types.Scene, network: Network, effect: Effect) -> None:
    """Raises AddonError if deepshade cannot make the image that a network corrects."""
    other = f"or choose a network that needs no `{network.method}`."
    lens = scene.camera.data
    if lens.shift_x != 0.0 or lens.shift_y != 0.0:
        raise AddonError(f"The camera's lens is shifted, which glTF cannot say. Set shift to 0, {other}")
    if effect.lamps and not lamps_of(scene):
        raise AddonError(f"`{network.method}` sees the light of lamps alone. Add one, {other}")


def export_scene(stage: Stage, path: Path) -> None:
    """Writes what is rendered of a stage as glTF; lights as `COMPAT` has them, which is as Cycles does."""
    with contextlib.ExitStack() as undo:
        for lamp in [one for one in lamps_of(stage.scene) if one.data.type == "AREA"]:
            for spot in spots_for(lamp, undo):
                stage.scene.collection.objects.link(spot)
        with bpy.context.temp_override(scene=stage.scene, view_layer=stage.scene.view_layers[0]):
            bpy.ops.export_scene.gltf(
                filepath=str(path), export_format="GLB", export_cameras=True, export_lights=True,
                export_import_convert_lighting_mode="COMPAT", export_apply=True, export_animations=False,
                use_active_scene=True, use_renderable=True, export_yup=True,
            )  # fmt: skip


def lamps_of(scene: bpy.types.Scene) -> list[bpy.types.Object]:
    """The lamps that a scene's renders see."""
    return [one for one in scene.objects if one.type == "LIGHT" and not one.hide_render]


SPOTS = ((1.0, 2.0 / 3.0), (1.0 / 3.0, 1.0 / 3.0))
"""Blend and weight of spots of half a turn that together shine nearly as a surface does, by the cosine.

Their intensities in glTF are the square of the cosine, and four times that, at most 1. The sum is right at 0,
60 and 90 degrees, and 6 % below the cosine at 45.
"""


def spots_for(lamp: bpy.types.Object, undo: contextlib.ExitStack) -> Iterator[bpy.types.Object]:
    """Spots at four places of an area lamp, which glTF has not. Together they have its intensity."""
    area = lamp.data
    along = area.size if area.shape in {"SQUARE", "DISK"} else area.size_y
    for across, down in itertools.product((-0.25, 0.25), repeat=2):
        for blend, weight in SPOTS:
            data = bpy.data.lights.new("deepshade_spot", "SPOT")
            undo.callback(bpy.data.lights.remove, data)
            data.color = area.color
            # A spot of so many watts has a 4 pi th of them in its direction, a surface a pi th.
            data.energy = 4.0 * weight * area.energy / 4.0
            data.spot_size, data.spot_blend = math.pi, blend
            spot = bpy.data.objects.new("deepshade_spot", data)
            undo.callback(bpy.data.objects.remove, spot)
            place = Matrix.Translation((across * area.size, down * along, 0.0))
            spot.matrix_world = lamp.matrix_world @ place
            yield spot


WORLD_SIZE = (512, 256)
"""Columns and rows of the image of a world."""


def render_world(stage: Stage) -> np.ndarray:
    """A stage's world as an equirectangular image `[height, width, 3]`, Blender's -y in its middle."""
    with contextlib.ExitStack() as undo:
        scene = bpy.data.scenes.new("deepshade_world")
        undo.callback(bpy.data.scenes.remove, scene)
        data = bpy.data.cameras.new("deepshade_world")
        undo.callback(bpy.data.cameras.remove, data)
        camera = bpy.data.objects.new("deepshade_world", data)
        undo.callback(bpy.data.objects.remove, camera)
        data.type = "PANO"
        (data if hasattr(data, "panorama_type") else data.cycles).panorama_type = "EQUIRECTANGULAR"
        camera.rotation_euler = (math.pi / 2.0, 0.0, math.pi)
        scene.collection.objects.link(camera)
        scene.camera, scene.world = camera, stage.scene.world
        scene.render.engine = "CYCLES"
        scene.render.resolution_x, scene.render.resolution_y = WORLD_SIZE
        set_render(scene.render, stage.folder)
        set_cycles(scene.cycles, 1)
        with bpy.context.temp_override(scene=scene, view_layer=scene.view_layers[0]):
            bpy.ops.render.render(write_still=True, scene=scene.name)
        channels = read_exr(stage.folder / "passes.exr")
        return np.maximum(layer(channels, f"{scene.view_layers[0].name}.Combined", "RGB"), 0.0)


# ---------------------------------------------------------------------------------------------------------
# The comparison
# ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Figures:
    """How far a network is from Cycles, over the pixels where both say something."""

    difference: float
    """Mean absolute difference."""
    bias: float
    """Mean of the network's image less that of Cycles'."""
    mean: float
    """Mean of Cycles' image."""


@dataclass(frozen=True)
class Comparison:
    """An effect by a network and by Cycles."""

    effect: str
    network: str
    radius: float
    """Metres."""
    learned: np.ndarray
    """`[height, width, channels]`"""
    cycles: np.ndarray
    """`[height, width, channels]`"""
    compared: np.ndarray
    """Where both say something, `[height, width]`."""
    seconds: dict[str, float] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)

    @property
    def figures(self) -> Figures:
        """How far the two are from each other."""
        error = (self.learned - self.cycles)[self.compared]
        cycles = self.cycles[self.compared]
        return Figures(float(np.abs(error).mean()), float(error.mean()), float(cycles.mean()))

    def save(self, folder: Path) -> None:
        """Writes it into a folder, as `comparison.exr` and `comparison.json`."""
        components = "RGB"[: self.learned.shape[-1]]
        channels = layered("learned", components, self.learned) | layered("cycles", components, self.cycles)
        write_exr(folder / "comparison.exr", channels | {"compared": self.compared.astype(np.float32)})
        said = {name: getattr(self, name) for name in ("effect", "network", "radius", "seconds", "notes")}
        said["figures"] = asdict(self.figures)
        (folder / "comparison.json").write_text(json.dumps(said, indent=2), encoding="utf-8")

    @classmethod
    def load(cls, folder: Path) -> Comparison:
        """Reads what `save` wrote."""
        said = json.loads((folder / "comparison.json").read_text(encoding="utf-8"))
        del said["figures"]
        channels = read_exr(folder / "comparison.exr")
        components = "RGB"[: EFFECTS[said["effect"]].channels]
        images = {name: layer(channels, name, components) for name in ("learned", "cycles")}
        return cls(**said, **images, compared=channels["compared"] > 0.5)


def render_effect(
    scene: bpy.types.Scene,
    effect: str,
    *,
    network: Path,
    radius: float,
    samples: int = 64,
    program: str = "",
    view_layer: str = "",
    report: Report = lambda share, text: None,
) -> Comparison:
    """An effect of a scene in its current frame, by a network and by Cycles.

    `network` is its folder, the radius is in metres, `program` the path of deepshade, by default the one on
    PATH, `view_layer` by default the scene's first. The scene is left as it was, also where this fails.
    Raises AddonError.
    """
    if effect not in EFFECTS:
        raise AddonError(f"There is no effect {effect}. Choose {', '.join(EFFECTS)}.")
    if not (radius > 0.0 and math.isfinite(radius)):
        raise AddonError(f"The radius is {radius} m. State how far the effect reaches, more than 0.")
    wanted, by, net = EFFECTS[effect], Program(program), Network.load(Path(network))
    if net.effect != effect:
        raise AddonError(f"The network {net.folder.name} makes {net.effect}. Choose one for {effect}.")
    check_scene(scene)
    if net.needs_estimate:
        check_estimate(scene, net, wanted)
    with tempfile.TemporaryDirectory(prefix="deepshade-", ignore_cleanup_errors=True) as folder:
        layers = view_layer or scene.view_layers[0].name
        with staged(scene, layers, wanted, radius, samples, Path(folder)) as stage:
            return compared(stage, wanted, net, by, radius, report)


def compared(
    stage: Stage, effect: Effect, network: Network, program: Program, radius: float, report: Report
) -> Comparison:
    """Renders a stage, runs the network, and puts both images side by side."""
    clock = Clock()
    report(0.0, "Cycles")
    passes = render_passes(stage, lambda share, text: report(0.7 * share, text))
    clock.stop("render")
    seen = surfaces(passes)
    if not seen.any():
        raise AddonError("The camera sees no surface. Turn it to the scene, or look at its clipping.")
    reference = passes[effect.reference][..., : effect.channels]
    if effect.is_light and not reference[seen].any():
        raise AddonError("No such light falls on what is seen. Add a lamp, or for `do` a world that shines.")
    channels = gbuffer_of(passes, stage.camera.matrix_world, stage.metres, network.inputs)
    notes = []
    if network.needs_estimate:
        report(0.7, f"deepshade, {network.method}")
        image, notes = estimate(stage, network, effect, radius, seen.shape, program)
        channels |= layered("estimate", "RGB", np.where(seen[..., None], image, 0.0))
        clock.stop("estimate")
    report(0.9, f"deepshade, the network {network.folder.name}")
    learned, said = infer(channels, network, effect, radius, program, stage.folder)
    clock.stop("network")
    report(1.0, "done")
    # Cycles has no light without a colour to reflect it.
    lit = seen & (passes["Diffuse Color"].max(axis=-1) > 0.01) if effect.is_light else seen
    notes += [line for line in said.splitlines() if line]
    return Comparison(effect.name, network.folder.name, radius, learned, reference, lit, clock.seconds, notes)


def infer(
    channels: dict[str, np.ndarray], network: Network, effect: Effect, radius: float, program: Program,
    folder: Path,
) -> tuple[np.ndarray, str]:  # fmt: skip
    """A network's image of a g-buffer, `[height, width, channels]`, and what the program had to say."""
    write_exr(folder / "gbuffer.exr", channels)
    said = program.run(
        "infer", "--model", network.folder, "--gbuffer", folder / "gbuffer.exr", "--radius", radius,
        "--out", folder / "learned.exr",
    )  # fmt: skip
    image = read_exr(folder / "learned.exr")
    return (layer(image, effect.name, "RGB") if effect.is_light else image[effect.name][..., None]), said


class Clock:
    """How long each part of the work took, seconds."""

    def __init__(self) -> None:
        """Begins the first part."""
        self.seconds: dict[str, float] = {}
        self._since = time.perf_counter()

    def stop(self, part: str) -> None:
        """Ends a part; the next one begins."""
        now = time.perf_counter()
        self.seconds[part], self._since = now - self._since, now


# ---------------------------------------------------------------------------------------------------------
# Pictures
# ---------------------------------------------------------------------------------------------------------


def picture(learned: np.ndarray, cycles: np.ndarray, layout: str, split: float) -> np.ndarray:
    """Both images in one, `[height, width, 3]`, under one exposure.

    `SPLIT` shows the network's up to the share `split` of the width, and from there Cycles'. `SIDES` shows
    one beside the other, and `DIFFERENCE` how far they are apart, too.
    """
    both = [np.broadcast_to(image, (*image.shape[:2], 3)) for image in (learned, cycles)]
    white = float(np.percentile(cycles, 99.0)) if learned.shape[-1] == 3 else 1.0
    learned, cycles = (image / white if white > 0.0 else image for image in both)
    if layout == "SIDES":
        return np.hstack([learned, cycles])
    if layout == "DIFFERENCE":
        return np.hstack([learned, cycles, np.abs(learned - cycles)])
    column = round(split * learned.shape[1])
    shown = np.where(np.arange(learned.shape[1])[:, None] < column, learned, cycles)
    if 0 < column < learned.shape[1]:
        shown[:, column] = (1.0, 0.5, 0.0)
    return shown


def image_named(name: str, pixels: np.ndarray) -> bpy.types.Image:
    """Blender's image of that name, of pixels `[height, width, 1 or 3]`, made where there is none."""
    height, width = pixels.shape[:2]
    image = bpy.data.images.get(name)
    if image is None:
        image = bpy.data.images.new(name, width, height, float_buffer=True)
    elif tuple(image.size) != (width, height):
        image.scale(width, height)
    # Blender's images begin at the bottom.
    opaque = np.ones((height, width, 4), np.float32)
    opaque[..., :3] = pixels[::-1]
    image.pixels.foreach_set(opaque.ravel())
    image.update()
    return image


def pixels_named(name: str) -> np.ndarray | None:
    """The pixels `[height, width, 3]` of Blender's image of that name, if there is one."""
    image = bpy.data.images.get(name)
    if image is None or not image.size[0]:
        return None
    flat = np.empty(4 * image.size[0] * image.size[1], np.float32)
    image.pixels.foreach_get(flat)
    return flat.reshape(image.size[1], image.size[0], 4)[::-1, :, :3]


def image_names(effect: str) -> tuple[str, str, str]:
    """Names of Blender's images: the network's, Cycles', and both in one."""
    return f"deepshade {effect}", f"Cycles {effect}", f"deepshade | Cycles {effect}"


def show(comparison: Comparison, layout: str, split: float) -> bpy.types.Image:
    """Makes a comparison's images in Blender; gives the one that has both."""
    learned, cycles, _ = image_names(comparison.effect)
    image_named(learned, comparison.learned)
    image_named(cycles, comparison.cycles)
    return show_again(comparison.effect, layout, split)


def show_again(effect: str, layout: str, split: float) -> bpy.types.Image | None:
    """Makes the image that has both anew, of the two that are there; nothing where there are none."""
    names = image_names(effect)
    both = [pixels_named(name) for name in names[:2]]
    if any(pixels is None for pixels in both):
        return None
    channels = EFFECTS[effect].channels
    learned, cycles = (pixels[..., :channels] for pixels in both)
    return image_named(names[2], picture(learned, cycles, layout, split))


# ---------------------------------------------------------------------------------------------------------
# A second Blender, which does the work on a copy of the file
# ---------------------------------------------------------------------------------------------------------


@dataclass(frozen=True)
class Order:
    """What a second Blender is to do."""

    file: str
    scene: str
    view_layer: str
    effect: str
    network: str
    radius: float
    samples: int
    program: str


class Job:
    """The work of a second Blender. Nothing here blocks."""

    def __init__(self, order: Order, folder: Path) -> None:
        """Begins. The folder is the job's own, and is removed by `close`."""
        self.folder = folder
        folder.mkdir(exist_ok=True)
        (folder / "order.json").write_text(json.dumps(asdict(order)), encoding="utf-8")
        # What it makes for itself goes with the folder, also where it is killed.
        within = os.environ | dict.fromkeys(("TMPDIR", "TEMP", "TMP"), str(folder))
        with (folder / "log.txt").open("wb") as log:
            self._process = subprocess.Popen(
                second_blender(order.file, folder), stdin=subprocess.DEVNULL, stdout=log,
                stderr=subprocess.STDOUT, env=within, start_new_session=os.name == "posix",
            )  # fmt: skip

    def is_running(self) -> bool:
        """Whether it is still at work."""
        return self._process.poll() is None

    def progress(self) -> tuple[float, str]:
        """The share that is done, 0 to 1, and what is being done."""
        try:
            share, text = (self.folder / "progress.txt").read_text(encoding="utf-8").split(" ", 1)
            return float(share), text
        except (OSError, ValueError):
            return 0.0, "starting"

    def result(self) -> Comparison:
        """What it made, once it has ended. Raises AddonError with its reason if it failed."""
        error = self.folder / "error.txt"
        if error.is_file():
            raise AddonError(error.read_text(encoding="utf-8"))
        if self._process.returncode != 0 or not (self.folder / "comparison.json").is_file():
            log = (self.folder / "log.txt").read_text(encoding="utf-8", errors="replace")
            raise AddonError("The second Blender failed:\n" + "\n".join(log.splitlines()[-8:]))
        return Comparison.load(self.folder)

    def close(self) -> None:
        """Ends it, if it is still at work, with what it started, and removes its files."""
        if self.is_running():
            if os.name == "posix":
                os.killpg(self._process.pid, signal.SIGKILL)
            else:
                self._process.kill()
            self._process.wait()
        shutil.rmtree(self.folder, ignore_errors=True)


def second_blender(file: str, folder: Path) -> list[str]:
    """The command line of a Blender that does an order; of Python, where Blender is a module of it."""
    if not bpy.app.binary_path:
        return [sys.executable, __file__, "--order", str(folder)]
    scripts = [] if bpy.app.autoexec_fail else ["--enable-autoexec"]
    return [
        bpy.app.binary_path, "--background", *scripts, file, "--python-exit-code", "1", "--python", __file__,
        "--", "--order", str(folder),
    ]  # fmt: skip


def do_order(folder: Path) -> None:
    """Does an order: writes progress, then a comparison, or why there is none."""

    def report(share: float, text: str) -> None:
        # Renamed when whole, since it is read at any time.
        (folder / "progress.new").write_text(f"{share:.3f} {text}", encoding="utf-8")
        (folder / "progress.new").replace(folder / "progress.txt")

    order = Order(**json.loads((folder / "order.json").read_text(encoding="utf-8")))
    if bpy.data.filepath != order.file:
        bpy.ops.wm.open_mainfile(filepath=order.file)
    try:
        comparison = render_effect(
            bpy.data.scenes[order.scene], order.effect, network=Path(order.network), radius=order.radius,
            samples=order.samples, program=order.program, view_layer=order.view_layer, report=report,
        )  # fmt: skip
    except AddonError as error:
        (folder / "error.txt").write_text(str(error), encoding="utf-8")
    else:
        comparison.save(folder)


def start_job(scene: bpy.types.Scene, view_layer: str, settings: Settings) -> Job:
    """Begins the work that a scene's settings ask for. Raises AddonError if it is plain that it must fail."""
    check_scene(scene)
    preferences = preferences_of()
    program = Program(preferences.program)
    network = Network.load(models_folder(preferences.models, preferences.program) / settings.network)
    if network.needs_estimate:
        check_estimate(scene, network, EFFECTS[settings.effect])
    folder = Path(tempfile.mkdtemp(prefix="deepshade-"))
    file = str(folder / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file, copy=True, check_existing=False)
    order = Order(
        file, scene.name, view_layer, settings.effect, str(network.folder), settings.radius, settings.samples,
        str(program.path),
    )  # fmt: skip
    return Job(order, folder)


# ---------------------------------------------------------------------------------------------------------
# The interface
# ---------------------------------------------------------------------------------------------------------


class Preferences(bpy.types.AddonPreferences):
    """Where deepshade is."""

    bl_idname = __name__

    program: bpy.props.StringProperty(
        name="Program", subtype="FILE_PATH", description="The program deepshade; by default the one on PATH"
    )
    models: bpy.props.StringProperty(
        name="Networks", subtype="DIR_PATH",
        description="deepshade's folder `models`; by default the one above the program",
    )  # fmt: skip

    def draw(self, context: bpy.types.Context) -> None:
        """Both paths, and what is wrong with them."""
        self.layout.prop(self, "program")
        self.layout.prop(self, "models")
        try:
            models_folder(self.models, self.program)
        except AddonError as error:
            draw_lines(self.layout, str(error), "ERROR")


def preferences_of() -> Any:
    """The add-on's preferences; their defaults where it is not enabled, as in a test."""
    addon = bpy.context.preferences.addons.get(__name__)
    return addon.preferences if addon else argparse.Namespace(program="", models="")


_networks: list[tuple[str, str, str]] = []
"""Items of a menu, which Blender needs to be kept."""


def network_items(settings: Settings, context: bpy.types.Context | None) -> list[tuple[str, str, str]]:
    """The networks of the chosen effect, for a menu."""
    global _networks
    preferences = preferences_of()
    try:
        found = networks_of(settings.effect, models_folder(preferences.models, preferences.program))
        _networks = [(one.folder.name, one.folder.name, f"Reads {', '.join(one.inputs)}") for one in found]
    except AddonError:
        _networks = []
    return _networks


def compose_again(settings: Settings, context: bpy.types.Context) -> None:
    """Shows the images again, as the settings now have it."""
    show_again(settings.effect, settings.layout, settings.split)


class Settings(bpy.types.PropertyGroup):
    """What is compared, and how it is shown."""

    effect: bpy.props.EnumProperty(
        name="Effect", items=[(one.name, one.label, one.description) for one in EFFECTS.values()]
    )
    network: bpy.props.EnumProperty(name="Network", items=network_items)
    radius: bpy.props.FloatProperty(
        name="Radius (m)", description="How far the effect reaches", default=0.5, min=0.001, soft_max=20.0
    )
    samples: bpy.props.IntProperty(
        name="Samples", description="Samples of a pixel that Cycles takes", default=64, min=1, max=16384
    )
    layout: bpy.props.EnumProperty(
        name="Layout", update=compose_again,
        items=[
            ("SPLIT", "Split", "The network's image to the left of the slider, Cycles' to the right"),
            ("SIDES", "Sides", "The network's image beside Cycles'"),
            ("DIFFERENCE", "Difference", "Both, and how far they are apart"),
        ],
    )  # fmt: skip
    split: bpy.props.FloatProperty(
        name="Slider", subtype="FACTOR", default=0.5, min=0.0, max=1.0, update=compose_again
    )
    said: bpy.props.StringProperty(options={"SKIP_SAVE"})


class CompareOperator(bpy.types.Operator):
    """Renders the passes by Cycles, runs the network, and shows both. Escape cancels"""

    bl_idname = "deepshade.compare"
    bl_label = "Compare with Cycles"

    job: Job | None = None
    """The one that runs; of the class, so that there is but one."""
    is_cancelled = False
    told = (0.0, "")

    @classmethod
    def poll(cls, context: bpy.types.Context) -> bool:
        """Not while one runs."""
        return CompareOperator.job is None

    def invoke(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Begins."""
        cls, settings = CompareOperator, context.scene.deepshade
        try:
            cls.job = start_job(context.scene, context.view_layer.name, settings)
        except AddonError as error:
            settings.said = str(error)
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        cls.is_cancelled, cls.told, settings.said = False, (0.0, "starting"), ""
        windows = context.window_manager
        self._scene, self._timer = context.scene, windows.event_timer_add(0.2, window=context.window)
        windows.progress_begin(0.0, 1.0)
        windows.modal_handler_add(self)
        return {"RUNNING_MODAL"}

    def modal(self, context: bpy.types.Context, event: bpy.types.Event) -> set[str]:
        """Looks whether the job has ended, and else lets Blender go on."""
        cls = CompareOperator
        if cls.is_cancelled or event.type == "ESC":
            self._end(context)
            self._scene.deepshade.said = "Cancelled."
            return {"CANCELLED"}
        if event.type != "TIMER" or cls.job is None:
            return {"PASS_THROUGH"}
        if cls.job.is_running():
            cls.told = cls.job.progress()
            context.window_manager.progress_update(cls.told[0])
            redraw(context)
            return {"PASS_THROUGH"}
        return self._finish(context)

    def _finish(self, context: bpy.types.Context) -> set[str]:
        """Shows what the job made, or says why it failed."""
        settings = self._scene.deepshade
        try:
            comparison = CompareOperator.job.result()
        except AddonError as error:
            settings.said = str(error)
            self.report({"ERROR"}, str(error))
            return {"CANCELLED"}
        finally:
            self._end(context)
        settings.said = summary(comparison)
        open_image(context, show(comparison, settings.layout, settings.split))
        return {"FINISHED"}

    def _end(self, context: bpy.types.Context) -> None:
        """Ends the job and all that was begun with it."""
        if CompareOperator.job is not None:
            CompareOperator.job.close()
            CompareOperator.job = None
        context.window_manager.event_timer_remove(self._timer)
        context.window_manager.progress_end()
        redraw(context)

    def cancel(self, context: bpy.types.Context) -> None:
        """Blender itself ends it, as when a file is opened."""
        self._end(context)


class CancelOperator(bpy.types.Operator):
    """Ends the comparison that runs"""

    bl_idname = "deepshade.cancel"
    bl_label = "Cancel"

    def execute(self, context: bpy.types.Context) -> set[str]:
        """Leaves word; the timer does the rest."""
        CompareOperator.is_cancelled = True
        return {"FINISHED"}


def summary(comparison: Comparison) -> str:
    """What was measured, in some lines."""
    figures, share = comparison.figures, ""
    if EFFECTS[comparison.effect].is_light and figures.mean > 0.0:
        share = f" ({100.0 * figures.difference / figures.mean:.0f} % of Cycles' mean)"
    times = [f"{part} {seconds:.1f} s" for part, seconds in comparison.seconds.items()]
    lines = [
        f"{comparison.network}, radius {comparison.radius:g} m",
        f"mean difference {figures.difference:.4f}{share}",
        f"bias {figures.bias:+.4f}",
        f"mean of Cycles {figures.mean:.4f}",
    ]
    return "\n".join(lines + times + comparison.notes)


def redraw(context: bpy.types.Context) -> None:
    """Draws the panels again."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type in {"PROPERTIES", "IMAGE_EDITOR"}:
                area.tag_redraw()


def open_image(context: bpy.types.Context, image: bpy.types.Image) -> None:
    """Shows an image in all Image Editors that are open."""
    for window in context.window_manager.windows:
        for area in window.screen.areas:
            if area.type == "IMAGE_EDITOR":
                area.spaces.active.image = image


def draw_lines(layout: bpy.types.UILayout, text: str, icon: str = "NONE") -> None:
    """Several lines of text, the long ones broken."""
    column = layout.column(align=True)
    for line in text.splitlines():
        for part in re.findall(r".{1,34}(?:\s|$)|\S{35,}", line):
            column.label(text=part, icon=icon)
            icon = "BLANK1" if icon != "NONE" else "NONE"


class Panel:
    """What both panels show."""

    bl_label = "deepshade"

    def draw(self, context: bpy.types.Context) -> None:
        """Settings, what is going on, and what came of it."""
        layout, settings = self.layout, context.scene.deepshade
        layout.use_property_split = True
        column = layout.column()
        column.enabled = CompareOperator.job is None
        for name in ("effect", "network", "radius", "samples"):
            column.prop(settings, name)
        if not settings.network:
            draw_lines(layout, "No network of this effect: state the folder in the preferences.", "ERROR")
        if CompareOperator.job is None:
            layout.operator("deepshade.compare", icon="RENDER_STILL")
        else:
            share, text = CompareOperator.told
            if hasattr(layout, "progress"):
                layout.progress(factor=share, text=text)
            else:
                layout.label(text=f"{text}, {100.0 * share:.0f} %")
            layout.operator("deepshade.cancel", icon="CANCEL")
        layout.prop(settings, "layout")
        if settings.layout == "SPLIT":
            layout.prop(settings, "split", slider=True)
        if settings.said:
            draw_lines(layout, settings.said)


class RenderPanel(Panel, bpy.types.Panel):
    """In the properties of the render."""

    bl_idname = "RENDER_PT_deepshade"
    bl_space_type = "PROPERTIES"
    bl_region_type = "WINDOW"
    bl_context = "render"


class ImagePanel(Panel, bpy.types.Panel):
    """In the side bar of the Image Editor."""

    bl_idname = "IMAGE_PT_deepshade"
    bl_space_type = "IMAGE_EDITOR"
    bl_region_type = "UI"
    bl_category = "deepshade"


CLASSES = (Preferences, Settings, CompareOperator, CancelOperator, RenderPanel, ImagePanel)


def register() -> None:
    """Called by Blender when the add-on is enabled."""
    for one in CLASSES:
        bpy.utils.register_class(one)
    bpy.types.Scene.deepshade = bpy.props.PointerProperty(type=Settings)


def unregister() -> None:
    """Called by Blender when the add-on is disabled."""
    if CompareOperator.job is not None:
        CompareOperator.job.close()
        CompareOperator.job = None
    del bpy.types.Scene.deepshade
    for one in reversed(CLASSES):
        bpy.utils.unregister_class(one)


# ---------------------------------------------------------------------------------------------------------
# The command line
# ---------------------------------------------------------------------------------------------------------


def main(arguments: Sequence[str]) -> None:
    """`blender --background scene.blend --python deepshade_addon.py -- --effect ao --radius 1`"""
    parser = argparse.ArgumentParser(prog="deepshade_addon.py", description="An effect beside Cycles' own")
    parser.add_argument("--order", type=Path, help=argparse.SUPPRESS)
    parser.add_argument("--effect", choices=list(EFFECTS), default="ao")
    parser.add_argument("--network", type=Path, help="folder of the network")
    parser.add_argument("--radius", type=float, default=0.5, help="metres")
    parser.add_argument("--samples", type=int, default=64, help="samples of a pixel by Cycles")
    parser.add_argument("--program", default="", help="deepshade; by default the one on PATH")
    parser.add_argument("--out", type=Path, default=Path(), help="folder for comparison.exr and .json")
    given = parser.parse_args(arguments)
    if given.order:
        do_order(given.order)
        return
    try:
        network = given.network or models_folder("", given.program) / given.effect
        comparison = render_effect(
            bpy.context.scene, given.effect, network=network, radius=given.radius, samples=given.samples,
            program=given.program, view_layer=bpy.context.view_layer.name,
        )  # fmt: skip
    except AddonError as error:
        sys.exit(str(error))
    given.out.mkdir(parents=True, exist_ok=True)
    comparison.save(given.out)
    print(summary(comparison))


if __name__ == "__main__":
    main(sys.argv[sys.argv.index("--") + 1 :] if "--" in sys.argv else sys.argv[1:])
