//! Which parser reads a report: the closed set of families, each with what it must remember.

use super::uclogic::Packing;
use super::{
    digitiser, uclogic, vendors, wacom_bamboo, wacom_bluetooth, wacom_display, wacom_graphire,
    wacom_intuos, wacom_pad, wacom_pro,
};
use crate::descriptor::Descriptor;
use crate::report::{Batch, Parsed};
use crate::tablet::{Family, Id, PadLayout, Quirk, Tablet};

/// libinput's time of silence after which a pen that never says so has left.
const SILENCE_US: u64 = 50_000;

/// A family bound to one model.
#[derive(Debug, Clone)]
pub enum Engine {
    Intuos(wacom_intuos::Traits, wacom_intuos::Memory, Option<PadLayout>),
    Simple {
        max_distance: u32,
        memory: wacom_bamboo::Memory,
    },
    BambooPad,
    Graphire(wacom_graphire::Kind),
    PenPartner {
        leaves: bool,
    },
    Display(wacom_display::Kind, u32, wacom_display::Memory),
    Pro(wacom_pro::Kind),
    Bluetooth(wacom_bluetooth::Kind, wacom_bluetooth::Memory),
    UcLogic(uclogic::Traits, uclogic::Memory),
    /// Families without memory; `leaves`: they say when the pen goes.
    Vendor {
        parse: fn(&[u8]) -> Parsed,
        leaves: bool,
    },
    Digitiser(Box<Descriptor>),
}

impl Engine {
    /// `descriptor` of the interface; empty where it is unknown.
    pub fn new(tablet: &Tablet, id: &Id, descriptor: &[u8]) -> Engine {
        let quirk = |q| id.quirks.contains(&q);
        let described = Descriptor::parse(descriptor).unwrap_or_default();
        let uclogic = |packing| {
            let range = described.pens.iter().find_map(|p| p.in_range.as_ref());
            let range_bit =
                range.and_then(|b| b.start.checked_sub(8)).filter(|b| *b < 8).map(|b| b as u8);
            let untilted =
                described.pens.iter().filter(|p| p.tilt[0].is_none()).filter_map(|p| p.report_id);
            let untilted = untilted.filter(|id| *id < 32).fold(0, |bits, id| bits | 1 << id);
            let traits =
                uclogic::Traits { packing, range_bit, no_tilt: quirk(Quirk::NoTilt), untilted };
            Engine::UcLogic(traits, uclogic::Memory::default())
        };
        let vendor = |parse: fn(&[u8]) -> Parsed, leaves| Engine::Vendor { parse, leaves };
        let display =
            |kind| Engine::Display(kind, tablet.pen.max_pressure, wacom_display::Memory::default());
        let bluetooth = |kind| Engine::Bluetooth(kind, wacom_bluetooth::Memory::default());
        match id.parser {
            Family::WacomIntuosV1 => Engine::Intuos(
                wacom_intuos::Traits {
                    halved: quirk(Quirk::Halved),
                    halved_pressure: tablet.pen.max_pressure < 2047,
                    needs_ready: quirk(Quirk::NeedsReady),
                    needs_new_pen: quirk(Quirk::NeedsNewPen),
                    height_inverted: quirk(Quirk::HeightInverted),
                    max_distance: tablet.pen.max_distance,
                },
                wacom_intuos::Memory::default(),
                tablet.pad.layout,
            ),
            Family::WacomSimple => Engine::Simple {
                max_distance: tablet.pen.max_distance,
                memory: wacom_bamboo::Memory::default(),
            },
            Family::WacomBambooPad => Engine::BambooPad,
            Family::WacomGraphire => Engine::Graphire(wacom_graphire::Kind::Graphire),
            Family::WacomGraphire4 => Engine::Graphire(wacom_graphire::Kind::Graphire4),
            Family::WacomBamboo => Engine::Graphire(wacom_graphire::Kind::Ring),
            Family::WacomGraphireBluetooth => Engine::Graphire(wacom_graphire::Kind::Bluetooth),
            Family::WacomPenPartner => Engine::PenPartner { leaves: false },
            Family::WacomPl => display(wacom_display::Kind::Pl),
            Family::WacomPtu => display(wacom_display::Kind::Ptu),
            Family::WacomDtu => display(wacom_display::Kind::Dtu),
            Family::WacomDtus => display(wacom_display::Kind::Dtus),
            Family::WacomTabletPc => display(wacom_display::Kind::TabletPc),
            Family::WacomIntuosV2 => Engine::Pro(wacom_pro::Kind::V2),
            Family::WacomProBluetooth => bluetooth(wacom_bluetooth::Kind::Pro),
            Family::WacomIntuosBluetooth => bluetooth(wacom_bluetooth::Kind::Intuos),
            Family::WacomIntuosV3 => Engine::Pro(wacom_pro::Kind::V3),
            Family::WacomOne => Engine::Pro(wacom_pro::Kind::One),
            Family::UcLogic => uclogic(Packing::XpPen),
            Family::XpPenOffset => uclogic(Packing::XpPenOffset),
            Family::XpPenGen2 => uclogic(Packing::XpPenGen2),
            Family::Huion => uclogic(Packing::Huion),
            Family::Floogoo => uclogic(Packing::Fma),
            Family::Veikk => vendor(|b| vendors::veikk(b, false), true),
            Family::VeikkA15 => vendor(|b| vendors::veikk(b, true), true),
            Family::Acepen => vendor(vendors::acepen, true),
            Family::Kye => vendor(vendors::kye, false),
            Family::KyePlain => vendor(vendors::kye_plain, false),
            Family::TenMoons => vendor(vendors::ten_moons, false),
            Family::Plain => vendor(vendors::plain, false),
            Family::Xenx => vendor(vendors::xenx, true),
            Family::RobotPen => vendor(vendors::robot_pen, true),
            Family::WoodPad => vendor(vendors::wood_pad, true),
            Family::Digitiser => Engine::Digitiser(Box::new(described)),
        }
    }

    /// Reads one report, its id first where it has one.
    pub fn parse(&mut self, b: &[u8], out: &mut Batch) {
        match self {
            Engine::Intuos(traits, memory, pad) => {
                match pad.and_then(|layout| wacom_pad::parse(b, layout)) {
                    Some(halves) => halves.into_iter().for_each(|r| out.push(Parsed::Pad(r))),
                    None => out.push(wacom_intuos::parse(b, traits, memory)),
                }
            }
            Engine::Simple { max_distance, memory } => {
                out.push(wacom_bamboo::parse(b, *max_distance, memory));
            }
            Engine::BambooPad => out.push(wacom_bamboo::bamboo_pad(b)),
            Engine::Graphire(kind) => {
                let parsed = wacom_graphire::parse(b, *kind);
                out.push(parsed);
                if parsed != Parsed::Nothing {
                    wacom_graphire::pad(b, *kind)
                        .into_iter()
                        .for_each(|r| out.push(Parsed::Pad(r)));
                }
            }
            Engine::PenPartner { leaves } => {
                let parsed = wacom_graphire::pen_partner(b);
                *leaves |= parsed == Parsed::Away;
                out.push(parsed);
            }
            Engine::Display(kind, max, memory) => {
                out.push(wacom_display::parse(b, *kind, *max, memory));
            }
            Engine::Pro(kind) => wacom_pro::parse(b, *kind, out),
            Engine::Bluetooth(kind, memory) => wacom_bluetooth::parse(b, *kind, memory, out),
            Engine::UcLogic(traits, memory) => out.push(uclogic::parse(b, traits, memory)),
            Engine::Vendor { parse, .. } => out.push(parse(b)),
            Engine::Digitiser(d) => digitiser::parse(b, d, out),
        }
    }

    /// Linux `wacom_intuos_schedule_prox_event` asks for the same report.
    pub fn names_tool(&self) -> Option<u8> {
        match self {
            Engine::Intuos(traits, ..) => Some(if traits.height_inverted { 8 } else { 5 }),
            _ => None,
        }
    }

    /// Before it is switched to its maker's protocol such a tablet counts as its descriptor says,
    /// in the same layout.
    pub fn follows_descriptor(&self) -> bool {
        matches!(self, Engine::UcLogic(..))
    }

    /// The family always tells tilt, if not in every report.
    pub fn has_tilt(&self) -> bool {
        matches!(self, Engine::Intuos(traits, ..) if !traits.height_inverted)
    }

    /// Silence that means "gone", for families and firmwares that never say it.
    pub fn silence_us(&self) -> Option<u64> {
        let mute = match self {
            Engine::Intuos(..) | Engine::Simple { .. } | Engine::Graphire(_) => false,
            Engine::Display(..) | Engine::Pro(_) | Engine::Bluetooth(..) => false,
            Engine::BambooPad => true,
            Engine::PenPartner { leaves } | Engine::Vendor { leaves, .. } => !leaves,
            Engine::UcLogic(_, memory) => memory.is_mute(),
            Engine::Digitiser(d) => d.pens.iter().any(|p| p.in_range.is_none()),
        };
        mute.then_some(SILENCE_US)
    }
}
