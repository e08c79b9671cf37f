//! The program of the web page.

fn main() {
    #[cfg(target_arch = "wasm32")]
    antumbra_viewer::open_page();
    #[cfg(not(target_arch = "wasm32"))]
    eprintln!("this is the program of a web page: `cargo xtask web` builds it, `antumbra view` opens the window");
}
