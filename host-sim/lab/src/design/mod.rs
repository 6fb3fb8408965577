//! Design methods: from a requirement to the size of a machine.
//!
//! Each machine has a method of its own, a module here and a variant of [`Machine`]. Its requirement is its options on the command line, and
//! [`Method`] leads from them to all outputs. If a method has no solution, its error names the responsible option.

pub mod crank_rocker;
pub mod five_bar;
pub mod flywheel;
mod page;
pub mod platform;
mod range;
mod scene;
pub mod screen;

use std::io::{self, Write};
use std::path::PathBuf;

use serde::Serialize;

use scene::runnable;

pub use range::{OutOfRange, Range};
pub use scene::NotRunnable;

/// Machines beside the platform.
#[derive(Clone, Debug, clap::Subcommand)]
pub enum Machine {
    /// Find the links of a crank-rocker from the swing of its rocker, for a drive with a screw
    CrankRocker(crank_rocker::CrankRocker),
    /// Find the joint angles of a suspended five-bar arm for a place of its hand
    FiveBar(five_bar::Requirement),
    /// Find the torque curve of a crusher's induction motor, and what its flywheel evens out
    Flywheel(flywheel::Flywheel),
    /// Find springs, natural speed and amplitude of a self-centring vibrating screen
    Screen(screen::Requirement),
}

/// Form of the text that is printed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// A page for people.
    Page,
    /// One JSON object.
    Json,
    /// A scene that can be run.
    Scene,
}

/// Outputs of a design.
#[derive(Clone, Debug)]
pub struct Printed {
    /// Text in the requested form.
    pub text: Vec<u8>,
    /// SVG text, and the file for it.
    pub drawing: Option<(PathBuf, String)>,
}

/// Reason why there is no design, or not in this form. It has a line for each wrong number.
#[derive(Debug)]
pub struct Refused(pub String);

impl<E: std::error::Error> From<E> for Refused {
    fn from(error: E) -> Self {
        Self(error.to_string())
    }
}

/// Method of a machine, with the values of its options.
pub trait Method {
    /// The designed machine.
    type Design;
    /// The object that `--json` prints.
    type Figures: Serialize;

    /// Sizes the machine.
    ///
    /// # Errors
    /// A number is out of its range, or no machine meets the requirement.
    fn design(&self) -> Result<Self::Design, Refused>;

    /// Returns the figures of a design.
    fn figures(&self, design: &Self::Design) -> Self::Figures;

    /// Writes a design for people.
    ///
    /// # Errors
    /// `out` cannot be written.
    fn write_page(&self, design: &Self::Design, out: &mut dyn Write) -> io::Result<()>;

    /// Returns a scene, as TOML text.
    ///
    /// # Errors
    /// The design leaves too much open.
    fn scene(&self, design: &Self::Design) -> Result<String, Refused>;

    /// Returns the requested drawing, as SVG text, with its file.
    ///
    /// # Errors
    /// It cannot be drawn.
    fn drawing(&self, _: &Self::Design) -> Result<Option<(PathBuf, String)>, Refused> {
        Ok(None)
    }
}

impl Machine {
    /// Designs the machine.
    ///
    /// # Errors
    /// Those of [`print()`].
    pub fn print(&self, form: Form) -> Result<Printed, Refused> {
        match self {
            Self::CrankRocker(method) => print(method, form),
            Self::FiveBar(method) => print(method, form),
            Self::Flywheel(method) => print(method, form),
            Self::Screen(method) => print(method, form),
        }
    }
}

/// Designs a machine by its method.
///
/// # Errors
/// There is no design; or a run would refuse its scene, for instance for a speed outside the range of scenes.
pub fn print<M: Method>(method: &M, form: Form) -> Result<Printed, Refused> {
    let design = method.design()?;
    let mut text = Vec::new();
    match form {
        Form::Page => method.write_page(&design, &mut text)?,
        Form::Json => {
            serde_json::to_writer_pretty(&mut text, &method.figures(&design))?;
            text.push(b'\n');
        }
        Form::Scene => text = runnable(method.scene(&design)?)?.into_bytes(),
    }
    Ok(Printed {
        text,
        drawing: method.drawing(&design)?,
    })
}

/// Refuses the scene of a machine that is designed in part.
fn no_scene(machine: &str) -> Refused {
    Refused(format!(
        "--scene: the design of a {machine} leaves too much open for a scene; start from `cophase scenes {machine}`"
    ))
}
