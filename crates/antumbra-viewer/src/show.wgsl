// What is shown instead of the picture: the visibility as grey, or its error in the colours of the heat map.

@group(0) @binding(0) var visibility: texture_2d<f32>;
// Under 0 where errors are not measured.
@group(0) @binding(1) var truth: texture_2d<f32>;
// From too dark (left) to too light (right).
@group(0) @binding(2) var colors: texture_2d<f32>;
@group(0) @binding(3) var shown: texture_storage_2d<rgba8unorm, write>;

const NOT_MEASURED: f32 = 112.0 / 255.0;

override is_error: bool = false;
// The error at which the colours saturate.
override scale: f32 = 0.25;

@compute @workgroup_size(8, 8)
fn show(@builtin(global_invocation_id) pixel: vec3<u32>) {
    if any(pixel.xy >= textureDimensions(visibility)) {
        return;
    }
    let v = textureLoad(visibility, pixel.xy, 0).x;
    var color = vec3(clamp(v, 0.0, 1.0));
    if is_error {
        let t = textureLoad(truth, pixel.xy, 0).x;
        let last = f32(textureDimensions(colors).x - 1u);
        let place = clamp((v - t) / scale * 0.5 + 0.5, 0.0, 1.0) * last;
        let heat = textureLoad(colors, vec2(u32(place + 0.5), 0u), 0).rgb;
        color = select(heat, vec3(NOT_MEASURED), t < 0.0);
    }
    textureStore(shown, pixel.xy, vec4(color, 1.0));
}
