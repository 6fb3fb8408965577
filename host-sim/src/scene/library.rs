//! The built-in scenes.

/// A scene that comes with the command: its name, and its text, to start one's own from.
#[derive(Clone, Copy, Debug)]
pub struct BuiltIn {
    /// What to call it on the command line.
    pub name: &'static str,
    /// The scene file.
    pub text: &'static str,
}

impl BuiltIn {
    /// Machine that it describes, for lists.
    pub fn machine(&self) -> &'static str {
        let scene = self.scene();
        match (&scene.machine, &scene.cam, scene.plant_table()) {
            (Some(machine), ..) => machine.mechanism.name(),
            (_, Some(cam), _) if cam.screw_lead_mm.is_some() => "electronic cam",
            (_, Some(_), _) => "cam shaft",
            (.., Some(table)) => table.key(),
            (None, None, None) => "no machine",
        }
    }
}

macro_rules! scenes {
    ($($name:literal),* $(,)?) => {
        &[$(BuiltIn { name: $name, text: include_str!(concat!("../../scenes/", $name, ".toml")) }),*]
    };
}

/// Scene that `cophase run` runs when it is given none. It shows on one page what the controller is for: a fault, its detection and its
/// correction.
pub const FIRST: &str = "coupling-slip";

/// All of them; the first is the one to start a scene of one's own from.
pub const SCENES: &[BuiltIn] = scenes![
    "default",
    "coupling-slip",
    "patent-1",
    "patent-2",
    "patent-3",
    "patent-4",
    "lost-steps",
    "stiff-bearing",
    "pulse-servo",
    "scotch-yoke",
    "crank-rocker",
    "suspended",
    "wrapper",
    "screen",
    "jaw-crusher",
    "five-bar",
    "electronic-cam",
];

/// Finds one by its name.
pub fn find(name: &str) -> Option<&'static BuiltIn> {
    SCENES.iter().find(|scene| scene.name == name)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Checked;

    #[test]
    fn all_are_well_formed_and_called_what_they_are_called() {
        for built_in in SCENES {
            let scene = built_in.scene();
            assert_eq!(scene.name, built_in.name);
            assert!(!scene.description.is_empty());
            Checked::new(scene).unwrap();
        }
    }
}
