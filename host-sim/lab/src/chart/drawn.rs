//! Input and output of every chart.

use std::fmt;

/// Finished chart.
#[derive(Clone, Debug)]
pub struct Drawn {
    /// Data, with a header.
    pub csv: String,
    /// Pictures, at least one, each with its own file.
    pub pictures: Vec<DrawnPicture>,
    /// Message of one or two sentences for each picture, also printed below it.
    pub says: String,
}

impl Drawn {
    /// Chart with one picture, whose file has the chart's name.
    pub fn one(csv: String, svg: String, says: String) -> Self {
        let pictures = vec![DrawnPicture { part: None, svg }];
        Self {
            csv,
            pictures,
            says,
        }
    }

    /// Returns the names and texts of all files of the chart `name`: the data, then the pictures.
    pub fn files(&self, name: &str) -> Vec<(String, &str)> {
        let data = (format!("{name}.csv"), self.csv.as_str());
        let pictures = self.pictures.iter().map(|picture| {
            let file = match picture.part {
                None => format!("{name}.svg"),
                Some(part) => format!("{name}-{part}.svg"),
            };
            (file, picture.svg.as_str())
        });
        std::iter::once(data).chain(pictures).collect()
    }
}

/// Picture of a chart.
#[derive(Clone, Debug)]
pub struct DrawnPicture {
    /// Part of the chart that it shows, at the end of the file's name; `None` if it shows the whole chart.
    pub part: Option<&'static str>,
    /// Picture as SVG text.
    pub svg: String,
}

/// Size of the measurements.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Size {
    /// Fewer points and shorter runs, which take seconds even in a debug build.
    Small,
    /// Size of the manual.
    #[default]
    Full,
}

/// Callback for progress: the finished part, and the whole.
pub type Progress<'a> = &'a mut dyn FnMut(u64, u64);

/// Reason why a chart could not be made. It is no `Error` itself, so that every error converts to it.
#[derive(Clone, Debug)]
pub struct ChartError(pub String);

impl fmt::Display for ChartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.0)
    }
}

impl<E: std::error::Error> From<E> for ChartError {
    fn from(error: E) -> Self {
        Self(error.to_string())
    }
}
