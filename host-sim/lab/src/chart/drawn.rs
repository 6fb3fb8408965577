//! What every chart is asked for, and gives.

/// A chart that was made.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// Data, with a header.
    pub csv: String,
    /// The picture.
    pub svg: String,
    /// What it says, in a sentence or two; it stands under the picture too.
    pub says: String,
}

/// How much is measured.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Size {
    /// Fewer points, shorter runs: seconds even where nothing is optimised.
    Small,
    /// What the docs show.
    #[default]
    Full,
}

/// Told how much is done, of how much.
pub type Progress<'a> = &'a mut dyn FnMut(u64, u64);

/// Why a chart could not be made.
#[derive(Clone, Debug, thiserror::Error)]
#[error("{0}")]
pub struct ChartError(pub String);
