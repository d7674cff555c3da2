// The clay, lit from the eye's own frame so that form reads from every side, and the lines that lie
// over it.

// A part of a stroke that is shown before it is made.
struct LedDab {
    // xyz: where it begins; w: the radius.
    start: vec4<f32>,
    // xyz: where it ends.
    end: vec4<f32>,
    // xyz: what it adds in its middle; w: -1 where that leads into the clay, else 1.
    by: vec4<f32>,
};

struct Frame {
    view_projection: mat4x4<f32>,
    // Rows of the view's rotation: right, up, backward. The w of the first is 1 where colours come
    // from the vertices.
    right: vec4<f32>,
    up: vec4<f32>,
    back: vec4<f32>,
    // xyz: the brush's place; w: its radius, 0 for none.
    brush: vec4<f32>,
    // xyz: the material's colour; w: 1 for facets.
    base: vec4<f32>,
    // Highlight's strength and exponent, light at the rim, strength of cavities.
    finish: vec4<f32>,
    // A map's lowest value, one over its span, which (0 none, 1 mask, 2 values, 3 overhang,
    // 4 draft), and how much nearer lines are.
    map: vec4<f32>,
    scale: array<vec4<f32>, 8>,
    // The ground's lower and upper colour.
    low: vec4<f32>,
    high: vec4<f32>,
    // What lights the clay (0 the studio, 1 a picture of a ball, 2 what is around), how far that is
    // turned about the upright axis, how bright it is, and 1 for metal.
    light: vec4<f32>,
    // The reference picture's width and height as shares of the view, and how dense it is.
    backdrop: vec4<f32>,
    // xyz: towards the studio's main light, in the frame of the view; w: how much of it a shadow
    // takes.
    main_light: vec4<f32>,
    // From a place to that light's own picture of depths.
    shadow: mat4x4<f32>,
    // Of a map of angles. xyz: the build direction, or the one in which a mould opens; w: the sine
    // of the limit, as the check compares with it.
    angle_up: vec4<f32>,
    // Up to this height a face is on the plate; the limit and the end of the scale, radians.
    angle_ends: vec4<f32>,
    // xyz: towards what a plane cuts off; w: how far along that the plane is. Zeros: none.
    cut: vec4<f32>,
    led: array<LedDab, 8>,
    // The falloff's values at even steps from the middle to the rim.
    profile: array<vec4<f32>, 3>,
    // x: how many are led.
    led_count: vec4<u32>,
};

@group(0) @binding(0) var<uniform> frame: Frame;
@group(1) @binding(0) var ball: texture_2d<f32>;
@group(1) @binding(1) var diffuse_around: texture_2d<f32>;
@group(1) @binding(2) var glossy_around: texture_2d<f32>;
@group(1) @binding(3) var smooth_reads: sampler;
@group(1) @binding(4) var reference: texture_2d<f32>;
@group(1) @binding(5) var lit_depths: texture_depth_2d;
@group(1) @binding(6) var depth_reads: sampler_comparison;

struct Corner {
    @builtin(position) clip: vec4<f32>,
    @location(0) normal: vec3<f32>,
    @location(1) colour: vec4<f32>,
    @location(2) place: vec3<f32>,
    @location(3) masked: f32,
    @location(4) value: f32,
    @location(5) known: f32,
};

fn profile_at(i: u32) -> f32 {
    let j = min(i, 11u);
    return frame.profile[j / 4u][j % 4u];
}

// The falloff at so many steps from the middle, and its slope by a step; the slope is even between
// the values, or facets would be seen.
fn fall(step: f32) -> vec2<f32> {
    let j = min(u32(step), 10u);
    let at = step - f32(j);
    let a = profile_at(j);
    let b = profile_at(j + 1u);
    let before = profile_at(select(j - 1u, 1u, j == 0u));
    let after = select(profile_at(j + 2u), 0.0, j + 2u > 11u);
    return vec2<f32>(mix(a, b, at), mix(b - before, after - a, at) * 0.5);
}

struct Surface {
    place: vec3<f32>,
    normal: vec3<f32>,
};

// A vertex with what the pens will have added to it. Each way counts as four dabs along it. The
// normal follows from how fast that falls off.
fn led(place: vec3<f32>, normal: vec4<f32>) -> Surface {
    var out = Surface(place, normal.xyz);
    for (var i = 0u; i < frame.led_count.x; i++) {
        let dab = frame.led[i];
        let height = length(dab.by.xyz);
        let up = dab.by.xyz / max(height, 1e-30);
        let side = clamp((dot(normal.xyz, up) * dab.by.w + 0.5) * 2.0, 0.0, 1.0);
        let share = 0.25 * side * (1.0 - normal.w);
        for (var k = 0u; k < 4u; k++) {
            let centre = mix(dab.start.xyz, dab.end.xyz, (f32(k) + 0.5) * 0.25);
            let away = place - centre;
            // As on the surface that the stroke found, whatever it has raised since.
            let flat = away - up * dot(away, up);
            let x = length(flat) / dab.start.w;
            if (x >= 1.0 || dot(away, away) > 4.0 * dab.start.w * dab.start.w) {
                continue;
            }
            let there = fall(x * 11.0);
            out.place += dab.by.xyz * (share * there.x);
            // Where the surface is steep already, it becomes less so by as much.
            let rise = height * share * dab.by.w * max(dot(normal.xyz, up) * dab.by.w, 0.1);
            let slope = there.y * 11.0 / dab.start.w * rise;
            out.normal -= flat / max(length(flat), 1e-30) * slope;
        }
    }
    return out;
}

@vertex
fn clay_vertex(
    @location(0) at: vec3<f32>,
    @location(1) normal: vec4<f32>,
    @location(2) colour: vec4<f32>,
    @location(3) value: f32,
) -> Corner {
    let moved = led(at, normal);
    return corner(moved.place, vec4<f32>(moved.normal, normal.w), colour, value);
}

// What lies over the clay is not led.
@vertex
fn overlay_vertex(
    @location(0) place: vec3<f32>,
    @location(1) normal: vec4<f32>,
    @location(2) colour: vec4<f32>,
    @location(3) value: f32,
) -> Corner {
    return corner(place, normal, colour, value);
}

// A form that the clay hides: its outline, and hardly its middle.
@vertex
fn ghost_vertex(
    @location(0) place: vec3<f32>,
    @location(1) normal: vec4<f32>,
    @location(2) colour: vec4<f32>,
    @location(3) value: f32,
) -> Corner {
    return corner(place, normal, colour, value);
}

@fragment
fn ghost_fragment(in: Corner) -> @location(0) vec4<f32> {
    let n = normalize(in.normal);
    let edge = pow(1.0 - clamp(dot(n, frame.back.xyz), 0.0, 1.0), 3.0);
    return vec4<f32>(in.colour.rgb, in.colour.a * (0.12 + 0.88 * edge));
}

fn corner(place: vec3<f32>, normal: vec4<f32>, colour: vec4<f32>, value: f32) -> Corner {
    var out: Corner;
    out.clip = frame.view_projection * vec4<f32>(place, 1.0);
    out.normal = normal.xyz;
    out.masked = normal.w;
    out.colour = colour;
    out.place = place;
    // A value that is not a number is not known; it would spread over the triangle.
    let bits = bitcast<u32>(value) & 0x7fffffffu;
    let known = bits < 0x7f800000u;
    out.value = select(0.0, value, known);
    out.known = select(0.0, 1.0, known);
    return out;
}

// For the main light's picture of depths.
@vertex
fn shadow_vertex(
    @location(0) at: vec3<f32>,
    @location(1) normal: vec4<f32>,
) -> @builtin(position) vec4<f32> {
    return frame.shadow * vec4<f32>(led(at, normal).place, 1.0);
}

fn scaled(value: f32) -> vec3<f32> {
    let at = clamp((value - frame.map.x) * frame.map.y, 0.0, 1.0) * 7.0;
    let i = min(u32(at), 6u);
    if (frame.scale[0].a < 0.5) {
        return frame.scale[min(u32(at * 8.0 / 7.0), 7u)].rgb;
    }
    return mix(frame.scale[i].rgb, frame.scale[i + 1u].rgb, at - f32(i));
}

// The colour of a face by its angle. The scale has two halves, below the limit and above it, and a
// step between them: a face is never between the two.
fn by_angle(n: vec3<f32>, place: vec3<f32>) -> vec3<f32> {
    let rise = dot(n, frame.angle_up.xyz);
    let overhang = frame.map.z < 3.5;
    if (overhang && dot(place, frame.angle_up.xyz) <= frame.angle_ends.x) {
        return frame.scale[0].rgb;
    }
    let sine = clamp(select(abs(rise), -rise, overhang), -1.0, 1.0);
    let angle = asin(sine);
    let limit = frame.angle_ends.y;
    let above = select(sine >= frame.angle_up.w, sine > frame.angle_up.w, overhang);
    let below_share = angle / max(limit, 1e-6);
    let above_share = (angle - limit) / max(frame.angle_ends.z - limit, 1e-6);
    let at = clamp(select(below_share, above_share, above), 0.0, 1.0) * 3.0;
    let step = min(u32(at), 2u);
    let i = step + select(0u, 4u, above);
    return mix(frame.scale[i].rgb, frame.scale[i + 1u].rgb, at - f32(step));
}

// Two soft lights, a rim and a sky, in the frame of the view; `reaches`: the share of the main light
// that nothing stands in.
fn lit(n: vec3<f32>, base: vec3<f32>, reaches: f32) -> vec3<f32> {
    let main_light = frame.main_light.xyz;
    let key = max(dot(n, main_light), 0.0) * reaches;
    let fill = max(dot(n, normalize(vec3<f32>(0.8, -0.1, 0.45))), 0.0);
    let sky = 0.5 + 0.5 * n.y;
    let rim = pow(1.0 - clamp(n.z, 0.0, 1.0), 3.0);
    // A light straight behind the clay has no way half to the eye.
    let half_way = normalize(main_light + vec3<f32>(0.0, 0.0, 1.001));
    let shine = pow(max(dot(n, half_way), 0.0), frame.finish.y) * frame.finish.x * reaches;
    let warm = vec3<f32>(1.0, 0.95, 0.88) * key * 0.85;
    let cool = vec3<f32>(0.55, 0.68, 0.95) * fill * 0.28;
    let ambient = mix(vec3<f32>(0.13, 0.11, 0.11), vec3<f32>(0.26, 0.29, 0.34), sky);
    let edge = vec3<f32>(0.35, 0.42, 0.5) * rim * frame.finish.z;
    return base * (warm + cool + ambient) + vec3<f32>(shine) + edge;
}

// Where a direction of the view lies in a picture of what is around.
fn around(d: vec3<f32>) -> vec2<f32> {
    let turned = atan2(d.x, d.z) + frame.light.y;
    return vec2<f32>(turned * 0.15915494 + 0.5, acos(clamp(d.y, -1.0, 1.0)) * 0.31830989);
}

// What is mirrored, by Schlick's fresnel (1994); a rougher surface reads a smaller picture.
fn mirrored(n: vec3<f32>, at_front: vec3<f32>) -> vec3<f32> {
    let facing = clamp(n.z, 0.0, 1.0);
    let back = vec3<f32>(2.0 * n.z * n.xy, 2.0 * n.z * n.z - 1.0);
    let rough = sqrt(2.0 / (frame.finish.y + 2.0));
    let seen = textureSampleLevel(glossy_around, smooth_reads, around(back), rough * 9.0).rgb;
    return seen * (at_front + (vec3<f32>(1.0) - at_front) * pow(1.0 - facing, 5.0));
}

// The share of the main light that reaches a place: the mean of sixteen looks into the picture of
// depths, each of which weighs four texels. What lies beside the picture is lit.
fn reached(place: vec3<f32>) -> f32 {
    let at = (frame.shadow * vec4<f32>(place, 1.0)).xyz;
    let middle = vec2<f32>(at.x, -at.y) * 0.5 + vec2<f32>(0.5);
    if (any(middle < vec2<f32>(0.0)) || any(middle > vec2<f32>(1.0))) {
        return 1.0;
    }
    let texel = 1.0 / f32(textureDimensions(lit_depths).x);
    var sum = 0.0;
    for (var i = 0u; i < 16u; i++) {
        let by = vec2<f32>(f32(i % 4u), f32(i / 4u)) - vec2<f32>(1.5);
        sum += textureSampleCompareLevel(lit_depths, depth_reads, middle + by * texel, at.z);
    }
    return 1.0 - frame.main_light.w * (1.0 - sum / 16.0);
}

// By what the person chose.
fn shaded(n: vec3<f32>, base: vec3<f32>, place: vec3<f32>) -> vec3<f32> {
    if (frame.light.x > 1.5) {
        let soft = textureSampleLevel(diffuse_around, smooth_reads, around(n), 0.0).rgb;
        let scattered = base * soft * (1.0 - frame.light.w);
        let shine = mix(vec3<f32>(0.04 + 0.1 * frame.finish.x), base, frame.light.w);
        return (scattered + mirrored(n, shine)) * frame.light.z;
    }
    if (frame.light.x > 0.5) {
        // The normals that the eye sees fill the disc of the ball.
        let at = vec2<f32>(n.x, -n.y) * 0.485 + vec2<f32>(0.5);
        return textureSampleLevel(ball, smooth_reads, at, 0.0).rgb * base;
    }
    var reaches = 1.0;
    // What turns away from the light lies in its own shadow: no highlight is left there.
    if (frame.main_light.w > 0.0) {
        reaches = reached(place);
    }
    if (frame.light.w > 0.5) {
        return mirrored(n, base) * (0.4 + 0.6 * reaches) + lit(n, base, reaches) * 0.15;
    }
    return lit(n, base, reaches);
}

// A plane cuts this place off.
fn is_cut_off(place: vec3<f32>) -> bool {
    return dot(place, frame.cut.xyz) > frame.cut.w;
}

@fragment
fn clay_fragment(in: Corner, @builtin(front_facing) front: bool) -> @location(0) vec4<f32> {
    // How the surface bends across the screen: how fast the normal turns along either axis.
    let bend = dot(dpdx(in.normal), frame.right.xyz) - dot(dpdy(in.normal), frame.up.xyz);
    let facet = cross(dpdy(in.place), dpdx(in.place));
    if (is_cut_off(in.place)) {
        discard;
    }
    if (!front && dot(frame.cut.xyz, frame.cut.xyz) > 0.0) {
        // The inside of a closed form, through the cut: as if it were solid, and hatched.
        let stripe = step(0.5, fract((in.clip.x + in.clip.y) / 9.0));
        return vec4<f32>(mix(vec3<f32>(0.43, 0.19, 0.08), vec3<f32>(0.54, 0.25, 0.11), stripe), 1.0);
    }
    var n = normalize(in.normal);
    if (frame.base.w > 0.5 && dot(facet, facet) > 0.0) {
        n = normalize(facet);
        // Derivatives know no front: the corners' normals do.
        n = select(n, -n, dot(n, in.normal) < 0.0);
    }
    var view = vec3<f32>(dot(n, frame.right.xyz), dot(n, frame.up.xyz), dot(n, frame.back.xyz));
    var base = frame.base.xyz * mix(vec3<f32>(1.0), in.colour.rgb, frame.right.w);
    if (frame.right.w < 0.5) {
        base = base * in.colour.rgb;
    }
    if (!front) {
        view = -view;
        base = vec3<f32>(0.28, 0.30, 0.36);
    }
    var held = in.masked;
    if (frame.map.z > 0.5) {
        held = 0.0;
        base = vec3<f32>(0.22, 0.24, 0.28);
        if (frame.map.z < 1.5) {
            base = scaled(in.masked);
        } else if (frame.map.z > 2.5) {
            // Of the triangle itself, as in the check: corners of few triangles have normals that
            // no face has.
            let sharp = dot(facet, facet) > 0.0;
            let own = select(normalize(in.normal), normalize(facet), sharp);
            if (front) {
                base = by_angle(select(own, -own, dot(own, in.normal) < 0.0), in.place);
            }
        } else if (in.known > 0.02) {
            // Corners without a value take no part: the value follows from the others.
            base = scaled(in.value / in.known);
        }
        base *= 0.8;
    }
    var colour = shaded(view, mix(base, base * 0.35, held), in.place);
    colour *= 1.0 + clamp(bend * 4.0, -0.4, 0.4) * frame.finish.w;
    // The falloff inside the brush: strongest in the middle.
    if (frame.brush.w > 0.0) {
        let x = distance(in.place, frame.brush.xyz) / frame.brush.w;
        let width = max(fwidth(x), 1e-4);
        if (x < 1.0) {
            colour += vec3<f32>(0.07, 0.085, 0.10) * exp(-x * x * 12.5);
            // Where the bell is at half its height.
            let ring = 1.0 - smoothstep(0.0, 1.5 * width, abs(x - 0.2355));
            colour += vec3<f32>(0.10, 0.11, 0.12) * ring;
        }
    }
    return vec4<f32>(colour, 1.0);
}

// What is not of the work: its own colour, and the work through it; denser towards its outline.
@fragment
fn overlay_fragment(in: Corner) -> @location(0) vec4<f32> {
    let n = normalize(in.normal);
    let view = vec3<f32>(dot(n, frame.right.xyz), dot(n, frame.up.xyz), dot(n, frame.back.xyz));
    let edge = pow(1.0 - clamp(view.z, 0.0, 1.0), 2.0);
    return vec4<f32>(lit(view, in.colour.rgb, 1.0), mix(in.colour.a, 1.0, edge * 0.6));
}

struct LineCorner {
    @builtin(position) clip: vec4<f32>,
    @location(0) colour: vec4<f32>,
    @location(1) place: vec3<f32>,
};

fn line_corner(place: vec3<f32>, colour: vec4<f32>) -> LineCorner {
    var out: LineCorner;
    out.clip = frame.view_projection * vec4<f32>(place, 1.0);
    // A hair nearer, so that a line on the surface is not eaten by it.
    out.clip.z -= frame.map.w;
    out.colour = colour;
    out.place = place;
    return out;
}

@vertex
fn line_vertex(@location(0) place: vec3<f32>, @location(1) colour: vec4<f32>) -> LineCorner {
    return line_corner(place, colour);
}

@fragment
fn line_fragment(in: LineCorner) -> @location(0) vec4<f32> {
    return in.colour;
}

// What of a line is behind something, where it is seen through that at all.
@vertex
fn behind_vertex(
    @location(0) place: vec3<f32>,
    @location(1) colour: vec4<f32>,
    @location(2) through: f32,
) -> LineCorner {
    var out = line_corner(place, colour);
    out.colour.a *= through;
    return out;
}

@fragment
fn behind_fragment(in: LineCorner) -> @location(0) vec4<f32> {
    return in.colour;
}

@vertex
fn edge_vertex(
    @location(0) at: vec3<f32>,
    @location(1) normal: vec4<f32>,
) -> LineCorner {
    var out: LineCorner;
    let place = led(at, normal).place;
    out.clip = frame.view_projection * vec4<f32>(place, 1.0);
    out.clip.z -= 0.5 * frame.map.w;
    out.place = place;
    out.colour = vec4<f32>(0.0, 0.0, 0.0, 0.3);
    return out;
}

@fragment
fn edge_fragment(in: LineCorner) -> @location(0) vec4<f32> {
    if (is_cut_off(in.place)) {
        discard;
    }
    return in.colour;
}

struct Sky {
    @builtin(position) clip: vec4<f32>,
    @location(0) place: vec2<f32>,
};

@vertex
fn sky_vertex(@builtin(vertex_index) i: u32) -> Sky {
    let corner = vec2<f32>(f32((i << 1u) & 2u), f32(i & 2u));
    var out: Sky;
    out.clip = vec4<f32>(corner * 2.0 - 1.0, 1.0, 1.0);
    out.place = corner;
    return out;
}

@fragment
fn sky_fragment(in: Sky) -> @location(0) vec4<f32> {
    let ground = mix(frame.low.rgb, frame.high.rgb, in.place.y);
    let at = (in.place - vec2<f32>(0.5)) / max(frame.backdrop.xy, vec2<f32>(1e-6));
    if (frame.backdrop.z <= 0.0 || max(abs(at.x), abs(at.y)) > 0.5) {
        return vec4<f32>(ground, 1.0);
    }
    let shown = textureSampleLevel(reference, smooth_reads, vec2<f32>(at.x, -at.y) + 0.5, 0.0);
    return vec4<f32>(mix(ground, shown.rgb, shown.a * frame.backdrop.z), 1.0);
}
