//! The names that tables of a tablet's controls use, what they mean, and what a person may choose.

use sculptd_clay::brush::BrushKind;
use sculptd_devices::pad_actions::{ActionTable, Binding, Control};

/// Meaning of a name in a table.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Meaning {
    Undo,
    Redo,
    Fit,
    /// While held: the pen turns, slides or zooms the view.
    Turn,
    Slide,
    Zoom,
    /// While held: the pen drags the brush's radius (sideways) and strength (up and down).
    RadiusAndStrength,
    /// Carves where it would add, and the other way round; while held, or from now on.
    Invert,
    /// Another brush; while held, or from now on.
    Brush(BrushKind),
    /// Values.
    Radius,
    Strength,
}

/// The names that a table may use, for messages.
pub const NAMES: &str = "undo, redo, view.fit, view.turn, view.slide, view.zoom, brush.radius, \
    brush.strength, brush.radius-and-strength, brush.invert, or brush. and the name of a brush";

pub(crate) fn meaning(name: &str) -> Option<Meaning> {
    Some(match name {
        "undo" => Meaning::Undo,
        "redo" => Meaning::Redo,
        "view.fit" => Meaning::Fit,
        "view.turn" => Meaning::Turn,
        "view.slide" => Meaning::Slide,
        "view.zoom" => Meaning::Zoom,
        "brush.radius-and-strength" => Meaning::RadiusAndStrength,
        "brush.invert" => Meaning::Invert,
        "brush.radius" => Meaning::Radius,
        "brush.strength" => Meaning::Strength,
        other => Meaning::Brush(other.strip_prefix("brush.")?.parse().ok()?),
    })
}

/// Returns the user's choices for a control, with their labels. Keys and buttons press, hold, or
/// take one step; rotating controls take steps.
pub fn choices(control: Control) -> Vec<(String, Binding)> {
    let turn = |words: &str, value: &str, step| {
        let value = value.to_owned();
        (words.to_owned(), Binding::Turn { value, step })
    };
    let nothing = ("Nothing".to_owned(), Binding::Nothing);
    if matches!(control, Control::Wheel(_) | Control::Ring(_) | Control::Strip(_)) {
        return vec![
            nothing,
            turn("Radius", "brush.radius", 0.05),
            turn("Radius, the other way round", "brush.radius", -0.05),
            turn("Strength", "brush.strength", 0.05),
            turn("Strength, the other way round", "brush.strength", -0.05),
        ];
    }
    let press = |words: &str, name: &str| (words.to_owned(), Binding::Press(name.to_owned()));
    let hold = |words: &str, name: &str| (words.to_owned(), Binding::Hold(name.to_owned()));
    let mut all = vec![
        nothing,
        press("Undo", "undo"),
        press("Redo", "redo"),
        press("Frame the sculpture", "view.fit"),
        hold("Turn the view while held", "view.turn"),
        hold("Slide the view while held", "view.slide"),
        hold("Zoom while held", "view.zoom"),
        hold("Radius and strength by dragging", "brush.radius-and-strength"),
        hold("Carve while held", "brush.invert"),
        press("Carve or raise", "brush.invert"),
        turn("Larger brush", "brush.radius", 0.1),
        turn("Smaller brush", "brush.radius", -0.1),
        turn("Stronger brush", "brush.strength", 0.05),
        turn("Weaker brush", "brush.strength", -0.05),
    ];
    for kind in BrushKind::ALL {
        let name = format!("brush.{kind}");
        all.push((format!("Brush {kind}"), Binding::Press(name.clone())));
        all.push((format!("Brush {kind} while held"), Binding::Hold(name)));
    }
    all
}

/// Checks that every name of a table is known.
///
/// # Errors
/// Returns an error that names the control, the unknown name and the known names.
pub fn check(table: &ActionTable) -> Result<(), String> {
    table.check()?;
    for (control, binding) in table.controls.iter().chain(table.modes.iter().flatten()) {
        if let Binding::Press(name) | Binding::Hold(name) | Binding::Turn { value: name, .. } =
            binding
            && meaning(name).is_none()
        {
            return Err(format!("actions: {control}: '{name}': expected one of {NAMES}"));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_choice_is_one_that_the_loop_knows() {
        for control in [Control::Key(1), Control::Barrel(2), Control::Ring(1), Control::Eraser] {
            let all = choices(control);
            assert!(all.len() > 4);
            for (words, binding) in all {
                let table =
                    ActionTable { controls: [(control, binding)].into(), modes: Vec::new() };
                assert_eq!(check(&table), Ok(()), "{words}");
            }
        }
    }

    #[test]
    fn a_name_that_nobody_knows_is_refused_with_its_control() {
        let table: ActionTable =
            toml::from_str("[controls]\nkey-2 = { press = \"brush.clay\" }\n").expect("parses");
        assert_eq!(check(&table), Ok(()));
        let wrong: ActionTable =
            toml::from_str("[controls]\nkey-2 = { press = \"fly\" }\n").expect("parses");
        let said = check(&wrong).expect_err("refused");
        assert!(said.contains("key-2") && said.contains("'fly'"), "{said}");
        assert_eq!(check(&ActionTable::defaults()), Ok(()));
    }
}
