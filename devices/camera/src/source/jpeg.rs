//! One JPEG picture, as a webcam sends it: it may lack its Huffman tables, and it may be cut off.

use zune_jpeg::JpegDecoder;
use zune_jpeg::zune_core::bytestream::ZCursor;
use zune_jpeg::zune_core::colorspace::ColorSpace;
use zune_jpeg::zune_core::options::DecoderOptions;

use crate::picture::{MAX_PIXELS, Picture};

/// Bytes after the end marker that some cameras fill up with.
const PADDING: usize = 4096;

/// Decodes a picture.
///
/// # Errors
/// Returns what is wrong with it.
pub(super) fn decode(bytes: &[u8]) -> Result<Picture, String> {
    let end = bytes.len().saturating_sub(PADDING);
    if !bytes[end..].windows(2).any(|w| w == [0xff, 0xd9]) {
        return Err("it is cut off".into());
    }
    let options = DecoderOptions::default()
        .jpeg_set_out_colorspace(ColorSpace::RGB)
        .set_max_width(16_384)
        .set_max_height(16_384);
    let mut decoder = JpegDecoder::new_with_options(ZCursor::new(bytes), options);
    decoder.decode_headers().map_err(|e| format!("{e:?}"))?;
    let (width, height) = decoder.dimensions().ok_or("it has no size")?;
    if width * height > MAX_PIXELS || width < 2 || height < 2 {
        return Err(format!("{width} by {height} pixels"));
    }
    let rgb = decoder.decode().map_err(|e| format!("{e:?}"))?;
    if rgb.len() != width * height * 3 {
        return Err(format!("{} bytes for {width} by {height} pixels", rgb.len()));
    }
    Ok(Picture { width, height, rgb })
}
