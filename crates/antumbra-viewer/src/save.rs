//! What is taken away, as the bytes of files.

use crate::desk::{Compare, Desk};
use crate::export;
use crate::readback::Readback;
use crate::session::Session;

/// The pictures of both halves on their way to a file.
pub struct Saving {
    halves: Vec<Readback>,
    size: [u32; 2],
    divider: u32,
}

impl Saving {
    /// Asks for what is shown now, without what is written over it.
    pub fn start(desk: &Desk, session: &Session) -> Option<Saving> {
        let canvas = session.canvas.as_ref()?;
        let count = if desk.compare == Compare::One { 1 } else { 2 };
        let read = |half: &crate::stage::Half| Readback::start(&session.gpu, &half.image);
        Some(Saving {
            halves: canvas.halves[..count].iter().map(read).collect(),
            size: canvas.size,
            divider: if count == 1 { canvas.size[0] } else { (canvas.size[0] as f32 * desk.divider) as u32 },
        })
    }

    /// The picture as a PNG file, once its parts have come.
    pub fn poll(&mut self, parts: &mut Vec<Vec<u8>>) -> Option<Result<Vec<u8>, String>> {
        while let Some(next) = self.halves.get(parts.len()) {
            parts.push(next.poll()?);
        }
        let row = self.size[0] as usize * 4;
        let whole = parts.iter().all(|p| p.len() == row * self.size[1] as usize);
        if !whole {
            return Some(Err("the device went away before the picture was read".to_owned()));
        }
        let cut = self.divider as usize * 4;
        let rows = (0..self.size[1] as usize).map(|y| y * row);
        let right = parts.last()?;
        let joined: Vec<u8> =
            rows.flat_map(|at| [&parts[0][at..at + cut], &right[at + cut..at + row]].concat()).collect();
        Some(export::png(self.size, &joined).map_err(|e| e.to_string()))
    }
}

/// The text of a scene file of what is on the desk.
pub fn scene_text(desk: &Desk, session: &Session) -> Result<String, String> {
    let open = desk.open.as_ref().ok_or("no scene is open")?;
    let size = session.canvas.as_ref().map_or([768; 2], |c| c.size);
    let text = open.text.as_deref();
    let file = export::scene_file(&open.source, text, &open.scene, &desk.camera, &desk.light, size)?;
    let turned = desk.angle.to_degrees();
    let note = if desk.angle == 0.0 {
        String::new()
    } else {
        format!("# The occluders were turned by {turned:.1} degrees, which a scene file cannot say.\n")
    };
    Ok(note + &file)
}
