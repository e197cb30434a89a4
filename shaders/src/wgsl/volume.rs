//! Light in participating media.

use super::{Shader, uniforms};

table! {
    /// The transmittance interval map.
    VOLUME_SHELL_INTERVALS: "volume-shell.intervals", file "methods/volume_shell/intervals",
        constants [SAMPLES = 16, MEDIUM = 2], uniforms [Intervals, FrameView, MediumRecord],
        shared ["surface_distance", "random", "bounded", "view", "medium_span", "medium", "transmittance", "intervals_encode_wide"];
    /// The same, with samples kept as in the paper.
    VOLUME_SHELL_PAPER_INTERVALS: "volume-shell.paper_intervals", file "methods/volume_shell/intervals",
        constants [SAMPLES = 16, MEDIUM = 2], uniforms [Intervals, FrameView, MediumRecord],
        shared ["surface_distance", "random", "bounded", "view", "medium_span", "medium", "transmittance", "intervals_encode_paper"];
    /// Light that surfels scatter into the intervals of rays, of a level.
    VOLUME_SHELL_SPLAT: "volume-shell.splat", file "methods/volume_shell/splat",
        constants [SAMPLES = 16, MEDIUM = 2, HEIGHT = 8, PARTS = 16, LOOKUPS = 4, GREY = 0,
                   ATTENUATED = 1, TOUCHED_ONLY = 1, SILHOUETTES = 1],
        uniforms [SplatLevel, SplatPart, VolumeShell, FrameView, MediumRecord],
        shared ["random", "bounded", "view", "packing", "interleaved", "surfel", "surfel_record", "surfel_tree",
                "surfel_walk", "surfel_facing", "surfel_sent", "medium_span", "medium", "colours", "phase", "transmittance",
                "intervals_decode", "intervals_decode_wide"];
    /// The same onto samples that are kept as in the paper.
    VOLUME_SHELL_PAPER_SPLAT: "volume-shell.paper_splat", file "methods/volume_shell/splat",
        constants [SAMPLES = 16, MEDIUM = 2, HEIGHT = 8, PARTS = 16, LOOKUPS = 4, GREY = 0,
                   ATTENUATED = 1, TOUCHED_ONLY = 1, SILHOUETTES = 1],
        uniforms [SplatLevel, SplatPart, VolumeShell, FrameView, MediumRecord],
        shared ["random", "bounded", "view", "packing", "interleaved", "surfel", "surfel_record", "surfel_tree",
                "surfel_walk", "surfel_facing", "surfel_sent", "medium_span", "medium", "colours", "phase", "transmittance",
                "intervals_decode", "intervals_decode_paper"];
    /// Light of the lamps that the intervals of rays scatter.
    VOLUME_SHELL_DIRECT: "volume-shell.direct", file "methods/volume_shell/direct",
        constants [SAMPLES = 16, MEDIUM = 2, LIGHTS = 1, GREY = 0], uniforms [VolumeShell, FrameView, MediumRecord, LightRecord],
        shared ["view", "lights", "shadow", "medium_span", "medium", "colours", "light_dimmed", "phase", "single_scattering", "transmittance",
                "intervals_decode", "intervals_decode_wide"];
    /// A coarser level of a Gaussian pyramid.
    VOLUME_SHELL_REDUCE: "volume-shell.reduce", file "methods/volume_shell/reduce", constants [], uniforms [Pyramid],
        shared [];
    /// A coarser level of a Gaussian pyramid in the size of a finer one.
    VOLUME_SHELL_EXPAND: "volume-shell.expand", file "methods/volume_shell/expand", constants [], uniforms [Pyramid],
        shared [];
    /// What froxels scatter of the lamps' light.
    FROXEL_SCATTER: "froxel.scatter", file "methods/froxel/scatter", constants [LIGHTS = 1, MEDIUM = 2, GREY = 0],
        uniforms [Froxels, FrameView, LightRecord, MediumRecord],
        shared ["bounded", "view", "lights", "shadow", "medium_span", "medium", "colours", "light_dimmed", "phase",
                "single_scattering", "froxel_index", "growing", "froxels"];
    /// Sums of columns of froxels.
    FROXEL_INTEGRATE: "froxel.integrate", file "methods/froxel/integrate", constants [],
        uniforms [Froxels, MediumRecord], shared ["bounded", "mean_decay", "froxel_index"];
    /// Fog in front of pixels, from froxels.
    FROXEL_APPLY: "froxel.apply", file "methods/froxel/apply", constants [MEDIUM = 2],
        uniforms [Froxels, FrameView, MediumRecord], shared ["surface_distance", "view", "medium_span", "froxel_index", "growing", "froxels"];
    /// Single scattering by steps along view rays.
    FOG_MARCH: "fog-march.march", file "methods/fog_march/march", constants [MEDIUM = 2, GREY = 0],
        uniforms [FogMarch, OfLamp, FrameView, LightRecord, MediumRecord],
        shared ["surface_distance", "random", "bounded", "view", "lights", "shadow", "medium_span", "medium", "colours", "light_dimmed", "phase",
                "single_scattering", "mean_decay", "fog_steps"];
    /// Where a lamp's epipolar slices leave the image.
    EPIPOLAR_LINES: "epipolar.lines", file "methods/epipolar/lines", constants [],
        uniforms [Epipolar, OfLamp, FrameView, LightRecord], shared ["view", "lamp_axis", "epipolar_lines"];
    /// From which to which light ray view rays are in the medium.
    EPIPOLAR_BOUNDS: "epipolar.bounds", file "methods/epipolar/bounds", constants [MEDIUM = 2],
        uniforms [Epipolar, OfLamp, FrameView, LightRecord, MediumRecord],
        shared ["surface_distance", "view", "lamp_axis", "medium_span", "growing", "epipolar_rays", "epipolar_view"];
    /// Where the light rays of slices end.
    EPIPOLAR_TRACE: "epipolar.trace", file "methods/epipolar/trace", constants [],
        uniforms [Epipolar, OfLamp, FrameView, LightRecord],
        shared ["view", "shadow", "lamp_axis", "epipolar_lines", "growing", "epipolar_rays"];
    /// Partial sums over light rays.
    EPIPOLAR_SUMS: "epipolar.sums", file "methods/epipolar/sums", constants [], uniforms [Epipolar], shared [];
    /// Fog in front of pixels, from partial sums.
    EPIPOLAR_GATHER: "epipolar.gather", file "methods/epipolar/gather", constants [MEDIUM = 2, GREY = 0],
        uniforms [Epipolar, OfLamp, FrameView, LightRecord, MediumRecord],
        shared ["surface_distance", "view", "lights", "lamp_axis", "medium_span", "medium", "colours", "light_dimmed", "phase", "epipolar_lines",
                "growing", "epipolar_rays", "epipolar_view"];
    /// Fog in front of pixels whose view rays cross few light rays.
    EPIPOLAR_MARCH: "epipolar.march", file "methods/epipolar/march", constants [MEDIUM = 2, GREY = 0],
        uniforms [Epipolar, OfLamp, FrameView, LightRecord, MediumRecord],
        shared ["surface_distance", "random", "bounded", "view", "lights", "shadow", "lamp_axis", "medium_span", "medium", "colours", "light_dimmed",
                "phase", "single_scattering", "mean_decay", "fog_steps", "epipolar_lines", "growing", "epipolar_rays", "epipolar_view"];
    /// The sum of all levels.
    VOLUME_SHELL_ADD: "volume-shell.add", file "methods/volume_shell/add", constants [], uniforms [LevelSum],
        shared [];
}
