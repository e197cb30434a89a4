"""What networks read, by closed forms; `test_program` holds it against the program."""

from __future__ import annotations

from dataclasses import replace

import pytest
import torch
from torch import Tensor

from deepshade.inputs import exposure, network_input
from deepshade.made import focal_length, made
from specs import IMAGE, LIGHT, MONO


def wall(height: int, width: int, depth: float, focal: float) -> dict[str, Tensor]:
    """A wall that faces the camera."""
    y, x = torch.meshgrid(torch.arange(height) + 0.5, torch.arange(width) + 0.5, indexing="ij")
    across, up = (x - width / 2) * depth / focal, (height / 2 - y) * depth / focal
    position = torch.stack([across, up, torch.full_like(x, -depth)])
    return {"position": position, "valid": torch.ones(1, height, width)}


def test_a_wall_tells_its_camera_and_has_no_relief() -> None:
    layers = wall(48, 40, 2.0, 64.0)
    assert focal_length(layers["position"], layers["valid"] > 0.5) == pytest.approx(64.0, rel=1e-5)
    layers["valid"][0, 5:9, 7] = 0.0
    found = made(["normal", "relief", "pixel-radius", "border"], layers, 0.25)
    # 0.25 m at 2 m, with a focal length of 64: 8 pixels, whose logarithm is 3.
    seen = layers["valid"][0] > 0.5
    assert found["relief"].abs().max() < 1e-5 and found["relief"].shape == (3, 48, 40)
    assert found["pixel_radius"][0][seen].tolist() == pytest.approx([0.375] * int(seen.sum()), abs=1e-4)
    border = found["border"][0]
    assert border[20, 3] == pytest.approx(3.5 / 8.0, abs=1e-4) and border[20, 20] == 1.0
    assert all(not values[:, ~seen].any() for values in found.values())


def test_a_step_has_the_relief_of_its_height() -> None:
    layers = wall(128, 128, 2.0, 80.0)
    layers["position"][2, :, 64:] = -3.0
    relief = made(["relief"], layers, 0.5)["relief"]
    # Left of the edge the mean over the coarsest squares is half a metre further away: a radius.
    assert relief[2, 64, 63] == pytest.approx(-0.5, abs=0.02)
    assert relief[0, 64, 20] == pytest.approx(0.0, abs=1e-6)


def test_lengths_are_in_radii_and_nothing_is_read_where_nothing_is_seen() -> None:
    layers = wall(4, 4, 2.0, 4.0) | {"normal": torch.full((3, 4, 4), 0.5)}
    layers["valid"][0, 0, 0] = 0.0
    layers["normal"][:, 0, 0] = torch.nan
    x, light = network_input(layers, 0.25, replace(IMAGE, reach=replace(IMAGE.reach, radius=2.0)))
    assert x.shape == (1, 6, 4, 4) and light == 1.0
    assert torch.equal(x[0, :3, 0, 1], torch.full((3,), 0.5)) and not x[0, :, 0, 0].any()
    torch.testing.assert_close(x[0, 3:, 2, 3], 8.0 * layers["position"][:, 2, 3])


def test_a_run_reads_its_own_colour_and_mean_free_paths_count_by_powers_of_two() -> None:
    layers = wall(4, 4, 2.0, 4.0)
    layers["mean_free_path"] = torch.tensor([0.01, 0.02, 0.03])[:, None, None].expand(3, 4, 4)
    layers["light"] = torch.tensor([0.25, 0.5, 0.125])[:, None, None].expand(3, 4, 4)
    x, light = network_input(layers, 1.0, MONO)
    assert x.shape == (3, 5, 4, 4) and light == 2.0
    torch.testing.assert_close(x[:, 3, 0, 0], torch.tensor([0.32, 0.64, 0.96]))
    torch.testing.assert_close(x[:, 4, 0, 0], torch.tensor([0.5, 1.0, 0.25]))


def test_a_faint_rest_does_not_make_a_lit_spot_too_bright() -> None:
    estimated = replace(LIGHT, effect="do", inputs=("estimate",))
    for rest, expected in ((0.0, 2.0), (0.125, 8.0), (1e-9, 128.0)):
        estimate = torch.full((3, 10, 100), rest)
        estimate[:, 0, 0] = 0.5
        assert exposure({"estimate": estimate}, estimated).item() == pytest.approx(expected)


def test_exposure_brings_what_is_bright_to_one() -> None:
    light = torch.cat([torch.arange(1.0, 1001.0), torch.tensor([torch.inf, torch.nan, -3.0, 0.0, 0.0])])
    layers = {"light": light.reshape(3, 5, 67)}
    assert exposure(layers, LIGHT).item() == pytest.approx(1.0 / 990.0)
    assert exposure({"light": torch.zeros(3, 2, 2)}, LIGHT) == 1.0
    bounced = replace(LIGHT, effect="gi")
    assert exposure(layers, bounced).item() == pytest.approx(8.0 / 990.0)


def test_filters_go_by_circles_movements_and_free_paths_in_pixels() -> None:
    layers = wall(4, 4, 2.0, 64.0)
    layers |= {"depth": torch.full((1, 4, 4), 2.0), "blurriness": torch.full((1, 4, 4), -16.0)}
    layers["motion"] = torch.stack([torch.full((4, 4), torch.pi / 2), torch.full((4, 4), 4.0)])
    layers["mean_free_path"] = torch.full((3, 4, 4), 0.25)
    layers["valid"][0, 0, 0] = 0.0
    found = made(["signed-circle", "movement", "free-path-pixels"], layers, 1.0)
    assert found["signed_circle"][0, 1, 1] == -1.0
    assert found["movement"][:, 1, 1].tolist() == pytest.approx([-0.5, 0.0], abs=1e-6)
    # 0.25 m at 2 m, with a focal length of 64: 8 pixels, whose logarithm is 3.
    assert found["free_path_pixels"][:, 1, 1].tolist() == pytest.approx([0.375] * 3, abs=1e-4)
    assert all(not values[:, 0, 0].any() for values in found.values())
