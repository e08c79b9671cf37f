//! Structs that host and shaders share: declared once, in Rust.

/// A struct whose WGSL declaration is made from the Rust one: see [`gpu_struct`](crate::gpu_struct).
pub trait HostStruct: encase::ShaderType + encase::internal::WriteInto {
    /// The declaration in WGSL.
    fn wgsl() -> String;

    /// Appends the bytes of a uniform buffer.
    fn write_uniform(&self, bytes: &mut Vec<u8>) {
        let mut buffer = encase::UniformBuffer::new(bytes);
        buffer.write(self).expect("a vector grows as needed");
    }
}

/// The WGSL name of a Rust type that a [`HostStruct`] may have as a field.
pub trait WgslType {
    /// As written in WGSL.
    const NAME: &'static str;
}

macro_rules! wgsl_types {
    ($($rust:ty => $wgsl:literal),* $(,)?) => { $(impl WgslType for $rust { const NAME: &'static str = $wgsl; })* };
}
wgsl_types! {
    f32 => "f32", u32 => "u32", i32 => "i32",
    glam::Vec2 => "vec2<f32>", glam::Vec3 => "vec3<f32>", glam::Vec4 => "vec4<f32>",
    glam::UVec2 => "vec2<u32>", glam::UVec4 => "vec4<u32>", glam::Mat3 => "mat3x3<f32>", glam::Mat4 => "mat4x4<f32>",
    [glam::Vec4; 6] => "array<vec4<f32>, 6>",
}

/// Declares a struct once for the host and for the shaders, which import it from `package::host`. The build script
/// finds every declaration that starts a line, so nothing is registered by hand; names are unique over the crate.
#[doc(hidden)]
#[macro_export]
macro_rules! gpu_struct {
    ($(#[$meta:meta])* $vis:vis struct $name:ident { $($(#[$field_meta:meta])* $field:ident : $type:ty),* $(,)? }) => {
        $(#[$meta])*
        #[derive(Clone, Copy, Debug, encase::ShaderType)]
        $vis struct $name { $($(#[$field_meta])* pub $field: $type),* }

        impl $crate::gpu::host_struct::HostStruct for $name {
            fn wgsl() -> String {
                let mut text = format!("struct {} {{\n", stringify!($name));
                $(text.push_str(&format!("    {}: {},\n", stringify!($field), <$type as $crate::gpu::host_struct::WgslType>::NAME));)*
                text.push_str("}\n");
                text
            }
        }
    };
}
