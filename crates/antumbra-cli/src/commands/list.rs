//! `antumbra techniques`, `scenes` and `adapters`.

use super::print;
use crate::error::CliError;
use antumbra::technique::TechniqueInfo;
use antumbra::technique::settings::{Kind, Setting};
use antumbra::techniques::TECHNIQUES;
use antumbra_bench::Error;
use antumbra_scene::builtin;
use serde::Serialize;
use std::fmt::Write;

/// Lists the techniques.
pub fn techniques(json: bool) -> Result<(), CliError> {
    if json {
        return print_json(&TECHNIQUES.iter().map(technique_json).collect::<Vec<_>>());
    }
    let mut text = String::new();
    for t in TECHNIQUES {
        let _ = writeln!(text, "{:<18} {} [{}]\n{:18} {}", t.name, t.title, t.source, "", t.summary);
        let defaults = (t.defaults)(&Default::default());
        for s in t.settings {
            let _ = writeln!(text, "{:18}   {}={}  {} ({})", "", s.key, plain(&defaults[s.key]), s.help, values_of(s));
        }
    }
    print(&text)
}

fn technique_json(t: &TechniqueInfo) -> serde_json::Value {
    let defaults = (t.defaults)(&Default::default());
    let setting = |s: &Setting| {
        let mut value = serde_json::to_value(s).unwrap_or_default();
        value["default"] = defaults[s.key].clone();
        value
    };
    serde_json::json!({
        "name": t.name,
        "title": t.title,
        "source": t.source,
        "summary": t.summary,
        "settings": t.settings.iter().map(setting).collect::<Vec<_>>(),
    })
}

/// A default as a user types it: text without quotes.
fn plain(value: &serde_json::Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

fn values_of(setting: &Setting) -> String {
    match setting.kind {
        Kind::Integer { min, max } => format!("{min} to {max}"),
        Kind::Number { min, max } => format!("{min} to {max}"),
        Kind::Toggle => "true, false".to_owned(),
        Kind::Choice { options } => options.join(", "),
        Kind::Points { max } => format!("up to {max} points `x y;x y;...`, or @FILE with one a line"),
    }
}

/// Lists the built-in scenes.
pub fn scenes(json: bool) -> Result<(), CliError> {
    if json {
        return print_json(&builtin::list());
    }
    let mut text = String::new();
    for s in builtin::list() {
        let name = format!("builtin:{}", s.name);
        let _ = writeln!(text, "{name:<18} {}, {} triangles\n{:18} {}", s.title, s.triangles, "", s.description);
        for p in s.parameters {
            let _ = writeln!(text, "{:18}   {}={}  {} ({} to {})", "", p.name, p.default, p.help, p.min, p.max);
        }
    }
    print(&text)
}

/// An adapter in the list.
#[derive(Serialize)]
struct Adapter {
    index: usize,
    name: String,
    kind: &'static str,
    backend: String,
    driver: String,
    max_texture_size: u32,
    timestamps: bool,
}

impl Adapter {
    fn new(index: usize, adapter: &wgpu::Adapter) -> Adapter {
        let info = adapter.get_info();
        let kind = match info.device_type {
            wgpu::DeviceType::DiscreteGpu => "discrete",
            wgpu::DeviceType::IntegratedGpu => "integrated",
            wgpu::DeviceType::VirtualGpu => "virtual",
            wgpu::DeviceType::Cpu => "software",
            wgpu::DeviceType::Other => "other",
        };
        Adapter {
            index,
            name: info.name,
            kind,
            backend: info.backend.to_string(),
            driver: format!("{} {}", info.driver, info.driver_info).trim().to_owned(),
            max_texture_size: adapter.limits().max_texture_dimension_2d,
            timestamps: adapter.features().contains(wgpu::Features::TIMESTAMP_QUERY),
        }
    }
}

/// Lists the adapters. Fails without any, since nothing can be rendered.
pub fn adapters(json: bool) -> Result<(), CliError> {
    let found = pollster::block_on(antumbra::gpu::device::adapters());
    let list: Vec<Adapter> = found.iter().enumerate().map(|(i, a)| Adapter::new(i, a)).collect();
    if json {
        print_json(&list)?;
    } else {
        let line = |a: &Adapter| format!("{}  {} ({}, {}, {})\n", a.index, a.name, a.kind, a.backend, a.driver);
        print(&list.iter().map(line).collect::<String>())?;
    }
    if list.is_empty() { Err(Error::from(antumbra::Error::NoAdapter).into()) } else { Ok(()) }
}

fn print_json(value: &impl Serialize) -> Result<(), CliError> {
    let text = serde_json::to_string_pretty(value).unwrap_or_default();
    print(&(text + "\n"))
}
