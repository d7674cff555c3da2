//! Where a collector listens.

use hyper::Uri;
use hyper::header::{HeaderName, HeaderValue};

/// A collector's address, and what is sent with each request.
#[derive(Debug, Clone)]
pub struct Endpoint {
    /// `HOST:PORT`.
    pub authority: String,
    /// The path before `/v1/metrics`; empty or `/PATH`.
    pub path: String,
    /// Headers of each request; they may hold a secret.
    pub headers: Vec<(HeaderName, HeaderValue)>,
}

impl Endpoint {
    /// Parses `http://HOST[:PORT][/PATH]`; the default port is 4318 (OTLP over HTTP). `headers` has
    /// the format of `OTEL_EXPORTER_OTLP_HEADERS`: `NAME=VALUE` separated by commas, with
    /// percent-encoded values.
    ///
    /// # Errors
    /// Returns a message with the expected format, without any part of a header's value.
    pub fn read(text: &str, headers: &str) -> Result<Endpoint, String> {
        let expected = "expected http://HOST:PORT; for TLS let a collector near by send it on";
        let uri: Uri = text.trim().parse().map_err(|_| expected.to_owned())?;
        if uri.scheme_str() != Some("http") || uri.query().is_some() {
            return Err(expected.into());
        }
        let host = uri.host().filter(|h| !h.is_empty()).ok_or(expected)?;
        let authority = format!("{host}:{}", uri.port_u16().unwrap_or(4318));
        let path = uri.path().trim_end_matches('/').to_owned();
        let one = |pair: &str| {
            let (name, value) = pair.split_once('=')?;
            let value = unescaped(value.trim())?;
            let mut value = HeaderValue::from_bytes(&value).ok()?;
            value.set_sensitive(true);
            Some((name.trim().parse().ok()?, value))
        };
        let pairs = headers.split(',').filter(|p| !p.trim().is_empty());
        let headers: Option<Vec<_>> = pairs.map(one).collect();
        let headers = headers.ok_or("expected headers as NAME=VALUE,NAME=VALUE")?;
        Ok(Endpoint { authority, path, headers })
    }

    /// For people; without the headers.
    pub fn shown(&self) -> String {
        format!("http://{}{}", self.authority, self.path)
    }
}

/// Bytes of a text in which `%` and two hexadecimal digits stand for one.
pub fn unescaped(text: &str) -> Option<Vec<u8>> {
    let mut out = Vec::with_capacity(text.len());
    let mut bytes = text.bytes();
    while let Some(byte) = bytes.next() {
        let mut digit = || char::from(bytes.next()?).to_digit(16).map(|d| d as u8);
        out.push(if byte == b'%' { digit()? << 4 | digit()? } else { byte });
    }
    Some(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_endpoint_is_plain_http_with_the_usual_port() {
        let of = |text| Endpoint::read(text, "").map(|e| e.shown());
        assert_eq!(of("http://localhost"), Ok("http://localhost:4318".into()));
        assert_eq!(of("http://10.0.0.7:80/otlp/"), Ok("http://10.0.0.7:80/otlp".into()));
        assert_eq!(of("http://[::1]:4318"), Ok("http://[::1]:4318".into()));
        for wrong in ["https://a:1", "localhost:4318", "http://", "", "http://a?b", "\u{1}"] {
            assert!(of(wrong).is_err_and(|e| e.contains("http://HOST:PORT")), "{wrong}");
        }
    }

    #[test]
    fn headers_are_read_and_never_shown() {
        let read = Endpoint::read("http://a", "api-key=s%3Dcret, x-team = clay,");
        let headers = read.expect("read").headers;
        assert_eq!((headers.len(), headers[0].1.as_bytes()), (2, &b"s=cret"[..]));
        assert!(!format!("{headers:?}").contains("cret"));
        for wrong in ["secret", "a b=secret", "a=%2", "a=%zz", "a=%0a"] {
            let why = Endpoint::read("http://a", wrong).expect_err(wrong);
            assert!(!why.contains("secret"), "{why}");
        }
    }
}
