// Looking into a technique: a layer of a texture as grey between its smallest and largest value, or a list of pixels.
// Numbers of a buffer are gathered into a texture first.

struct Look {
    layer: u32,
    level: u32,
    channel: u32,
    // Of the list's picture, or places of the numbers.
    width: u32,
    height: u32,
    // Numbers of a place, or places a side of what a mask and lists are of.
    stride: u32,
}

struct Range {
    low: f32,
    high: f32,
}

@group(0) @binding(0) var<uniform> look: Look;
@group(0) @binding(1) var<storage, read_write> range: Range;
@group(0) @binding(2) var values: texture_2d_array<f32>;
@group(0) @binding(3) var shown: texture_storage_2d<rgba8unorm, write>;
@group(0) @binding(4) var<storage, read> list: array<u32>;
@group(0) @binding(5) var<storage, read> numbers: array<f32>;
@group(0) @binding(6) var gathered: texture_storage_2d<r32float, write>;

// Samples a side that the range is measured on: as many as pixels are shown.
const SAMPLES: u32 = 512u;

var<workgroup> lows: array<f32, 256>;
var<workgroup> highs: array<f32, 256>;

fn value_at(at: vec2<u32>) -> f32 {
    return textureLoad(values, at, look.layer, look.level)[look.channel];
}

// What is exactly 0 is nothing at all in most maps, and infinities and what is not a number have no place in a range.
fn counts(v: f32) -> bool {
    let exponent = (bitcast<u32>(v) >> 23u) & 0xffu;
    return v != 0.0 && exponent != 0xffu;
}

@compute @workgroup_size(256)
fn measure(@builtin(local_invocation_index) lane: u32) {
    let size = textureDimensions(values, look.level);
    var low = 3e38;
    var high = -3e38;
    for (var i = lane; i < SAMPLES * SAMPLES; i += 256u) {
        let v = value_at(vec2(i % SAMPLES, i / SAMPLES) * size / SAMPLES);
        if counts(v) {
            low = min(low, v);
            high = max(high, v);
        }
    }
    lows[lane] = low;
    highs[lane] = high;
    workgroupBarrier();
    if lane == 0u {
        for (var i = 0u; i < 256u; i++) {
            low = min(low, lows[i]);
            high = max(high, highs[i]);
        }
        range.low = low;
        range.high = high;
    }
}

@compute @workgroup_size(8, 8)
fn show_values(@builtin(global_invocation_id) pixel: vec3<u32>) {
    let size = textureDimensions(shown);
    if any(pixel.xy >= size) {
        return;
    }
    let v = value_at(pixel.xy * textureDimensions(values, look.level) / size);
    // Where all are the same, such as the bits of a mask, they are white.
    let grey = select(1.0, clamp((v - range.low) / (range.high - range.low), 0.0, 1.0), range.high > range.low);
    let color = select(vec3(0.13, 0.16, 0.28), vec3(0.08 + 0.92 * grey), counts(v));
    textureStore(shown, pixel.xy, vec4(color, 1.0));
}

@compute @workgroup_size(8, 8)
fn clear(@builtin(global_invocation_id) pixel: vec3<u32>) {
    textureStore(shown, pixel.xy, vec4(0.13, 0.16, 0.28, 1.0));
}

fn listed_pixel(k: u32) -> vec2<u32> {
    let entry = list[4u + 2u * k];
    return vec2(entry & 0xffffu, entry >> 16u);
}

@compute @workgroup_size(64)
fn show_list(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let k = id.x + id.y * groups.x * 64u;
    if k >= list[3] {
        return;
    }
    let at = listed_pixel(k);
    textureStore(shown, at * textureDimensions(shown) / vec2(look.width, look.height), vec4(1.0, 0.78, 0.3, 1.0));
}

@compute @workgroup_size(8, 8)
fn forget(@builtin(global_invocation_id) at: vec3<u32>) {
    textureStore(gathered, at.xy, vec4(0.0));
}

@compute @workgroup_size(64)
fn gather_rows(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let k = id.x + id.y * groups.x * 64u;
    if k < look.width * look.height {
        textureStore(gathered, vec2(k % look.width, k / look.width), vec4(numbers[k * look.stride + look.channel]));
    }
}

@compute @workgroup_size(64)
fn gather_listed(@builtin(global_invocation_id) id: vec3<u32>, @builtin(num_workgroups) groups: vec3<u32>) {
    let k = id.x + id.y * groups.x * 64u;
    if k < list[3] {
        textureStore(gathered, listed_pixel(k), vec4(numbers[k * look.stride + look.channel]));
    }
}

// The first and the end of the places, along x or y, that lie below a pixel of what is shown.
fn places_of(pixel: u32, pixels: u32) -> vec2<u32> {
    return vec2(pixel, pixel + 1u) * look.stride / pixels;
}

fn is_set(at: vec2<u32>) -> bool {
    return ((list[at.y * ((look.stride + 31u) / 32u) + at.x / 32u] >> (at.x % 32u)) & 1u) != 0u;
}

// Lists lie block by block, 8 x 8 texels a block.
fn length_of_list(at: vec2<u32>) -> u32 {
    let block = at.y / 8u * ((look.stride + 7u) / 8u) + at.x / 8u;
    let k = block * 64u + at.y % 8u * 8u + at.x % 8u;
    return list[k] - select(0u, list[max(k, 1u) - 1u], k > 0u);
}

@compute @workgroup_size(8, 8)
fn gather_mask(@builtin(global_invocation_id) pixel: vec3<u32>) {
    let xs = places_of(pixel.x, look.width);
    let ys = places_of(pixel.y, look.height);
    var most = 0.0;
    for (var y = ys.x; y < ys.y; y++) {
        for (var x = xs.x; x < xs.y; x++) {
            most = select(most, 1.0, is_set(vec2(x, y)));
        }
    }
    textureStore(gathered, pixel.xy, vec4(most));
}

@compute @workgroup_size(8, 8)
fn gather_lengths(@builtin(global_invocation_id) pixel: vec3<u32>) {
    let xs = places_of(pixel.x, look.width);
    let ys = places_of(pixel.y, look.height);
    var most = 0u;
    for (var y = ys.x; y < ys.y; y++) {
        for (var x = xs.x; x < xs.y; x++) {
            most = max(most, length_of_list(vec2(x, y)));
        }
    }
    textureStore(gathered, pixel.xy, vec4(f32(most)));
}
