// The host's own shaders: a prepass that writes depth and normals, and a pass that shades with Antumbra's visibility.
struct Camera { clip_from_world: mat4x4<f32>, eye: vec4<f32>, light: vec4<f32> }
@group(0) @binding(0) var<uniform> camera: Camera;
@group(0) @binding(1) var visibility: texture_2d<f32>;
@group(0) @binding(2) var normals: texture_2d<f32>;

struct Vertex {
    @location(0) position: vec3<f32>,
    @location(1) normal: vec3<f32>,
    // One matrix an instance.
    @location(2) x: vec4<f32>, @location(3) y: vec4<f32>, @location(4) z: vec4<f32>, @location(5) w: vec4<f32>,
}
struct Surface { @builtin(position) position: vec4<f32>, @location(0) normal: vec3<f32>, @location(1) world: vec3<f32> }

@vertex
fn prepass_vertex(v: Vertex) -> Surface {
    let model = mat4x4(v.x, v.y, v.z, v.w);
    let world = model * vec4(v.position, 1.0);
    return Surface(camera.clip_from_world * world, (model * vec4(v.normal, 0.0)).xyz, world.xyz);
}

@fragment
fn prepass_fragment(s: Surface) -> @location(0) vec4<f32> {
    // Flat faces: their vertex normals are geometric normals. They are turned to the camera.
    let n = normalize(s.normal);
    return vec4(select(n, -n, dot(n, s.world - camera.eye.xyz) > 0.0), 1.0);
}

@vertex
fn shade_vertex(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    return vec4(f32(i & 1u) * 4.0 - 1.0, f32(i >> 1u) * 4.0 - 1.0, 0.0, 1.0);
}

@fragment
fn shade_fragment(@builtin(position) p: vec4<f32>) -> @location(0) vec4<f32> {
    let n = textureLoad(normals, vec2<u32>(p.xy), 0);
    if n.w == 0.0 {
        return vec4(0.35, 0.45, 0.6, 1.0);
    }
    let lit = max(dot(n.xyz, camera.light.xyz), 0.0) * textureLoad(visibility, vec2<u32>(p.xy), 0).x;
    return vec4(vec3(0.9, 0.8, 0.7) * (0.1 + 0.9 * lit), 1.0);
}
