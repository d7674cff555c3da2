// Screen-space ambient occlusion: how much of the sky each place of the clay sees, from the depth of
// what is drawn. After McGuire, Mara and Luebke, "Scalable Ambient Obscurance" (2012), at half the
// picture's size, then smoothed across the pattern of its turns, then laid over the picture.
//
// DEPTH stands for the depth's kind, one sample a pixel or several; of several the first is read.

struct Shade {
    // Half the view at depth 1 (perspective) or everywhere (orthographic), near, far.
    lens: vec4<f32>,
    // 1 where there is no perspective; the reach in mesh units; the strength; 0.
    reach: vec4<f32>,
};

@group(0) @binding(0) var<uniform> shade: Shade;
@group(0) @binding(1) var depths: DEPTH;
@group(0) @binding(2) var shades: texture_2d<f32>;

const TURNS: u32 = 11u;
const SAMPLES: i32 = 12;

@vertex
fn whole(@builtin(vertex_index) i: u32) -> @builtin(position) vec4<f32> {
    let corner = vec2<f32>(f32((i << 1u) & 2u), f32(i & 2u));
    return vec4<f32>(corner * 2.0 - 1.0, 0.0, 1.0);
}

// The distance before the eye of a pixel; beyond everything where nothing is drawn.
fn depth_at(p: vec2<i32>) -> f32 {
    let size = vec2<i32>(textureDimensions(depths));
    let d = textureLoad(depths, clamp(p, vec2<i32>(0), size - 1), 0).r;
    if (d >= 1.0) {
        return 1e30;
    }
    let near = shade.lens.z;
    let far = shade.lens.w;
    if (shade.reach.x > 0.5) {
        return near + d * (far - near);
    }
    return near * far / (far - d * (far - near));
}

fn place(p: vec2<i32>, z: f32) -> vec3<f32> {
    let size = vec2<f32>(textureDimensions(depths));
    let ndc = (vec2<f32>(p) + 0.5) / size * 2.0 - 1.0;
    let scale = select(z, 1.0, shade.reach.x > 0.5);
    return vec3<f32>(vec2<f32>(ndc.x, -ndc.y) * shade.lens.xy * scale, -z);
}

// The step to the neighbour on whichever side the surface goes on.
fn slope(p: vec2<i32>, at: vec3<f32>, by: vec2<i32>) -> vec3<f32> {
    let ahead = place(p + by, depth_at(p + by)) - at;
    let behind = at - place(p - by, depth_at(p - by));
    return select(behind, ahead, abs(ahead.z) < abs(behind.z));
}

@fragment
fn gather(@builtin(position) pixel: vec4<f32>) -> @location(0) vec4<f32> {
    let half_pixel = vec2<i32>(pixel.xy);
    let p = half_pixel * 2;
    let z = depth_at(p);
    if (z > 1e29) {
        return vec4<f32>(1.0);
    }
    let at = place(p, z);
    let normal = normalize(cross(slope(p, at, vec2<i32>(0, 1)), slope(p, at, vec2<i32>(1, 0))));
    let size = vec2<f32>(textureDimensions(depths));
    let view = shade.lens.y * 2.0 * select(z, 1.0, shade.reach.x > 0.5);
    // Close to the work the reach follows the view, so that small creases show too.
    let reach = min(shade.reach.y, view * 0.16);
    let disk = reach / view * size.y;
    if (disk < 2.0) {
        return vec4<f32>(1.0);
    }
    // A pattern of sixteen turns that the smoothing runs over.
    let cell = vec2<u32>(half_pixel) & vec2<u32>(3u);
    let turn = f32((cell.x * 5u + cell.y * 11u + cell.x * cell.y * 7u) & 15u) / 16.0 * 6.2831853;
    let square = reach * reach;
    var sum = 0.0;
    for (var i = 0; i < SAMPLES; i++) {
        let along = (f32(i) + 0.5) / f32(SAMPLES);
        let angle = along * f32(TURNS) * 6.2831853 + turn;
        let q = p + vec2<i32>(round(vec2<f32>(cos(angle), sin(angle)) * (along * disk)));
        let qz = depth_at(q);
        if (qz > 1e29) {
            continue;
        }
        let v = place(q, qz) - at;
        let vv = dot(v, v);
        let vn = dot(v, normal) - reach * 0.012;
        let f = max(square - vv, 0.0) / square;
        sum += f * f * max(vn / (vv + square * 0.001), 0.0) * reach;
    }
    let seen = max(1.0 - sum * shade.reach.z * 2.3 / f32(SAMPLES), 0.0);
    return vec4<f32>(seen);
}

@fragment
fn smooth_out(@builtin(position) pixel: vec4<f32>) -> @location(0) vec4<f32> {
    let p = vec2<i32>(pixel.xy);
    let size = vec2<i32>(textureDimensions(shades));
    let z = depth_at(p * 2);
    if (z > 1e29) {
        return vec4<f32>(1.0);
    }
    var sum = 0.0;
    var weight = 0.0;
    for (var y = -2; y < 2; y++) {
        for (var x = -2; x < 2; x++) {
            let q = clamp(p + vec2<i32>(x, y), vec2<i32>(0), size - 1);
            let w = max(1.0 - abs(depth_at(q * 2) - z) / (shade.reach.y * 0.3), 0.0);
            sum += textureLoad(shades, q, 0).r * w;
            weight += w;
        }
    }
    return vec4<f32>(sum / max(weight, 1e-3));
}

@fragment
fn lay(@builtin(position) pixel: vec4<f32>) -> @location(0) vec4<f32> {
    let p = vec2<i32>(pixel.xy);
    let z = depth_at(p);
    if (z > 1e29) {
        return vec4<f32>(1.0);
    }
    let size = vec2<i32>(textureDimensions(shades));
    let low = vec2<i32>(floor((pixel.xy - 1.0) * 0.5));
    let part = (pixel.xy - 1.0) * 0.5 - vec2<f32>(low);
    var sum = 0.0;
    var weight = 0.0;
    for (var y = 0; y < 2; y++) {
        for (var x = 0; x < 2; x++) {
            let q = clamp(low + vec2<i32>(x, y), vec2<i32>(0), size - 1);
            let near = max(1.0 - abs(depth_at(q * 2) - z) / (shade.reach.y * 0.3), 0.0);
            let share = select(1.0 - part, part, vec2<bool>(x == 1, y == 1));
            let w = share.x * share.y * near + 1e-5;
            sum += textureLoad(shades, q, 0).r * w;
            weight += w;
        }
    }
    let seen = sum / weight;
    // What light there is in a hollow has come from the clay: a little of it stays, and it is warm.
    return vec4<f32>(mix(vec3<f32>(0.10, 0.07, 0.07), vec3<f32>(1.0), seen), 1.0);
}
