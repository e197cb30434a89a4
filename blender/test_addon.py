# SPDX-License-Identifier: MIT OR Apache-2.0
"""Tests of the add-on, by Blender as a Python module: `pip install bpy pytest`, then `pytest blender`.

`DEEPSHADE` names the program, else it is the `deepshade` on PATH.
"""

from __future__ import annotations

import dataclasses
import math
import os
import shutil
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import bpy
import numpy as np
import pytest
from mathutils import Matrix, Vector

sys.path.insert(0, str(Path(__file__).parent))
import deepshade_addon as addon

MODELS = Path(__file__).parents[1] / "models"
SIZE = (192, 144)
RADIUS = 0.5
"""Metres."""

AO_BOUND = 0.02
"""Mean absolute difference of `ao`, of which wrong conventions are beyond."""
DO_BOUND = 0.15
"""The same of `do`, as a share of Cycles' mean."""
GI_BOUND = {"POINT": 0.26, "AREA": 0.26, "SUN": 0.26, "SPOT": 0.4}
"""The same of `gi`, by the lamp. Where a spot leaves much in the dark, noise is a larger share."""


@pytest.fixture(scope="session")
def program() -> str:
    found = shutil.which(os.environ.get("DEEPSHADE", "deepshade"))
    if found is None:
        pytest.skip("no program: set DEEPSHADE, or put deepshade on PATH")
    return str(Path(found).resolve())


def room(lamp: str = "POINT") -> bpy.types.Scene:
    """A corner of a room, 6 m wide, with three boxes, coloured walls and one lamp; z is up."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = SIZE
    box("floor", (6, 6, 0.1), (0, 0, -0.05), (0.7, 0.7, 0.7))
    box("back", (6, 0.1, 3), (0, 3, 1.5), (0.8, 0.2, 0.1))
    box("left", (0.1, 6, 3), (-3, 0, 1.5), (0.1, 0.2, 0.8))
    box("tall", (1, 1, 1.6), (-1, 0.8, 0.8), (0.7, 0.7, 0.7), 0.4)
    box("small", (0.8, 0.8, 0.8), (0.9, -0.2, 0.4), (0.2, 0.7, 0.1), -0.3)
    box("flat", (2, 0.4, 0.3), (0.6, 1.8, 0.15), (0.7, 0.7, 0.2))
    if lamp:
        data = bpy.data.lights.new("lamp", lamp)
        data.energy = 300.0
        put(bpy.data.objects.new("lamp", data), (1.5, -1.0, 2.5), (-1.0, 1.0, 0.0))
    camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
    put(camera, (3.5, -5.0, 2.6), (0.0, 0.5, 0.6))
    scene.camera = camera
    return scene


def box(name: str, size: tuple, at: tuple, colour: tuple, turn: float = 0.0) -> None:
    bpy.ops.mesh.primitive_cube_add(size=1, location=at, rotation=(0, 0, turn))
    bpy.context.object.name, bpy.context.object.scale = name, size
    material = bpy.data.materials.new(name)
    if material.node_tree is None:
        material.use_nodes = True
    material.node_tree.nodes["Principled BSDF"].inputs["Base Color"].default_value = (*colour, 1)
    bpy.context.object.data.materials.append(material)


def put(thing: bpy.types.Object, at: tuple, target: tuple) -> None:
    """Links a thing into the scene, its -z towards a target."""
    thing.location = at
    thing.rotation_euler = (Vector(target) - Vector(at)).to_track_quat("-Z", "Y").to_euler()
    bpy.context.scene.collection.objects.link(thing)


def sky(scene: bpy.types.Scene) -> bpy.types.Node:
    """Gives a world that is red towards x, green towards -y, blue above; the node that turns it."""
    world = bpy.data.worlds.new("sky")
    scene.world = world
    if world.node_tree is None:
        world.use_nodes = True
    nodes, links = world.node_tree.nodes, world.node_tree.links
    place, turn = nodes.new("ShaderNodeTexCoord"), nodes.new("ShaderNodeVectorRotate")
    scale, clamp = nodes.new("ShaderNodeVectorMath"), nodes.new("ShaderNodeVectorMath")
    turn.rotation_type = "Z_AXIS"
    scale.operation, scale.inputs[1].default_value = "MULTIPLY", (2.0, -2.0, 1.0)
    clamp.operation, clamp.inputs[1].default_value = "MAXIMUM", (0.05, 0.05, 0.05)
    links.new(place.outputs["Generated"], turn.inputs["Vector"])
    links.new(turn.outputs["Vector"], scale.inputs[0])
    links.new(scale.outputs["Vector"], clamp.inputs[0])
    links.new(clamp.outputs["Vector"], nodes["Background"].inputs["Color"])
    return turn


def state(scene: bpy.types.Scene) -> dict[str, object]:
    """All settings that a render may touch, and how many things of each kind there are."""
    owners = {
        "scene": scene, "render": scene.render, "output": scene.render.image_settings, "cycles": scene.cycles,
        "world": scene.world, "camera": scene.camera, "lens": scene.camera.data,
        **{f"layer {one.name}": one for one in scene.view_layers},
        **{f"object {one.name}": one for one in bpy.data.objects},
    }  # fmt: skip
    kept: dict[str, object] = {"path": bpy.data.filepath}
    for owner, thing in owners.items():
        for name in set(thing.bl_rna.properties.keys()) - {"users"} if thing else ():
            value = getattr(thing, name)
            is_plain = isinstance(value, (bool, int, float, str))
            kept[f"{owner}.{name}"] = value if is_plain else getattr(value, "name", None)
    for name in ("scenes", "worlds", "cameras", "objects", "meshes", "materials", "lights", "images"):
        kept[name] = sorted(one.name for one in getattr(bpy.data, name) if one.name != "Render Result")
    if scene.world:
        kept["distance"] = scene.world.light_settings.distance
    return kept


@dataclasses.dataclass(frozen=True)
class Shot:
    """Passes of the room, and what is needed to go on with them."""

    passes: dict[str, np.ndarray]
    camera: Matrix
    network: addon.Network

    @property
    def channels(self) -> dict[str, np.ndarray]:
        """The g-buffer of them."""
        return addon.gbuffer_of(self.passes, self.camera, 1.0, self.network.inputs)


@pytest.fixture(scope="module")
def shot(tmp_path_factory: pytest.TempPathFactory) -> Shot:
    scene, folder = room(), tmp_path_factory.mktemp("shot")
    with addon.staged(scene, scene.view_layers[0].name, addon.EFFECTS["ao"], RADIUS, 64, folder) as stage:
        passes = addon.render_passes(stage, lambda share, text: None)
        return Shot(passes, stage.camera.matrix_world.copy(), addon.Network.load(MODELS / "ao"))


Infer = Callable[..., float]
Record = Callable[[str, float], None]
"""pytest's, which keeps a figure for `cargo xtask hosts`."""


@pytest.fixture(scope="module")
def ao_error(shot: Shot, program: str, tmp_path_factory: pytest.TempPathFactory) -> Infer:
    """The mean difference to Cycles of a g-buffer's `ao`, taken as it is."""
    trusting = Trusting(program)

    def of(channels: dict[str, np.ndarray], radius: float = RADIUS) -> float:
        folder = tmp_path_factory.mktemp("infer")
        image, _ = addon.infer(channels, shot.network, addon.EFFECTS["ao"], radius, trusting, folder)
        return difference(shot, image)

    return of


class Trusting(addon.Program):
    """The program, which takes any g-buffer."""

    def run(self, *arguments: object) -> str:
        """Adds the option that says so."""
        return super().run(*arguments, "--trusted")


def difference(shot: Shot, image: np.ndarray) -> float:
    seen = addon.surfaces(shot.passes)
    return float(np.abs(image - shot.passes["Ambient Occlusion"][..., :1])[seen].mean())


# Files


def test_channels_come_back_from_a_file(tmp_path: Path) -> None:
    random = np.random.default_rng(1)
    written = {name: random.normal(size=(5, 7)).astype(np.float32) for name in ("b.X", "a", "b.Y")}
    addon.write_exr(tmp_path / "a.exr", written)
    read = addon.read_exr(tmp_path / "a.exr")
    assert read.keys() == written.keys()
    assert all(np.array_equal(read[name], written[name]) for name in written)


@pytest.mark.parametrize("codec", ["NONE", "ZIPS", "ZIP"])
@pytest.mark.parametrize("depth", ["16", "32"])
def test_files_of_blender_are_read(tmp_path: Path, codec: str, depth: str) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    pixels = np.random.default_rng(2).random((19, 8, 3)).astype(np.float32)
    image = addon.image_named("random", pixels)
    output = bpy.context.scene.render.image_settings
    output.file_format, output.color_depth, output.exr_codec = "OPEN_EXR", depth, codec
    output.color_mode = "RGB"
    image.save_render(str(tmp_path / "a.exr"), scene=bpy.context.scene)
    read = addon.read_exr(tmp_path / "a.exr")
    assert np.abs(np.stack([read[name] for name in "RGB"], -1) - pixels).max() < 1e-3


def test_what_is_no_file_of_ours_is_refused(tmp_path: Path) -> None:
    (tmp_path / "a.exr").write_bytes(b"no image, though it is long enough")
    with pytest.raises(addon.AddonError, match="no OpenEXR file"):
        addon.read_exr(tmp_path / "a.exr")


# The g-buffer


def test_positions_lie_where_their_pixels_see_them(shot: Shot) -> None:
    channels = shot.channels
    width, height = SIZE
    focal = bpy.data.cameras["camera"].lens / 36.0 * width
    rows, columns = np.mgrid[0:height, 0:width] + 0.5
    depth = -channels["position.Z"]
    at_column = channels["position.X"] / depth * focal + width / 2
    at_row = height / 2 - channels["position.Y"] / depth * focal
    assert np.abs(at_column - columns).max() < 0.01
    assert np.abs(at_row - rows).max() < 0.01
    assert np.abs(at_row[::-1] - rows).max() > 1.0
    assert np.abs(depth - shot.passes["Depth"][..., 0]).max() < 1e-4


def test_normals_stand_on_the_surface_of_the_positions(shot: Shot) -> None:
    def share(channels: dict[str, np.ndarray]) -> float:
        position, normal = (addon.layer(channels, name, "XYZ") for name in ("position", "normal"))
        along, down = np.diff(position, axis=1)[:-1], np.diff(position, axis=0)[:, :-1]
        surface = addon.unit(np.cross(down, along))
        return float(((surface * normal[:-1, :-1]).sum(-1) > 0.999).mean())

    assert share(shot.channels) > 0.9
    world = shot.channels | addon.layered("normal", "XYZ", addon.unit(shot.passes["Normal"]))
    assert share(world) < 0.1


def test_normals_of_the_world_have_y_up(shot: Shot) -> None:
    channels = addon.gbuffer_of(shot.passes, shot.camera, 1.0, ["world-normal"])
    floor = np.abs(shot.passes["Position"][..., 2]) < 1e-3
    assert floor.sum() > 1000
    # Some pixels lie on an edge, and have the mean of two normals.
    assert (channels["world_normal.Y"][floor] > 0.999).mean() > 0.98


def test_an_input_that_the_add_on_does_not_make_is_named(shot: Shot) -> None:
    with pytest.raises(addon.AddonError, match="glossiness"):
        addon.gbuffer_of(shot.passes, shot.camera, 1.0, ["normal", "glossiness"])


# Ambient occlusion


def test_ao_is_that_of_cycles(shot: Shot, ao_error: Infer, record_property: Record) -> None:
    error, white = ao_error(shot.channels), difference(shot, np.ones((*SIZE[::-1], 1)))
    record_property("mean_abs_blender_ao", error)
    print(f"ao: mean difference {error:.4f}, of a white image {white:.4f}")
    assert error < AO_BOUND < white


def test_wrong_conventions_are_beyond_the_bound(shot: Shot, ao_error: Infer) -> None:
    channels = shot.channels
    normal = addon.layer(channels, "normal", "XYZ")
    position = addon.layer(channels, "position", "XYZ")
    wrong = {
        "normals of the world": addon.layered("normal", "XYZ", addon.unit(shot.passes["Normal"])),
        "y of normals downwards": addon.layered("normal", "XYZ", normal * (1.0, -1.0, 1.0)),
        "z of normals away": addon.layered("normal", "XYZ", normal * (1.0, 1.0, -1.0)),
        "positions of the world": addon.layered("position", "XYZ", shot.passes["Position"]),
        "y of positions downwards": addon.layered("position", "XYZ", position * (1.0, -1.0, 1.0)),
        "decimetres": addon.layered("position", "XYZ", 10.0 * position),
        "centimetres of a metre": addon.layered("position", "XYZ", 0.01 * position),
        "rows from the bottom": {name: image[::-1] for name, image in channels.items()},
    }
    errors = {name: ao_error(channels | changed) for name, changed in wrong.items()}
    errors["half the radius"] = ao_error(channels, RADIUS / 2.0)
    errors["twice the radius"] = ao_error(channels, RADIUS * 2.0)
    print({name: round(error, 4) for name, error in errors.items()})
    assert all(error > AO_BOUND for error in errors.values())


def test_deepshade_refuses_normals_of_the_world(shot: Shot, program: str, tmp_path: Path) -> None:
    world = shot.channels | addon.layered("normal", "XYZ", addon.unit(shot.passes["Normal"]))
    with pytest.raises(addon.AddonError, match="normals"):
        addon.infer(world, shot.network, addon.EFFECTS["ao"], RADIUS, addon.Program(program), tmp_path)


def test_the_unit_of_the_scene_counts(program: str) -> None:
    def ao(metres: float) -> addon.Comparison:
        scene = room()
        scene.unit_settings.scale_length = metres
        return addon.render_effect(
            scene, "ao", network=MODELS / "ao-small", radius=RADIUS * metres, samples=16, program=program
        )

    one, tenth = ao(1.0), ao(0.1)
    assert np.abs(one.learned - tenth.learned).mean() < 1e-3
    assert np.array_equal(one.cycles, tenth.cycles)


def test_where_no_surface_is_seen_nothing_is_compared(program: str) -> None:
    scene = room()
    bpy.data.objects.remove(bpy.data.objects["back"])
    found = addon.render_effect(
        scene, "ao", network=MODELS / "ao-small", radius=RADIUS, samples=16, program=program
    )
    assert 0.1 < found.compared.mean() < 0.9
    assert np.all(found.learned[~found.compared] == 1.0)
    assert found.figures.difference < 2.0 * AO_BOUND


def test_a_camera_with_a_parent_and_a_scale_is_the_same_camera(program: str) -> None:
    scene = room()
    plain = addon.render_effect(
        scene, "ao", network=MODELS / "ao-small", radius=RADIUS, samples=4, program=program
    )
    scene = room()
    parent = bpy.data.objects.new("parent", None)
    scene.collection.objects.link(parent)
    parent.location, parent.scale = (1.0, 2.0, 3.0), (2.0, 2.0, 2.0)
    bpy.context.view_layer.update()
    scene.camera.parent = parent
    scene.camera.matrix_parent_inverse = Matrix.Scale(0.5, 4) @ Matrix.Translation((-1.0, -2.0, -3.0))
    scene.camera.scale = (3.0, 3.0, 3.0)
    other = addon.render_effect(
        scene, "ao", network=MODELS / "ao-small", radius=RADIUS, samples=4, program=program
    )
    assert np.abs(plain.learned - other.learned).mean() < 1e-3


# Light


def relative(comparison: addon.Comparison, image: np.ndarray | None = None) -> float:
    changed = comparison if image is None else dataclasses.replace(comparison, learned=image)
    return changed.figures.difference / changed.figures.mean


@pytest.mark.parametrize("lamp", ["POINT", "AREA", "SUN", "SPOT"])
def test_gi_is_that_of_cycles(lamp: str, program: str, record_property: Record) -> None:
    found = addon.render_effect(
        room(lamp), "gi", network=MODELS / "gi", radius=6.0, samples=128, program=program
    )
    error, image = relative(found), found.learned
    wrong = {
        "flipped": relative(found, image[::-1]),
        "mirrored": relative(found, image[:, ::-1]),
        "watts of a steradian": relative(found, image * 4.0 * math.pi),
        "radiance for irradiance": relative(found, image * math.pi),
        "half": relative(found, image / 2.0),
        "black": relative(found, image * 0.0),
    }
    if lamp != "SPOT":  # whose light falls on grey alone
        wrong["red for blue"] = relative(found, image[..., ::-1])
    record_property(f"relative_blender_gi_{lamp.lower()}", error)
    print(f"gi, {lamp}: {error:.3f}", {name: round(error, 3) for name, error in wrong.items()}, found.notes)
    assert error < GI_BOUND[lamp] < min(wrong.values())


def test_do_is_that_of_cycles(program: str, record_property: Record) -> None:
    scene = room()
    turn = sky(scene)
    found = addon.render_effect(scene, "do", network=MODELS / "do", radius=6.0, samples=128, program=program)
    error, flipped = relative(found), relative(found, found.learned[::-1])
    turn.inputs["Angle"].default_value = math.pi
    other = addon.render_effect(scene, "do", network=MODELS / "do", radius=6.0, samples=4, program=program)
    turned = relative(found, other.learned)
    record_property("relative_blender_do", error)
    print(f"do: {error:.3f}; sky turned {turned:.3f}, flipped {flipped:.3f}", found.figures, found.notes)
    assert error < DO_BOUND < min(turned, flipped)


# What is left behind


def failing(folder: Path) -> str:
    """A program that fails and says why."""
    path = folder / "deepshade"
    path.write_text("#!/bin/sh\necho out of luck >&2\nexit 2\n")
    path.chmod(0o755)
    return str(path)


def arranged() -> bpy.types.Scene:
    """The room with settings unlike those that passes need, and two view layers."""
    scene = room()
    sky(scene)
    scene.view_layers.new("other").use_pass_mist = True
    scene.render.filepath = "//elsewhere"
    scene.render.use_border = True
    scene.render.image_settings.file_format = "JPEG"
    scene.cycles.samples = 7
    scene.camera.data.dof.use_dof = True
    bpy.context.view_layer.update()
    return scene


@pytest.mark.parametrize("effect", list(addon.EFFECTS))
def test_the_scene_is_as_it_was_after_a_failure(effect: str, tmp_path: Path) -> None:
    scene = arranged()
    before = state(scene)
    with pytest.raises(addon.AddonError, match="out of luck"):
        addon.render_effect(
            scene, effect, network=MODELS / effect, radius=1.0, samples=1, program=failing(tmp_path)
        )
    assert state(scene) == before


def test_the_scene_is_as_it_was_after_success_and_interruption(program: str) -> None:
    scene = arranged()
    before = state(scene)
    render = {"network": MODELS / "do", "radius": 1.0, "samples": 1, "program": program}
    addon.render_effect(scene, "do", **render)
    assert state(scene) == before

    def interrupt(share: float, text: str) -> None:
        if share >= 0.7:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        addon.render_effect(scene, "do", report=interrupt, **render)
    assert state(scene) == before


def test_a_change_of_the_scene_would_be_seen() -> None:
    scene = arranged()
    before = state(scene)
    for owner, name, value in (
        (scene.render, "filepath", "//frame"),
        (scene.view_layers["other"], "use_pass_z", not scene.view_layers["other"].use_pass_z),
        (scene.cycles, "samples", 8),
        (bpy.data.objects["lamp"], "hide_render", True),
        (scene.world.light_settings, "distance", 3.0),
    ):
        kept = getattr(owner, name)
        setattr(owner, name, value)
        assert state(scene) != before, name
        setattr(owner, name, kept)
    assert state(scene) == before


# Errors say what to do


def engine(scene: bpy.types.Scene) -> None:
    scene.render.engine = "BLENDER_WORKBENCH"


def no_camera(scene: bpy.types.Scene) -> None:
    scene.camera = None


def orthographic(scene: bpy.types.Scene) -> None:
    scene.camera.data.type = "ORTHO"


def panoramic(scene: bpy.types.Scene) -> None:
    scene.camera.data.type = "PANO"


def oblong(scene: bpy.types.Scene) -> None:
    scene.render.pixel_aspect_x = 2.0


def away(scene: bpy.types.Scene) -> None:
    scene.camera.rotation_euler = (math.pi, 0.0, 0.0)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (engine, "Set it to Cycles"),
        (no_camera, "Add one"),
        (orthographic, "orthographic"),
        (panoramic, "panoramic"),
        (oblong, "Set both aspects to 1"),
        (away, "Turn it to the scene"),
    ],
)
def test_scenes_that_cannot_be_compared_are_refused(
    change: Callable[[bpy.types.Scene], None], said: str, tmp_path: Path
) -> None:
    scene = room()
    change(scene)
    with pytest.raises(addon.AddonError, match=said):
        addon.render_effect(
            scene, "ao", network=MODELS / "ao", radius=1.0, samples=1, program=failing(tmp_path)
        )


@pytest.mark.parametrize("effect", ["gi", "do"])
def test_light_that_is_not_there_is_missed(effect: str, tmp_path: Path) -> None:
    scene = room(lamp="")
    with pytest.raises(addon.AddonError, match="Add a lamp"):
        addon.render_effect(
            scene,
            effect,
            network=MODELS / f"{effect}-paper",
            radius=1.0,
            samples=1,
            program=failing(tmp_path),
        )


def test_light_of_the_world_alone_has_no_estimate_of_gi(tmp_path: Path) -> None:
    scene = room(lamp="")
    sky(scene)
    with pytest.raises(addon.AddonError, match="lamps alone"):
        addon.render_effect(
            scene, "gi", network=MODELS / "gi", radius=1.0, samples=1, program=failing(tmp_path)
        )


def test_a_shifted_lens_has_no_estimate(tmp_path: Path) -> None:
    scene = room()
    scene.camera.data.shift_x = 0.1
    with pytest.raises(addon.AddonError, match="Set shift to 0"):
        addon.render_effect(
            scene, "gi", network=MODELS / "gi", radius=1.0, samples=1, program=failing(tmp_path)
        )


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"effect": "sss"}, "Choose ao, gi, do"),
        ({"radius": 0.0}, "more than 0"),
        ({"radius": math.nan}, "more than 0"),
        ({"network": MODELS / "gi"}, "Choose one for ao"),
        ({"network": MODELS}, "holds no network"),
        ({"program": "/nowhere/deepshade"}, "cargo build --release"),
        ({"view_layer": "nowhere"}, "no view layer nowhere"),
    ],
)
def test_what_is_asked_for_has_to_be_there(changed: dict, said: str, tmp_path: Path) -> None:
    asked = {"effect": "ao", "network": MODELS / "ao", "radius": 1.0, "program": failing(tmp_path)} | changed
    with pytest.raises(addon.AddonError, match=said):
        addon.render_effect(room(), **asked)


# Pictures


def test_the_slider_parts_the_network_from_cycles() -> None:
    learned, cycles = np.full((4, 10, 1), 0.25), np.full((4, 10, 1), 0.75)
    shown = addon.picture(learned, cycles, "SPLIT", 0.3)
    assert np.all(shown[:, :3] == 0.25)
    assert np.all(shown[:, 4:] == 0.75)
    assert addon.picture(learned, cycles, "SIDES", 0.0).shape == (4, 20, 3)
    assert np.all(addon.picture(learned, cycles, "DIFFERENCE", 0.0)[:, 20:] == 0.5)


def test_images_of_blender_begin_at_the_bottom_and_are_used_again() -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    rising = np.arange(12.0).reshape(4, 3, 1)
    one = addon.Comparison("ao", "ao", 1.0, rising, rising + 1.0, np.ones((4, 3), bool))
    image = addon.show(one, "SIDES", 0.5)
    assert tuple(image.size) == (6, 4)
    assert np.allclose(list(image.pixels[:4]), [9.0, 9.0, 9.0, 1.0])
    assert np.array_equal(addon.pixels_named("Cycles ao")[..., :1], rising + 1.0)
    again = addon.show_again("ao", "SPLIT", 1.0)
    assert again == image
    assert tuple(again.size) == (3, 4)
    assert np.array_equal(addon.pixels_named(image.name)[..., :1], rising)
    assert addon.show_again("gi", "SPLIT", 1.0) is None


# The interface


@pytest.fixture
def enabled(program: str, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """The add-on, as Blender enables it, with the program on PATH."""
    monkeypatch.setenv("PATH", f"{Path(program).parent}{os.pathsep}{os.environ['PATH']}")
    if Path(program).name != "deepshade":
        pytest.skip(f"the program is named {Path(program).name}")
    addon.register()
    yield
    addon.unregister()


def ended(job: addon.Job) -> addon.Job:
    until = time.monotonic() + 120.0
    while job.is_running():
        assert time.monotonic() < until
        time.sleep(0.05)
    return job


def test_a_second_blender_makes_the_same(
    enabled: None, program: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(addon, "models_folder", lambda stated, program: MODELS)
    scene = room()
    settings = scene.deepshade
    settings.network, settings.radius, settings.samples = "ao-small", RADIUS, 4
    before = state(scene)
    job = addon.start_job(scene, scene.view_layers[0].name, settings)
    folder = job.folder
    try:
        found = ended(job).result()
        assert job.progress() == (1.0, "done")
    finally:
        job.close()
    assert not folder.exists()
    assert state(scene) == before
    here = addon.render_effect(
        scene, "ao", network=MODELS / "ao-small", radius=RADIUS, samples=4, program=program
    )
    assert np.array_equal(found.learned, here.learned)
    assert np.array_equal(found.cycles, here.cycles)
    assert found.figures == here.figures
    assert "mean difference" in addon.summary(found)


def order(scene: bpy.types.Scene, folder: Path, **changed: object) -> addon.Order:
    file = str(folder / "scene.blend")
    bpy.ops.wm.save_as_mainfile(filepath=file, copy=True)
    asked = addon.Order(
        file, scene.name, scene.view_layers[0].name, "ao", str(MODELS / "ao"), RADIUS, 4, failing(folder)
    )
    return dataclasses.replace(asked, **changed)


def test_a_second_blender_says_why_it_failed(tmp_path: Path) -> None:
    job = addon.Job(order(room(), tmp_path), tmp_path / "job")
    with pytest.raises(addon.AddonError, match="out of luck"):
        ended(job).result()
    job.close()


def test_a_second_blender_that_breaks_is_shown(tmp_path: Path) -> None:
    job = addon.Job(order(room(), tmp_path, file="/nowhere/scene.blend"), tmp_path / "job")
    with pytest.raises(addon.AddonError, match="second Blender failed"):
        ended(job).result()
    job.close()


def test_a_cancelled_job_ends_with_all_that_it_started(tmp_path: Path) -> None:
    before = set(Path(tempfile.gettempdir()).glob("deepshade-*"))
    mark = tmp_path / "process"
    slow = tmp_path / "slow"
    slow.write_text(f"#!/bin/sh\necho $$ > {mark}.new && mv {mark}.new {mark}\nexec sleep 60\n")
    slow.chmod(0o755)
    job = addon.Job(order(room(), tmp_path, program=str(slow)), tmp_path / "job")
    until = time.monotonic() + 60.0
    while not mark.exists():
        assert time.monotonic() < until
        time.sleep(0.05)
    assert job.is_running()
    assert job.progress()[1].startswith("deepshade")
    job.close()
    assert not job.is_running()
    assert not (tmp_path / "job").exists()
    assert set(Path(tempfile.gettempdir()).glob("deepshade-*")) == before
    assert not is_alive(int(mark.read_text()))


def is_alive(process: int) -> bool:
    """Whether a process runs; one that has ended and waits for its parent does not."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rsplit(")", 1)[1].split()[0] != "Z"
    except OSError:
        return False


def test_the_menu_has_the_networks_of_the_effect(enabled: None, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(addon, "models_folder", lambda stated, program: MODELS)
    settings = room().deepshade
    for effect, first in (("ao", "ao"), ("gi", "gi"), ("do", "do")):
        settings.effect = effect
        names = [item[0] for item in addon.network_items(settings, None)]
        assert names[0] == first
        assert all(addon.Network.load(MODELS / name).effect == effect for name in names)


def test_the_folder_of_networks_is_found_above_the_program(tmp_path: Path) -> None:
    (tmp_path / "target").mkdir()
    program = failing(tmp_path / "target")
    with pytest.raises(addon.AddonError, match="State deepshade's folder"):
        addon.models_folder("", program)
    (tmp_path / "models").mkdir()
    assert addon.models_folder("", program) == (tmp_path / "models").resolve()
    with pytest.raises(addon.AddonError, match="no folder"):
        addon.models_folder(str(tmp_path / "nowhere"), program)
