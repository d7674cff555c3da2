use super::*;

fn pad_events(edges: &mut ControlEdges, pad: Pad) -> Vec<ControlEvent> {
    let mut out = Vec::new();
    edges.pad(&pad, &mut |e| out.push(e));
    out
}

fn touched(i: usize, place: Option<f32>) -> Pad {
    let mut pad = Pad::default();
    pad.strips[i] = place;
    pad
}

#[test]
fn a_control_is_written_as_it_is_read() {
    use Control::*;
    for control in [Key(1), Key(32), Barrel(2), Wheel(1), Ring(2), Strip(1), Eraser] {
        assert_eq!(control.to_string().parse(), Ok(control));
    }
    for bad in ["key", "key-0", "key-33", "wheel-3", "knob-1", "", "eraser-1", "key--1"] {
        assert!(bad.parse::<Control>().is_err(), "{bad}");
    }
}

#[test]
fn keys_are_released_before_others_are_pressed() {
    let mut edges = ControlEdges::default();
    let keys = |keys| Pad { keys, ..Pad::default() };
    assert_eq!(pad_events(&mut edges, keys(1)), [ControlEvent::Pressed(Control::Key(1))]);
    assert_eq!(pad_events(&mut edges, keys(1)), []);
    assert_eq!(
        pad_events(&mut edges, keys(0x8000_0002)),
        [
            ControlEvent::Released(Control::Key(1)),
            ControlEvent::Pressed(Control::Key(2)),
            ControlEvent::Pressed(Control::Key(32)),
        ]
    );
    assert_eq!(pad_events(&mut edges, Pad::default()).len(), 2, "a pad that left holds nothing");
}

#[test]
fn a_wheel_tells_its_steps_also_over_a_lost_state() {
    let mut edges = ControlEdges::default();
    let wheel = |a, b| Pad { wheels: [a, b], ..Pad::default() };
    assert_eq!(
        pad_events(&mut edges, wheel(3, -1)),
        [ControlEvent::Turned(Control::Wheel(1), 3), ControlEvent::Turned(Control::Wheel(2), -1)]
    );
    assert_eq!(
        pad_events(&mut edges, wheel(-2, -1)),
        [ControlEvent::Turned(Control::Wheel(1), -5)]
    );
    assert_eq!(pad_events(&mut edges, wheel(-2, -1)), []);
}

#[test]
fn a_ring_goes_the_shorter_way_round_and_a_strip_has_ends() {
    let mut edges = ControlEdges::new([TouchShape::Ring, TouchShape::Strip]);
    assert_eq!(pad_events(&mut edges, touched(0, Some(0.9))), [], "coming down is no movement");
    let over = pad_events(&mut edges, touched(0, Some(0.1)));
    assert_eq!(over, [ControlEvent::Turned(Control::Ring(1), 4)], "a fifth of a turn, clockwise");
    let back = pad_events(&mut edges, touched(0, Some(0.85)));
    assert_eq!(back, [ControlEvent::Turned(Control::Ring(1), -5)], "and the rest is kept");
    assert_eq!(pad_events(&mut edges, touched(0, None)), []);
    assert_eq!(pad_events(&mut edges, touched(0, Some(0.3))), [], "it came down elsewhere");

    assert_eq!(pad_events(&mut edges, touched(1, Some(1.0))), []);
    let down = pad_events(&mut edges, touched(1, Some(0.0)));
    assert_eq!(down, [ControlEvent::Turned(Control::Strip(2), -12)]);
}

#[test]
fn slow_movement_adds_up_to_whole_steps() {
    let mut edges = ControlEdges::new([TouchShape::Strip; 2]);
    let mut steps = 0;
    for i in 0..=120 {
        for e in pad_events(&mut edges, touched(0, Some(i as f32 / 120.0))) {
            let ControlEvent::Turned(Control::Strip(1), n) = e else { panic!("{e:?}") };
            steps += n;
        }
    }
    assert_eq!(steps, 12);
}

#[test]
fn a_pen_that_leaves_lets_go_of_its_buttons_and_its_eraser() {
    let mut edges = ControlEdges::default();
    let mut out = Vec::new();
    let pen = |in_range, buttons, tool| Pen { in_range, buttons, tool, ..Pen::default() };
    for state in [
        pen(true, 0b10, Tool::Pen),
        pen(false, 0b10, Tool::Pen),
        pen(true, 0, Tool::Eraser),
        pen(true, 0, Tool::Eraser),
        pen(false, 0, Tool::Eraser),
    ] {
        edges.pen(&state, &mut |e| out.push(e));
    }
    use ControlEvent::{Pressed, Released};
    assert_eq!(
        out,
        [
            Pressed(Control::Barrel(2)),
            Released(Control::Barrel(2)),
            Pressed(Control::Eraser),
            Released(Control::Eraser),
        ]
    );
}

const TABLE: &str = r#"
[controls]
key-1 = "next-mode"
key-2 = { hold = "view.turn" }
key-3 = { turn = { value = "brush.radius", step = -0.1 } }
barrel-1 = "nothing"

[[modes]]
ring-1 = { turn = { value = "brush.radius", step = 0.5 } }

[[modes]]
ring-1 = { turn = { value = "view.zoom", step = 2.0 } }
key-2 = { press = "undo" }
"#;

fn state() -> ActionState {
    let table: ActionTable = toml::from_str(TABLE).unwrap();
    table.check().unwrap();
    ActionState::new(table.with_defaults(), [TouchShape::Ring, TouchShape::Strip])
}

fn acted(state: &mut ActionState, pad: Pad) -> Vec<ActionEvent> {
    let mut out = Vec::new();
    state.pad(&pad, &mut |e| out.push(e));
    out
}

#[test]
fn a_mode_changes_what_a_ring_does_and_not_what_is_released() {
    let mut state = state();
    let keys = |keys| Pad { keys, ..Pad::default() };
    let turn = ActionEvent::Pressed { action: "view.turn".into(), held: true };
    assert_eq!(acted(&mut state, keys(0b10)), [turn]);
    assert_eq!(acted(&mut state, keys(0b11)), [ActionEvent::Mode(1)]);
    let released = ActionEvent::Released { action: "view.turn".into() };
    assert_eq!(acted(&mut state, keys(0)), [released], "as it was pressed");
    let undo = ActionEvent::Pressed { action: "undo".into(), held: false };
    assert_eq!(acted(&mut state, keys(0b10)), [undo], "what key 2 does in the second mode");
    assert_eq!(acted(&mut state, keys(0)), [], "an action that happens once is not released");

    acted(&mut state, touched(0, Some(0.0)));
    let zoom = ActionEvent::Turned { value: "view.zoom".into(), amount: 12.0 };
    assert_eq!(acted(&mut state, touched(0, Some(0.25))), [zoom]);
    assert_eq!(acted(&mut state, keys(0b1)), [ActionEvent::Mode(0)], "after the last the first");
    acted(&mut state, touched(0, Some(0.0)));
    let radius = ActionEvent::Turned { value: "brush.radius".into(), amount: 3.0 };
    assert_eq!(acted(&mut state, touched(0, Some(0.25))), [radius]);
}

#[test]
fn defaults_fill_what_a_table_leaves_out_and_nothing_takes_one_away() {
    let state = state();
    let of = |c| state.table.binding(c, 0).cloned();
    assert_eq!(of(Control::Barrel(1)), None);
    // The eraser carves by itself.
    assert_eq!(of(Control::Eraser), None);
    assert!(matches!(of(Control::Key(3)), Some(Binding::Turn { .. })));
    ActionTable::defaults().check().unwrap();
}

#[test]
fn a_new_table_releases_what_is_held() {
    let (mut state, mut out) = (state(), Vec::new());
    acted(&mut state, Pad { keys: 0b10, ..Pad::default() });
    state.set_table(ActionTable::defaults(), &mut |e| out.push(e));
    assert_eq!(out, [ActionEvent::Released { action: "view.turn".into() }]);
    assert_eq!(acted(&mut state, Pad::default()), [], "and once only");
}

#[test]
fn nonsense_is_named() {
    let bad = |text: &str| toml::from_str::<ActionTable>(text).map(|t| t.check());
    assert!(bad("[controls]\nknob-1 = \"nothing\"").unwrap_err().to_string().contains("knob-1"));
    assert!(bad("[controls]\nkey-1 = { hop = \"x\" }").unwrap_err().to_string().contains("hop"));
    let e = bad("[controls]\nkey-1 = { press = \"\" }").unwrap().unwrap_err();
    assert!(e.contains("key-1"), "{e}");
    let e = bad("[controls]\nkey-1 = { turn = { value = \"a\", step = inf } }").unwrap();
    assert!(e.unwrap_err().contains("step"));
    assert!(bad("speed = 1").is_err());
}
