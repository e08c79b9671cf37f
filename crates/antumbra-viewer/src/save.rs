//! Content of saved files.

use crate::export;
use crate::readback::Readback;
use crate::session::Session;
use crate::view_state::{Compare, ViewState};

/// Images of both halves in readback.
pub struct Saving {
    halves: Vec<Readback>,
    size: [u32; 2],
    divider: u32,
}

impl Saving {
    /// Starts the readback of the displayed images, without overlays.
    pub fn start(view_state: &ViewState, session: &Session) -> Option<Saving> {
        let targets = session.targets.as_ref()?;
        let count = if view_state.compare == Compare::One { 1 } else { 2 };
        let read = |half: &crate::render_targets::Half| Readback::start(&session.gpu, &half.image);
        Some(Saving {
            halves: targets.halves[..count].iter().map(read).collect(),
            size: targets.size,
            divider: if count == 1 { targets.size[0] } else { (targets.size[0] as f32 * view_state.divider) as u32 },
        })
    }

    /// The PNG file, once its parts have arrived.
    pub fn poll(&mut self, parts: &mut Vec<Vec<u8>>) -> Option<Result<Vec<u8>, String>> {
        while let Some(next) = self.halves.get(parts.len()) {
            parts.push(next.poll()?);
        }
        let row = self.size[0] as usize * 4;
        let whole = parts.iter().all(|p| p.len() == row * self.size[1] as usize);
        if !whole {
            return Some(Err("the device went away before the image was read".to_owned()));
        }
        let cut = self.divider as usize * 4;
        let rows = (0..self.size[1] as usize).map(|y| y * row);
        let right = parts.last()?;
        let joined: Vec<u8> =
            rows.flat_map(|at| [&parts[0][at..at + cut], &right[at + cut..at + row]].concat()).collect();
        Some(export::png(self.size, &joined).map_err(|e| e.to_string()))
    }
}

/// The text of a scene file of the current view.
pub fn scene_text(view_state: &ViewState, session: &Session) -> Result<String, String> {
    let open = view_state.open.as_ref().ok_or("no scene is open")?;
    let size = session.targets.as_ref().map_or([768; 2], |c| c.size);
    let text = open.text.as_deref();
    let file = export::scene_file(&open.source, text, &open.scene, &view_state.camera, &view_state.light, size)?;
    let turned = view_state.angle.to_degrees();
    let note = if view_state.angle == 0.0 {
        String::new()
    } else {
        format!("# The occluders were turned by {turned:.1} degrees, which a scene file cannot say.\n")
    };
    Ok(note + &file)
}
