//! Asks what is at the other end of a serial line, and starts its stream of packets.

use std::io::{self, Read, Write};
use std::time::Duration;

use glam::Vec2;

use super::{Protocol, SerialFacts, SerialLayout, isdv4, summa_mm, wacom_iv, wacom_v};
use crate::device_thread::StopToken;

const MM_PER_INCH: f32 = 25.4;
/// Timeout of one read of the line.
const SLICE: Duration = Duration::from_millis(10);
/// Longest wait for an answer.
const PATIENCE: Duration = Duration::from_millis(700);
/// Longest answer that is taken in.
const MAX_REPLY: usize = 64;

/// A serial line, real or not.
pub(crate) trait Wire: Read + Write + Send {
    /// 8 bits, 1 stop bit. A pseudo-terminal may ignore it.
    fn set_line(&mut self, baud: u32, odd_parity: bool) -> io::Result<()>;
    /// Sets the timeout of a read.
    fn set_patience(&mut self, patience: Duration) -> io::Result<()>;
    /// Discards received bytes that were not read.
    fn clear(&mut self) -> io::Result<()>;
}

impl Wire for Box<dyn serialport::SerialPort> {
    fn set_line(&mut self, baud: u32, odd_parity: bool) -> io::Result<()> {
        let parity = if odd_parity { serialport::Parity::Odd } else { serialport::Parity::None };
        self.set_baud_rate(baud)?;
        Ok(self.set_parity(parity)?)
    }
    fn set_patience(&mut self, patience: Duration) -> io::Result<()> {
        Ok(self.set_timeout(patience)?)
    }
    fn clear(&mut self) -> io::Result<()> {
        Ok((**self).clear(serialport::ClearBuffer::Input)?)
    }
}

/// Rule that finds the end of an answer.
#[derive(Debug, Clone, Copy)]
enum End {
    /// This number of bytes from the first with bit 7 set.
    Packet(usize),
    /// A carriage return; some models leave it out, and then silence does.
    Line,
}

/// The order in which protocols are tried on a port whose tablet is not known: the one that answers
/// fastest first, the one with the oddest line last.
pub(crate) const PROBE_ORDER: [Protocol; 4] =
    [Protocol::Isdv4, Protocol::WacomV, Protocol::WacomIv, Protocol::SummaMm];

/// Asks for the tablet's facts and starts its stream. `Ok(None)`: nothing answered in this
/// protocol.
pub(crate) fn open(
    wire: &mut dyn Wire,
    protocol: Protocol,
    fingers: bool,
    stop: &StopToken,
) -> io::Result<Option<SerialFacts>> {
    wire.set_patience(SLICE)?;
    let mut s = Session { wire, stop };
    match protocol {
        Protocol::Isdv4 => s.isdv4(fingers),
        Protocol::WacomIv | Protocol::WacomV => s.wacom(protocol),
        Protocol::SummaMm => s.summa(),
    }
}

struct Session<'a> {
    wire: &'a mut dyn Wire,
    stop: &'a StopToken,
}

impl Session<'_> {
    fn say(&mut self, words: &[u8]) -> io::Result<()> {
        self.wire.write_all(words)?;
        self.wire.flush()
    }

    /// Waits, then throws away what came meanwhile.
    fn settle(&mut self, ms: u64) -> io::Result<()> {
        if self.stop.wait(Duration::from_millis(ms)) {
            return Err(io::Error::new(io::ErrorKind::Interrupted, "stopped"));
        }
        self.wire.clear()
    }

    fn ask(&mut self, question: &[u8], end: End) -> io::Result<Vec<u8>> {
        self.say(question)?;
        let (mut reply, mut buffer) = (Vec::new(), [0; MAX_REPLY]);
        for _ in 0..PATIENCE.as_millis() / SLICE.as_millis() {
            if self.stop.stopped() {
                return Err(io::Error::new(io::ErrorKind::Interrupted, "stopped"));
            }
            match self.wire.read(&mut buffer) {
                Ok(0) => return Err(io::ErrorKind::BrokenPipe.into()),
                Ok(n) => reply.extend_from_slice(&buffer[..n]),
                Err(e)
                    if matches!(e.kind(), io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock) => {}
                Err(e) => return Err(e),
            }
            match end {
                End::Packet(length) => {
                    let start = reply.iter().position(|b| b & 0x80 != 0).unwrap_or(reply.len());
                    reply.drain(..start);
                    if reply.len() >= length {
                        break;
                    }
                }
                End::Line if reply.contains(&b'\r') => break,
                End::Line => {}
            }
            if reply.len() > MAX_REPLY {
                break;
            }
        }
        Ok(reply)
    }

    /// Two speeds: 38400 for those with touch and most others, 19200 for the first ones.
    fn isdv4(&mut self, fingers: bool) -> io::Result<Option<SerialFacts>> {
        for baud in [38400, 19200] {
            self.wire.set_line(baud, false)?;
            self.say(b"0")?;
            self.settle(250)?;
            let reply = self.ask(b"*", End::Packet(isdv4::CONTROL_LENGTH))?;
            let Some(query) = isdv4::Isdv4Query::parse(&reply) else { continue };
            let touch =
                isdv4::TouchQuery::parse(&self.ask(b"%", End::Packet(isdv4::CONTROL_LENGTH))?);
            self.say(b"1")?;
            let area = query.max.map(|m| m as f32 / isdv4::PER_MM);
            return Ok(Some(SerialFacts {
                model: format!("ISDV4 tablet, version {}", query.version),
                max: query.max,
                area_mm: Vec2::from(area),
                max_pressure: query.max_pressure,
                layout: SerialLayout::Isdv4(isdv4::Isdv4Layout::new(query, touch, fingers)),
            }));
        }
        Ok(None)
    }

    fn wacom(&mut self, protocol: Protocol) -> io::Result<Option<SerialFacts>> {
        self.wire.set_line(9600, false)?;
        self.say(b"\r#")?;
        self.settle(100)?;
        let reply = self.ask(b"~#", End::Line)?;
        let Some(model) = answer(&reply, "~#") else { return Ok(None) };
        let five = ["GD", "XD"].iter().any(|p| model.starts_with(p));
        if five != (protocol == Protocol::WacomV) {
            return Ok(None);
        }
        let Some(max) = self.maxima(&model)? else { return Ok(None) };
        if five {
            self.wacom_v(&model, max).map(Some)
        } else {
            self.wacom_iv(&model, max).map(Some)
        }
    }

    fn maxima(&mut self, model: &str) -> io::Result<Option<[i32; 2]>> {
        let reply = self.ask(b"~C\r", End::Line)?;
        let numbers = answer(&reply, "~C").map(|a| numbers(&a)).unwrap_or_default();
        Ok(match numbers[..] {
            [x, y, ..] if x > 0 && y > 0 => Some([x, y]),
            // A serial Graphire does not answer this; it comes in one size.
            _ if model.starts_with("ET") => Some([5103, 3711]),
            _ => None,
        })
    }

    fn wacom_iv(&mut self, model: &str, max: [i32; 2]) -> io::Result<SerialFacts> {
        let stated =
            answer(&self.ask(b"~R\r", End::Line)?, "~R").map(|a| numbers(&a)).unwrap_or_default();
        // The answer holds a hexadecimal word, two figures, and then the resolution in lines an
        // inch.
        let usual = if model.starts_with("PL") || model.starts_with("DT") { 508 } else { 1000 };
        let per_inch = |i: usize| stated.get(i).copied().filter(|r| *r > 0).unwrap_or(usual) as f32;
        let layout = wacom_iv::WacomIvLayout::new(model, version(model), max);
        match &model[..model.len().min(2)] {
            "CT" => self.say(b"PH1\rST\r")?,
            "PL" | "DT" => self.say(b"OC1\rIT0\rSR\rST\r")?,
            _ => {
                self.say(b"MU1\rOC1\r~M0\r~M1\rIT0\rIN0\rSR\rZF1\r")?;
                if layout.tilt {
                    self.say(b"FM1\r")?;
                }
                self.say(b"ST\r")?;
            }
        }
        Ok(SerialFacts {
            model: format!("Wacom {model}"),
            max,
            area_mm: Vec2::new(max[0] as f32 / per_inch(3), max[1] as f32 / per_inch(4))
                * MM_PER_INCH,
            max_pressure: layout.max_pressure(),
            layout: SerialLayout::WacomIv(layout),
        })
    }

    fn wacom_v(&mut self, model: &str, max: [i32; 2]) -> io::Result<SerialFacts> {
        self.say(b"BA38\r")?;
        self.settle(50)?;
        self.wire.set_line(38400, false)?;
        self.say(b"MT1\rID1\rIT0\rST\r")?;
        Ok(SerialFacts {
            model: format!("Wacom {model}"),
            max,
            // All of them have 2540 lines an inch: 100 a mm.
            area_mm: Vec2::new(max[0] as f32, max[1] as f32) / 100.0,
            max_pressure: wacom_v::MAX_PRESSURE,
            layout: SerialLayout::WacomV(wacom_v::WacomVLayout::new(max)),
        })
    }

    fn summa(&mut self) -> io::Result<Option<SerialFacts>> {
        self.wire.set_line(9600, true)?;
        // A break would reset it; a NUL makes it find the speed.
        self.say(&[0])?;
        self.settle(200)?;
        self.say(b"B")?;
        let reply = self.ask(b"z?", End::Line)?;
        let id: String =
            reply.iter().map(|b| char::from(b & 0x7f)).filter(|c| c.is_ascii_graphic()).collect();
        let reply = self.ask(b"ha", End::Packet(summa_mm::LENGTH))?;
        if reply.len() < summa_mm::LENGTH {
            return Ok(None);
        }
        let max = summa_mm::place(&reply);
        if max.iter().any(|m| *m <= 0) {
            return Ok(None);
        }
        // Absolute, first tablet, origin at the top, binary, streaming.
        self.say(b"F0bzb@")?;
        let mm = |counts: i32| counts as f32 / summa_mm::PER_INCH * MM_PER_INCH;
        Ok(Some(SerialFacts {
            model: format!("SummaSketch {id}"),
            max,
            area_mm: Vec2::new(mm(max[0]), mm(max[1])),
            max_pressure: 0,
            layout: SerialLayout::SummaMm,
        }))
    }
}

/// The text after a question's echo, if the reply holds one.
fn answer(reply: &[u8], echo: &str) -> Option<String> {
    let text: String = reply.iter().map(|b| char::from(b & 0x7f)).collect();
    let text = text.split_once(echo)?.1.split('\r').next().unwrap_or_default().trim();
    (!text.is_empty()).then(|| text.to_owned())
}

/// Decimal numbers between commas; what is none counts as 0.
fn numbers(text: &str) -> Vec<i32> {
    text.split(',').map(|n| n.trim().parse().unwrap_or(0)).collect()
}

/// `V1.3` somewhere in a model's name.
fn version(model: &str) -> (u32, u32) {
    let digits = |t: &str| {
        t.chars().take_while(char::is_ascii_digit).collect::<String>().parse().unwrap_or(0)
    };
    let Some((_, tail)) = model.rsplit_once('V') else { return (0, 0) };
    (digits(tail), tail.split_once('.').map_or(0, |(_, minor)| digits(minor)))
}

#[cfg(test)]
#[path = "session_tests.rs"]
mod tests;
