//! Which parser reads a report: the closed set of families, each with what it must remember.

use super::uclogic::Packing;
use super::{
    digitiser, uclogic, vendors, wacom_bamboo, wacom_display, wacom_graphire, wacom_intuos,
    wacom_pad, wacom_pro,
};
use crate::descriptor::Descriptor;
use crate::report::{PadReport, Parsed};
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
    UcLogic(uclogic::Traits, uclogic::Memory),
    /// Families without memory; `leaves`: they say when the pen goes.
    Maker {
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
        let maker = |parse: fn(&[u8]) -> Parsed, leaves| Engine::Maker { parse, leaves };
        let display =
            |kind| Engine::Display(kind, tablet.pen.max_pressure, wacom_display::Memory::default());
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
            Family::WacomIntuosV3 => Engine::Pro(wacom_pro::Kind::V3),
            Family::WacomOne => Engine::Pro(wacom_pro::Kind::One),
            Family::UcLogic => uclogic(Packing::XpPen),
            Family::XpPenOffset => uclogic(Packing::XpPenOffset),
            Family::XpPenGen2 => uclogic(Packing::XpPenGen2),
            Family::Huion => uclogic(Packing::Huion),
            Family::Floogoo => uclogic(Packing::Fma),
            Family::Veikk => maker(|b| vendors::veikk(b, false), true),
            Family::VeikkA15 => maker(|b| vendors::veikk(b, true), true),
            Family::Acepen => maker(vendors::acepen, true),
            Family::Kye => maker(vendors::kye, false),
            Family::KyePlain => maker(vendors::kye_plain, false),
            Family::TenMoons => maker(vendors::ten_moons, false),
            Family::Plain => maker(vendors::plain, false),
            Family::Xenx => maker(vendors::xenx, true),
            Family::RobotPen => maker(vendors::robot_pen, true),
            Family::WoodPad => maker(vendors::wood_pad, true),
            Family::Digitiser => Engine::Digitiser(Box::new(described)),
        }
    }

    /// What a report says of the pen, and of the pad where they share it.
    pub fn parse(&mut self, b: &[u8]) -> (Parsed, Option<PadReport>, Option<PadReport>) {
        match self {
            Engine::Intuos(traits, memory, pad) => {
                match pad.and_then(|layout| wacom_pad::parse(b, layout)) {
                    Some([first, second]) => (Parsed::Nothing, Some(first), Some(second)),
                    None => (wacom_intuos::parse(b, traits, memory), None, None),
                }
            }
            Engine::Simple { max_distance, memory } => {
                (wacom_bamboo::parse(b, *max_distance, memory), None, None)
            }
            Engine::BambooPad => (wacom_bamboo::bamboo_pad(b), None, None),
            Engine::Graphire(kind) => {
                let parsed = wacom_graphire::parse(b, *kind);
                let pad =
                    if parsed == Parsed::Nothing { None } else { wacom_graphire::pad(b, *kind) };
                (parsed, pad, None)
            }
            Engine::PenPartner { leaves } => {
                let parsed = wacom_graphire::pen_partner(b);
                *leaves |= parsed == Parsed::Away;
                (parsed, None, None)
            }
            Engine::Display(kind, max, memory) => {
                (wacom_display::parse(b, *kind, *max, memory), None, None)
            }
            Engine::Pro(kind) => (wacom_pro::parse(b, *kind), None, None),
            Engine::UcLogic(traits, memory) => (uclogic::parse(b, traits, memory), None, None),
            Engine::Maker { parse, .. } => (parse(b), None, None),
            Engine::Digitiser(d) => (digitiser::parse(b, d), None, None),
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
            Engine::Display(..) | Engine::Pro(_) => false,
            Engine::BambooPad => true,
            Engine::PenPartner { leaves } | Engine::Maker { leaves, .. } => !leaves,
            Engine::UcLogic(_, memory) => memory.is_mute(),
            Engine::Digitiser(d) => d.pens.iter().any(|p| p.in_range.is_none()),
        };
        mute.then_some(SILENCE_US)
    }
}
