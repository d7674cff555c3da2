//! One page: a thread that reads what the page sends and sends what the page lacks.

use std::collections::VecDeque;
use std::io::ErrorKind;
use std::net::TcpStream;
use std::sync::Arc;
use std::sync::atomic::Ordering::Relaxed;
use std::time::Duration;

use crossbeam_channel as cc;
use tungstenite::protocol::{CloseFrame, Role, WebSocketConfig, frame::coding::CloseCode};
use tungstenite::{Message, WebSocket};

use super::delivery::{self, Delivery, ShownObject};
use super::downloads::WorkFormat;
use super::guests::{Guest, JoinedGuest, PagePlace};
use super::keys::WebRole;
use super::messages::{
    BrushShown, GuestRequest, Hello, PenShown, PersonShown, Tell, changed_brush,
};
use super::rate::RateLimit;
use super::walls::{WallScale, WallsWanted};
use super::{RESUMES, WebState};
use crate::Published;
use crate::command_queue::{CommandAnswer, QueuedCommand};
use crate::people::colour_of;
use sculptd_clay::brush::{BrushKind, BrushSettings};
use sculptd_devices::browser::{BrowserPen, MAX_RECORDS, RECORD};
use sculptd_devices::queue::Sender;
use sculptd_engine::answer::Answer;
use sculptd_engine::camera::Camera;
use sculptd_engine::command::{Command, OfPerson};

/// Longest message of a page, bytes: a full batch and its head.
const MESSAGE_BYTES: usize = MAX_RECORDS * RECORD + 64;
/// Time in which a page must say who it is.
const HELLO: Duration = Duration::from_secs(5);
/// Time in which a page must take some of what is sent to it.
const STALLED: Duration = Duration::from_secs(10);
/// Time without a message after which a page is gone; it sends one every two seconds.
const SILENT: Duration = Duration::from_secs(15);
/// Interval between two looks while something changes, and while nothing does.
const BUSY: Duration = Duration::from_millis(6);
const IDLE: Duration = Duration::from_millis(50);
/// Looks without a change after which a page counts as idle.
const QUIET_LOOKS: u32 = 40;
/// Messages and bytes a second that a page may send.
const MESSAGES: u64 = 1000;
const BYTES: u64 = 1 << 20;
/// Messages read at a time, so that what is sent keeps its turn.
const READ_AT_ONCE: usize = 64;
/// Interval between two lists of others' pens.
const PENS_US: u64 = 30_000;

const PEN_BATCH: u8 = 1;
const RECEIVED: u8 = 2;
const ALIVE: u8 = 3;

/// Serves a page until it leaves, its key ends or the daemon does.
pub fn run(stream: TcpStream, read: Vec<u8>, state: &Arc<WebState>, _place: PagePlace) {
    let peer = stream.peer_addr().map(|a| a.to_string()).unwrap_or_default();
    let timed = stream
        .set_read_timeout(Some(HELLO))
        .and_then(|()| stream.set_write_timeout(Some(STALLED)))
        .and_then(|()| stream.set_nodelay(true));
    if let Err(e) = timed {
        tracing::warn!("web: {peer}: {e}");
        return;
    }
    let config = WebSocketConfig::default()
        .max_message_size(Some(MESSAGE_BYTES))
        .max_frame_size(Some(MESSAGE_BYTES));
    let mut socket = WebSocket::from_partially_read(stream, read, Role::Server, Some(config));
    let hello = match first_message(&mut socket) {
        Ok(hello) => hello,
        Err(why) => {
            tracing::info!("web: {peer} was refused: {why}");
            return refuse(&mut socket, why);
        }
    };
    let now = state.clock.now_us();
    let Some(key) = state.keys.find(&hello.key, now) else {
        tracing::warn!("web: {peer} was refused: its link is not valid");
        let why = "This link is not valid, or has expired. Ask for a new one.".into();
        return refuse(&mut socket, why);
    };
    let joined = state.guests.join(&key, hello.ticket.as_deref(), &hello.name, now);
    match joined {
        Ok(joined) => {
            let Guest { role, name, person, .. } = &joined.guest;
            tracing::info!("web: {peer} joined as {} {person} '{name}'", role.name());
            let mut page = ConnectedPage::new(socket, state, joined, hello.received);
            let why = page.serve();
            tracing::info!("web: {peer} left: {why}");
            page.end();
        }
        Err(why) => refuse(&mut socket, why),
    }
}

type Socket = WebSocket<TcpStream>;

/// Waits for the first message. The read timeout is [`HELLO`] here.
fn first_message(socket: &mut Socket) -> Result<Hello, String> {
    match socket.read() {
        Ok(Message::Text(text)) => serde_json::from_str(&text).map_err(|e| e.to_string()),
        Ok(_) => Err("the first message must say who joins".into()),
        Err(e) => Err(e.to_string()),
    }
}

fn refuse(socket: &mut Socket, why: String) {
    let _ = tell(socket, &Tell::Refused { why });
    let frame = CloseFrame { code: CloseCode::Policy, reason: "refused".into() };
    let _ = socket.close(Some(frame)).and_then(|()| socket.flush());
}

fn tell(socket: &mut Socket, what: &Tell) -> Result<(), String> {
    let text = serde_json::to_string(what).map_err(|e| e.to_string())?;
    socket.send(Message::text(text)).map_err(|e| e.to_string())
}

/// A request whose answer is awaited.
struct AwaitedAnswer {
    answer: cc::Receiver<CommandAnswer>,
    redo: bool,
}

/// What was sent last, to send it again only where it differs.
#[derive(Default)]
struct LastTold {
    objects: Vec<ShownObject>,
    host: Option<Camera>,
    people: Vec<PersonShown>,
    pens: Vec<PenShown>,
    pens_us: u64,
    taken: u32,
    complete: bool,
    walls: Option<WallScale>,
}

struct ConnectedPage<'a> {
    socket: Socket,
    state: &'a Arc<WebState>,
    guest: Guest,
    connection: u64,
    delivery: Delivery,
    resumed: bool,
    pen: Option<(BrowserPen, Sender)>,
    camera: Camera,
    brush: BrushSettings,
    asked: VecDeque<AwaitedAnswer>,
    /// Path of the file that is being written.
    file: Option<cc::Receiver<Result<String, String>>>,
    told: LastTold,
    /// The guest has asked for the map of walls.
    asks_walls: bool,
    /// The map is shown: asked for, or shown in the window too.
    walls: Option<WallsWanted>,
    last_batch: u32,
    heard_us: u64,
    messages: RateLimit,
    bytes: RateLimit,
    out: Vec<u8>,
}

impl<'a> ConnectedPage<'a> {
    fn new(socket: Socket, state: &'a Arc<WebState>, joined: JoinedGuest, received: u32) -> Self {
        let JoinedGuest { guest, connection, resumed } = joined;
        let shown = state.published.load();
        let now = state.clock.now_us();
        let is_resumed = resumed.is_some();
        let mut delivery = resumed.unwrap_or_default();
        delivery.resume(received);
        // A guest who comes back has the own view and brush, as the world has them.
        let settings = delivery.settings.take();
        let (camera, brush) = settings.unwrap_or((shown.camera, shown.brush));
        let pen = guest.pen.map(|device| {
            let mut sender = state.factory.sender();
            sender.stop_when(state.stop.clone());
            (BrowserPen::new(device), sender)
        });
        ConnectedPage {
            socket,
            state,
            guest,
            connection,
            delivery,
            resumed: is_resumed,
            pen,
            camera,
            brush,
            asked: VecDeque::new(),
            file: None,
            told: LastTold::default(),
            asks_walls: false,
            walls: None,
            last_batch: 0,
            heard_us: now,
            messages: RateLimit::new(MESSAGES, now),
            bytes: RateLimit::new(BYTES, now),
            out: Vec::new(),
        }
    }

    /// Serves until there is a reason to end, and returns it.
    fn serve(&mut self) -> String {
        let mut quiet = 0;
        if let Err(why) = self.welcome() {
            return why;
        }
        loop {
            let now = self.state.clock.now_us();
            if let Some(why) = self.ends(now) {
                return why;
            }
            let changed = match self.send(now) {
                Ok(changed) => changed,
                Err(why) => return why,
            };
            quiet = if changed { 0 } else { quiet + 1 };
            let wait = match (self.delivery.can_send(), quiet) {
                (true, _) => Duration::from_millis(1),
                (_, ..QUIET_LOOKS) => BUSY,
                _ => IDLE,
            };
            match self.read(wait) {
                Ok(true) => quiet = 0,
                Ok(false) => {}
                Err(why) => return why,
            }
        }
    }

    fn welcome(&mut self) -> Result<(), String> {
        let shown = self.state.published.load_full();
        if self.guest.person != 0 {
            self.send_command(Command::Camera(self.camera), None, None)?;
            self.send_command(Command::Brush(self.brush), None, None)?;
        }
        let welcome = Tell::Welcome {
            role: self.guest.role.name(),
            guest: self.guest.number,
            person: self.guest.person,
            ticket: self.guest.ticket.clone(),
            resumed: self.resumed,
            camera: self.camera,
            brush: BrushShown::from(&self.brush),
            brushes: BrushKind::ALL.to_vec(),
            extent: shown.extent,
            records: MAX_RECORDS,
        };
        tell(&mut self.socket, &welcome)
    }

    /// Returns the reason to end the connection, if there is one.
    fn ends(&mut self, now: u64) -> Option<String> {
        if self.state.stop.load(Relaxed) {
            let _ = tell(&mut self.socket, &Tell::Note { text: "The daemon has ended.".into() });
            return Some("the daemon ends".into());
        }
        if !self.state.keys.is_valid(self.guest.key, now) {
            let why = "This link is no longer valid. Ask for a new one.".to_owned();
            refuse(&mut self.socket, why);
            return Some("its key is no longer valid".into());
        }
        if !self.state.guests.is_current(self.connection) {
            return Some("the page has connected again".into());
        }
        self.state.downloads.expire(now);
        let silent = now.saturating_sub(self.heard_us) > SILENT.as_micros() as u64;
        silent.then(|| "nothing was heard of it".into())
    }

    /// Reads what has come, and waits for at most `wait` if nothing has. Returns true if something
    /// has.
    fn read(&mut self, wait: Duration) -> Result<bool, String> {
        let io = |e: std::io::Error| e.to_string();
        self.socket.get_ref().set_read_timeout(Some(wait)).map_err(io)?;
        for n in 0..READ_AT_ONCE {
            let message = match self.socket.read() {
                Ok(message) => message,
                Err(tungstenite::Error::Io(e))
                    if matches!(e.kind(), ErrorKind::WouldBlock | ErrorKind::TimedOut) =>
                {
                    return Ok(n > 0);
                }
                Err(e) => return Err(e.to_string()),
            };
            if n == 0 {
                let soon = Some(Duration::from_micros(200));
                self.socket.get_ref().set_read_timeout(soon).map_err(io)?;
            }
            let now = self.state.clock.now_us();
            self.heard_us = now;
            let within = self.messages.take(1, now) && self.bytes.take(message.len() as u64, now);
            if !within {
                refuse(&mut self.socket, "This page sends too much.".into());
                return Err("it sends too much".into());
            }
            match message {
                Message::Binary(bytes) => self.take_binary(&bytes, now)?,
                Message::Text(text) => self.take_text(&text, now)?,
                Message::Close(_) => return Err("it was closed".into()),
                Message::Ping(_) | Message::Pong(_) | Message::Frame(_) => {}
            }
        }
        Ok(true)
    }

    fn take_binary(&mut self, bytes: &[u8], now: u64) -> Result<(), String> {
        const BAD: &str = "a message that is none";
        let (kind, rest) = bytes.split_first().ok_or(BAD)?;
        if *kind == ALIVE && rest.is_empty() {
            return Ok(());
        }
        let (number, rest) = rest.split_first_chunk::<4>().ok_or(BAD)?;
        let number = u32::from_le_bytes(*number);
        match *kind {
            RECEIVED if rest.is_empty() => {
                self.delivery.acknowledge(number);
                Ok(())
            }
            PEN_BATCH => self.take_pen(number, rest, now),
            _ => Err(BAD.into()),
        }
    }

    fn take_pen(&mut self, number: u32, records: &[u8], now: u64) -> Result<(), String> {
        let Some((pen, sender)) = &mut self.pen else {
            return self.note("You are watching: this link does not sculpt.");
        };
        if number <= self.last_batch {
            // It came before the cut already.
            return Ok(());
        }
        self.last_batch = number;
        // A tablet lies over the view of the person at the machine.
        let aspect = match self.guest.role {
            WebRole::Device => self.state.published.load().camera.aspect,
            _ => self.camera.aspect,
        };
        let samples = pen.take(records, aspect, now).map_err(|e| e.to_string())?;
        samples.into_iter().for_each(|sample| sender.push(sample));
        Ok(())
    }

    fn take_text(&mut self, text: &str, now: u64) -> Result<(), String> {
        let ask: GuestRequest = match serde_json::from_str(text) {
            Ok(ask) => ask,
            Err(e) => return self.note(&format!("not understood: {e}")),
        };
        if let GuestRequest::Name { name } = &ask {
            self.state.guests.rename(self.connection, name);
            return Ok(());
        }
        if let GuestRequest::File { format } = ask {
            return self.write_file(format);
        }
        if let (GuestRequest::Walls { on }, WebRole::Sculptor) = (&ask, self.guest.role) {
            self.asks_walls = *on;
            return Ok(());
        }
        if self.guest.role != WebRole::Sculptor {
            return match ask {
                // The pages in front of a viewer's camera come first.
                GuestRequest::Camera { camera, .. } if camera.is_sane() => {
                    self.camera = camera;
                    Ok(())
                }
                _ => self.note("You are watching: this link does not sculpt."),
            };
        }
        match &ask {
            GuestRequest::Camera { camera, at } => {
                if !camera.is_sane() {
                    return self.note("a view with numbers that are not finite");
                }
                self.camera = *camera;
                self.send_command(Command::Camera(*camera), Some((*at, now)), None)?;
            }
            GuestRequest::Brush { at, .. } => {
                self.brush = changed_brush(&self.brush, &ask, &self.state.presets);
                self.send_command(Command::Brush(self.brush), Some((*at, now)), None)?;
                let brush = BrushShown::from(&self.brush);
                return tell(&mut self.socket, &Tell::Brush { brush });
            }
            GuestRequest::Undo { at } | GuestRequest::Redo { at } => {
                let redo = matches!(ask, GuestRequest::Redo { .. });
                let (send, answer) = cc::bounded(1);
                let command = if redo { Command::Redo } else { Command::Undo };
                self.send_command(command, Some((*at, now)), Some(send))?;
                self.asked.push_back(AwaitedAnswer { answer, redo });
            }
            GuestRequest::Name { .. } | GuestRequest::File { .. } | GuestRequest::Walls { .. } => {}
        }
        Ok(())
    }

    /// Writes the work as a file, on a thread of its own: a large one takes seconds.
    fn write_file(&mut self, format: WorkFormat) -> Result<(), String> {
        if self.file.is_some() {
            return self.note("The file is being written.");
        }
        let (done, file) = cc::bounded(1);
        let state = self.state.clone();
        let write = move || {
            let shown = state.published.load_full();
            let _ = done.send(state.downloads.write(&shown, format, state.clock.now_us()));
        };
        let thread = std::thread::Builder::new().name("sculptd-take-home".into()).spawn(write);
        match thread {
            Ok(_) => self.file = Some(file),
            Err(e) => return self.note(&format!("No file can be written: {e}.")),
        }
        Ok(())
    }

    /// Sends a command of the guest. `at`: the time of its event on the page's clock, and when it
    /// was read.
    fn send_command(
        &mut self,
        command: Command,
        at: Option<(f64, u64)>,
        answer: Option<cc::Sender<CommandAnswer>>,
    ) -> Result<(), String> {
        let t_us = match (&mut self.pen, at) {
            (Some((pen, _)), Some((page_us, read_us))) => Some(pen.time(page_us, read_us)),
            _ => None,
        };
        let of = OfPerson { person: self.guest.person, command };
        let command = Command::OfPerson(Box::new(of));
        let queued = QueuedCommand { answer, t_us, ..QueuedCommand::from(command) };
        // The loop takes 64 commands a tick: it has room again before long. Where it has not, the
        // page connects again, and its view and brush are set anew.
        let sent = self.state.commands.send_timeout(queued, Duration::from_secs(2));
        sent.map_err(|_| "the loop is busy, a command was not taken".into())
    }

    fn note(&mut self, text: &str) -> Result<(), String> {
        tell(&mut self.socket, &Tell::Note { text: text.to_owned() })
    }

    /// Sends what has changed. Returns true if something has.
    fn send(&mut self, now: u64) -> Result<bool, String> {
        let shown = self.state.published.load_full();
        let mut changed = self.tell_answers()?;
        if let Some((_, sender)) = &mut self.pen
            && sender.flush()
            && self.told.taken != self.last_batch
        {
            self.told.taken = self.last_batch;
            tell(&mut self.socket, &Tell::Taken { batch: self.last_batch })?;
            changed = true;
        }
        changed |= self.tell_facts(&shown, now)?;
        changed |= self.tell_walls()?;
        self.delivery.look(&shown, &self.camera);
        // A bounded number, so that what the page sends has its turn.
        for _ in 0..READ_AT_ONCE {
            if !self.delivery.next(&mut self.out) {
                break;
            }
            changed = true;
            self.told.complete = false;
            let message = Message::binary(std::mem::take(&mut self.out));
            self.socket.write(message).map_err(|e| e.to_string())?;
        }
        self.socket.flush().map_err(|e| e.to_string())?;
        if self.delivery.is_complete() && !std::mem::replace(&mut self.told.complete, true) {
            let bytes = self.delivery.sent_bytes;
            tell(&mut self.socket, &Tell::Complete { bytes })?;
        }
        Ok(changed)
    }

    fn tell_answers(&mut self) -> Result<bool, String> {
        let mut told = false;
        if let Some(Ok(written)) = self.file.as_ref().map(cc::Receiver::try_recv) {
            self.file = None;
            told = true;
            match written {
                Ok(path) => tell(&mut self.socket, &Tell::File { path })?,
                Err(why) => self.note(&format!("There is no file: {why}."))?,
            }
        }
        while let Some(first) = self.asked.front() {
            let answer = match first.answer.try_recv() {
                Ok(answer) => Some(answer.result),
                Err(cc::TryRecvError::Empty) => return Ok(told),
                Err(cc::TryRecvError::Disconnected) => None,
            };
            let word = if first.redo { "redo" } else { "undo" };
            self.asked.pop_front();
            told = true;
            match answer {
                Some(Ok(Answer::NothingInMemory)) => {
                    self.note(&format!("There is nothing to {word}."))?
                }
                Some(Ok(_)) => {}
                Some(Err(why)) => self.note(&format!("No {word}: {why}."))?,
                None => self.note(&format!("The {word} was not carried out."))?,
            }
        }
        Ok(told)
    }

    /// Shows the map of walls to who asked for it, and to everybody while the window shows it.
    fn tell_walls(&mut self) -> Result<bool, String> {
        let WebState { walls, window, published, stop, .. } = &**self.state;
        let wanted = self.asks_walls || window.shows_walls();
        if wanted != self.walls.is_some() {
            self.walls = wanted.then(|| walls.want(published, stop));
        }
        let map = self.walls.as_ref().and_then(|_| walls.measured_map());
        let scale = map.as_ref().map(|m| m.scale);
        self.delivery.walls.follow(map);
        if scale == self.told.walls {
            return Ok(false);
        }
        self.told.walls = scale;
        tell(&mut self.socket, &Tell::Walls { scale })?;
        Ok(true)
    }

    fn tell_facts(&mut self, shown: &Published, now: u64) -> Result<bool, String> {
        let mut changed = false;
        let objects = delivery::shown_objects(shown);
        if objects != self.told.objects {
            tell(&mut self.socket, &Tell::Objects { objects: objects.clone() })?;
            self.told.objects = objects;
            changed = true;
        }
        if self.told.host != Some(shown.camera) {
            self.told.host = Some(shown.camera);
            tell(&mut self.socket, &Tell::Host { camera: shown.camera })?;
            changed = true;
        }
        if now.saturating_sub(self.told.pens_us) < PENS_US {
            return Ok(changed);
        }
        self.told.pens_us = now;
        let people: Vec<PersonShown> = self.state.guests.here().iter().map(person).collect();
        if people != self.told.people {
            tell(&mut self.socket, &Tell::People { people: people.clone() })?;
            self.told.people = people;
            changed = true;
        }
        let own = self.guest.person;
        let others = shown.others.iter().flatten().filter(|o| o.person != own);
        let pens: Vec<PenShown> = others
            .map(|o| PenShown {
                person: o.person,
                position: o.position.to_array(),
                radius: o.radius,
                down: o.down,
            })
            .collect();
        if pens != self.told.pens {
            tell(&mut self.socket, &Tell::Pens { pens: pens.clone() })?;
            self.told.pens = pens;
            changed = true;
        }
        Ok(changed)
    }

    /// The page is gone: its pen is lifted, and it may come back.
    fn end(mut self) {
        let now = self.state.clock.now_us();
        if let Some((pen, sender)) = &mut self.pen {
            if let Some(lifted) = pen.leave(now) {
                sender.push(lifted);
            }
            // Dropping the sender hands over what it kept.
            sender.flush();
        }
        let comes_back = self.state.keys.is_valid(self.guest.key, now) && !RESUMES.is_zero();
        self.delivery.settings = Some((self.camera, self.brush));
        let delivery = comes_back.then(|| std::mem::take(&mut self.delivery));
        self.state.guests.leave(self.connection, delivery, now);
    }
}

fn person(guest: &Guest) -> PersonShown {
    PersonShown {
        guest: guest.number,
        person: guest.person,
        name: guest.name.clone(),
        role: guest.role.name(),
        colour: colour_of(guest.person),
    }
}
