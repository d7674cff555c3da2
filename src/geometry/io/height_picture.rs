//! Pictures of heights in, from whatever format the picture has, and out: brightness and opacity in
//! 16 bits.

use image::{ImageBuffer, ImageFormat, ImageReader, Luma, LumaA};

/// A picture of heights, rows from the top, each from the left.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct HeightPicture {
    /// Pixels.
    pub width: u32,
    /// Pixels.
    pub height: u32,
    /// Brightness and opacity, each 0 to 65535; `width * height` pairs.
    pub pixels: Vec<[u16; 2]>,
}

/// Reads PNG, and with the feature `pictures` JPEG, WebP, TIFF and OpenEXR; 8 or 16 bits or float.
/// Colours become their brightness. `most`: pixels at most; the size is looked at before anything
/// of that size is made.
///
/// # Errors
/// Says what is wrong: not a picture, too large, damaged.
pub fn read_height_picture(bytes: &[u8], most: u64) -> Result<HeightPicture, String> {
    let reader = ImageReader::new(std::io::Cursor::new(bytes))
        .with_guessed_format()
        .map_err(|e| format!("not a picture: {e}"))?;
    let (width, height) = reader.into_dimensions().map_err(|e| format!("not a picture: {e}"))?;
    if u64::from(width) * u64::from(height) > most {
        return Err(format!("{width} x {height} pixels; at most {most} are taken"));
    }
    let image = image::load_from_memory(bytes).map_err(|e| e.to_string())?.into_luma_alpha16();
    let pixels = image.pixels().map(|p| p.0).collect();
    Ok(HeightPicture { width, height, pixels })
}

/// Encodes a PNG of 16 bits: of brightness alone if all pixels are opaque, else with opacity.
///
/// # Errors
/// Returns an error if the number of pixels does not match the size, or is 0.
pub fn write_height_picture(picture: &HeightPicture) -> Result<Vec<u8>, String> {
    let HeightPicture { width, height, pixels } = picture;
    let wrong = || format!("{} pixels are not {width} x {height}", pixels.len());
    let mut bytes = std::io::Cursor::new(Vec::new());
    let written = if pixels.iter().all(|p| p[1] == u16::MAX) {
        let luma = pixels.iter().map(|p| p[0]).collect();
        let image = ImageBuffer::<Luma<u16>, Vec<u16>>::from_raw(*width, *height, luma);
        image.ok_or_else(wrong)?.write_to(&mut bytes, ImageFormat::Png)
    } else {
        let both = pixels.iter().flatten().copied().collect();
        let image = ImageBuffer::<LumaA<u16>, Vec<u16>>::from_raw(*width, *height, both);
        image.ok_or_else(wrong)?.write_to(&mut bytes, ImageFormat::Png)
    };
    written.map_err(|e| e.to_string())?;
    Ok(bytes.into_inner())
}
