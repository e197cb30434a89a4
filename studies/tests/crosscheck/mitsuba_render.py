"""Renders what `deepshade-studies crosscheck` exports with Mitsuba 3, so that its truth is checked by a renderer of others.

    python mitsuba_render.py FOLDER...

Each folder holds `scene.json` (a case; written by studies/src/crosscheck/export.rs) with the files that it names. The script
adds `mean.pfm` and `variance.pfm`: the mean of renderings with independent seeds, and the variance of that mean.

Effects that Mitsuba has are left to its own integrators (`path`, `volpath`); the others are written here once more
from their definitions (shaders/src/effect.rs), on Mitsuba's intersections, samplers and emitters.
"""

import json
import sys
from pathlib import Path

import drjit as dr
import mitsuba as mi

mi.set_variant("llvm_ad_rgb")

from mitsuba import ScalarTransform4f as Transform  # noqa: E402  (exists once a variant is set)


class Effect(mi.SamplingIntegrator):
    """An effect at the first surface that a camera ray meets."""

    def __init__(self, props):
        super().__init__(props)
        self.radius = props.get("radius", dr.inf)
        self.cosine = props.get("cosine", True)
        self.background = props.get("background", 0.0)
        self.glossy = props.get("glossy", False)

    def sample(self, scene, sampler, ray, medium=None, active=True):
        si = scene.ray_intersect(ray, active)
        seen = active & si.is_valid()
        value = self.at_surface(scene, sampler, si, -ray.d, seen)
        return dr.select(seen, value, mi.Spectrum(self.background)), mi.Bool(True), []

    def direction(self, sampler, si, to_viewer, active):
        """A direction around the shading normal with density cosine / pi, and whether it leaves the triangle."""
        geometric = dr.select(dr.dot(si.n, to_viewer) < 0, -si.n, si.n)
        smooth = si.sh_frame.n
        smooth = dr.select(dr.dot(smooth, geometric) < 0, -smooth, smooth)
        # A normal that looks away from the viewer is bent until it faces.
        least, cosine = 1e-3, dr.dot(smooth, to_viewer)
        bent = dr.normalize(smooth + to_viewer * (least - cosine))
        normal = dr.select(cosine < least, bent, smooth)
        square = sampler.next_2d(active)
        warp = mi.warp.square_to_cosine_hemisphere if self.cosine else mi.warp.square_to_uniform_hemisphere
        direction = mi.Frame3f(normal).to_world(warp(square))
        return direction, dr.dot(direction, geometric) > 0

    def direct(self, scene, sampler, si, active):
        """Light of the emitters that a surface reflects."""
        emitted, weight = scene.sample_emitter_direction(si, sampler.next_2d(active), True, active)
        active &= emitted.pdf > 0
        return weight * si.bsdf().eval(mi.BSDFContext(), si, si.to_local(emitted.d), active)

    def leaving(self, si, to_viewer, direction):
        """A ray within the radius. Mitsuba's own start nine times as far above a surface, which lets light into creases:
        0.07 % more in the ambient occlusion of the blobs."""
        geometric = dr.select(dr.dot(si.n, to_viewer) < 0, -si.n, si.n)
        ray = mi.Ray3f(si.p + geometric * (1e-5 * (1 + dr.max(dr.abs(si.p)))), direction)
        ray.maxt = self.radius
        return ray

    def open(self, scene, sampler, si, to_viewer, active):
        """A cosine-distributed direction, and whether nothing blocks it within the radius."""
        direction, above = self.direction(sampler, si, to_viewer, active)
        return direction, above & ~scene.ray_test(self.leaving(si, to_viewer, direction), active & above)


class AmbientOcclusion(Effect):
    def at_surface(self, scene, sampler, si, to_viewer, active):
        _, open = self.open(scene, sampler, si, to_viewer, active)
        return dr.select(open, mi.Spectrum(1), mi.Spectrum(0))


class DirectionalOcclusion(Effect):
    def at_surface(self, scene, sampler, si, to_viewer, active):
        direction, open = self.open(scene, sampler, si, to_viewer, active)
        return dr.select(open, environment(scene, direction, active), 0)


class ImageBasedLighting(Effect):
    """By the surfaces' own reflectance in a glossy scene, whose normals are the triangles'; else of diffuse surfaces."""

    def at_surface(self, scene, sampler, si, to_viewer, active):
        if self.glossy:
            random = sampler.next_1d(active), sampler.next_2d(active)
            sampled, weight = si.bsdf().sample(mi.BSDFContext(), si, *random, active)
            return dr.select(active, weight * environment(scene, si.to_world(sampled.wo), active), 0)
        direction, above = self.direction(sampler, si, to_viewer, active)
        reflected = si.bsdf().eval_diffuse_reflectance(si, active) * environment(scene, direction, active)
        return dr.select(above, reflected, 0)


class OneBounce(Effect):
    def at_surface(self, scene, sampler, si, to_viewer, active):
        direction, above = self.direction(sampler, si, to_viewer, active)
        bounce = scene.ray_intersect(self.leaving(si, to_viewer, direction), active & above)
        lit = active & above & bounce.is_valid()
        return dr.select(lit, self.direct(scene, sampler, bounce, lit), 0)


class GlossyBounce(Effect):
    """Where glossy surfaces have no diffuse base and meet matte ones alone."""

    def at_surface(self, scene, sampler, si, to_viewer, active):
        random = sampler.next_1d(active), sampler.next_2d(active)
        active &= mi.has_flag(si.bsdf().flags(), mi.BSDFFlags.GlossyReflection)
        sampled, weight = si.bsdf().sample(mi.BSDFContext(), si, *random, active)
        direction = si.to_world(sampled.wo)
        bounce = scene.ray_intersect(self.leaving(si, to_viewer, direction), active & (sampled.pdf > 0))
        lit = active & (sampled.pdf > 0) & bounce.is_valid()
        return dr.select(lit, weight * self.direct(scene, sampler, bounce, lit), 0)


class DirectTimesOcclusion(Effect):
    def at_surface(self, scene, sampler, si, to_viewer, active):
        _, open = self.open(scene, sampler, si, to_viewer, active)
        return dr.select(open, self.direct(scene, sampler, si, active), 0)


class FogIndirect(mi.SamplingIntegrator):
    """Light - surface - medium - eye in a homogeneous medium inside a box, whose transmittance is closed. The scene is
    loaded without the box, which would be in the light's way."""

    def __init__(self, props):
        super().__init__(props)
        self.scattering = mi.Color3f(props["scattering"])
        self.extinction = mi.Color3f(props["extinction"])
        self.box = mi.BoundingBox3f(props["low"], props["high"])
        self.g = props["anisotropy"]

    def inside(self, origin, direction, length):
        """Where a segment is inside of the box: distances from its start."""
        hit, near, far = self.box.ray_intersect(mi.Ray3f(origin, direction))
        near, far = dr.maximum(near, 0), dr.minimum(far, length)
        return dr.select(hit & (near < far), near, 0), dr.select(hit & (near < far), far, 0)

    def transmittance(self, origin, direction, length):
        near, far = self.inside(origin, direction, length)
        return dr.exp(-self.extinction * (far - near))

    def sample(self, scene, sampler, ray, medium=None, active=True):
        si = scene.ray_intersect(ray, active)
        near, far = self.inside(ray.o, ray.d, dr.select(si.is_valid(), si.t, dr.inf))
        depth = near + (far - near) * sampler.next_1d(active)
        vertex = ray.o + depth * ray.d
        # Uniform along the ray and over the sphere: plain, and its noise is known.
        weight = (far - near) * dr.exp(-self.extinction * (depth - near)) * self.scattering
        direction = mi.warp.square_to_uniform_sphere(sampler.next_2d(active))
        base = 1 + self.g * self.g - 2 * self.g * dr.dot(ray.d, direction)
        weight *= (1 - self.g * self.g) / (base * dr.sqrt(base))
        lit = active & (far > near)
        surface = scene.ray_intersect(mi.Ray3f(vertex, direction), lit)
        lit &= surface.is_valid()
        weight *= self.transmittance(vertex, direction, surface.t)
        emitted, light = scene.sample_emitter_direction(surface, sampler.next_2d(lit), True, lit)
        lit &= emitted.pdf > 0
        weight *= self.transmittance(surface.p, emitted.d, emitted.dist)
        light *= surface.bsdf().eval(mi.BSDFContext(), surface, surface.to_local(emitted.d), lit)
        return dr.select(lit, weight * light, 0), mi.Bool(True), []


class Coated(mi.BSDF):
    """A specular lobe with a diffuse base, each of which half of the directions are sampled from."""

    def __init__(self, props):
        super().__init__(props)
        self.diffuse, self.specular = mi.Color3f(props["diffuse"]), mi.Color3f(props["specular"])
        reflection = mi.BSDFFlags.DiffuseReflection | mi.BSDFFlags.GlossyReflection | mi.BSDFFlags.FrontSide
        self.m_components, self.m_flags = [reflection], reflection

    def eval(self, ctx, si, wo, active=True):
        above = active & (si.wi.z > 0) & (wo.z > 0)
        return dr.select(above, self.reflectance(si.wi, wo) * wo.z, 0)

    def pdf(self, ctx, si, wo, active=True):
        above = active & (si.wi.z > 0) & (wo.z > 0)
        return dr.select(above, 0.5 * (self.lobe_pdf(si.wi, wo) + wo.z * dr.inv_pi), 0)

    def eval_pdf(self, ctx, si, wo, active=True):
        return self.eval(ctx, si, wo, active), self.pdf(ctx, si, wo, active)

    def sample(self, ctx, si, sample1, sample2, active=True):
        sampled = dr.zeros(mi.BSDFSample3f)
        base = mi.warp.square_to_cosine_hemisphere(sample2)
        sampled.wo = dr.select(sample1 < 0.5, self.lobe_sample(si.wi, sample2), base)
        sampled.pdf = self.pdf(ctx, si, sampled.wo, active)
        sampled.eta = 1
        sampled.sampled_type = mi.UInt32(+mi.BSDFFlags.GlossyReflection)
        sampled.sampled_component = 0
        active &= sampled.pdf > 0
        return sampled, dr.select(active, self.eval(ctx, si, sampled.wo, active) / sampled.pdf, 0)

    def to_string(self):
        return type(self).__name__


class Microfacets(Coated):
    """GGX microfacets with Schlick's Fresnel over a diffuse base that gets what is let through, as defined in
    render/src/path/bsdf.rs; Mitsuba has neither as it is. Distribution and masking are Mitsuba's own."""

    # Mean of (1 - cos)^5 over the hemisphere, as the definition has it, a little below 1 / 21.
    MEAN_OF_FIFTH = 1 / 22

    def __init__(self, props):
        super().__init__(props)
        self.facets = mi.MicrofacetDistribution(mi.MicrofacetType.GGX, props["roughness"] ** 2, True)

    def fresnel(self, cosine):
        return self.specular + (1 - self.specular) * dr.clip(1 - cosine, 0, 1) ** 5

    def reflectance(self, wi, wo):
        half = dr.normalize(wi + wo)
        # Masking and shadowing together with the height: lambda is 1 / G1 - 1 (Heitz 2014).
        hidden = [dr.rcp(self.facets.smith_g1(v, half)) - 1 for v in (wi, wo)]
        lobe = self.facets.eval(half) / (1 + hidden[0] + hidden[1]) / (4 * wi.z * wo.z)
        through = (1 - self.fresnel(wi.z)) * (1 - self.fresnel(wo.z))
        mean = 1 - self.specular - (1 - self.specular) * self.MEAN_OF_FIFTH
        # A white mirror lets nothing through.
        base = self.diffuse * through / dr.maximum(mean, 1e-6) * dr.inv_pi
        return base + self.fresnel(dr.dot(wi, half)) * lobe

    def lobe_pdf(self, wi, wo):
        half = dr.normalize(wi + wo)
        return self.facets.pdf(wi, half) / (4 * dr.dot(wo, half))

    def lobe_sample(self, wi, square):
        facet, _ = self.facets.sample(wi, square)
        return 2 * dr.dot(wi, facet) * facet - wi


class Phong(Coated):
    """The energy-normalised Phong lobe beside Lambert's law, as defined in render/src/path/bsdf.rs; Mitsuba 3 has no
    Phong."""

    def __init__(self, props):
        super().__init__(props)
        self.exponent = 2 / max(props["roughness"] ** 2, 0.02) ** 2 - 2

    def power(self, wi, wo):
        cosine = dr.dot(mi.Vector3f(-wi.x, -wi.y, wi.z), wo)
        return dr.select(cosine > 0, dr.maximum(cosine, 1e-9) ** self.exponent, 0)

    def reflectance(self, wi, wo):
        lobe = (self.exponent + 2) / dr.two_pi * self.power(wi, wo)
        return self.diffuse * dr.inv_pi + self.specular * lobe

    def lobe_pdf(self, wi, wo):
        return (self.exponent + 1) / dr.two_pi * self.power(wi, wo)

    def lobe_sample(self, wi, square):
        cosine = square.y ** (1 / (self.exponent + 1))
        sine, (sin, cos) = dr.safe_sqrt(1 - cosine * cosine), dr.sincos(dr.two_pi * square.x)
        around = mi.Frame3f(mi.Vector3f(-wi.x, -wi.y, wi.z))
        return around.to_world(mi.Vector3f(sine * cos, sine * sin, cosine))


mi.register_bsdf("microfacets", Microfacets)
mi.register_bsdf("phong", Phong)

for name, integrator in {
    "ao": AmbientOcclusion,
    "do": DirectionalOcclusion,
    "ibl": ImageBasedLighting,
    "gi": OneBounce,
    "glossy": GlossyBounce,
    "multi": DirectTimesOcclusion,
    "fog-indirect": FogIndirect,
}.items():
    mi.register_integrator(name, integrator)


def environment(scene, direction, active):
    """Radiance from infinitely far away."""
    si = dr.zeros(mi.SurfaceInteraction3f, dr.width(direction))
    si.wi = -direction
    return scene.environment().eval(si, active)


def rgb(values):
    return {"type": "rgb", "value": values}


def vectors(plugin):
    """The description of a plugin of this file, its lists of three numbers as what a plugin gets."""
    return {
        name: mi.ScalarVector3f(value) if isinstance(value, list) else value for name, value in plugin.items()
    }


def sensor(case):
    camera = case["camera"]
    lens = camera["lens"]
    height, width = case["size"]
    sensor = {
        "type": "thinlens" if lens else "perspective",
        "fov_axis": "y",
        "fov": camera["fov_degrees"],
        "near_clip": camera["near"],
        "far_clip": camera["far"],
        # Mitsuba's camera looks along +z with x to the left: `look_at` has it so, the columns of ours would not do.
        "to_world": Transform().look_at(camera["origin"], camera["target"], camera["up"]),
        "film": {
            "type": "hdrfilm",
            "width": width,
            "height": height,
            "rfilter": {"type": "box"},
            "pixel_format": "rgb",
            "component_format": "float32",
        },
        "sampler": {"type": "independent"},
    }
    if lens:
        sensor |= {"aperture_radius": lens["radius"], "focus_distance": lens["focus"]}
    if camera["in_medium"]:
        sensor["medium"] = {"type": "ref", "id": "fog"}
    return sensor


def mesh(folder, exported):
    texture = exported["texture"]
    reflectance = rgb(exported["colour"])
    if texture:
        reflectance = {
            "type": "bitmap",
            "filename": str(folder / texture["file"]),
            "raw": True,
            "filter_type": texture["filter"],
            "wrap_mode": texture["wrap"],
        }
    bsdf = {"type": "diffuse", "reflectance": reflectance}
    if exported["glossy"]:
        bsdf = vectors(exported["glossy"])
    shape = {
        "type": "ply",
        "filename": str(folder / exported["file"]),
        "face_normals": exported["flat"],
        "bsdf": {"type": "twosided", "bsdf": bsdf},
    }
    if exported["emission"]:
        shape["emitter"] = {"type": "area", "radiance": rgb(exported["emission"])}
    return shape


def light(exported):
    kind = exported["type"]
    if kind == "point":
        return {"type": "point", "position": exported["position"], "intensity": rgb(exported["intensity"])}
    if kind == "directional":
        return {
            "type": "directional",
            "direction": exported["direction"],
            "irradiance": rgb(exported["irradiance"]),
        }
    target = [p + d for p, d in zip(exported["position"], exported["direction"])]
    return {
        "type": "spot",
        "to_world": Transform().look_at(exported["position"], target, exported["up"]),
        "intensity": rgb(exported["intensity"]),
        "cutoff_angle": exported["cutoff_degrees"],
        "beam_width": exported["beam_degrees"],
    }


def medium(folder, exported):
    """The medium, and the box that it fills."""
    low, high = exported["bounds"]
    size = [b - a for a, b in zip(low, high)]
    place = Transform().translate(low) @ Transform().scale(size)
    fog = {
        "type": "heterogeneous" if exported["grid"] else "homogeneous",
        "albedo": rgb(exported["albedo"]),
        "phase": {"type": "hg", "g": exported["anisotropy"]},
    }
    if exported["grid"]:
        # Extinction for each colour, in a grid over the unit cube.
        fog["sigma_t"] = {
            "type": "gridvolume",
            "filename": str(folder / exported["grid"]),
            "raw": True,
            "filter_type": "trilinear",
            "wrap_mode": "clamp",
            "to_world": place,
        }
        fog["albedo"] = {"type": "constvolume", "value": rgb(exported["albedo"])}
    else:
        # Colours are at most 1, so that the scale takes the rest.
        largest = max(exported["extinction"])
        fog["scale"] = largest
        fog["sigma_t"] = rgb([value / largest for value in exported["extinction"]])
    around = {
        "type": "cube",
        "to_world": place @ Transform().translate([0.5] * 3) @ Transform().scale([0.5] * 3),
        "bsdf": {"type": "null"},
        "interior": {"type": "ref", "id": "fog"},
    }
    return {"fog": fog, "fog_box": around}


def scene(folder, case):
    things = {"type": "scene"}
    if case["medium"]:
        things |= medium(folder, case["medium"])
    things["sensor"] = sensor(case)
    things |= {f"mesh_{i}": mesh(folder, exported) for i, exported in enumerate(case["meshes"])}
    things |= {f"light_{i}": light(exported) for i, exported in enumerate(case["lights"])}
    if case["environment"]:
        things["environment"] = {"type": "envmap", "filename": str(folder / case["environment"])}
    return mi.load_dict(things)


def renderings(scene, integrator, case):
    """Independent renderings of a case, one a seed."""
    integrator = mi.load_dict(vectors(integrator))
    seeds = range(case["first_seed"], case["first_seed"] + case["seeds"])
    images = [mi.render(scene, integrator=integrator, spp=case["samples_a_seed"], seed=seed) for seed in seeds]
    dr.eval(images)
    return images


def mean_and_variance(images):
    """The mean of independent images, and the variance of that mean."""
    mean = sum(images) / len(images)
    squares = sum((image - mean) ** 2 for image in images)
    return mean, squares / (len(images) * (len(images) - 1))


def render(folder):
    case = json.loads((folder / "scene.json").read_text())
    if case["integrator"]["type"] == "fog-indirect":
        case["medium"], case["camera"]["in_medium"] = None, False
    loaded = scene(folder, case)
    images = renderings(loaded, case["integrator"], case)
    if case["minus"]:
        # With the same random numbers, so that the paths of both cancel out.
        images = [more - less for more, less in zip(images, renderings(loaded, case["minus"], case))]
    mean, variance = mean_and_variance(images)
    for name, image in [("mean", mean), ("variance", variance)]:
        mi.Bitmap(mi.TensorXf(image)).write(str(folder / f"{name}.pfm"))


if __name__ == "__main__":
    mi.set_log_level(mi.LogLevel.Error)
    for argument in sys.argv[1:]:
        render(Path(argument))
        print(f"rendered {Path(argument).name}", file=sys.stderr, flush=True)
