//! What the keys, wheels and barrel buttons of tablets do to the work: their changes become
//! commands of the tick in which they came.
//!
//! Laws kept here:
//! * The commands go into the journal as any others, and samples are changed before the world and
//!   the journal see them: a replay needs neither the table nor this module.
//! * A pen whose held button moves the view or a setting does not sculpt with the same motion.
//! * A click that the desktop makes of a pad's key does not sculpt.

use std::sync::Arc;

use glam::Vec2;

use sculptd_clay::brush::{BrushSettings, Presets};
use sculptd_devices::pad_actions::{ActionEvent, ActionState, ActionTable, Control, TouchShape};
use sculptd_devices::{Body, DeviceId, Pen, Sample};
use sculptd_engine::camera::Camera;
use sculptd_engine::command::Command;
use sculptd_engine::world::World;

use crate::adaptors::POINTER_ID;
use crate::tablet_controls::TabletControls;
use crate::tablet_models::DeviceTables;
use crate::tablet_vocabulary::{Meaning, meaning};

/// Ids of tablets, serial pens and their recordings; a pointer has separate buttons.
const TABLETS: [std::ops::Range<u16>; 2] = [0..200, 300..400];
/// Tablets whose controls are followed.
const MOST: usize = 16;
/// The radius grows by this power of e, and the strength by this much, over the tablet's width and
/// height.
const DRAG: f32 = 3.0;

/// An X server makes a click of a pad's key: so long after it at most, microseconds. A window that
/// draws slowly hears of it late.
const CLICK_US: u64 = 250_000;

/// The pointer, as far as it tells a mouse's press from the click that a pad's key makes.
#[derive(Debug, Default)]
struct PointerPress {
    /// Time of a pad key's press that no pointer press has followed yet, in microseconds.
    key_us: Option<u64>,
    down: bool,
    /// True if a key caused this press.
    of_key: bool,
}

impl PointerPress {
    /// Takes the press away where it is a key's.
    fn take(&mut self, t_us: u64, pen: &mut Pen) {
        let begins = pen.tip && !std::mem::replace(&mut self.down, pen.tip);
        if begins && let Some(key_us) = self.key_us.take() {
            self.of_key = t_us.saturating_sub(key_us) <= CLICK_US;
        }
        self.of_key &= pen.tip;
        pen.tip &= !self.of_key;
    }
}

/// One tablet's controls.
#[derive(Debug)]
struct Tablet {
    id: DeviceId,
    /// Its model, once that is known.
    model: Option<String>,
    state: ActionState,
    /// Effects of the pen's motion while buttons are held.
    held: Vec<Meaning>,
    /// Last position of its pen, as shares of its area.
    last: Option<Vec2>,
    /// True during a stroke, which a button does not interrupt.
    sculpts: bool,
    /// The pressed keys of its pad.
    keys: u32,
}

/// The controls of all tablets.
#[derive(Debug)]
pub struct TabletActions {
    /// Of the settings for all tablets.
    table: ActionTable,
    /// Of single models.
    models: DeviceTables,
    controls: TabletControls,
    /// The user's bindings, as the tablets use them now.
    own: Arc<ActionTable>,
    presets: Presets,
    tablets: Vec<Tablet>,
    pointer: PointerPress,
    /// The brush before a held button changed it.
    before: Option<BrushSettings>,
}

/// The commands of a tick as they grow: the second change goes on from the first.
struct Asked<'a> {
    brush: BrushSettings,
    camera: Camera,
    world: &'a World,
    out: &'a mut Vec<Command>,
}

impl Asked<'_> {
    fn brush(&mut self, brush: BrushSettings) {
        self.brush = brush.clamped();
        self.out.push(Command::Brush(self.brush));
    }
}

impl TabletActions {
    /// The table's own bindings over the defaults. A tablet with an eraser carves with it where the
    /// table says nothing.
    pub fn new(table: ActionTable, presets: Presets) -> Self {
        let (controls, models) = (TabletControls::default(), DeviceTables::default());
        let own = controls.own();
        TabletActions {
            table,
            models,
            controls,
            own,
            presets,
            tablets: Vec::new(),
            pointer: PointerPress::default(),
            before: None,
        }
    }

    /// With what a person binds while it runs.
    pub fn with_controls(self, controls: TabletControls) -> Self {
        TabletActions { controls, ..self }
    }

    /// With what single models do.
    pub fn with_models(self, models: DeviceTables) -> Self {
        TabletActions { models, ..self }
    }

    /// The table that is in force for a model: the person's own bindings over the settings, those
    /// over the tablet's file, and that over the defaults.
    fn table(&self, model: Option<&str>) -> ActionTable {
        let mut table = self.models.table(model, &self.table).over(ActionTable::defaults());
        // Some tablets do not report which entry is a ring, so a strip's binding serves both.
        for n in 1..=2 {
            if let Some(binding) = table.controls.get(&Control::Strip(n)).cloned() {
                table.controls.entry(Control::Ring(n)).or_insert(binding);
            }
        }
        ActionTable::clone(&self.own).over(table)
    }

    /// Applies bindings that the user changed since the last tick. Held controls are released.
    fn follow_controls(&mut self, asked: &mut Asked<'_>) {
        let own = self.controls.own();
        if Arc::ptr_eq(&own, &self.own) {
            return;
        }
        self.own = own;
        for i in 0..self.tablets.len() {
            self.take_table(i, asked);
        }
    }

    /// Gives a tablet the table that is in force for it.
    fn take_table(&mut self, i: usize, asked: &mut Asked<'_>) {
        let table = self.table(self.tablets[i].model.as_deref());
        let mut events = Vec::new();
        self.tablets[i].state.set_table(table, &mut |e| events.push(e));
        events.into_iter().for_each(|e| self.apply(i, &e, asked));
    }

    /// Asks for the model of a tablet that is not known yet.
    fn follow_model(&mut self, i: usize, asked: &mut Asked<'_>) {
        if self.tablets[i].model.is_none()
            && let Some(model) = self.models.model(self.tablets[i].id)
        {
            self.tablets[i].model = Some(model);
            self.take_table(i, asked);
        }
    }

    /// Takes the samples of a tick; what their controls ask for is added to the tick's commands.
    pub fn take(&mut self, samples: &mut [Sample], world: &World, out: &mut Vec<Command>) {
        let newest_brush = out.iter().rev().find_map(|c| match c {
            Command::Brush(b) => Some(*b),
            _ => None,
        });
        let newest_camera = out.iter().rev().find_map(|c| match c {
            Command::Camera(c) => Some(*c),
            _ => None,
        });
        let mut asked = Asked {
            brush: newest_brush.unwrap_or(*world.brush()),
            camera: newest_camera.unwrap_or(*world.camera()),
            world,
            out,
        };
        self.follow_controls(&mut asked);
        let listens = self.controls.is_listening();
        let followed =
            |s: &Sample| s.device == POINTER_ID || TABLETS.iter().any(|t| t.contains(&s.device.0));
        for sample in samples.iter_mut().filter(|s| followed(s)) {
            if sample.device == POINTER_ID {
                if let Body::Pen(pen) = &mut sample.body {
                    self.pointer.take(sample.t_us, pen);
                }
                continue;
            }
            let Some(i) = self.tablet(sample.device) else { continue };
            self.follow_model(i, &mut asked);
            let mut events = Vec::new();
            let Tablet { state, keys, .. } = &mut self.tablets[i];
            match &sample.body {
                Body::Pad(pad) => {
                    let before = std::mem::replace(keys, pad.keys);
                    if pad.keys & !before != 0 {
                        self.pointer.key_us = Some(sample.t_us);
                    }
                    state.pad(pad, &mut |e| events.push(e));
                }
                Body::Pen(pen) => state.pen(pen, &mut |e| events.push(e)),
                Body::Hands(_) => {}
            }
            if let Some(control) = state.take_latest() {
                self.controls.note(sample.device, control);
            }
            let counts = |e: &ActionEvent| !listens || matches!(e, ActionEvent::Released { .. });
            events.into_iter().filter(counts).for_each(|e| self.apply(i, &e, &mut asked));
            if let Body::Pen(pen) = &mut sample.body {
                drag(&mut self.tablets[i], pen, &mut asked);
            }
        }
    }

    fn tablet(&mut self, id: DeviceId) -> Option<usize> {
        let at = self.tablets.iter().position(|t| t.id == id);
        if at.is_none() && self.tablets.len() < MOST {
            // A ring's shorter way round is also right for a strip, where no finger jumps by half.
            let state = ActionState::new(self.table(None), [TouchShape::Ring; 2]);
            let (held, last) = (Vec::new(), None);
            let (model, sculpts, keys) = (None, false, 0);
            self.tablets.push(Tablet { id, model, state, held, last, sculpts, keys });
            return Some(self.tablets.len() - 1);
        }
        at
    }

    fn apply(&mut self, tablet: usize, event: &ActionEvent, asked: &mut Asked<'_>) {
        match event {
            ActionEvent::Pressed { action, held } => {
                let Some(what) = meaning(action) else { return };
                self.begin(tablet, what, *held, asked);
            }
            ActionEvent::Released { action } => {
                let what = meaning(action);
                self.tablets[tablet].held.retain(|m| Some(*m) != what);
                let lends = matches!(what, Some(Meaning::Brush(_) | Meaning::Invert));
                if let Some(before) = self.before.take_if(|_| lends) {
                    // Restore the lent brush first: the world remembers the settings of the brush
                    // it replaces.
                    let lent = asked.brush.key();
                    if lent != before.key() {
                        let kept = asked.world.kept_brushes();
                        asked.brush(self.presets.kept(&before, kept, lent));
                    }
                    asked.brush(before);
                }
            }
            ActionEvent::Turned { value, amount } => match meaning(value) {
                Some(Meaning::Radius) => {
                    let radius = asked.brush.radius * (1.0 + amount.clamp(-0.9, 9.0));
                    asked.brush(BrushSettings { radius, ..asked.brush });
                }
                Some(Meaning::Strength) => {
                    let strength = asked.brush.strength + amount;
                    asked.brush(BrushSettings { strength, ..asked.brush });
                }
                _ => {}
            },
            ActionEvent::Mode(_) => {}
        }
    }

    fn begin(&mut self, tablet: usize, what: Meaning, held: bool, asked: &mut Asked<'_>) {
        match what {
            Meaning::Undo => asked.out.push(Command::Undo),
            Meaning::Redo => asked.out.push(Command::Redo),
            Meaning::Fit => {
                let active = asked.world.scene().active();
                let (lo, hi) = active.settings.transform.bounds(active.clay.bounds());
                if lo.cmple(hi).all() {
                    asked.camera.frame(lo, hi);
                    asked.out.push(Command::Camera(asked.camera));
                }
            }
            Meaning::Invert | Meaning::Brush(_) => {
                if held {
                    self.before.get_or_insert(asked.brush);
                }
                asked.brush(match what {
                    Meaning::Brush(kind) => {
                        let kept = asked.world.kept_brushes();
                        let now = self.presets.recalled(&asked.brush, kept, kind);
                        // A brush lent while a button is held keeps the current radius.
                        let radius = if held { asked.brush.radius } else { now.radius };
                        BrushSettings { radius, ..now }
                    }
                    _ => BrushSettings { negative: !asked.brush.negative, ..asked.brush },
                });
            }
            Meaning::Turn | Meaning::Slide | Meaning::Zoom | Meaning::RadiusAndStrength => {
                self.tablets[tablet].held.push(what);
            }
            Meaning::Radius | Meaning::Strength => {}
        }
    }
}

/// The pen's motion, where a held button takes it: then its tip touches nothing.
fn drag(tablet: &mut Tablet, pen: &mut Pen, asked: &mut Asked<'_>) {
    let at = pen.pos_mm / pen.area_mm.max(Vec2::splat(1e-3));
    let last = tablet.last.replace(at);
    if !pen.in_range {
        tablet.last = None;
    }
    let taken = tablet.held.last().copied().filter(|_| !tablet.sculpts);
    tablet.sculpts = pen.tip && pen.in_range && taken.is_none();
    let Some(what) = taken else { return };
    pen.tip = false;
    let Some(by) = last.map(|last| at - last).filter(|by| *by != Vec2::ZERO && pen.in_range) else {
        return;
    };
    match what {
        Meaning::Turn => asked.camera.orbit(by),
        Meaning::Slide => asked.camera.pan(by),
        Meaning::Zoom => asked.camera.zoom((-2.0 * by.y).exp()),
        _ => {
            let radius = asked.brush.radius * (DRAG * by.x).exp();
            let strength = asked.brush.strength - by.y;
            asked.brush(BrushSettings { radius, strength, ..asked.brush });
            return;
        }
    }
    asked.out.push(Command::Camera(asked.camera));
}

#[cfg(test)]
mod tests {
    use super::*;
    use sculptd_clay::brush::BrushKind;
    use sculptd_clay::{Clay, Workers};
    use sculptd_devices::Pad;
    use sculptd_devices::pad_actions::Binding;
    use sculptd_engine::world::WorldOptions;
    use sculptd_geometry::shapes;

    fn world() -> World {
        let (ball, _) = shapes::uv_sphere(1.0, 12, 24).triangulate();
        let mesh = Clay::build(&ball, &Default::default()).expect("a ball");
        let brush = Presets::default().of(BrushKind::Draw);
        let options =
            WorldOptions { dab_budget: 1 << 20, undo_bytes: 1 << 20, hands: Default::default() };
        World::new(mesh, Camera::default(), brush, Workers::new(1), options)
    }

    fn sample(body: Body) -> Sample {
        Sample { device: DeviceId(3), t_us: 0, device_t_us: None, body }
    }

    fn pen(x: f32, buttons: u32, tip: bool) -> Sample {
        sample(Body::Pen(Pen {
            in_range: true,
            tip,
            buttons,
            pos_mm: Vec2::new(x, 50.0),
            area_mm: Vec2::splat(100.0),
            ..Default::default()
        }))
    }

    fn pad(keys: u32, wheel: i32) -> Sample {
        sample(Body::Pad(Pad { keys, wheels: [wheel, 0], ..Default::default() }))
    }

    /// Steps the world by these samples; what was asked of it, and the samples as it took them.
    fn step(
        actions: &mut TabletActions,
        world: &mut World,
        mut samples: Vec<Sample>,
    ) -> (Vec<Command>, Vec<Sample>) {
        let mut commands = Vec::new();
        actions.take(&mut samples, world, &mut commands);
        world.step(world.tick() + 1, &samples, &commands);
        (commands, samples)
    }

    fn actions() -> TabletActions {
        TabletActions::new(ActionTable::default(), Presets::default())
    }

    #[test]
    fn keys_undo_and_a_wheel_turns_the_radius() {
        let (mut actions, mut world) = (actions(), world());
        let (asked, _) = step(&mut actions, &mut world, vec![pad(1, 0)]);
        assert!(matches!(asked[..], [Command::Undo]));
        assert!(step(&mut actions, &mut world, vec![pad(1, 0)]).0.is_empty(), "once a press");
        let before = world.brush().radius;
        step(&mut actions, &mut world, vec![pad(0, 1), pad(0, 2)]);
        let grown = world.brush().radius / before;
        assert!((grown - 1.05 * 1.05).abs() < 1e-5, "two steps of five percent: {grown}");
    }

    #[test]
    fn a_click_that_the_desktop_makes_of_a_key_does_not_sculpt() {
        let (mut actions, mut world) = (actions(), world());
        let at = |t_us, body| Sample { t_us, ..sample(body) };
        let key = |t_us, keys| at(t_us, Body::Pad(Pad { keys, ..Default::default() }));
        let press = |t_us, tip| {
            let pen = pen(50.0, 0, tip).body;
            Sample { device: POINTER_ID, ..at(t_us, pen) }
        };
        let tips = |actions: &mut TabletActions, world: &mut World, samples| {
            let (_, seen) = step(actions, world, samples);
            seen.iter().filter(|s| matches!(s.body, Body::Pen(p) if p.tip)).count()
        };
        let click = vec![key(1_000, 1), press(41_000, true), press(60_000, true)];
        assert_eq!(tips(&mut actions, &mut world, click), 0);
        // Its release, and a mouse's press afterwards, while the key is still held.
        let mouse = vec![press(70_000, false), press(90_000, true), press(98_000, false)];
        assert_eq!(tips(&mut actions, &mut world, mouse), 1);
        // Long after a key it is a mouse's, too.
        let late = vec![key(100_000, 0), key(110_000, 2), press(900_000, true)];
        assert_eq!(tips(&mut actions, &mut world, late), 1);
    }

    #[test]
    fn a_model_has_its_own_table_as_soon_as_it_is_known() {
        use std::sync::atomic::{AtomicBool, Ordering::Relaxed};
        let table = |text: &str| toml::from_str::<ActionTable>(text).expect("a table");
        let mut config = crate::config::DevicesConfig::default();
        let own = "controls.key-2 = { press = \"brush.clay\" }";
        config.model_actions.insert("Acme Slate".into(), table(own));
        let catalogue = sculptd_devices::catalogue::Catalogue::default();
        let tables = crate::tablet_models::ModelTables::new(&catalogue, &config);
        let known = Arc::new(AtomicBool::new(false));
        let says = known.clone();
        let model_of = move |id: DeviceId| {
            (says.load(Relaxed) && id == DeviceId(3)).then(|| "Acme Slate".to_owned())
        };
        let models = DeviceTables::new(tables, Arc::new(model_of));
        let all = table("controls.key-2 = { press = \"view.fit\" }");
        let mut actions = TabletActions::new(all, Presets::default()).with_models(models);
        let mut world = world();
        let press = |actions: &mut TabletActions, world: &mut World| {
            let asked = step(actions, world, vec![pad(0b10, 0), pad(0, 0)]).0;
            (asked.len(), matches!(asked[0], Command::Camera(_)), world.brush().kind)
        };
        let before = world.brush().kind;
        assert_eq!(press(&mut actions, &mut world), (1, true, before), "the table of all tablets");
        known.store(true, Relaxed);
        assert_eq!(press(&mut actions, &mut world), (1, false, BrushKind::Clay));
        // Controls missing from the model's table act as on every tablet.
        assert!(matches!(step(&mut actions, &mut world, vec![pad(1, 0)]).0[..], [Command::Undo]));
    }

    #[test]
    fn a_held_key_lends_a_brush_and_gives_back_the_one_before() {
        let (mut actions, mut world) = (actions(), world());
        let before = *world.brush();
        step(&mut actions, &mut world, vec![pad(0b1000, 0)]);
        assert_eq!(world.brush().kind, BrushKind::Smooth);
        step(&mut actions, &mut world, vec![pad(0, 0)]);
        assert_eq!(*world.brush(), before);
    }

    #[test]
    fn a_barrel_button_turns_the_view_and_does_not_sculpt() {
        let (mut actions, mut world) = (actions(), world());
        let yaw = world.camera().yaw;
        let (_, seen) = step(
            &mut actions,
            &mut world,
            vec![pen(40.0, 1, false), pen(45.0, 1, true), pen(50.0, 1, true)],
        );
        assert!((world.camera().yaw - yaw).abs() > 0.1);
        let tip = |s: &Sample| matches!(s.body, Body::Pen(p) if p.tip);
        assert!(!seen.iter().any(tip));
        // Released: the same pen sculpts, and a button in the middle of a stroke breaks nothing.
        let (asked, seen) = step(
            &mut actions,
            &mut world,
            vec![pen(50.0, 0, false), pen(50.0, 0, true), pen(51.0, 1, true), pen(52.0, 1, true)],
        );
        assert!(asked.is_empty());
        assert_eq!(seen.iter().filter(|s| tip(s)).count(), 3);
    }

    #[test]
    fn what_is_bound_while_it_runs_holds_from_the_next_tick_and_a_listened_key_does_nothing() {
        let controls = TabletControls::default();
        let (actions, mut world) = (actions(), world());
        let mut actions = actions.with_controls(controls.clone());
        controls.listen(true);
        assert!(step(&mut actions, &mut world, vec![pad(1, 0), pad(0, 0)]).0.is_empty());
        let worked = controls.last().expect("told");
        assert_eq!((worked.device, worked.control), (DeviceId(3), Control::Key(1)));
        assert!(!controls.is_listening(), "one control is the answer");
        // It is not kept anywhere, and holds all the same.
        let bound = controls.bind(Control::Key(1), Some(Binding::Hold("brush.clay".into())));
        assert!(bound.is_err());
        let before = *world.brush();
        step(&mut actions, &mut world, vec![pad(1, 0)]);
        assert_eq!(world.brush().kind, BrushKind::Clay);
        // Rebinding a held control returns the brush that it lent.
        let _ = controls.bind(Control::Key(1), None);
        step(&mut actions, &mut world, vec![]);
        assert_eq!(*world.brush(), before);
        step(&mut actions, &mut world, vec![pad(0, 0)]);
        assert!(matches!(step(&mut actions, &mut world, vec![pad(1, 0)]).0[..], [Command::Undo]));
    }
}
