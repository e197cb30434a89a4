//! Light in participating media.

use super::Shader;

shaders! {
    table VOLUME;
    /// The transmittance interval map.
    VOLUME_SHELL_INTERVALS: "volume-shell.intervals", "methods/volume_shell/intervals_wide";
    /// The same, with samples kept as in the paper.
    VOLUME_SHELL_PAPER_INTERVALS: "volume-shell.paper_intervals", "methods/volume_shell/intervals_paper";
    /// Light that surfels scatter into the intervals of rays, of a level.
    VOLUME_SHELL_SPLAT: "volume-shell.splat", "methods/volume_shell/splat_wide";
    /// The same onto samples that are kept as in the paper.
    VOLUME_SHELL_PAPER_SPLAT: "volume-shell.paper_splat", "methods/volume_shell/splat_paper";
    /// Light of the lamps that the intervals of rays scatter.
    VOLUME_SHELL_DIRECT: "volume-shell.direct", "methods/volume_shell/direct";
    /// A coarser level of a Gaussian pyramid.
    VOLUME_SHELL_REDUCE: "volume-shell.reduce", "methods/volume_shell/reduce";
    /// A coarser level of a Gaussian pyramid in the size of a finer one.
    VOLUME_SHELL_EXPAND: "volume-shell.expand", "methods/volume_shell/expand";
    /// What froxels scatter of the lamps' light.
    FROXEL_SCATTER: "froxel.scatter", "methods/froxel/scatter";
    /// Sums of columns of froxels.
    FROXEL_INTEGRATE: "froxel.integrate", "methods/froxel/integrate";
    /// Fog in front of pixels, from froxels.
    FROXEL_APPLY: "froxel.apply", "methods/froxel/apply";
    /// Single scattering by steps along view rays.
    FOG_MARCH: "fog-march.march", "methods/fog_march/march";
    /// Where a lamp's epipolar slices leave the image.
    EPIPOLAR_LINES: "epipolar.lines", "methods/epipolar/lines";
    /// From which to which light ray view rays are in the medium.
    EPIPOLAR_BOUNDS: "epipolar.bounds", "methods/epipolar/bounds";
    /// Where the light rays of slices end.
    EPIPOLAR_TRACE: "epipolar.trace", "methods/epipolar/trace";
    /// Partial sums over light rays.
    EPIPOLAR_SUMS: "epipolar.sums", "methods/epipolar/sums";
    /// Fog in front of pixels, from partial sums.
    EPIPOLAR_GATHER: "epipolar.gather", "methods/epipolar/gather";
    /// Fog in front of pixels whose view rays cross few light rays.
    EPIPOLAR_MARCH: "epipolar.march", "methods/epipolar/march";
    /// The sum of all levels.
    VOLUME_SHELL_ADD: "volume-shell.add", "methods/volume_shell/add";
}
