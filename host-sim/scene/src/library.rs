//! The built-in scenes.

/// Scene that is built into the command, with its text as a template for users.
#[derive(Clone, Copy, Debug)]
pub struct BuiltIn {
    /// Name on the command line.
    pub name: &'static str,
    /// Text of the scene file.
    pub text: &'static str,
}

macro_rules! scenes {
    ($($name:literal),* $(,)?) => {
        &[$(BuiltIn { name: $name, text: include_str!(concat!("../../scenes/", $name, ".toml")) }),*]
    };
}

/// Scene that `cophase run` runs without an argument. It shows the purpose of the controller: a fault, its detection and its
/// correction.
pub const FIRST: &str = "coupling-slip";

/// All built-in scenes. The first is the template for users' scenes.
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

/// Returns the built-in scene with a name.
pub fn find(name: &str) -> Option<&'static BuiltIn> {
    SCENES.iter().find(|scene| scene.name == name)
}
