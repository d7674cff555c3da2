//! QR codes of links, for screens.

/// A QR code (ISO/IEC 18004), as squares.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Code {
    /// Squares a side, the quiet border not counted.
    pub side: usize,
    /// Row by row; true is dark.
    pub dark: Vec<bool>,
}

impl Code {
    /// `None` for a text that no code holds.
    pub fn of(text: &str) -> Option<Code> {
        let code = qrcodegen::QrCode::encode_text(text, qrcodegen::QrCodeEcc::Medium).ok()?;
        let side = code.size();
        let dark = (0..side)
            .flat_map(|y| (0..side).map(move |x| (x, y)))
            .map(|(x, y)| code.get_module(x, y));
        Some(Code { side: side as usize, dark: dark.collect() })
    }
}

/// A link by which guests join, and its code.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Invitation {
    pub url: String,
    pub code: Code,
}
