//! The parsers, one for each family, with what each remembers between reports.

use super::pen_firmware::FirmwareRules;
use super::uclogic::{Packing, UcLogicBits};
use super::{
    digitiser, uclogic, vendors, wacom_bamboo, wacom_bluetooth, wacom_display, wacom_graphire,
    wacom_intuos, wacom_pad, wacom_pro,
};
use crate::descriptor::{Descriptor, PenLayout};
use crate::report::{Batch, Parsed};
use crate::tablet::{Family, Id, PadLayout, Quirk, Tablet};

/// Microseconds of silence after which a pen has left that sends no report of it; the figure is
/// libinput's.
const SILENCE_US: u64 = 50_000;

/// USB vendor of Huion's tablets and Gaomon's.
const HUION: u16 = 0x256c;
/// USB vendor whose pens seem to leave when their second button is pressed.
const XP_PEN: u16 = 0x28bd;
/// USB vendor whose second barrel button is sent as tip and first button.
const WALTOP: u16 = 0x172f;

/// Linux `wacom_set_barrel_switch3_usage`.
fn sends_third_as_both(pen: &PenLayout) -> bool {
    let two = pen.barrel[0].is_some() && pen.barrel[1].is_some();
    two && pen.serial.is_some() && pen.barrel[2].is_none()
}

/// A family bound to one model.
#[derive(Debug, Clone)]
pub enum Engine {
    /// Intuos 1 to 5, Intuos Pro, most Cintiqs, with the layout of their pads.
    Intuos(wacom_intuos::IntuosTraits, wacom_intuos::IntuosMemory, Option<PadLayout>),
    /// Bamboo, One by Wacom, Intuos of 2013.
    Simple {
        /// Greatest height in counts; 0 where height is not sent.
        max_distance: u32,
        /// The tool of the present visit.
        memory: wacom_bamboo::BambooMemory,
    },
    /// Bamboo Pad.
    BambooPad,
    /// Graphire and the tablets that share its layout.
    Graphire(wacom_graphire::GraphireKind),
    /// PenPartner.
    PenPartner {
        /// A report of the newer kind was seen, which says when the pen leaves.
        leaves: bool,
    },
    /// Pen displays of the PL, PTU and DTU series and tablet PCs, with their full pressure.
    Display(wacom_display::DisplayKind, u32, wacom_display::DisplayMemory),
    /// Intuos Pro of 2017 and 2025, Intuos of 2018, Wacom One.
    Pro(wacom_pro::ProKind),
    /// The same over Bluetooth.
    Bluetooth(wacom_bluetooth::BluetoothKind, wacom_bluetooth::BluetoothMemory),
    /// UC-Logic, Huion, XP-Pen and their many brands.
    UcLogic(uclogic::UcLogicTraits, uclogic::UcLogicMemory),
    /// Families that remember nothing.
    Vendor {
        /// Reads one report.
        parse: fn(&[u8]) -> Parsed,
        /// The reports say when the pen leaves.
        leaves: bool,
    },
    /// By the report descriptor.
    Digitiser(Box<Descriptor>, FirmwareRules),
}

impl Engine {
    /// `descriptor` of the interface; empty where it is unknown.
    pub fn new(tablet: &Tablet, id: &Id, descriptor: &[u8]) -> Engine {
        let quirk = |q| id.quirks.contains(&q);
        let mut described = Descriptor::parse(descriptor).unwrap_or_default();
        // A bare pointer beside a pen is a mouse.
        if described.pens.iter().any(|p| !p.bare) {
            described.pens.retain(|p| !p.bare);
        }
        let uclogic = |packing| {
            let range = described.pens.iter().find_map(|p| p.in_range.as_ref());
            let range_bit =
                range.and_then(|b| b.start.checked_sub(8)).filter(|b| *b < 8).map(|b| b as u8);
            let untilted =
                described.pens.iter().filter(|p| p.tilt[0].is_none()).filter_map(|p| p.report_id);
            let untilted = untilted.filter(|id| *id < 32).fold(0, |bits, id| bits | 1 << id);
            let traits = uclogic::UcLogicTraits {
                packing,
                range_bit,
                no_tilt: quirk(Quirk::NoTilt),
                untilted,
                bits: UcLogicBits::of(
                    &described,
                    id.vid == XP_PEN,
                    id.vid == HUION || packing == Packing::Huion && id.vid != XP_PEN,
                ),
            };
            Engine::UcLogic(traits, uclogic::UcLogicMemory::default())
        };
        let vendor = |parse: fn(&[u8]) -> Parsed, leaves| Engine::Vendor { parse, leaves };
        let display = |kind| {
            Engine::Display(kind, tablet.pen.max_pressure, wacom_display::DisplayMemory::default())
        };
        let bluetooth = |kind| Engine::Bluetooth(kind, wacom_bluetooth::BluetoothMemory::default());
        match id.parser {
            Family::WacomIntuosV1 => Engine::Intuos(
                wacom_intuos::IntuosTraits {
                    halved: quirk(Quirk::Halved),
                    halved_pressure: tablet.pen.max_pressure < 2047,
                    needs_ready: quirk(Quirk::NeedsReady),
                    needs_new_pen: quirk(Quirk::NeedsNewPen),
                    height_inverted: quirk(Quirk::HeightInverted),
                    max_distance: tablet.pen.max_distance,
                },
                wacom_intuos::IntuosMemory::default(),
                tablet.pad.layout,
            ),
            Family::WacomSimple => Engine::Simple {
                max_distance: tablet.pen.max_distance,
                memory: wacom_bamboo::BambooMemory::default(),
            },
            Family::WacomBambooPad => Engine::BambooPad,
            Family::WacomGraphire => Engine::Graphire(wacom_graphire::GraphireKind::Graphire),
            Family::WacomGraphire4 => Engine::Graphire(wacom_graphire::GraphireKind::Graphire4),
            Family::WacomBamboo => Engine::Graphire(wacom_graphire::GraphireKind::Ring),
            Family::WacomGraphireBluetooth => {
                Engine::Graphire(wacom_graphire::GraphireKind::Bluetooth)
            }
            Family::WacomPenPartner => Engine::PenPartner { leaves: false },
            Family::WacomPl => display(wacom_display::DisplayKind::Pl),
            Family::WacomPtu => display(wacom_display::DisplayKind::Ptu),
            Family::WacomDtu => display(wacom_display::DisplayKind::Dtu),
            Family::WacomDtus => display(wacom_display::DisplayKind::Dtus),
            Family::WacomTabletPc => display(wacom_display::DisplayKind::TabletPc),
            Family::WacomIntuosV2 => Engine::Pro(wacom_pro::ProKind::V2),
            Family::WacomProBluetooth => bluetooth(wacom_bluetooth::BluetoothKind::Pro),
            Family::WacomIntuosBluetooth => bluetooth(wacom_bluetooth::BluetoothKind::Intuos),
            Family::WacomIntuosV3 => Engine::Pro(wacom_pro::ProKind::V3),
            Family::WacomOne => Engine::Pro(wacom_pro::ProKind::One),
            Family::UcLogic => uclogic(Packing::XpPen),
            Family::XpPenOffset => uclogic(Packing::XpPenOffset),
            Family::XpPenGen2 => uclogic(Packing::XpPenGen2),
            Family::Huion => uclogic(Packing::Huion),
            Family::Floogoo => uclogic(Packing::Fma),
            Family::Veikk => vendor(|b| vendors::veikk(b, false), true),
            Family::VeikkA15 => vendor(|b| vendors::veikk(b, true), true),
            Family::Acepen => vendor(vendors::acepen, true),
            Family::Kye => vendor(vendors::kye, false),
            Family::KyePlain => vendor(vendors::kye_plain, true),
            Family::TenMoons => vendor(vendors::ten_moons, false),
            Family::Plain => vendor(vendors::plain_layout, false),
            Family::Xenx => vendor(vendors::xenx, true),
            Family::RobotPen => vendor(vendors::robot_pen, true),
            Family::WoodPad => vendor(vendors::wood_pad, true),
            Family::Signature => vendor(vendors::signature, true),
            Family::Digitiser => {
                let rules = FirmwareRules {
                    third_is_both: described.pens.iter().any(sends_third_as_both),
                    second_is_tip_and_first: id.vid == WALTOP,
                    ..FirmwareRules::default()
                };
                Engine::Digitiser(Box::new(described), rules)
            }
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
            Engine::Digitiser(d, _) => digitiser::parse(b, d, out),
        }
    }

    /// Returns the firmware faults of this family's pens.
    pub fn firmware_rules(&self) -> FirmwareRules {
        let none = FirmwareRules::default();
        match self {
            Engine::Pro(wacom_pro::ProKind::V2 | wacom_pro::ProKind::One)
            | Engine::Bluetooth(..) => FirmwareRules { third_is_both: true, ..none },
            Engine::UcLogic(traits, _) => FirmwareRules {
                third_is_invert: traits.bits.third_is_invert,
                second_bounces: traits.bits.second_bounces,
                ..none
            },
            Engine::Digitiser(_, rules) => *rules,
            _ => none,
        }
    }

    /// Linux `wacom_intuos_schedule_prox_event` asks for the same report.
    pub fn names_tool(&self) -> Option<u8> {
        match self {
            Engine::Intuos(traits, ..) => Some(if traits.height_inverted { 8 } else { 5 }),
            _ => None,
        }
    }

    /// Before it is switched to its vendor's protocol such a tablet has the ranges of its
    /// descriptor, in the same layout.
    pub fn follows_descriptor(&self) -> bool {
        matches!(self, Engine::UcLogic(..))
    }

    /// The family always reports tilt, if not in every report.
    pub fn has_tilt(&self) -> bool {
        matches!(self, Engine::Intuos(traits, ..) if !traits.height_inverted)
    }

    /// Microseconds of silence after which the pen has left, for families and firmwares that send
    /// no report of it.
    pub fn silence_us(&self) -> Option<u64> {
        let mute = match self {
            Engine::Intuos(..) | Engine::Simple { .. } | Engine::Graphire(_) => false,
            Engine::Display(..) | Engine::Pro(_) | Engine::Bluetooth(..) => false,
            Engine::BambooPad => true,
            Engine::PenPartner { leaves } | Engine::Vendor { leaves, .. } => !leaves,
            Engine::UcLogic(_, memory) => memory.is_mute(),
            Engine::Digitiser(d, _) => d.pens.iter().any(|p| p.in_range.is_none()),
        };
        mute.then_some(SILENCE_US)
    }
}
