//! `steps.gtkw`: a layout for GTKWave with the wires, speed, phase errors and acceleration of a run's own axes.

/// Text of the layout for a number of axes. Lines that begin with `@` are GTKWave's flags of the traces that follow.
pub fn gtkwave_layout(axes: usize) -> String {
    const BLANK: &str = "@200";
    const BIT: &str = "@28";
    // Flags: right-justified, decimal real, interpolated analogue curve. A blank line follows, over which the curve
    // extends.
    const CURVE: &str = "@88420";
    const EXTENDED: &str = "@20000";
    let mut text = "[*] Wires and signals of a run: gtkwave steps.fst steps.gtkw\n\
                    [*] steps.vcd has the wires only; GTKWave leaves out what a file does not have.\n\
                    [size] 1300 820\n[pos] -1 -1\n"
        .to_owned();
    text += &format!("*-25.000000{}\n", " -1".repeat(27));
    text += "[sst_width] 10\n[signals_width] 190\n[sst_expanded] 0\n";
    text += &format!("{BLANK}\n-wires\n{BIT}\ncophase.enable\ncophase.sync\n");
    for wire in ["step", "dir", "index"] {
        for axis in 0..axes {
            text += &format!("cophase.{wire}_{axis}\n");
        }
    }
    // One quantity of the machine: a curve of three lines, under a heading.
    let curve = |heading: &str, signal: &str| {
        format!("{BLANK}\n-{heading}\n{CURVE}\ncophase.{signal}\n{EXTENDED}\n-\n-\n")
    };
    text += &curve("speed, rad/s", "omega_rad_s");
    text += &format!("{BLANK}\n-phase error, deg\n");
    for axis in 0..axes {
        text += &format!("{CURVE}\ncophase.phase_error_deg_{axis}\n{EXTENDED}\n-\n");
    }
    text + &curve("acceleration, m/s2", "accel_mps2")
}
