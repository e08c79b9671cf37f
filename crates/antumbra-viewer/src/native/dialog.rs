//! The desktop's file dialog.

use crate::open::Chosen;
use eframe::egui;
use std::sync::mpsc::{Receiver, channel};

/// Shows the file dialog on a thread of its own; it may never return.
pub fn choose_files(extensions: &[&str], wake: impl Fn() + Send + 'static) -> Receiver<Chosen> {
    let (send, receive) = channel();
    // Some systems require a start on the window's thread.
    let asked = rfd::AsyncFileDialog::new().set_title("Open a scene").add_filter("models and scenes", extensions);
    let asked = asked.pick_files();
    std::thread::spawn(move || {
        let chosen = match pollster::block_on(asked) {
            Some(files) => Ok(files.iter().map(|f| super::dropped(f.path().to_owned())).collect()),
            // On Linux a closed dialog gives an empty list.
            None if cfg!(target_os = "linux") => Err("the desktop offers no file dialog (no XDG portal, no zenity): \
                 drop the file on the window, or type its path under Scene"
                .to_owned()),
            None => Ok(Vec::<egui::DroppedFileHandle>::new()),
        };
        // The window may have closed.
        let _ = send.send(chosen);
        wake();
    });
    receive
}
