//! What a technique is, and the one list of techniques.

use crate::settings::{Setting, Settings, SpecError, nearest, parse_values};
use crate::shader::Needs;
use crate::{Error, Frame, Gpu, recorder::Recorder, techniques::TECHNIQUES};
use serde_json::{Map, Value};
use std::pin::Pin;

/// Fills a frame's visibility. It may be made on one thread and recorded on another.
pub trait Technique: wgpu::WasmNotSend {
    /// Records all passes. Textures are made at the first call and again when sizes change.
    fn record(&mut self, frame: &Frame, recorder: &mut Recorder) -> Result<(), Error>;

    /// GPU memory that it owns, by the label of the pass that fills it.
    fn memory(&self) -> Vec<Memory>;

    /// Keeps from the next [`Technique::record`] on, or no longer, what only people look at: inner pictures that the
    /// visibility does not need, which cost time and memory.
    fn look_inside(&mut self, _looked_at: bool) {}

    /// What it holds on the way to the visibility, for looking at: maps, pyramids, lists of pixels. Nothing before the
    /// first [`Technique::record`].
    fn inner_pictures(&self) -> Vec<InnerPicture> {
        Vec::new()
    }

    /// What the last frame did, in figures that are neither time nor memory, such as the number of maps. Waits for the
    /// GPU: for tests and reports.
    fn figures<'a>(&'a self, _gpu: &'a Gpu) -> FiguresFuture<'a> {
        Box::pin(std::future::ready(Ok(Vec::new())))
    }
}

/// Names and values of [`Technique::figures`].
pub type FiguresFuture<'a> = Pin<Box<dyn Future<Output = Result<Vec<(&'static str, f64)>, Error>> + 'a>>;

/// GPU memory of one pass.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Memory {
    /// Label of the pass.
    pub pass: &'static str,
    /// Bytes.
    pub bytes: u64,
}

impl Memory {
    /// `bytes` that belong to `pass`.
    pub fn new(pass: &'static str, bytes: u64) -> Memory {
        Memory { pass, bytes }
    }
}

/// A texture or list that a technique works with, and how to look at it.
#[derive(Clone, Debug)]
pub struct InnerPicture {
    /// A few words for a menu; the label of the pass that fills it, where there is one.
    pub name: &'static str,
    /// What its values are, with their unit.
    pub help: &'static str,
    /// The values.
    pub content: InnerContent,
}

/// Where the values of an [`InnerPicture`] lie.
#[derive(Clone, Debug)]
pub enum InnerContent {
    /// Float, unsigned or depth texels, any layers and levels; needs `TEXTURE_BINDING`.
    Texture(wgpu::Texture),
    /// Points that the light is looked at from, in parts of its edges from its centre, each in [-1/2, 1/2]².
    LightPoints(Vec<glam::Vec2>),
    /// Pixels that were listed, as in `shaders/penumbra_list.wesl`.
    Pixels {
        /// The list; needs `STORAGE`.
        list: wgpu::Buffer,
        /// Size of the picture, pixels.
        size: [u32; 2],
    },
    /// Numbers in a buffer: those of a place one after the other.
    Numbers {
        /// Of all places; 32-bit floats; needs `STORAGE`.
        numbers: wgpu::Buffer,
        /// Numbers of a place.
        stride: u32,
        /// How many of these mean something, from the first on.
        channels: u32,
        /// Places along x and y.
        size: [u32; 2],
        /// Which places there are, in this order, as in `shaders/penumbra_list.wesl`; needs `STORAGE`. None: all, row by row.
        list: Option<wgpu::Buffer>,
    },
    /// A bit for each place of a square, as in `passes/silhouette`: rows of whole 32-bit words.
    Mask {
        /// The words; needs `STORAGE`.
        bits: wgpu::Buffer,
        /// Places a side.
        side: u32,
    },
    /// How long the list of each texel of a square map is.
    ListLengths {
        /// Where each list ends, as in `shaders/texel_lists.wesl`; needs `STORAGE`.
        ends: wgpu::Buffer,
        /// Texels a side.
        side: u32,
    },
}

impl InnerPicture {
    /// A texture of this name.
    pub fn of_texture(name: &'static str, help: &'static str, texture: &crate::resource::Texture) -> InnerPicture {
        InnerPicture { name, help, content: InnerContent::Texture(texture.texture.clone()) }
    }

    /// Points of the light, in parts of its edges from its centre.
    pub fn of_light_points(points: &[glam::Vec2]) -> InnerPicture {
        InnerPicture {
            name: "light samples",
            help: "points of the light that maps are drawn from, seen as the light's rectangle",
            content: InnerContent::LightPoints(points.to_vec()),
        }
    }
}

/// Makes a technique from its settings.
pub type MakeTechnique = fn(&Gpu, Value) -> Result<Box<dyn Technique>, Error>;

/// An entry of the list of techniques.
#[derive(Clone, Copy)]
pub struct TechniqueInfo {
    /// Name on the command line.
    pub name: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// Where it comes from: authors, year, section.
    pub source: &'static str,
    /// One sentence: what it does and what it is good for.
    pub summary: &'static str,
    /// Its settings.
    pub settings: &'static [Setting],
    /// Its defaults where these settings are given: a preset among them changes others.
    pub defaults: fn(&Map<String, Value>) -> Value,
    /// The most that a shader of it takes of what devices give a limited number of.
    pub needs: Needs,
    /// Makes one from all its settings.
    pub make: MakeTechnique,
}

impl TechniqueInfo {
    /// Refuses an adapter that cannot run it as it comes, with the error that it would meet there, before anything is
    /// compiled.
    pub fn check(&self, gpu: &Gpu) -> Result<(), Error> {
        self.needs.check(self.name, &gpu.device.limits())?;
        let map = (self.defaults)(&Map::new())["map"].as_u64().and_then(|map| u32::try_from(map).ok());
        map.map_or(Ok(()), |map| gpu.check_size("shadow map", map, map))
    }
}

/// A technique with its settings, as on the command line: `name:key=value,key=value`.
#[derive(Clone)]
pub struct Spec {
    /// The technique.
    pub technique: &'static TechniqueInfo,
    /// All settings, defaults filled in.
    pub settings: Value,
    /// As it was given.
    pub text: String,
}

impl std::str::FromStr for Spec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Spec, SpecError> {
        let (name, values) = text.split_once(':').unwrap_or((text, ""));
        let technique = find(name)?;
        let given = parse_values(technique.name, technique.settings, values)?;
        let mut settings = (technique.defaults)(&given);
        settings.as_object_mut().unwrap_or(&mut Map::new()).extend(given);
        Ok(Spec { technique, settings, text: text.to_owned() })
    }
}

impl Spec {
    /// Makes the technique.
    pub fn make(&self, gpu: &Gpu) -> Result<Box<dyn Technique>, Error> {
        (self.technique.make)(gpu, self.settings.clone())
    }
}

/// The technique of this name.
pub fn find(name: &str) -> Result<&'static TechniqueInfo, SpecError> {
    TECHNIQUES.iter().find(|t| t.name == name).ok_or_else(|| SpecError::UnknownTechnique {
        asked: name.to_owned(),
        nearest: nearest(name, TECHNIQUES.iter().map(|t| t.name)),
    })
}

/// A technique that is made from its settings: the line that a technique adds to the list is `entry::<Its>()`.
pub trait Describe: Technique + Sized + 'static {
    /// Its settings.
    type Settings: Settings;
    /// Name on the command line, name for people, source, and what it does in one sentence.
    const ABOUT: About;
    /// The most that a shader of it takes, if it is more than every WebGPU device gives.
    const NEEDS: Needs = Needs::CORE;

    /// Its defaults where these settings are given. Techniques with presets start from the preset that is given.
    fn defaults(_given: &Map<String, Value>) -> Self::Settings {
        Self::Settings::default()
    }

    /// Makes one; compiles its pipelines.
    fn make(gpu: &Gpu, settings: Self::Settings) -> Result<Self, Error>;
}

/// What a technique says of itself.
pub struct About {
    /// Name on the command line.
    pub name: &'static str,
    /// Name for people.
    pub title: &'static str,
    /// Where it comes from.
    pub source: &'static str,
    /// What it does and what it is good for.
    pub summary: &'static str,
}

/// The list entry of a technique.
pub(crate) const fn entry<T: Describe>() -> TechniqueInfo {
    TechniqueInfo {
        name: T::ABOUT.name,
        title: T::ABOUT.title,
        source: T::ABOUT.source,
        summary: T::ABOUT.summary,
        settings: T::Settings::FIELDS,
        needs: T::NEEDS,
        defaults: |given| serde_json::to_value(T::defaults(given)).expect("settings are plain data"),
        make: |gpu, value| {
            let settings = serde_json::from_value(value).map_err(|e| SpecError::Value {
                technique: T::ABOUT.name.to_owned(),
                key: "settings".to_owned(),
                value: String::new(),
                expected: e.to_string(),
            })?;
            Ok(Box::new(T::make(gpu, settings)?))
        },
    }
}
