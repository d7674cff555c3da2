//! The checks that processes ask for: each measures, compares with the limits, and says what to do.

use glam::DVec3;
use sculptd_geometry::job::{Cancelled, Job};
use sculptd_geometry::measure::projected_area;
use sculptd_geometry::thickness::MeasuredSide;

use crate::answer::PartFacts;
use crate::columns::{CELLS, cell_area};
use crate::estimates::{clamping_force, cooling_time};
use crate::finding::{Finding, FindingKind};
use crate::layers::overhangs::overhangs;
use crate::layers::placement::{covers, first_layer, tip_angle, too_large};
use crate::layers::plate::PlateContact;
use crate::layers::sweep::sweep;
use crate::moulding::{best_parting, draft_regions, undercuts};
use crate::part::{PreparedPart, Standing};
use crate::preset::BuildMethod;
use crate::repair::rounding_volume;
use crate::settings::CheckSettings;
use crate::walls::{WallLimits, thin_places, wall_spread};

/// One check's findings and facts.
pub(crate) type Outcome = (Vec<Finding>, PartFacts);

/// Why a check could not run.
pub(crate) enum Stopped {
    Cancelled,
    Because(String),
}

impl From<Cancelled> for Stopped {
    fn from(_: Cancelled) -> Stopped {
        Stopped::Cancelled
    }
}

/// The input of a check.
pub(crate) struct CheckView<'a> {
    pub part: &'a PreparedPart,
    pub stand: &'a Standing,
    pub settings: &'a CheckSettings,
    pub job: &'a Job,
}

/// A check's name, its name in a sentence, and what it does.
pub(crate) type AskedCheck =
    (&'static str, &'static str, fn(&CheckView<'_>) -> Result<Outcome, Stopped>);

/// The checks that a process asks for.
pub(crate) fn asked(settings: &CheckSettings) -> Vec<AskedCheck> {
    let p = &settings.process;
    let mut out: Vec<AskedCheck> = Vec::new();
    if settings.walls.is_some() || p.pin.is_some() || p.resolution.is_some() {
        out.push(("walls", "wall thickness", walls));
    }
    if p.gap.is_some() || p.hole.is_some() {
        out.push(("gaps", "clearance", gaps));
    }
    if p.method == BuildMethod::Mould {
        out.push(("thick-sections", "the thickest wall", thick_sections));
    }
    if p.islands || p.trapped.is_some() || p.cup.is_some() {
        out.push(("layers", "what layers begin and seal", layers));
    }
    if p.overhang.is_some() {
        out.push(("overhangs", "overhangs", down_faces));
    }
    if p.tip_angle.is_some() || p.contact_area.is_some() {
        out.push(("placement", "the first layer", placement));
    }
    if settings.printer.as_ref().is_some_and(|p| p.build_volume.is_some()) {
        out.push(("size", "the size", size));
    }
    if p.method == BuildMethod::Mould {
        out.push(("mould", "draft and undercuts", mould));
    }
    out
}

/// A number of a preset in single precision as it was written: 0.8, not 0.800000012.
fn as_written(value: f32) -> f64 {
    value.to_string().parse().unwrap_or_else(|_| f64::from(value))
}

fn walls(c: &CheckView<'_>) -> Result<Outcome, Stopped> {
    let p = &c.settings.process;
    let preset = c.settings.walls.as_ref();
    let limits = WallLimits {
        fail_below: preset.map(|w| as_written(w.fail_below)),
        warn_below: preset.map(|w| as_written(w.warn_below)),
        round: p.pin,
        resolution: p.resolution,
    };
    let found = thin_places(c.part, MeasuredSide::Wall, &limits, c.job)?;
    Ok((found, PartFacts::default()))
}

fn gaps(c: &CheckView<'_>) -> Result<Outcome, Stopped> {
    let p = &c.settings.process;
    let limits = WallLimits {
        fail_below: p.gap,
        warn_below: None,
        round: p.hole.or(p.gap),
        resolution: p.resolution.filter(|_| p.gap.is_some()),
    };
    let found = thin_places(c.part, MeasuredSide::Gap, &limits, c.job)?;
    Ok((found, PartFacts::default()))
}

fn thick_sections(c: &CheckView<'_>) -> Result<Outcome, Stopped> {
    let Some(spread) = wall_spread(c.part, c.job)? else {
        return Err(Stopped::Because("no place of the part has a wall".into()));
    };
    let place = c.part.to_file(spread.position);
    let mut out = Vec::new();
    let value = spread.thickest;
    if let Some(limit) = c.settings.walls.as_ref().and_then(|w| w.fail_above).map(as_written)
        && value - spread.error > limit
    {
        let message = format!("a section is {value:.2} mm thick; core it out to {limit:.2} mm");
        let found = Finding::new(FindingKind::ThickSection, message).at(place);
        out.push(found.measured(value, limit, "mm").within(spread.error));
    }
    if let Some(limit) = c.settings.walls.as_ref().and_then(|w| w.neighbour_ratio).map(as_written) {
        let ratio = value / spread.nominal;
        let error = spread.error / spread.nominal;
        if ratio - error > limit {
            let message = format!(
                "a section is {ratio:.2} times the nominal wall of {:.2} mm and may sink; core it \
                 out, or make ribs thinner",
                spread.nominal
            );
            let found = Finding::new(FindingKind::Sink, message).at(place);
            out.push(found.measured(ratio, limit, "times").within(error).warning());
        }
    }
    let facts = PartFacts {
        nominal_wall: Some(spread.nominal),
        thickest_wall: Some(value),
        cooling_time: cooling_time(value, &c.settings.material),
        ..Default::default()
    };
    Ok((out, facts))
}

fn layers(c: &CheckView<'_>) -> Result<Outcome, Stopped> {
    let (p, part) = (&c.settings.process, c.part);
    let contact = PlateContact::new(part, c.stand);
    let plate = p.method == BuildMethod::Layers;
    let layer = c.settings.layer();
    let found = sweep(part, c.stand, &contact, layer, plate, c.job)?;
    let mut out = Vec::new();
    if p.islands {
        for i in &found.islands {
            let message = format!(
                "layer {} begins a contour at {:.3} mm with nothing below it; support it or turn \
                 the part",
                i.layer, i.height
            );
            let island = Finding::new(FindingKind::Island, message).at(part.to_file(i.position));
            out.push(island.measured(i.height, 0.0, "mm").over(i.area));
        }
    }
    if let Some(limit) = p.trapped {
        for v in found.trapped.iter().filter(|v| v.volume > limit + rounding_volume(part)) {
            let what = match p.method {
                BuildMethod::Layers if p.cup.is_some() => "resin stays in it; add a drain hole",
                BuildMethod::Powder => "powder stays in it; add an escape hole",
                BuildMethod::Mould => "no mould makes it; open it or split the part",
                BuildMethod::Layers => "support in it cannot be removed; open it or fill it",
            };
            let message = format!("a cavity of {:.3} mm3 is enclosed: {what}", v.volume);
            let trapped = Finding::new(FindingKind::TrappedVolume, message);
            let trapped = trapped.at(part.to_file(v.position)).measured(v.volume, limit, "mm3");
            // Filament leaves air in it, which does no harm.
            let harmless = p.method == BuildMethod::Layers && p.cup.is_none();
            out.push(if harmless { trapped.warning() } else { trapped });
        }
    }
    if let Some(limit) = p.cup {
        for v in found.cups.iter().filter(|v| v.volume > limit) {
            let until = match v.opens {
                Some(h) => format!("until {h:.2} mm above the plate"),
                None => "by the plate".into(),
            };
            let message = format!(
                "a volume of {:.3} mm3 is sealed {until} and pulls at the part; add a vent at its \
                 lowest point or turn the part",
                v.volume
            );
            let cup = Finding::new(FindingKind::SuctionCup, message);
            let cup = cup.at(part.to_file(v.position)).measured(v.volume, limit, "mm3");
            out.push(if v.through { cup.warning() } else { cup });
        }
    }
    Ok((out, PartFacts::default()))
}

fn down_faces(c: &CheckView<'_>) -> Result<Outcome, Stopped> {
    let (p, part) = (&c.settings.process, c.part);
    let Some(limit) = p.overhang else { return Ok(Default::default()) };
    let cell = cell_area(part, CELLS);
    let found = overhangs(part, c.stand, limit, p.bridge.is_some(), cell, c.job)?;
    let mut out = Vec::new();
    let (mut area, mut support, mut variance) = (0.0, 0.0, 0.0);
    for o in &found {
        area += o.region.area;
        support += o.support.total;
        variance += o.support.variance;
        let place = part.to_file(o.region.position);
        if let (Some(span), Some(limit)) = (o.bridge, p.bridge) {
            if span > limit + part.tolerance {
                let message = format!(
                    "a ceiling spans {span:.2} mm between its supports; shorten it to {limit} mm \
                     or support it"
                );
                let bridge = Finding::new(FindingKind::Bridge, message).at(place);
                out.push(bridge.measured(span, limit, "mm").over(o.region.area));
            }
        } else if o.region.area >= p.overhang_area.unwrap_or(0.0) {
            let message = format!(
                "{:.1} mm2 look down at {:.1} degrees from the vertical; support them ({:.1} mm3) \
                 or turn the part",
                o.region.area, o.angle, o.support.total
            );
            let overhang = Finding::new(FindingKind::Overhang, message).at(place);
            out.push(overhang.measured(o.angle, limit, "degrees").over(o.region.area));
        }
    }
    let facts = PartFacts {
        overhang_area: Some(area),
        support_volume: Some(support),
        support_error: Some(variance.sqrt()),
        ..Default::default()
    };
    Ok((out, facts))
}

fn placement(c: &CheckView<'_>) -> Result<Outcome, Stopped> {
    let (p, part) = (&c.settings.process, c.part);
    let layer = first_layer(part, c.stand, c.settings.layer());
    let place = part.to_file(layer.centre);
    let mut out = Vec::new();
    if let Some(limit) = p.contact_area
        && !covers(part, layer.area, limit)
    {
        let message = format!(
            "the first layer covers {:.2} mm2; turn the part, flatten its base, or print it on a \
             raft",
            layer.area
        );
        let contact = Finding::new(FindingKind::Contact, message).at(place);
        out.push(contact.measured(layer.area, limit, "mm2"));
    }
    let mut tip = None;
    if let (Some(limit), Some(centre)) = (p.tip_angle, part.sizes.centroid) {
        let angle = tip_angle(c.stand, &layer, centre);
        tip = Some(angle);
        if angle < limit - 1e-6 {
            let message = if angle < 0.0 {
                "the centre of mass is not above the first layer, so that the part falls; support \
                 it or turn it"
                    .to_string()
            } else {
                format!("the part falls when it is tilted by {angle:.2} degrees; widen its base")
            };
            let tipping = Finding::new(FindingKind::Tipping, message).at(part.to_file(centre));
            out.push(tipping.measured(angle, limit, "degrees"));
        }
    }
    let facts = PartFacts { contact_area: Some(layer.area), tip_angle: tip, ..Default::default() };
    Ok((out, facts))
}

fn size(c: &CheckView<'_>) -> Result<Outcome, Stopped> {
    let room = c.settings.printer.as_ref().and_then(|p| p.build_volume);
    let mut out = Vec::new();
    if let Some(room) = room
        && let Some((over, axis)) = too_large(c.part, c.stand, room)
    {
        let limit = room[axis];
        let side = ["width", "depth", "height"][axis];
        let message = format!(
            "the part is {over:.2} mm larger than the printer's {side}; scale, turn or split it"
        );
        let size = Finding::new(FindingKind::Size, message).at(c.part.to_file(DVec3::ZERO));
        out.push(size.measured(limit + over, limit, "mm"));
    }
    Ok((out, PartFacts::default()))
}

fn mould(c: &CheckView<'_>) -> Result<Outcome, Stopped> {
    let (p, part, pull) = (&c.settings.process, c.part, c.settings.up);
    let cell = cell_area(part, CELLS);
    let mut out = Vec::new();
    if let Some(limit) = p.draft {
        let large = |area: f64| area >= p.draft_area.unwrap_or(0.0);
        for r in draft_regions(part, pull, limit).iter().filter(|r| large(r.region.area)) {
            let message = format!(
                "{:.1} mm2 have a draft of {:.2} degrees; tilt them to {limit} degrees",
                r.region.area, r.draft
            );
            let draft = Finding::new(FindingKind::Draft, message);
            let draft = draft.at(part.to_file(r.region.position));
            out.push(draft.measured(r.draft, limit, "degrees").over(r.region.area));
        }
    }
    let mut facts = PartFacts::default();
    if let Some(limit) = p.undercut {
        let draft = p.draft.unwrap_or(0.0);
        let best = best_parting(part, &[pull], draft, c.job)?;
        let regions = undercuts(part, pull, cell, c.job)?;
        let total: f64 = regions.iter().map(|r| r.hidden.total).sum();
        facts.undercut_area = Some(total);
        let mut better = String::new();
        if let Some(b) = best {
            facts.parting_direction = Some(b.direction.to_array());
            facts.parting_undercut = Some(b.undercut.total);
            if b.undercut.total + 3.0 * b.undercut.error() < total - limit {
                let d = b.direction;
                better = format!(
                    ", or part the mould along ({:.3}, {:.3}, {:.3}), where {:.1} mm2 are left",
                    d.x, d.y, d.z, b.undercut.total
                );
            }
        }
        for r in regions.iter().filter(|r| r.hidden.total > limit) {
            let message = format!(
                "neither half of the mould releases {:.1} mm2; open the face or add a \
                 slide{better}",
                r.hidden.total
            );
            let undercut = Finding::new(FindingKind::Undercut, message);
            let undercut = undercut.at(part.to_file(r.region.position));
            let value = r.hidden.total;
            out.push(undercut.measured(value, limit, "mm2").over(value).within(r.hidden.error()));
        }
    }
    let shadow = projected_area(&part.centred.mesh, pull.as_vec3(), c.job)?;
    facts.projected_area = Some(shadow);
    facts.shot_volume = Some(part.sizes.volume);
    facts.clamping_force = clamping_force(shadow, &c.settings.material);
    let machine = c.settings.printer.as_ref();
    let middle = part.to_file(DVec3::ZERO);
    if let (Some(force), Some(limit)) =
        (facts.clamping_force, machine.and_then(|m| m.clamping_force))
        && force > limit
    {
        let message = format!(
            "the mould needs {force:.0} kN to stay closed; use a larger machine or turn the part"
        );
        let clamp = Finding::new(FindingKind::ClampingForce, message).at(middle);
        out.push(clamp.measured(force, limit, "kN"));
    }
    if let Some(limit) = machine.and_then(|m| m.shot_volume)
        && part.sizes.volume > limit
    {
        let message = "the part takes more than the machine injects; use a larger machine";
        let shot = Finding::new(FindingKind::ShotVolume, message).at(middle);
        out.push(shot.measured(part.sizes.volume, limit, "mm3"));
    }
    Ok((out, facts))
}
