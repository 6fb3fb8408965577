//! Charts: speed against accuracy, and where methods stop being stable. Each is data (CSV) and a picture (SVG).
//!
//! Both are the same on every run: costs are counted, not timed.

mod counted;
mod methods;
mod picture;
mod stability;

/// A chart that was made.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// Data, with a header.
    pub csv: String,
    /// The picture.
    pub svg: String,
    /// What it says, in a sentence or two.
    pub says: String,
}

/// A chart that can be made.
#[derive(Clone, Copy, Debug)]
pub struct Chart {
    /// As it is called on the command line, and its files.
    pub name: &'static str,
    /// What it shows, in a line.
    pub shows: &'static str,
    /// Makes it.
    pub draw: fn() -> Drawn,
}

/// All charts.
pub const CHARTS: [Chart; 2] = [
    Chart {
        name: "methods",
        shows: "error against cost of each method, on problems whose answers are published",
        draw: methods::draw,
    },
    Chart {
        name: "stability",
        shows: "growth a step against step × frequency of each method, and the edge beside its theory",
        draw: stability::draw,
    },
];

/// A chart by its name.
pub fn find(name: &str) -> Option<&'static Chart> {
    CHARTS.iter().find(|chart| chart.name == name)
}
