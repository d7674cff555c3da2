//! Lists of sentences across the boundary: the ledger of a file, the warnings of a measurement.

use std::ffi::{CString, c_char};

use crate::boundary::{optional, take_back};

/// Sentences for people, one fact each. It never changes.
#[derive(Debug)]
pub struct SculptdSentences {
    all: Vec<CString>,
}

impl SculptdSentences {
    pub(crate) fn new(texts: &[String]) -> SculptdSentences {
        let text = |t: &String| CString::new(t.replace('\0', " ")).unwrap_or_default();
        SculptdSentences { all: texts.iter().map(text).collect() }
    }
}

/// Returns the number of sentences; 0 for null.
///
/// # Safety
/// `sentences` is null or came from this library and was not freed.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_sentences_count(sentences: *const SculptdSentences) -> usize {
    // SAFETY: as this function's caller promises.
    unsafe { optional(sentences) }.map_or(0, |s| s.all.len())
}

/// Returns a sentence, which lives as long as the list; null beyond the last one, and for a null
/// list.
///
/// # Safety
/// As sculptd_sentences_count().
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_sentences_get(
    sentences: *const SculptdSentences,
    index: usize,
) -> *const c_char {
    // SAFETY: as this function's caller promises.
    let sentence = unsafe { optional(sentences) }.and_then(|s| s.all.get(index));
    sentence.map_or(std::ptr::null(), |s| s.as_ptr())
}

/// Frees a list of sentences; null is good.
///
/// # Safety
/// `sentences` is null or came from this library, and is not used any more.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn sculptd_sentences_free(sentences: *mut SculptdSentences) {
    // SAFETY: as this function's caller promises.
    unsafe { take_back(sentences) }
}
