//! The command line.

use crate::output::{self, OutputFile, ValuesFile, any_file, npy_file, png_file, values_file};
use antumbra::error::SpecError;
use antumbra::techniques::TECHNIQUES;
use antumbra::{AdapterChoice, Spec};
use antumbra_bench::kit::Suite;
use antumbra_bench::list;
use antumbra_bench::studies::rho;
use clap::builder::{OsStringValueParser, TypedValueParser};
use clap::{Args, Parser, Subcommand};
use std::error::Error;
use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::str::FromStr;

/// Real-time soft shadows of area lights, compared with a ray-traced reference.
#[derive(Debug, Parser)]
#[command(name = "antumbra", version, arg_required_else_help = true, max_term_width = 110)]
pub struct Cli {
    /// The command.
    #[command(subcommand)]
    pub command: Command,
}

/// The commands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Render a scene with one technique
    #[command(after_help = output::HELP)]
    Render(RenderArgs),
    /// Trace the reference: the visible fraction of the light at each pixel
    #[command(after_help = output::HELP)]
    Reference(ReferenceArgs),
    /// Compare techniques with the reference: error, milliseconds and megabytes, as a table and as a report with images
    Compare(CompareArgs),
    /// Measure the tables and curves of papers again, the paper's numbers beside ours
    #[command(after_help = list::help())]
    Bench(BenchArgs),
    /// Repeat a paper's user study with an image metric
    #[command(subcommand)]
    Study(Study),
    /// View techniques in a window: side by side, or beside the reference
    #[cfg(feature = "viewer")]
    View(ViewArgs),
    /// List the techniques, their settings and their papers
    Techniques(ListArgs),
    /// List the built-in scenes and their parameters
    Scenes(ListArgs),
    /// List this machine's graphics adapters, the best one first
    Adapters(ListArgs),
}

/// `antumbra render`.
#[derive(Debug, Args)]
#[command(group = clap::ArgGroup::new("outputs").required(true).multiple(true))]
pub struct RenderArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Image to write, a .png
    #[arg(short, long, value_name = "FILE", group = "outputs", value_parser = png_file())]
    pub output: Option<OutputFile>,
    /// Technique and its settings: name:key=value,key=value; `antumbra techniques` lists them
    #[arg(short, long, value_name = "SPEC", default_value = "backprojection", value_parser = shown::<Technique>())]
    pub technique: Technique,
    /// Visible fraction of the light at each pixel to write: .npy (float32, height x width), .exr or .png (16-bit grey)
    #[arg(long, value_name = "FILE", group = "outputs", value_parser = values_file())]
    pub visibility: Option<ValuesFile>,
    /// Milliseconds and bytes by pass to write, a JSON file
    #[arg(long, value_name = "FILE", group = "outputs", value_parser = any_file())]
    pub stats: Option<OutputFile>,
    #[command(flatten)]
    pub gpu: GpuArgs,
}

/// `antumbra reference`.
#[derive(Debug, Args)]
pub struct ReferenceArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Visible fraction of the light at each pixel to write: .npy (float32, height x width), .exr or .png (16-bit grey)
    #[arg(long, value_name = "FILE", value_parser = values_file())]
    pub visibility: ValuesFile,
    /// Mask of the pixels whose errors count, to write: .npy (float32, height x width), 1 where a surface that faces
    /// the light covers the whole pixel, else 0
    #[arg(long, value_name = "FILE", value_parser = npy_file())]
    pub valid: Option<OutputFile>,
    #[command(flatten)]
    pub truth: TruthArgs,
}

/// `antumbra compare`.
#[derive(Debug, Args)]
pub struct CompareArgs {
    #[command(flatten)]
    pub scene: SceneArgs,
    /// Technique and its settings, name:key=value,key=value; repeatable; `all` stands for every technique
    #[arg(short, long = "technique", value_name = "SPEC", required = true, value_parser = shown::<Techniques>())]
    pub techniques: Vec<Techniques>,
    /// Folder of the report, created if missing: index.html, results.json, results.csv, pictures
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    #[command(flatten)]
    pub truth: TruthArgs,
    #[command(flatten)]
    pub gpu: GpuArgs,
}

/// `antumbra bench`.
#[derive(Debug, Args)]
pub struct BenchArgs {
    /// Suites to run, listed below [default: all]
    #[arg(value_name = "SUITE", value_parser = list::find)]
    pub suites: Vec<&'static Suite>,
    /// Folder of the results, created if missing: for each suite a page, a table in Markdown, JSON and CSV
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Further scene to measure, named as for `render`; repeatable. The targets of `backprojection` need the Stanford
    /// bunny: a model with "bunny" in its file's name
    #[arg(long = "scene", value_name = "SCENE")]
    pub scenes: Vec<OsString>,
    /// Size of the images in pixels [default: the suite's]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    #[command(flatten)]
    pub truth: TruthArgs,
    #[command(flatten)]
    pub gpu: GpuArgs,
}

/// `antumbra study`.
#[derive(Debug, Subcommand)]
pub enum Study {
    /// Texels that a penumbra needs by its width in pixels, for `pvssm` [Shen 2011, figure 9]
    Rho(RhoArgs),
}

/// `antumbra study rho`.
#[derive(Debug, Args)]
pub struct RhoArgs {
    /// Folder of the results, created if missing: a page, a table in Markdown, JSON and CSV
    #[arg(short, long, value_name = "DIR")]
    pub output: PathBuf,
    /// Largest mean FLIP error in the penumbra that counts as equal to the reference
    #[arg(long, value_name = "FLIP", default_value_t = rho::THRESHOLD, value_parser = threshold)]
    pub threshold: f64,
    /// Widest penumbra in pixels; powers of two up to it are searched
    #[arg(long, value_name = "N", default_value_t = 512, value_parser = clap::value_parser!(u32).range(8..=512))]
    pub most: u32,
}

fn threshold(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|v| (1e-4..=0.5).contains(v));
    value.ok_or_else(|| "expected a FLIP error from 0.0001 to 0.5".to_owned())
}

/// `antumbra view`.
#[cfg(feature = "viewer")]
#[derive(Debug, Args)]
pub struct ViewArgs {
    /// A .glb, .gltf, .obj or .ply file, a scene file (.toml or .json), or builtin:NAME [default: builtin:fence]
    pub scene: Option<OsString>,
    /// Technique and its settings, name:key=value,key=value; one is shown beside the reference, two side by side
    #[arg(short, long = "technique", value_name = "SPEC", value_parser = shown::<Technique>())]
    pub techniques: Vec<Technique>,
    /// Size of the window in points [default: 1440x900]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// Part of an adapter's name, or its number in `antumbra adapters` [default: the best]
    #[arg(long, value_name = "NAME|INDEX")]
    pub adapter: Option<AdapterChoice>,
    /// Read commands from standard input, one JSON object per line, and answer each with a line
    #[arg(long)]
    pub commands: bool,
}

/// `antumbra techniques`, `scenes` and `adapters`.
#[derive(Debug, Args)]
pub struct ListArgs {
    /// Write JSON, for programs
    #[arg(long)]
    pub json: bool,
}

/// Scene and size of the image.
#[derive(Debug, Args)]
pub struct SceneArgs {
    /// A .glb, .gltf, .obj or .ply file, a scene file (.toml or .json), or builtin:NAME (`antumbra scenes` lists them)
    pub scene: OsString,
    /// Size of the image in pixels [default: the scene's own, else 768x768]
    #[arg(long, value_name = "WxH")]
    pub size: Option<Size>,
    /// Size of the light in metres, instead of the scene's
    #[arg(long, value_name = "W[xH]")]
    pub light_size: Option<LightSize>,
}

/// Adapter and timing.
#[derive(Debug, Args)]
pub struct GpuArgs {
    /// Part of an adapter's name, or its number in `antumbra adapters` [default: the best]
    #[arg(long, value_name = "NAME|INDEX")]
    pub adapter: Option<AdapterChoice>,
    /// Timed frames, whose median counts, after two warm-up frames (one if it takes over a second)
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    pub frames: u32,
}

/// Sampling and cache of the reference.
#[derive(Clone, Debug, Args)]
pub struct TruthArgs {
    /// Shadow rays per pixel, shared among its pixel samples
    #[arg(long, value_name = "N", default_value_t = 1024, value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    pub light_samples: u32,
    /// Primary rays per pixel; a square number gives a regular grid
    #[arg(long, value_name = "N", default_value_t = 16, value_parser = clap::value_parser!(u32).range(1..=4096))]
    pub pixel_samples: u32,
    /// Seed of the samples
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
    /// Folder of traced references [default: antumbra in the user's cache folder: on Linux $XDG_CACHE_HOME, else
    /// ~/.cache]
    #[arg(long, value_name = "DIR", env = "ANTUMBRA_CACHE")]
    pub cache: Option<PathBuf>,
    /// Trace again and store nothing, regardless of --cache
    #[arg(long)]
    pub no_cache: bool,
}

/// Reads a value as messages show it: a file that it names may have a name that is not UTF-8.
fn shown<T>() -> impl TypedValueParser<Value = T>
where
    T: FromStr<Err: Error + Send + Sync> + Clone + Send + Sync + 'static,
{
    OsStringValueParser::new().try_map(|text| text.to_string_lossy().parse())
}

/// A technique with its settings.
#[derive(Clone)]
pub struct Technique(pub Spec);

impl std::fmt::Debug for Technique {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0.text)
    }
}

impl FromStr for Technique {
    type Err = antumbra::error::SpecError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let spec: Spec = with_files(text)?.parse()?;
        Ok(Technique(Spec { text: text.to_owned(), ..spec }))
    }
}

/// A SPEC with each `key=@FILE` replaced by the file's points, one per line.
fn with_files(text: &str) -> Result<String, SpecError> {
    let Some((name, values)) = text.split_once(':').filter(|(_, values)| values.contains("=@")) else {
        return Ok(text.to_owned());
    };
    let part = |part: &str| {
        let Some((key, file)) = part.split_once("=@") else { return Ok(part.to_owned()) };
        let unread = |e: std::io::Error| SpecError::Value {
            technique: name.to_owned(),
            key: key.trim().to_owned(),
            value: format!("@{file}"),
            expected: format!("cannot read {file}: {e}"),
        };
        let lines = antumbra_scene::read_from_disk(Path::new(file.trim())).map_err(unread)?;
        let lines = String::from_utf8_lossy(&lines);
        Ok(format!("{key}={}", lines.trim().replace(',', " ").replace('\n', ";")))
    };
    let parts: Vec<String> = values.split(',').map(part).collect::<Result<_, _>>()?;
    Ok(format!("{name}:{}", parts.join(",")))
}

/// One technique or all.
#[derive(Clone, Debug)]
pub struct Techniques(pub Vec<Technique>);

impl FromStr for Techniques {
    type Err = antumbra::error::SpecError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let all = || TECHNIQUES.iter().map(|t| t.name.parse()).collect();
        if text == "all" { all() } else { text.parse().map(|t| vec![t]) }.map(Techniques)
    }
}

/// Size of an image in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Size(pub [u32; 2]);

impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let side = |t: &str| t.trim().parse::<u32>().ok();
        let sides = text.split_once(['x', 'X']).and_then(|(w, h)| Some([side(w)?, side(h)?]));
        match sides {
            Some([0, _] | [_, 0]) => Err("a picture has at least one pixel each way".to_owned()),
            Some(size) => Ok(Size(size)),
            None => Err("expected width x height in pixels, such as 1280x720".to_owned()),
        }
    }
}

/// Size of a light in metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LightSize(pub [f32; 2]);

impl FromStr for LightSize {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let (width, height) = text.split_once(['x', 'X']).unwrap_or((text, text));
        let edge = |t: &str| t.trim().parse::<f32>().ok().filter(|v| (0.0..=1e6).contains(v));
        let size = edge(width).zip(edge(height)).map(|(w, h)| LightSize([w, h]));
        size.ok_or_else(|| "expected one or two lengths in metres from 0 to 1000000, such as 0.5 or 1x0.25".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_command_line_is_consistent() {
        Cli::command().debug_assert();
    }

    #[test]
    fn points_are_read_from_a_file() {
        let file = std::env::temp_dir().join(format!("points-{}.txt", std::process::id()));
        std::fs::write(&file, "0.5 0.5\n0.25, 0.75\n").expect("a folder for temporary files");
        let text = format!("subpixel:map=256,points=@{}", file.display());
        let read = text.parse::<Technique>().unwrap_or_else(|e| panic!("{e}")).0;
        assert_eq!(
            (read.settings["points"].clone(), read.text),
            (serde_json::json!([[0.5, 0.5], [0.25, 0.75]]), text.clone())
        );
        std::fs::remove_file(&file).expect("was just written");
        let error = text.parse::<Technique>().expect_err("the file is gone").to_string();
        assert!(error.contains("cannot read") && error.contains("points"), "{error}");
    }

    #[test]
    fn sizes_are_read() {
        assert_eq!("12x34".parse(), Ok(Size([12, 34])));
        for bad in ["", "12", "0x5", "5x0", "-1x5", "1.5x2", "5x", "99999999999x1", "5x5x5"] {
            assert!(bad.parse::<Size>().is_err(), "{bad}");
        }
        assert_eq!("0.5".parse(), Ok(LightSize([0.5, 0.5])));
        assert_eq!("1x0".parse(), Ok(LightSize([1.0, 0.0])));
        for bad in ["", "x", "-1", "nan", "1xinf", "1x2x3"] {
            assert!(bad.parse::<LightSize>().is_err(), "{bad}");
        }
    }
}
