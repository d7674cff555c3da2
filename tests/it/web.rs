//! The page for browsers, as a program that is none meets it: keys, roles, floods and nonsense.

use std::net::TcpStream;

use serde_json::{Value, json};
use tungstenite::client::IntoClientRequest;
use tungstenite::{Message, WebSocket};

use crate::daemon_process::Daemon;
use crate::waiting::{comes, pause, until};

struct Served {
    daemon: Daemon,
    /// Sculptor, viewer, tablet.
    links: Vec<String>,
}

fn served() -> Served {
    let home = tempfile::tempdir().expect("a folder");
    let daemon = Daemon::run_in(home, &["--web", "127.0.0.1:0"]);
    until("it answers", || daemon.ctl("status", None).is_some());
    let lines = daemon.told.lock().expect("no panic").clone();
    let link = |line: &String| {
        line.split_whitespace().find(|w| w.starts_with("http://")).map(str::to_owned)
    };
    let links: Vec<String> = lines.iter().filter_map(link).filter(|l| l.contains('#')).collect();
    assert_eq!(links.len(), 3, "{lines:?}");
    Served { daemon, links }
}

fn host(link: &str) -> &str {
    link.trim_start_matches("http://").split('/').next().unwrap_or_default()
}

fn key(link: &str) -> &str {
    link.rsplit_once('#').map_or("", |(_, key)| key)
}

type Socket = WebSocket<TcpStream>;

fn dial(link: &str, origin: Option<&str>) -> Result<Socket, String> {
    let mut request =
        format!("ws://{}/join", host(link)).into_client_request().map_err(|e| e.to_string())?;
    if let Some(origin) = origin {
        request.headers_mut().insert("origin", origin.parse().expect("a header"));
    }
    let stream = TcpStream::connect(host(link)).map_err(|e| e.to_string())?;
    let patience = Some(std::time::Duration::from_secs(60));
    stream.set_read_timeout(patience).map_err(|e| e.to_string())?;
    let (socket, _) = tungstenite::client(request, stream).map_err(|e| e.to_string())?;
    Ok(socket)
}

/// The next message of text of this kind; `None` at the end of the connection.
fn told(socket: &mut Socket, is: &str) -> Option<Value> {
    loop {
        match socket.read() {
            Ok(Message::Text(text)) => {
                let value: Value = serde_json::from_str(&text).expect("JSON");
                if value["is"] == is {
                    return Some(value);
                }
            }
            Ok(_) => {}
            Err(_) => return None,
        }
    }
}

fn join(link: &str) -> Socket {
    join_with(link, &Value::Null).0
}

/// Joins with the ticket of a connection that was cut, or with `null`. Returns the welcome too.
fn join_with(link: &str, ticket: &Value) -> (Socket, Value) {
    let mut socket = dial(link, None).expect("a connection");
    let hello = json!({ "key": key(link), "name": "Ada", "ticket": ticket }).to_string();
    socket.send(Message::text(hello)).expect("sent");
    let welcome = told(&mut socket, "welcome").expect("welcome");
    (socket, welcome)
}

/// One record of a pen in the middle of the view.
fn record(us: f64, x: u16, tip: bool) -> Vec<u8> {
    let mut out = us.to_le_bytes().to_vec();
    for value in [x, 32_768, if tip { 40_000 } else { 0 }] {
        out.extend(value.to_le_bytes());
    }
    out.extend([0, 0, 0, 0, if tip { 35 } else { 33 }, 0]);
    out
}

fn batch(number: u32, records: &[Vec<u8>]) -> Message {
    let mut bytes = vec![1];
    bytes.extend(number.to_le_bytes());
    bytes.extend(records.concat());
    Message::binary(bytes)
}

fn hash(daemon: &Daemon) -> Value {
    daemon.ctl("hash", None).expect("an answer")["hash"].clone()
}

#[test]
fn nobody_joins_without_a_valid_key_and_no_other_page_does() {
    let served = served();
    let link = &served.links[0];
    for hello in [
        json!({ "key": "" }),
        json!({ "key": "0".repeat(32) }),
        json!({ "key": key(link), "more": 1 }),
        json!({}),
        json!([1]),
    ] {
        let mut socket = dial(link, None).expect("a connection");
        socket.send(Message::text(hello.to_string())).expect("sent");
        assert!(told(&mut socket, "refused").is_some(), "{hello}");
    }
    let mut socket = dial(link, None).expect("a connection");
    socket.send(Message::binary(vec![1, 2, 3])).expect("sent");
    assert!(told(&mut socket, "refused").is_some());
    let own = format!("http://{}", host(link));
    assert!(dial(link, Some(&own)).is_ok());
    for other in ["http://evil.example", "null", "https://127.0.0.1"] {
        assert!(dial(link, Some(other)).is_err(), "{other}");
    }
    assert_eq!(served.daemon.ctl("guests.list", None).expect("an answer")["guests"], json!([]));
}

#[test]
fn a_guest_sculpts_in_an_own_view_and_a_viewer_does_not() {
    let served = served();
    let before = hash(&served.daemon);
    let points: Vec<Vec<u8>> =
        (0..20).map(|i| record(f64::from(i) * 8000.0, 30_000 + 300 * i as u16, true)).collect();
    let mut viewer = join(&served.links[1]);
    viewer.send(batch(1, &points)).expect("sent");
    let note = told(&mut viewer, "note").expect("a note");
    assert!(note["text"].as_str().is_some_and(|t| t.contains("does not sculpt")), "{note}");
    assert_eq!(hash(&served.daemon), before);
    // Who watches does not turn the person at the machine into a viewer.
    let stroke = json!({ "points": [[0.5, 0.5, 0.5, 0], [0.52, 0.5, 0.5, 100]], "space": "view" });
    assert!(served.daemon.ctl("stroke", Some(&stroke.to_string())).is_some());
    until("the host's stroke is there", || hash(&served.daemon) != before);
    served.daemon.ctl("undo", None);
    until("it is undone", || hash(&served.daemon) == before);
    let mut guest = join(&served.links[0]);
    guest.send(batch(1, &points)).expect("sent");
    assert_eq!(told(&mut guest, "taken").map(|t| t["batch"].clone()), Some(json!(1)));
    until("the stroke is there", || hash(&served.daemon) != before);
    // The connection ends in the middle of the stroke: it ends as a lifted pen, and can be undone
    // by whoever comes back with the ticket; the person at the machine does not undo it.
    drop(guest);
    until("the guest is gone", || {
        let list = served.daemon.ctl("guests.list", None).expect("an answer");
        list["guests"].as_array().is_some_and(|g| g.len() == 1)
    });
    // Its last dabs come with its end.
    until("the stroke has ended", || {
        let now = hash(&served.daemon);
        pause(100);
        hash(&served.daemon) == now
    });
    let sculpted = hash(&served.daemon);
    served.daemon.ctl("undo", None);
    assert_eq!(hash(&served.daemon), sculpted);
}

#[test]
fn a_sculptor_is_sent_the_walls_and_a_viewer_asks_in_vain() {
    let served = served();
    let ask = Message::text(json!({ "do": "walls", "on": true }).to_string());
    let mut viewer = join(&served.links[1]);
    viewer.send(ask.clone()).expect("sent");
    assert!(told(&mut viewer, "note").is_some());
    let mut guest = join(&served.links[0]);
    guest.send(ask).expect("sent");
    let scale = told(&mut guest, "walls").expect("a scale")["scale"].clone();
    let (low, high) = (scale["low"].as_f64(), scale["high"].as_f64());
    assert!(low.zip(high).is_some_and(|(low, high)| 0.0 < low && low <= high), "{scale}");
    let off = json!({ "do": "walls", "on": false }).to_string();
    guest.send(Message::text(off)).expect("sent");
    while told(&mut guest, "walls").expect("an answer")["scale"] != Value::Null {}
}

#[test]
fn a_guest_who_comes_back_has_the_own_brush() {
    let served = served();
    let link = &served.links[0];
    let (mut guest, welcome) = join_with(link, &Value::Null);
    let clay = json!({ "do": "brush", "at": 0, "kind": "clay", "strength": 0.9 }).to_string();
    guest.send(Message::text(clay)).expect("sent");
    assert!(told(&mut guest, "brush").is_some());
    drop(guest);
    until("the guest is gone", || {
        let list = served.daemon.ctl("guests.list", None).expect("an answer");
        list["guests"] == json!([])
    });
    let (mut guest, back) = join_with(link, &welcome["ticket"]);
    assert_eq!((&back["resumed"], &back["person"]), (&json!(true), &welcome["person"]));
    let radius = json!({ "do": "brush", "at": 0, "radius": 0.2 }).to_string();
    guest.send(Message::text(radius)).expect("sent");
    let brush = told(&mut guest, "brush").expect("a brush")["brush"].clone();
    assert_eq!(brush["kind"], json!("clay"));
    assert!(brush["strength"].as_f64().is_some_and(|s| (s - 0.9).abs() < 1e-6), "{brush}");
}

#[test]
fn floods_and_nonsense_end_their_page_and_no_other() {
    let served = served();
    let mut calm = join(&served.links[0]);
    let bad: [Message; 6] = [
        Message::binary(vec![]),
        Message::binary(vec![9; 40]),
        Message::binary(vec![2, 1]),
        batch(1, &[vec![0; 7]]),
        batch(1, &vec![record(0.0, 9, true); 600]),
        Message::text("x".repeat(1 << 20)),
    ];
    for message in bad {
        let mut page = join(&served.links[0]);
        let _ = page.send(message.clone());
        assert!(told(&mut page, "never").is_none(), "{message:?}");
    }
    let mut page = join(&served.links[0]);
    for n in 1..20_000u32 {
        if page.send(batch(n, &[record(0.0, 9, false)])).is_err() {
            break;
        }
    }
    assert!(told(&mut page, "never").is_none());
    // Text that is none is answered, and the page goes on.
    calm.send(Message::text("{\"do\":\"fly\"}")).expect("sent");
    assert!(told(&mut calm, "note").is_some());
    for camera in ["1e99", "null", "\"x\""] {
        let text = format!(
            "{{\"do\":\"camera\",\"at\":1,\"camera\":{{\"target\":[0,0,{camera}],\"yaw\":0,\
             \"pitch\":0,\"distance\":1,\"fov_y\":1,\"aspect\":1,\"orthographic\":false}}}}"
        );
        calm.send(Message::text(text)).expect("sent");
        assert!(told(&mut calm, "note").is_some(), "{camera}");
    }
    assert!(served.daemon.ctl("status", None).is_some());
}

#[test]
fn a_revoked_or_expired_link_ends_its_pages() {
    let served = served();
    let invite = served.daemon.ctl("guests.invite", Some(r#"{"role":"viewer","minutes":0.1}"#));
    let invite = invite.expect("a link");
    let short = invite["link"].as_str().expect("a link").to_owned();
    let mut viewer = join(&short);
    let mut sculptor = join(&served.links[0]);
    assert!(told(&mut viewer, "refused").is_some(), "it expires after six seconds");
    let list = served.daemon.ctl("guests.list", None).expect("an answer");
    let first = &list["links"][0];
    assert_eq!(first["link"], json!(served.links[0]));
    let revoke = json!({ "key": first["key"] }).to_string();
    let reply = served.daemon.ctl("guests.revoke", Some(&revoke)).expect("an answer");
    assert_eq!(reply["guests"], json!(1));
    assert!(told(&mut sculptor, "refused").is_some());
    assert!(comes(|| {
        pause(20);
        let list = served.daemon.ctl("guests.list", None).expect("an answer");
        list["guests"] == json!([])
    }));
    assert!(served.daemon.ctl("guests.revoke", Some(&revoke)).is_none(), "there is none any more");
}
