use std::collections::VecDeque;

use super::*;

/// A line that answers by a table, at one speed only.
struct Fake {
    speed: u32,
    answers: &'static [(&'static [u8], &'static [u8])],
    now: u32,
    out: VecDeque<u8>,
    said: Vec<u8>,
}

impl Fake {
    fn new(speed: u32, answers: &'static [(&'static [u8], &'static [u8])]) -> Self {
        Fake { speed, answers, now: 0, out: VecDeque::new(), said: Vec::new() }
    }

    fn open(&mut self, protocol: Protocol) -> Option<SerialFacts> {
        let (_hold, stop) = crate::device_thread::pair();
        open(self, protocol, true, &stop).unwrap()
    }
}

impl Read for Fake {
    fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
        // Two bytes at a time, as a slow line gives them.
        let n = self.out.len().min(2);
        buf.iter_mut().zip(self.out.drain(..n)).for_each(|(b, v)| *b = v);
        if n > 0 { Ok(n) } else { Err(io::ErrorKind::TimedOut.into()) }
    }
}

impl Write for Fake {
    fn write(&mut self, words: &[u8]) -> io::Result<usize> {
        self.said.extend_from_slice(words);
        if self.now == self.speed {
            let known = self.answers.iter().find(|(q, _)| *q == words);
            self.out.extend(known.map_or(&[][..], |(_, a)| a));
        } else {
            // At the wrong speed everything is noise.
            self.out.extend([0xff, 0x00, 0xf8]);
        }
        Ok(words.len())
    }
    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Wire for Fake {
    fn set_line(&mut self, baud: u32, odd_parity: bool) -> io::Result<()> {
        self.now = baud + u32::from(odd_parity);
        Ok(())
    }
    fn set_patience(&mut self, _: Duration) -> io::Result<()> {
        Ok(())
    }
    fn clear(&mut self) -> io::Result<()> {
        self.out.clear();
        Ok(())
    }
}

const PEN: &[u8] = &[0xc0, 48, 106, 35, 20, 127, 1, 0, 0, 1, 5];
const SHORT: &[u8] = &[0xc0, 48, 106, 35, 20, 127, 1];
const TOUCH: &[u8] = &[0xc0, 10, 0b0110_0101, 7, 1, 3, 2, 0, 0, 0, 0];

#[test]
fn both_speeds_of_isdv4_are_tried_and_touch_is_asked_for() {
    for speed in [38400, 19200] {
        let mut line = Fake::new(speed, &[(b"*", PEN), (b"%", TOUCH)]);
        let facts = line.open(Protocol::Isdv4).expect("it answers");
        assert_eq!((line.now, facts.max, facts.max_pressure), (speed, [25000, 18000], 255));
        assert_eq!(facts.area_mm, Vec2::new(250.0, 180.0));
        assert_eq!(line.said.last(), Some(&b'1'), "the stream is started last");
        assert_eq!(facts.layout.length(0x90), 13, "two fingers");
    }
    assert!(Fake::new(9600, &[(b"*", PEN)]).open(Protocol::Isdv4).is_none());
    assert!(
        Fake::new(19200, &[(b"*", SHORT)]).open(Protocol::Isdv4).is_none(),
        "an answer cut short is none"
    );
}

#[test]
fn wacom_tablets_are_told_apart_by_their_name() {
    const IV: &[(&[u8], &[u8])] = &[
        (b"~#", b"~#UD-1212-R00,V1.2-4\r"),
        (b"~C\r", b"~C32480,32480\r"),
        (b"~R\r", b"~RE202C910,002,02,2540,2540\r"),
    ];
    let mut line = Fake::new(9600, IV);
    assert!(line.open(Protocol::WacomV).is_none());
    let facts = line.open(Protocol::WacomIv).unwrap();
    assert_eq!(
        (facts.max, facts.max_pressure),
        ([32480, 32480], 127),
        "an early ROM has seven bits"
    );
    assert!((facts.area_mm.x - 324.8).abs() < 0.1);
    assert!(line.said.ends_with(b"ZF1\rST\r"));

    const V: &[(&[u8], &[u8])] = &[(b"~#", b"~#GD-0912-R,V1.2\r"), (b"~C\r", b"~C30480,24060\r")];
    let mut line = Fake::new(9600, V);
    assert!(line.open(Protocol::WacomIv).is_none());
    let facts = line.open(Protocol::WacomV).unwrap();
    assert_eq!(
        (line.now, facts.area_mm, facts.max_pressure),
        (38400, Vec2::new(304.8, 240.6), 1023)
    );

    // A Graphire does not answer the question for its size, and leaves the carriage return out.
    let mut line = Fake::new(9600, &[(b"~#", b"~#ET-0405-R00,V1.1")]);
    assert_eq!(line.open(Protocol::WacomIv).unwrap().max, [5103, 3711]);
    let mut line = Fake::new(9600, &[(b"~#", b"~#UD-0608-R00,V1.3\r"), (b"~C\r", b"~C0,junk\r")]);
    assert!(line.open(Protocol::WacomIv).is_none(), "no size, no tablet");
}

#[test]
fn a_summasketch_speaks_with_odd_parity() {
    const MM: &[(&[u8], &[u8])] = &[(b"z?", b"MM1201"), (b"ha", &[0x98, 0x70, 0x2e, 0x70, 0x2e])];
    let facts = Fake::new(9601, MM).open(Protocol::SummaMm).unwrap();
    assert_eq!((facts.max, facts.max_pressure), ([6000, 6000], 0));
    assert!((facts.area_mm.x - 304.8).abs() < 0.01, "twelve inches");
    assert!(Fake::new(9600, MM).open(Protocol::SummaMm).is_none());
}

#[test]
fn an_endless_answer_ends() {
    struct Babble;
    impl Read for Babble {
        fn read(&mut self, buf: &mut [u8]) -> io::Result<usize> {
            buf.fill(0x55);
            Ok(buf.len())
        }
    }
    impl Write for Babble {
        fn write(&mut self, words: &[u8]) -> io::Result<usize> {
            Ok(words.len())
        }
        fn flush(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    impl Wire for Babble {
        fn set_line(&mut self, _: u32, _: bool) -> io::Result<()> {
            Ok(())
        }
        fn set_patience(&mut self, _: Duration) -> io::Result<()> {
            Ok(())
        }
        fn clear(&mut self) -> io::Result<()> {
            Ok(())
        }
    }
    let (_hold, stop) = crate::device_thread::pair();
    for protocol in PROBE_ORDER {
        assert_eq!(open(&mut Babble, protocol, true, &stop).unwrap(), None);
    }
}

#[test]
fn replies_read() {
    assert_eq!(answer(b"junk~#UD-0608-R00,V1.3-4\r", "~#").as_deref(), Some("UD-0608-R00,V1.3-4"));
    assert_eq!(answer(b"~#\r", "~#"), None);
    assert_eq!(version("UD-0608-R00,V1.3-4"), (1, 3));
    assert_eq!(version("UD-0608"), (0, 0));
    assert_eq!(numbers("4C00,0,0,1270,1270"), [0, 0, 0, 1270, 1270]);
}
