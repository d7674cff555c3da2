//! Grids as files of NumPy's format 1.0: a header that is a Python literal, then the samples.
//!
//! The array is `[z][y][x]`, single precision, little-endian, C order. Where the samples lie stands
//! in the header as a comment that NumPy ignores: `# origin x y z spacing s`, after the literal.

use std::io::{self, Write};
use std::path::Path;

use glam::DVec3;

use super::{DistanceGrid, MAX_SAMPLES};

const MAGIC: &[u8] = b"\x93NUMPY\x01\x00";

/// The reason why a file is not a grid.
#[derive(Debug, thiserror::Error)]
pub enum NpyError {
    /// The file could not be read.
    #[error("{path}: {source}")]
    Io {
        /// The file.
        path: String,
        /// The system's answer.
        source: io::Error,
    },
    /// The file is no grid of this kind.
    #[error("{path}: expected {expected}")]
    Format {
        /// The file.
        path: String,
        /// The expected format.
        expected: &'static str,
    },
}

impl DistanceGrid {
    /// Writes the grid; [`DistanceGrid::read_npy`] gives it back bit by bit.
    pub fn write_npy(&self, out: &mut dyn Write) -> io::Result<()> {
        let [x, y, z] = self.size;
        let o = self.origin;
        let mut header = format!(
            "{{'descr': '<f4', 'fortran_order': False, 'shape': ({z}, {y}, {x}), }} # origin {:e} \
                {:e} {:e} spacing {:e}",
            o.x, o.y, o.z, self.spacing
        );
        while !(MAGIC.len() + 2 + header.len() + 1).is_multiple_of(64) {
            header.push(' ');
        }
        header.push('\n');
        out.write_all(MAGIC)?;
        out.write_all(&(header.len() as u16).to_le_bytes())?;
        out.write_all(header.as_bytes())?;
        for row in self.values.chunks(4096) {
            let bytes: Vec<u8> = row.iter().flat_map(|v| v.to_le_bytes()).collect();
            out.write_all(&bytes)?;
        }
        Ok(())
    }

    /// Reads what [`DistanceGrid::write_npy`] wrote.
    pub fn read_npy(path: &Path) -> Result<DistanceGrid, NpyError> {
        let name = path.display().to_string();
        let bytes =
            std::fs::read(path).map_err(|source| NpyError::Io { path: name.clone(), source })?;
        parse(&bytes).map_err(|expected| NpyError::Format { path: name, expected })
    }
}

fn parse(bytes: &[u8]) -> Result<DistanceGrid, &'static str> {
    let rest = bytes.strip_prefix(MAGIC).ok_or("a NumPy file of version 1.0")?;
    let (length, rest) = rest.split_first_chunk::<2>().ok_or("a header")?;
    let (header, data) =
        rest.split_at_checked(u16::from_le_bytes(*length) as usize).ok_or("a whole header")?;
    let header = std::str::from_utf8(header).map_err(|_| "a header in ASCII")?;
    if !header.contains("'descr': '<f4'") || !header.contains("'fortran_order': False") {
        return Err("single precision, little-endian, C order");
    }
    let shape =
        header.split_once("'shape': (").and_then(|(_, s)| s.split_once(')')).ok_or("a shape")?.0;
    let shape: Vec<usize> = shape.split(',').filter_map(|n| n.trim().parse().ok()).collect();
    let [z, y, x] = shape[..] else { return Err("three dimensions") };
    let count = x.checked_mul(y).and_then(|n| n.checked_mul(z)).filter(|&n| n <= MAX_SAMPLES);
    if x < 2 || y < 2 || z < 2 || count.and_then(|n| n.checked_mul(4)) != Some(data.len()) {
        return Err("as many samples as the shape says, two or more along each side");
    }
    let place =
        header.split_once("# origin ").ok_or("the grid's place, '# origin x y z spacing s'")?.1;
    let numbers: Vec<f64> = place
        .split_whitespace()
        .filter(|w| *w != "spacing")
        .map_while(|w| w.parse().ok())
        .collect();
    let [ox, oy, oz, spacing] = numbers[..] else {
        return Err("an origin of three numbers and a spacing");
    };
    if !(spacing > 0.0 && spacing.is_finite() && ox.is_finite() && oy.is_finite() && oz.is_finite())
    {
        return Err("a finite origin and a positive spacing");
    }
    let values =
        data.chunks_exact(4).map(|c| f32::from_le_bytes([c[0], c[1], c[2], c[3]])).collect();
    Ok(DistanceGrid { origin: DVec3::new(ox, oy, oz), spacing, size: [x, y, z], values })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_survives_the_file_and_noise_does_not_pass() {
        let values: Vec<f32> = (0..24).map(|i| (i as f32).sin()).collect();
        let grid = DistanceGrid {
            origin: DVec3::new(0.1, -2.5e-7, 3e9),
            spacing: 1.0 / 3.0,
            size: [4, 3, 2],
            values,
        };
        let mut bytes = Vec::new();
        grid.write_npy(&mut bytes).unwrap();
        assert_eq!(parse(&bytes).unwrap(), grid);
        for cut in 0..bytes.len() {
            assert!(parse(&bytes[..cut]).is_err(), "{cut}");
        }
        for at in 0..130 {
            let mut bad = bytes.clone();
            bad[at] ^= 0x15;
            let _ = parse(&bad);
        }
    }
}
