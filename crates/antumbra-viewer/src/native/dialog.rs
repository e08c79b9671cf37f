//! The desktop's file dialog.

use crate::open::Chosen;
use eframe::egui;
use std::sync::mpsc::{Receiver, channel};

/// Asks for files without holding the window up: the dialog has a thread of its own, and none may come at all.
pub fn choose_files(extensions: &[&str], wake: impl Fn() + Send + 'static) -> Receiver<Chosen> {
    let (send, receive) = channel();
    // Some systems want it begun on the window's thread.
    let asked = rfd::AsyncFileDialog::new().set_title("Open a scene").add_filter("models and scenes", extensions);
    let asked = asked.pick_files();
    std::thread::spawn(move || {
        let chosen = match pollster::block_on(asked) {
            Some(files) => Ok(files.iter().map(|f| super::dropped(f.path().to_owned())).collect()),
            // On Linux it is an empty list that tells of a dialog that was closed.
            None if cfg!(target_os = "linux") => Err("the desktop offers no file dialog (no XDG portal, no zenity): \
                 drop the file on the window, or type its path under Scene"
                .to_owned()),
            None => Ok(Vec::<egui::DroppedFileHandle>::new()),
        };
        // Nobody waits where the window has closed.
        let _ = send.send(chosen);
        wake();
    });
    receive
}
