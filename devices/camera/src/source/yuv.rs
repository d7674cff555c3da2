//! Brightness and colour difference to red, green and blue (BT.601, as webcams and Y4M have it).

use crate::picture::Picture;

#[inline]
fn rgb(y: u8, u: u8, v: u8, full: bool) -> [u8; 3] {
    let (y, u, v) = (f32::from(y), f32::from(u) - 128.0, f32::from(v) - 128.0);
    let y = if full { y } else { (y - 16.0) * (255.0 / 219.0) };
    let colour = if full { 1.0 } else { 255.0 / 224.0 };
    let (u, v) = (u * colour, v * colour);
    [y + 1.402 * v, y - 0.344_136 * u - 0.714_136 * v, y + 1.772 * u]
        .map(|c| c.round().clamp(0.0, 255.0) as u8)
}

/// Two pixels in four bytes: Y U Y V.
pub(super) fn of_yuyv(bytes: &[u8], width: usize, height: usize) -> Result<Picture, String> {
    let row = width / 2 * 4;
    if width < 2 || bytes.len() < row * height {
        return Err(format!("{} bytes for {width} by {height} pixels", bytes.len()));
    }
    let width = width / 2 * 2;
    let mut out = Vec::with_capacity(width * height * 3);
    for pair in bytes[..row * height].as_chunks::<4>().0 {
        out.extend(rgb(pair[0], pair[1], pair[3], false));
        out.extend(rgb(pair[2], pair[1], pair[3], false));
    }
    Ok(Picture { width, height, rgb: out })
}

/// Brightness alone.
pub(super) fn of_grey(bytes: &[u8], width: usize, height: usize) -> Result<Picture, String> {
    if width == 0 || bytes.len() < width * height {
        return Err(format!("{} bytes for {width} by {height} pixels", bytes.len()));
    }
    let rgb = bytes[..width * height].iter().flat_map(|y| [*y; 3]).collect();
    Ok(Picture { width, height, rgb })
}

/// Planes of brightness and two colour differences; the latter cover `step` pixels each way.
pub(super) fn of_planes(
    planes: [&[u8]; 3],
    (width, height): (usize, usize),
    step: (usize, usize),
    full: bool,
) -> Picture {
    let across = width.div_ceil(step.0);
    let mut out = Vec::with_capacity(width * height * 3);
    for y in 0..height {
        for x in 0..width {
            let colour = y / step.1 * across + x / step.0;
            let of = |plane: &[u8]| plane.get(colour).copied().unwrap_or(128);
            let light = planes[0].get(y * width + x).copied().unwrap_or(0);
            out.extend(rgb(light, of(planes[1]), of(planes[2]), full));
        }
    }
    Picture { width, height, rgb: out }
}
