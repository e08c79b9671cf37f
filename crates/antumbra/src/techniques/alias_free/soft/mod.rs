//! Erik Sintorn, Elmar Eisemann, Ulf Assarsson, 2008: Sample based visibility for soft shadows using alias-free shadow
//! maps, <https://doi.org/10.1111/j.1467-8659.2008.01267.x>, in spirit.
//!
//! Each pixel tests its own triangles against many points of the light, one bit per point. Nothing is listed: a tile of
//! pixels loops over the clusters of triangles that may lie between it and the light, so no list can overflow. The
//! clusters and triangles are those in the convex hull of the tile's surface points and the light, so no caster is
//! missed, whether or not the light's centre sees it.

use crate::error::Error;
use crate::gpu::debug_view::DebugLayout;
use crate::gpu::device::Gpu;
use crate::gpu::recorder::{Recorder, Work};
use crate::gpu::resources::{BufferDescription, buffer_of};
use crate::gpu::shader::ShaderKey;
use crate::input::frame::BoundFrame;
use crate::passes::triangles::light_triangles::{AreaTriangles, Part};
use crate::technique::settings::Kind;
use crate::technique::{Description, Technique, TechniqueFactory};
use crate::{bindings, gpu_struct};
use glam::{DVec2, Vec2, Vec4};
use lattice::{Lattice, MOST_POINTS, MOST_ROWS};
use rounds::{ResumeState, Rounds};

pub(crate) mod lattice;
mod rounds;
#[cfg(test)]
mod twin;

crate::choices! {
    /// Points of the light per pixel.
    pub enum Points {
        /// The same for all pixels: penumbrae without grain, in as many steps as there are points.
        Same = "same",
        /// Moved and mirrored from pixel to pixel: grain instead of steps.
        Moved = "moved",
    }
}

crate::settings! {
    /// Settings of [`AliasFreeSoft`].
    pub struct AliasFreeSoftSettings {
        /// Points of the light.
        samples: u32 = 400, Kind::Integer { min: 2, max: MOST_POINTS };
        /// The same points for all pixels, or moved and mirrored from pixel to pixel.
        points: Points = Points::Same, Kind::Choice { options: Points::OPTIONS };
    }
}

gpu_struct! {
    /// From metres on the light to the lattice of its points; see `shaders/light_lattice.wesl`.
    pub(crate) struct LatticeUniform {
        /// Lattice coordinates of a metre along x and of one along y.
        coordinates: Vec4,
    }
}

gpu_struct! {
    /// A dispatch over a part of the triangles.
    pub(crate) struct TrianglePass {
        part: u32,
        parts: u32,
        /// Number of dispatches over this part before, which a tile may have left before its end.
        pass_index: u32,
        /// A tile stops after this many rounds of its loops.
        rounds: u32,
        /// Positions of the lattice among which pixels choose.
        placements: u32,
    }
}

/// Positions of the lattice for `points=moved`.
const PLACEMENTS: u32 = 16;

/// Triangles that are gathered and tested before others are.
const MOST_TRIANGLES: u32 = 1 << 15;

/// The narrowest light that has points, as a fraction of the distance to the nearest surface: a penumbra far below a
/// pixel.
const LEAST_LIGHT: f32 = 1e-4;

/// Shadow of a rectangular light by points on it.
pub struct AliasFreeSoft {
    settings: AliasFreeSoftSettings,
    lattice: Lattice,
    placements: wgpu::Buffer,
    rows: wgpu::Buffer,
}

impl TechniqueFactory for AliasFreeSoft {
    type Settings = AliasFreeSoftSettings;
    type Technique = AliasFreeSoft;
    const DESCRIPTION: Description = Description {
        name: "alias-free-soft",
        title: "Alias-free soft shadows",
        source: "after Sintorn 2008",
        summary: "triangles against points of the light from every pixel, without a map: next to ray-traced",
    };

    fn make(gpu: &Gpu, settings: AliasFreeSoftSettings) -> Result<AliasFreeSoft, Error> {
        let count = settings.samples;
        let lattice = Lattice::new(count);
        let (mut placements, mut rows) = (Vec::new(), Vec::<u32>::new());
        for k in 0..placement_count(&settings) {
            let placed = lattice.placed(place_of(k, count));
            let center = lattice.basis.inverse() * (DVec2::splat(0.5) - placed.origin);
            placements.push(Vec4::new(center.x as f32, center.y as f32, placed.rows.len() as f32, 0.0));
            rows.extend(placed.rows.iter().copied().chain(std::iter::repeat(0)).take(MOST_ROWS));
        }
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(AliasFreeSoft {
            placements: buffer_of(gpu, "placements of the lattice", bytemuck::cast_slice(&placements), storage),
            rows: buffer_of(gpu, "rows of points", bytemuck::cast_slice(&rows), storage),
            lattice,
            settings,
        })
    }
}

fn placement_count(settings: &AliasFreeSoftSettings) -> u32 {
    if settings.points == Points::Moved { PLACEMENTS } else { 1 }
}

/// The offset of the `k`-th lattice, evenly over a cell of its period [Roberts 2018, "R2"].
fn place_of(k: u32, points: u32) -> DVec2 {
    let step = DVec2::new(0.754_877_666_246_692_7, 0.569_840_290_998_053_3);
    (step * f64::from(k) + 0.5 / f64::from(points)).fract()
}

impl AliasFreeSoft {
    /// Lattice coordinates of metres on this light.
    fn lattice_uniform(&self, frame: &BoundFrame) -> LatticeUniform {
        let least = LEAST_LIGHT * frame.frustum.receivers[0];
        let size = frame.light.size.max(Vec2::splat(least)).as_dvec2();
        let inverse = self.lattice.basis.inverse();
        let (x, y) = ((inverse.x_axis / size.x).as_vec2(), (inverse.y_axis / size.y).as_vec2());
        LatticeUniform { coordinates: Vec4::new(x.x, x.y, y.x, y.y) }
    }

    /// The dispatches over all parts, in order.
    fn passes(&self, gpu: &Gpu, parts: &[Part]) -> Vec<TrianglePass> {
        let (count, placements) = (parts.len() as u32, placement_count(&self.settings));
        let of_part = |(part, triangles): (u32, &Part)| {
            let Rounds { most: rounds, passes } = Rounds::of(gpu, triangles, self.settings.samples);
            (0..passes).map(move |pass_index| TrianglePass { part, parts: count, pass_index, rounds, placements })
        };
        (0..count).zip(parts).flat_map(of_part).collect()
    }

    /// The points of the first placement, for debug views.
    fn debug_points(&self, recorder: &mut Recorder) {
        if recorder.captures_debug() {
            let placed = self.lattice.placed(place_of(0, self.settings.samples)).points(&self.lattice);
            let points: Vec<Vec2> = placed.iter().map(|p| (*p - 0.5).as_vec2()).collect();
            recorder.debug_points("light samples", &points);
        }
    }
}

/// Triangles that each pixel tested and points that are hidden, two floats per pixel, if debug views are captured.
fn effort(recorder: &mut Recorder, size: [u32; 2]) -> Option<wgpu::Buffer> {
    let help = "number of triangles that each pixel tested against the light's points; number of hidden points";
    let layout = DebugLayout::Numbers { stride: 2, channels: 2, size, list: None };
    let numbers = BufferDescription::new(u64::from(size[0]) * u64::from(size[1]) * 8).cleared().debug(help, layout);
    recorder.captures_debug().then(|| recorder.buffer("triangles and hidden points", numbers))
}

impl Technique for AliasFreeSoft {
    fn record(&mut self, frame: &BoundFrame, recorder: &mut Recorder) -> Result<(), Error> {
        let gpu = recorder.gpu;
        let parts = Part::of(&frame.casters, MOST_TRIANGLES);
        let passes = self.passes(gpu, &parts);
        let uniforms = recorder.uniforms("triangle passes", passes.iter().copied());
        let lattice = recorder.uniform("light lattice", &self.lattice_uniform(frame));
        let state = ResumeState::new(recorder, frame.size, &passes);
        let effort = effort(recorder, frame.size);
        self.debug_points(recorder);
        let triangles = AreaTriangles::new(recorder, &parts);
        let mut length = None;
        for (i, pass) in passes.iter().enumerate() {
            let part = &parts[pass.part as usize];
            if pass.pass_index == 0 {
                length = Some(triangles.record(recorder, frame, part)?);
            }
            let length = length.as_ref().expect("a part begins with its triangles");
            let batch = part.masked.map(|index| frame.casters.batches[index].bindings(&frame.casters));
            let key = ShaderKey::new("techniques::alias_free::soft::soften")
                .feature("masked", batch.is_some())
                .feature("parts", state.is_some())
                .feature("captured", effort.is_some());
            let soften = gpu.compute_pipeline(&key, "soften")?;
            let uniform = uniforms.at(i as u32);
            let own = bindings! {
                lattice: &lattice,
                placements: &self.placements,
                lattice_points: &self.rows,
                triangles: &triangles.texels,
                light_clusters: &triangles.clusters,
                cluster_length: &length.0,
                soft: &uniform,
            };
            let captured = effort.as_ref().map(|numbers| crate::binding_array! { effort: numbers });
            let resumed = state.as_ref().map(|state| state.bindings(recorder, pass.pass_index));
            let sets = [
                &frame.bindings()[..],
                own,
                captured.as_ref().map_or(&[], |set| &set[..]),
                resumed.as_ref().map_or(&[], |set| &set[..]),
                batch.as_ref().map_or(&[], |set| &set[..]),
            ];
            let work = match &state {
                Some(state) if pass.pass_index > 0 => state.work(pass.pass_index),
                _ => Work::Groups([frame.size[0].div_ceil(8), frame.size[1].div_ceil(8), 1]),
            };
            recorder.compute("visibility", &soften, &sets, work)?;
        }
        Ok(())
    }
}
