// Penumbra rectangles that the CPU has made: what the paper's program draws. For a benchmark only.

struct Shape {
    // Half the light over a texel, as texels a unit of inverse distance.
    widening: vec2<f32>,
    near: f32,
    size: f32,
}

@group(0) @binding(0) var<uniform> shape: Shape;
@group(0) @binding(1) var receivers: texture_depth_2d;

struct Rectangle {
    @builtin(position) position: vec4<f32>,
    @location(0) @interpolate(flat, either) patch_at: vec3<f32>,
}

// One instance a patch: the rectangle's low and high corner in texels, the patch's corner, its inverse distance.
@vertex
fn vertex(@builtin(vertex_index) corner: u32, @location(0) extent: vec4<f32>, @location(1) patch_at: vec3<f32>) -> Rectangle {
    let upper = vec2(corner == 1u || corner == 2u || corner == 4u, corner == 2u || corner == 4u || corner == 5u);
    let place = select(extent.xy, extent.zw, upper) / shape.size;
    return Rectangle(vec4(vec2(2.0, -2.0) * place - vec2(1.0, -1.0), 0.5, 1.0), patch_at);
}

@fragment
fn fragment(in: Rectangle) -> @location(0) f32 {
    let receiver_q = textureLoad(receivers, vec2<i32>(in.position.xy), 0) / shape.near;
    let above = in.patch_at.z - receiver_q;
    if receiver_q == 0.0 || above <= 0.0 {
        discard;
    }
    let half = shape.widening * above;
    let low = max(in.patch_at.xy, in.position.xy - half);
    let high = min(in.patch_at.xy + 1.0, in.position.xy + half);
    let edges = max(high - low, vec2(0.0)) / (2.0 * half);
    return edges.x * edges.y;
}
