//! Alias-free soft shadows: each pixel's own triangles against many points of the light, a bit a point [Sintorn, Eisemann,
//! Assarsson 2008, in spirit].
//!
//! Nothing is listed: a tile of pixels goes over the clusters of triangles that may stand between it and the light, so
//! there is no list that could be too long. Which clusters and triangles these are is decided by the convex hull of the
//! tile's surface points and the light, so no caster is missed, whether or not the light's centre sees it.

use crate::input::casters::BatchLayout;
use crate::input::frame::FrameUniform;
use crate::passes::triangles::light_triangles::{LightTriangles, Reach};
use crate::gpu::recorder::{Recorder, Work, dispatch};
use crate::gpu::resources::{UniformArray, buffer_of, storage_buffer, uniform};
use crate::gpu::shader::{HostStruct, ShaderKey};
use crate::technique::{TechniqueAbout, TechniqueFactory, InnerContent, InnerPicture, Memory, Technique};
use crate::error::Error;
use crate::input::frame::Frame;
use crate::gpu::device::Gpu;
use crate::{bindings, gpu_struct};
use crate::technique::settings::Kind;
use glam::{DVec2, Vec2, Vec4};
use lattice::{Lattice, MOST_POINTS, MOST_ROWS};
use rounds::{Between, Rounds};

pub(crate) mod lattice;
mod rounds;

crate::choices! {
    /// Whether all pixels look at the same points.
    pub enum Points {
        /// All do: penumbrae without grain, in as many steps as there are points.
        Same = "same",
        /// Each moves and mirrors them in its own way: grain instead of steps.
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
        /// What a metre along x and one along y add to the lattice's coordinates.
        coordinates: Vec4,
    }
}

gpu_struct! {
    /// Which part of the triangles is looked at, and how.
    pub(crate) struct TriangleLook {
        part: u32,
        parts: u32,
        /// Whether a look at it went before, which a tile may have left before its end.
        look: u32,
        /// After so many rounds of its loops a tile stops.
        rounds: u32,
        /// Places of the lattice among which pixels choose.
        placements: u32,
    }
}

/// Places of the lattice that pixels take where each has its own.
const PLACEMENTS: u32 = 16;

/// Triangles that are gathered at once, and looked at before others are.
const MOST_TRIANGLES: u32 = 1 << 15;

/// The narrowest light that has points, as a part of the distance to the nearest surface: a penumbra far below a pixel.
const LEAST_LIGHT: f32 = 1e-4;

/// Shadow of a rectangular light by points of it.
pub struct AliasFreeSoft {
    settings: AliasFreeSoftSettings,
    lattice: Lattice,
    uniform: wgpu::Buffer,
    placements: wgpu::Buffer,
    rows: wgpu::Buffer,
    triangles: Option<LightTriangles>,
    /// What lies between several looks.
    between: Option<Between>,
    looks: Option<UniformArray<TriangleLook>>,
    is_looked_at: bool,
    effort: Option<Effort>,
}

/// What each pixel has taken and found; kept only while people look at it.
struct Effort {
    size: [u32; 2],
    /// Triangles that were taken from the light's points, and points that are hidden: two floats a pixel.
    numbers: wgpu::Buffer,
}

impl Effort {
    /// Room in `slot` if `wanted`; none if not.
    fn ensure<'a>(slot: &'a mut Option<Effort>, gpu: &Gpu, size: [u32; 2], wanted: bool) -> Option<&'a Effort> {
        if !wanted {
            *slot = None;
        } else if slot.as_ref().is_none_or(|e| e.size != size) {
            let bytes = u64::from(size[0]) * u64::from(size[1]) * 8;
            *slot = Some(Effort { size, numbers: storage_buffer(gpu, "triangles of pixels", bytes) });
        }
        slot.as_ref()
    }

    fn inner_picture(&self) -> InnerPicture {
        let numbers = self.numbers.clone();
        InnerPicture {
            name: "triangles and hidden points",
            help: "how many triangles each pixel has taken from the light's points; how many of the points are hidden",
            content: InnerContent::Numbers { numbers, stride: 2, channels: 2, size: self.size, list: None },
        }
    }
}

impl TechniqueFactory for AliasFreeSoft {
    type Settings = AliasFreeSoftSettings;
    const ABOUT: TechniqueAbout = TechniqueAbout {
        name: "alias-free-soft",
        title: "Alias-free soft shadows",
        source: "after Sintorn 2008",
        summary: "triangles against points of the light from every pixel, without a map: next to ray-traced",
    };

    fn make(gpu: &Gpu, settings: AliasFreeSoftSettings) -> Result<Self, Error> {
        let count = settings.samples;
        let lattice = Lattice::new(count);
        let places = if settings.points == Points::Moved { PLACEMENTS } else { 1 };
        let (mut placements, mut rows) = (Vec::new(), Vec::<u32>::new());
        for k in 0..places {
            let placed = lattice.placed(place_of(k, count));
            let center = lattice.basis.inverse() * (DVec2::splat(0.5) - placed.origin);
            placements.push(Vec4::new(center.x as f32, center.y as f32, placed.rows.len() as f32, 0.0));
            rows.extend(placed.rows.iter().copied().chain(std::iter::repeat(0)).take(MOST_ROWS));
        }
        let storage = wgpu::BufferUsages::STORAGE;
        Ok(AliasFreeSoft {
            uniform: uniform(gpu, "light lattice", &LatticeUniform { coordinates: Vec4::ZERO }),
            placements: buffer_of(gpu, "places of the lattice", bytemuck::cast_slice(&placements), storage),
            rows: buffer_of(gpu, "rows of points", bytemuck::cast_slice(&rows), storage),
            lattice,
            settings,
            triangles: None,
            between: None,
            looks: None,
            is_looked_at: false,
            effort: None,
        })
    }
}

/// How the `k`-th lattice is moved: evenly over a cell of its period [Roberts 2018, "R2"].
fn place_of(k: u32, points: u32) -> DVec2 {
    let step = DVec2::new(0.754_877_666_246_692_7, 0.569_840_290_998_053_3);
    (step * f64::from(k) + 0.5 / f64::from(points)).fract()
}

impl AliasFreeSoft {
    /// Lattice coordinates of metres on this light.
    fn lattice_uniform(&self, frame: &Frame) -> LatticeUniform {
        let least = LEAST_LIGHT * frame.frustum.receivers[0];
        let size = frame.light.size.max(Vec2::splat(least)).as_dvec2();
        let inverse = self.lattice.basis.inverse();
        let (x, y) = ((inverse.x_axis / size.x).as_vec2(), (inverse.y_axis / size.y).as_vec2());
        LatticeUniform { coordinates: Vec4::new(x.x, x.y, y.x, y.y) }
    }
}

impl Technique for AliasFreeSoft {
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error> {
        let gpu = recorder.gpu;
        let parts = LightTriangles::parts(&frame.casters, MOST_TRIANGLES);
        if self.triangles.as_ref().is_none_or(|t| t.capacity() != LightTriangles::capacity_for(&parts)) {
            self.triangles = None; // Frees the old ones before the new ones are made.
            self.triangles = Some(LightTriangles::new(gpu, &parts, Reach::Light));
        }
        let triangles = self.triangles.as_ref().expect("just made");
        gpu.queue.write_buffer(&self.uniform, 0, &self.lattice_uniform(frame).uniform_bytes());
        let placements = if self.settings.points == Points::Moved { PLACEMENTS } else { 1 };
        let (count, samples) = (parts.len() as u32, self.settings.samples);
        let looks: Vec<TriangleLook> = (0..count)
            .zip(&parts)
            .flat_map(|(part, triangles)| {
                let Rounds { most, looks } = Rounds::of(gpu, triangles, samples);
                (0..looks).map(move |look| TriangleLook { part, parts: count, look, rounds: most, placements })
            })
            .collect();
        let uniforms = UniformArray::ensure(&mut self.looks, gpu, "looks", &looks);
        let between = Between::ensure(&mut self.between, gpu, frame.size, &looks);
        let effort = Effort::ensure(&mut self.effort, gpu, frame.size, self.is_looked_at);
        if let Some(effort) = effort {
            recorder.encoder.clear_buffer(&effort.numbers, 0, None);
        }
        for (i, look) in looks.iter().enumerate() {
            let part = &parts[look.part as usize];
            if look.look == 0 {
                triangles.record(recorder, frame, part)?;
            }
            let batch = part.masked.map(|index| &frame.casters.batches[index]);
            let key = ShaderKey::new("techniques::alias_free::soft::soften")
                .feature("masked", batch.is_some())
                .feature("parts", between.is_some())
                .feature("looked_at", effort.is_some());
            let soften = gpu.compute_pipeline(&key, "soften")?;
            let soft = uniforms.at(i as u32);
            let mut set = frame.bindings(bindings! {
                lattice: &self.uniform,
                placements: &self.placements,
                lattice_points: &self.rows,
                triangles: &triangles.texels,
                clusters: &triangles.clusters,
                cluster_length: &triangles.cluster_length.0,
                soft: &soft,
            });
            if let Some(effort) = effort {
                set.extend_from_slice(bindings! { effort: &effort.numbers });
            }
            let mut work = Work::Groups([frame.size[0].div_ceil(8), frame.size[1].div_ceil(8), 1]);
            if let Some(between) = between {
                let next = between.next_look(recorder, look.look);
                set.extend_from_slice(bindings! {
                    masks: &between.masks,
                    stopped_at: &between.stopped_at,
                    next_look: next,
                });
                if look.look > 0 {
                    work = between.work(look.look);
                }
            }
            recorder.compute_pass("visibility", |gpu, pass| {
                pass.set_pipeline(&soften.pipeline);
                pass.set_bind_group(0, &soften.bind_group(gpu, 0, &set), &[]);
                if let Some(batch) = batch {
                    pass.set_bind_group(1, &soften.bind_group(gpu, 1, &batch.bindings(&frame.casters)), &[]);
                }
                dispatch(pass, &soften, work);
            });
        }
        Ok(())
    }

    fn look_inside(&mut self, looked_at: bool) {
        self.is_looked_at = looked_at;
    }

    fn inner_pictures(&self) -> Vec<InnerPicture> {
        let placed = self.lattice.placed(place_of(0, self.settings.samples)).points(&self.lattice);
        let points: Vec<Vec2> = placed.iter().map(|p| (*p - 0.5).as_vec2()).collect();
        let help = "points of the light that triangles are taken from; with `points=moved` those of one pixel in 64";
        let points = InnerPicture { help, ..InnerPicture::of_light_points(&points) };
        [points].into_iter().chain(self.effort.iter().map(Effort::inner_picture)).collect()
    }

    fn memory(&self) -> Vec<Memory> {
        let kept =
            self.between.as_ref().map_or(0, Between::bytes) + self.effort.as_ref().map_or(0, |e| e.numbers.size());
        let own = Memory::new("visibility", kept + self.rows.size() + self.placements.size());
        self.triangles.iter().map(LightTriangles::memory).chain([own]).collect()
    }
}
