//! The device, shader composition, pipelines, the recorder and its resources. Knows no shadow.

pub mod bindings;
pub mod debug_view;
pub mod device;
pub mod host_struct;
pub mod limits;
mod link;
pub mod pipeline;
pub mod readback;
pub mod recorder;
pub mod resources;
pub mod shader;
pub mod texture;
pub mod timer;
