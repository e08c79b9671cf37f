//! `web-bind PROGRAM.wasm NAME FOLDER`: writes `NAME.js` and `NAME_bg.wasm` for a page's own modules.

use std::process::ExitCode;
use wasm_bindgen_cli_support::Bindgen;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [program, name, folder] = arguments.as_slice() else {
        eprintln!("web-bind PROGRAM.wasm NAME FOLDER");
        return ExitCode::from(2);
    };
    let mut bindgen = Bindgen::new();
    let bound = bindgen.input_path(program).out_name(name).typescript(false).web(true);
    match bound.and_then(|b| b.generate(folder)) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("web-bind: {error:#}");
            ExitCode::FAILURE
        }
    }
}
