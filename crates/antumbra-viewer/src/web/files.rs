//! Files of a page: addresses, dropped files, downloads.

use crate::open;
use crate::view_state::OpenScene;
use eframe::egui;
use std::collections::BTreeMap;
use std::future::Future;
use std::io;
use std::path::{Path, PathBuf};
use std::pin::Pin;
use std::sync::Arc;
use wasm_bindgen::{JsCast, JsValue};
use wasm_bindgen_futures::JsFuture;

/// Opens the scene at an address. A reader cannot wait for a file that another file refers to: missing files
/// are fetched, then reading starts again.
pub async fn load(name: &str) -> Result<OpenScene, String> {
    let mut known: BTreeMap<PathBuf, Result<Vec<u8>, String>> = BTreeMap::new();
    loop {
        let mut missing = None;
        let opened = open::from_files(name, &mut |file| match known.get(file) {
            Some(Ok(bytes)) => Ok(bytes.clone()),
            Some(Err(message)) => Err(io::Error::other(message.clone())),
            None => {
                missing.get_or_insert_with(|| file.to_owned());
                Err(io::ErrorKind::NotFound.into())
            }
        });
        let Some(file) = missing else { return opened };
        let bytes = fetch(&file.to_string_lossy()).await;
        known.insert(file, bytes);
    }
}

/// The bytes at an address, relative to the page's.
pub async fn fetch(address: &str) -> Result<Vec<u8>, String> {
    let window = web_sys::window().ok_or("there is no window")?;
    let response = JsFuture::from(window.fetch_with_str(address)).await.map_err(|e| text(&e))?;
    let response: web_sys::Response = response.dyn_into().map_err(|e| text(&e))?;
    if !response.ok() {
        return Err(format!("the server answers {} {}", response.status(), response.status_text()));
    }
    let bytes = JsFuture::from(response.array_buffer().map_err(|e| text(&e))?).await.map_err(|e| text(&e))?;
    Ok(js_sys::Uint8Array::new(&bytes).to_vec())
}

/// The message of a JavaScript error.
pub fn text(value: &JsValue) -> String {
    let error = value.dyn_ref::<js_sys::Error>().map(|e| String::from(e.message()));
    error.or_else(|| value.as_string()).unwrap_or_else(|| format!("{value:?}"))
}

/// Opens a file that was dropped on the page, with the dropped files that it refers to.
pub async fn load_dropped(file: &Path, all: &[egui::DroppedFileHandle]) -> Result<OpenScene, String> {
    let mut known = BTreeMap::new();
    for handle in all {
        known.insert(file_name(handle.path()), handle.bytes_async().await?);
    }
    open::from_files(&file.display().to_string(), &mut |name| {
        let missing =
            || io::Error::new(io::ErrorKind::NotFound, "drop it on the page together with the file that names it");
        known.get(&file_name(name)).cloned().ok_or_else(missing)
    })
}

/// The last part of a path: a page learns no more of it.
fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}

/// An address from a command, treated as a dropped file.
pub fn dropped(address: PathBuf) -> egui::DroppedFileHandle {
    Arc::new(Address(address))
}

#[derive(Debug)]
struct Address(PathBuf);

impl egui::DroppedFile for Address {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes_async(&self) -> Pin<Box<dyn Future<Output = Result<Vec<u8>, String>> + '_>> {
        Box::pin(async { fetch(&self.0.to_string_lossy()).await })
    }
}

/// Downloads bytes under this name and returns the place as text. The browser makes the name unique.
pub fn keep(stem: &str, extension: &str, bytes: &[u8]) -> Result<String, String> {
    download(&format!("{stem}.{extension}"), bytes).map_err(|e| text(&e))
}

/// Downloads a file; says where to.
pub fn write(path: &Path, bytes: &[u8]) -> Result<String, String> {
    download(&file_name(path), bytes).map_err(|e| text(&e))
}

fn download(name: &str, bytes: &[u8]) -> Result<String, JsValue> {
    let parts = js_sys::Array::of1(&js_sys::Uint8Array::from(bytes));
    let blob = web_sys::Blob::new_with_u8_array_sequence(&parts)?;
    let address = web_sys::Url::create_object_url_with_blob(&blob)?;
    let document = web_sys::window().and_then(|w| w.document()).ok_or("there is no page")?;
    let link: web_sys::HtmlAnchorElement = document.create_element("a")?.dyn_into()?;
    link.set_href(&address);
    link.set_download(name);
    link.click();
    web_sys::Url::revoke_object_url(&address)?;
    Ok(format!("{name} to the downloads"))
}
