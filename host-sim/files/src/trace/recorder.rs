//! Observer of a scene's run that writes its traces.

use std::io::{Seek, Write};

use cophase_link::sample::Sample;
use host_sim::checked::Checked;
use host_sim::sim::{Moment, Observer};

use super::mcap::McapTraceError;
use super::overdue::PhaseSensor;
use super::rows::Every;
use super::traces::{TraceSetup, Traces};
use super::turn_amplitude::TurnAmplitude;
use super::window::Window;
use super::{
    ControllerRows, EdgeError, Format, Row, RowShape, RowsUdp, ScopeData, TickEdges, TraceError,
};

/// Error while a trace was written.
#[derive(Debug, thiserror::Error)]
pub enum RecordError {
    /// In `trace.csv`.
    #[error("{file}: {0}", file = Format::Csv.file_name())]
    Csv(#[from] TraceError),
    /// In `trace.mcap`.
    #[error("{file}: {0}", file = Format::Mcap.file_name())]
    Mcap(#[from] McapTraceError),
    /// In a file of edges.
    #[error("edges: {0}")]
    Edges(#[from] EdgeError),
}

/// File of any kind. With it, the recorder is compiled in this crate, and not again in each crate that runs scenes.
trait File: Write + Seek {}

impl<W: Write + Seek> File for W {}

/// Writes the files of a trace, and collects the data for `scope.svg`.
pub struct Recorder<'a> {
    traces: Traces<'a, Box<dyn File + 'a>>,
    rows: ControllerRows,
    row: Row,
    amplitude: TurnAmplitude,
    sensors: Vec<PhaseSensor>,
    reversed: Vec<bool>,
    failed: Option<RecordError>,
}

impl<'a> Recorder<'a> {
    /// Writes a scene's run to `files`, of which each format has at most one. Sends its rows to `udp`, and fills `scope`.
    ///
    /// # Errors
    /// A header cannot be written.
    pub fn new<W: Write + Seek + 'a>(
        checked: &Checked,
        files: impl IntoIterator<Item = (Format, W)>,
        udp: Option<&'a mut RowsUdp>,
        every: Every,
        window: Window,
        scope: ScopeData,
    ) -> Result<Self, RecordError> {
        let axes = checked.scene.axes.count;
        let reversed = (0..axes)
            .map(|i| checked.scene.resolved(i).own.reversed)
            .collect();
        let files = files.into_iter();
        let files: Vec<_> = files
            .map(|(format, w)| (format, Box::new(w) as Box<dyn File + 'a>))
            .collect();
        let setup = TraceSetup {
            shape: RowShape::for_scene(checked),
            every,
            window,
            unknown: &[],
        };
        Ok(Self {
            traces: Traces::new(&setup, files, udp, scope)?,
            rows: ControllerRows::new(&checked.settings),
            row: Row::of_axes(axes),
            amplitude: TurnAmplitude::AT_REST,
            sensors: (0..axes).map(|i| PhaseSensor::new(checked, i)).collect(),
            reversed,
            failed: None,
        })
    }

    /// Closes the files. Returns the form of the written trace, and the content of the scope.
    ///
    /// # Errors
    /// The first error of a file.
    pub fn finish(self) -> Result<(super::TraceInfo, ScopeData), RecordError> {
        match self.failed {
            Some(error) => Err(error),
            None => self.traces.finish(),
        }
    }

    fn fill(&mut self, moment: &Moment<'_>) {
        // The row has the time of the tick that is played, and not the number of the tick in which it was planned.
        let sample = Sample::new(0, moment.telemetry, 0, 0);
        let row = &mut self.row;
        let (master_turns, command_turns) = (moment.master_turns, moment.command_turns);
        self.rows
            .fill(row, moment.end_ns, &sample, master_turns, command_turns);
        for (i, (axis, sensor)) in row.axes.iter_mut().zip(&mut self.sensors).enumerate() {
            axis.actual_turns = moment.actual_turns[i];
            axis.is_overdue = sensor.is_overdue(command_turns[i], moment.index[i].is_some());
        }
        let pose = moment.pose();
        row.tilt_x_mrad = pose.tilt_x_mrad;
        row.tilt_y_mrad = pose.tilt_y_mrad;
        row.warp_deg = pose.warp_deg;
        row.z_m = pose.z_m;
        row.accel_mps2 = pose.accel_mps2;
        row.amax_actual_mps2 =
            self.amplitude
                .measure(row.omega_rad_s, row.phase_turns, row.accel_mps2);
        row.pitch_mrad = pose.pitch_mrad;
    }
}

impl Observer for Recorder<'_> {
    fn tick(&mut self, moment: &Moment<'_>) {
        if self.failed.is_some() {
            return;
        }
        self.fill(moment);
        let edges = TickEdges::from_moment(moment, &self.reversed);
        let done = self
            .traces
            .push_row(&self.row)
            .and_then(|()| self.traces.push_edges(&edges, Some(&self.row)));
        self.failed = done.err();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::trace::{Format, ScopeFrame};
    use cophase_scene::load;
    use host_sim::sim::simulate;
    use std::io::Cursor;

    /// Runs a scene. Returns the text of one of its files, with rows every `every` ticks.
    fn recorded(text: &str, format: Format, every: u64) -> String {
        let checked = Checked::new(load::parse(text).unwrap()).unwrap();
        let mut file = Cursor::new(Vec::new());
        let scope = ScopeData::new(checked.scene.axes.count, ScopeFrame::for_scene(&checked));
        let (every, files) = (Every::Ticks(every), [(format, &mut file)]);
        let mut recorder = Recorder::new(&checked, files, None, every, Window::All, scope).unwrap();
        simulate(&checked, &mut recorder, |_, _| ()).unwrap();
        recorder.finish().unwrap();
        String::from_utf8(file.into_inner()).unwrap()
    }

    fn scene(index_width_deg: f64) -> String {
        format!(
            "name = \"held\"\n[machine]\ncrank_radius_mm = 10\nlambda = 0.25\nload_kg = 5\n\
             [limits]\nspeed_hz = 40\nacceleration_hz_per_s = 40\njerk_hz_per_s2 = 400\n\
             [axes]\ncount = 3\ndrive = \"servo\"\nsteps_per_turn = 4096\nindex_width_deg = {index_width_deg}\n\
             [[program]]\namax_g = 30\nramp_s = 1\nhold_s = 1\n"
        )
    }

    /// If this fails, a steady amplitude appears to change in a trace with few rows, as its rows are at few phases of the crank.
    #[test]
    fn a_trace_with_few_rows_has_the_amplitude_of_every_turn() {
        let text = recorded(&scene(0.0), Format::Csv, 25);
        let mut rows = ::csv::Reader::from_reader(text.as_bytes());
        let names = rows.headers().unwrap().clone();
        let place = |name: &str| names.iter().position(|known| known == name).unwrap();
        let places = ["amax_commanded_mps2", "amax_actual_mps2", "accel_mps2"].map(place);
        let rows: Vec<[f64; 3]> = rows
            .records()
            .map(|row| {
                row.map(|row| places.map(|place| row[place].parse().unwrap()))
                    .unwrap()
            })
            .collect();
        let top = rows.iter().map(|row| row[0]).fold(0.0, f64::max);
        // The first rows at the level may have the amplitude of a turn in the ramp.
        let held: Vec<_> = rows.iter().filter(|row| row[0] == top).skip(10).collect();
        assert!(held.len() > 50, "{} rows", held.len());
        let of = |column: usize| held.iter().map(move |row| row[column].abs());
        assert!(
            of(1).all(|actual| (actual / top - 1.0).abs() < 5e-3),
            "{:?}",
            of(1).collect::<Vec<_>>()
        );
        assert!(
            of(2).any(|accel| accel < 0.9 * top),
            "the rows are at other phases too"
        );
    }

    /// If this fails, an index pulse in `steps.vcd` is a tick long, or as long at any speed of the crank.
    #[test]
    fn an_index_pulse_lasts_while_the_flag_is_in_the_sensor() {
        let text = recorded(&scene(17.0), Format::Vcd, 1);
        let id = text
            .lines()
            .find(|line| line.contains(" index_0 "))
            .unwrap();
        let id = id.split_whitespace().nth(3).unwrap().to_owned();
        let (mut now_ns, mut edges) = (0_u64, Vec::new());
        for line in text.split("$dumpvars").nth(1).unwrap().lines() {
            if let Some(time) = line.strip_prefix('#') {
                now_ns = time.parse().unwrap();
            } else if line.strip_prefix(['0', '1']) == Some(&id) {
                edges.push((now_ns, line.starts_with('1')));
            }
        }
        // Pairs of a turn and its pulse in the steady part: the turns that are shortest.
        let rises: Vec<u64> = edges
            .iter()
            .filter(|edge| edge.1)
            .map(|edge| edge.0)
            .collect();
        let shortest = rises
            .windows(2)
            .map(|pair| pair[1] - pair[0])
            .min()
            .unwrap();
        let mut checked = 0;
        for turn in edges.windows(3).filter(|turn| turn[0].1) {
            let (whole, high) = (turn[2].0 - turn[0].0, turn[1].0 - turn[0].0);
            if whole < shortest + shortest / 1000 {
                let degrees = 360.0 * high as f64 / whole as f64;
                assert!((degrees - 17.0).abs() < 0.1, "high for {degrees} degrees");
                checked += 1;
            }
        }
        assert!(checked > 20, "{checked} turns");
    }
}
